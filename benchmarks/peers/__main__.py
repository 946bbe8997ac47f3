"""The same problem through pneurod and its peers: tables of what it costs and what comes out.

    make bench-peers        # or: python -m benchmarks.peers --python .venv-peers/bin/python

In each round every solver runs once on both paths, each run in a process of its own. Before each round the load of the
machine is measured, and the rounds end where other programs compute. Runs are written into results/peers/peers.json.
"""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from benchmarks.peers import load
from benchmarks.peers.runs import ROOT, Peer, Run, RunFailed, measured
from benchmarks.peers.tables import answers, costs

PEERS = (Peer("pneurod", "by_pneurod", own=True), Peer("NGSolve", "by_ngsolve"), Peer("FElupe", "by_felupe"))
#: to the four pressures one after the other, and straight to the last one
PATHS = ("four", "straight")


def say(sentence: str) -> None:
    """To the terminal."""
    print(sentence, flush=True)  # noqa: T201


def runs_of_rounds(rounds: int, python: str) -> tuple[list[Run], dict[str, str]]:
    """The runs of so many rounds, fewer where the machine is too busy for the next one; and why a peer gave none."""
    runs: list[Run] = []
    missing: dict[str, str] = {}
    measured(PEERS[0], "four", sys.executable, 0)  # not counted: compiles the kernels
    for number in range(1, rounds + 1):
        try:
            busy = load.check_load()
        except load.Busy as reason:
            say(f"round {number} is not run: {reason}")
            break
        say(f"round {number}: other programs use {busy:.2f} cores")
        for peer, path in [(peer, path) for peer in PEERS for path in PATHS]:
            try:
                run = measured(peer, path, sys.executable if peer.own else python, number)
            except RunFailed as failure:
                missing[peer.name] = str(failure)
                say(str(failure))
                continue
            runs.append(run)
            say(f"{peer.name}, {path}: {run.outcome.factorizations} factorizations, {run.cpu:.1f} s CPU")
    return runs, missing


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=".venv-peers/bin/python", help="of the peers' virtual environment")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "peers", help="folder of peers.json")
    options = parser.parse_args()
    runs, missing = runs_of_rounds(options.rounds, options.python)
    options.out.mkdir(parents=True, exist_ok=True)
    text = json.dumps([asdict(run) for run in runs], indent=1) + "\n"
    (options.out / "peers.json").write_text(text, encoding="utf-8")
    for path in PATHS:
        say(f"\n{path}\n\n{costs(PEERS, path, runs, missing)}")
    say(f"\n{answers(PEERS, runs)}")
    return 0 if runs and runs[-1].number == options.rounds and not missing else 1


if __name__ == "__main__":
    sys.exit(main())
