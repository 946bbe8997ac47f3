"""The same problem through pneurod and its peers: docs/peers.md and docs/peers.json.

    make bench-peers        # or: python -m benchmarks.peers --python .venv-peers/bin/python

Runs are interleaved and stored one by one; the same command continues a session. `--fresh` starts a new one.
"""

import argparse
import os
import platform
import shutil
import sys
from pathlib import Path

from benchmarks.peers.page import page
from benchmarks.peers.runs import ROOT, Peer, RunFailed, Session, measured, plan

PEERS = (
    Peer("pneurod", "by_pneurod", own=True),
    Peer("NGSolve", "by_ngsolve"),
    Peer("NGSolve, forms as C++", "by_ngsolve", options=("--cpp",), command="c++", package="g++"),
    Peer("FElupe", "by_felupe"),
    Peer("scikit-fem and SciPy", "by_skfem", repetitions=1, paths=("four",)),
    Peer("CalculiX", "by_calculix", command="ccx", package="calculix-ccx", repetitions=1, paths=("four",)),
)


def machine() -> str:
    """Processor, number of cores and Python."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"


def absent(peer: Peer) -> str:
    """What to do for a peer whose program is missing; empty for one that can run."""
    if not peer.command or shutil.which(peer.command):
        return ""
    return f"not installed: `apt-get install --no-install-recommends {peer.package}`"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=".venv-peers/bin/python", help="of the peers' virtual environment")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--at-most", type=int, default=sys.maxsize, help="number of runs this time")
    parser.add_argument("--fresh", action="store_true", help="forget the runs stored so far")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="folder of peers.md and peers.json")
    options = parser.parse_args()
    stored = options.out / "peers.json"
    session = Session(machine()) if options.fresh or not stored.exists() else Session.load(stored)
    session.missing = {peer.name: why for peer in PEERS if (why := absent(peer))}
    if not session.runs:
        measured(PEERS[0], "four", sys.executable)  # not counted: compiles the kernels where they are not on disk yet
    left = [(peer, path) for peer, path in plan(PEERS, options.rounds, session.runs) if not absent(peer)]
    for peer, path in left[: options.at_most]:
        try:
            run = measured(peer, path, sys.executable if peer.own else options.python)
        except RunFailed as failure:
            session.missing[peer.name] = str(failure)
            print(failure, file=sys.stderr)  # noqa: T201
            continue
        session.runs.append(run)
        session.save(stored)
        print(f"{peer.name}, {path}: {run.outcome.factorizations} factorizations, {run.cpu:.1f} s CPU", flush=True)  # noqa: T201
    session.save(stored)
    (options.out / "peers.md").write_text(page(PEERS, session), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
