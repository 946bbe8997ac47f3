"""The same problem through pneurod and its peers: tables of what it costs and what comes out.

    make bench-peers        # or: python -m benchmarks.peers --python .venv-peers/bin/python

Runs are interleaved and stored one by one in results/peers/peers.json; the same command continues the rounds of the
same day. Before each round the load of the machine is measured, and the round is refused while other programs compute.
`--fresh` forgets all runs. Without names, the peers that take minutes for a run (scikit-fem with SuperLU, CalculiX,
NGSolve with compiled forms) are left out.
"""

import argparse
import os
import platform
import shutil
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.peers import load
from benchmarks.peers.runs import ROOT, Peer, Round, RunFailed, Session, measured, plan
from benchmarks.peers.tables import answers, costs
from pipeline.store.provenance import processor

PEERS = (
    Peer("pneurod", "by_pneurod", own=True),
    Peer("NGSolve", "by_ngsolve"),
    Peer("NGSolve, forms as C++", "by_ngsolve", options=("--cpp",), command="c++", package="g++", default=False),
    Peer("FElupe", "by_felupe"),
    Peer("scikit-fem and SciPy", "by_skfem", repetitions=1, paths=("four",), default=False),
    Peer(
        "CalculiX",
        "by_calculix",
        command="ccx",
        package="calculix-ccx",
        repetitions=1,
        paths=("four",),
        default=False,
    ),
)


def machine() -> str:
    """Processor, number of cores and Python."""
    return f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}"


def absent(peer: Peer) -> str:
    """What to do for a peer whose program is missing; empty for one that can run."""
    if not peer.command or shutil.which(peer.command):
        return ""
    return f"not installed: `apt-get install --no-install-recommends {peer.package}`"


def chosen(names: Sequence[str]) -> list[Peer]:
    """The peers of these names, and pneurod with them; those that run by default where there are none.

    Raises ValueError for a name that is none of a peer.
    """
    if unknown := set(names) - {peer.name for peer in PEERS}:
        known = ", ".join(peer.name for peer in PEERS)
        raise ValueError(f"{', '.join(sorted(unknown))}: no peer of that name; there are {known}")
    return [peer for peer in PEERS if (peer.name in names or peer.own if names else peer.default)]


def say(sentence: str) -> None:
    """To the terminal."""
    print(sentence, flush=True)  # noqa: T201


def run_rounds(
    session: Session, peers: Sequence[Peer], options: argparse.Namespace, stored: Path, here: tuple[str, str]
) -> bool:
    """Run what is left of the rounds; False where the machine was too busy for the next one.

    here: date and machine.
    """
    for number, left in plan(peers, options.rounds, session.made(here)):
        try:
            busy = load.measured()
        except load.Busy as reason:
            say(f"round {number} is not run: {reason}")
            return False
        say(f"round {number}: other programs use {busy:.2f} cores")
        for peer, path in left:
            try:
                python = sys.executable if peer.own else options.python
                run = measured(peer, path, python, Round(*here, number, busy))
            except RunFailed as failure:
                session.missing[peer.name] = str(failure)
                say(str(failure))
                continue
            session.runs.append(run)
            session.save(stored)
            say(f"{peer.name}, {path}: {run.outcome.factorizations} factorizations, {run.cpu:.1f} s CPU")
    return True


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("peers", nargs="*", help="their names; pneurod runs beside them in each round")
    parser.add_argument("--python", default=".venv-peers/bin/python", help="of the peers' virtual environment")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--fresh", action="store_true", help="forget the runs that are stored")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "peers", help="folder of peers.json")
    options = parser.parse_args()
    try:
        peers = [peer for peer in chosen(options.peers) if not absent(peer)]
    except ValueError as reason:
        parser.error(str(reason))
    stored, here = options.out / "peers.json", (datetime.now(UTC).date().isoformat(), machine())
    session = Session() if options.fresh or not stored.exists() else Session.load(stored)
    session.missing = {peer.name: why for peer in PEERS if (why := absent(peer))}
    if plan(peers, options.rounds, session.made(here)):
        measured(PEERS[0], "four", sys.executable, Round(*here, 0, None))  # not counted: compiles the kernels
    complete = run_rounds(session, peers, options, stored, here)
    session.save(stored)
    made = session.made(here)
    for path in ("four", "straight"):
        say(f"\n{path}\n\n{costs(PEERS, path, made, session.missing)}")
    say(f"\n{answers(PEERS, made)}")
    return 0 if complete else 1


if __name__ == "__main__":
    sys.exit(main())
