"""Runs in separate processes that are measured from outside, and the session that stores them one by one."""

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median
from time import perf_counter

from benchmarks.peers.problem import Outcome

ROOT = Path(__file__).resolve().parents[2]
THREADS = ("OMP", "MKL", "OPENBLAS", "NUMBA")


@dataclass(frozen=True)
class Peer:
    """One row of the table."""

    name: str  #: as the rows call it
    module: str
    own: bool = False  #: runs with the project's Python, not with the peers'
    options: tuple[str, ...] = ()
    command: str = ""  #: a program that must be there
    package: str = ""  #: the Debian package that brings it
    repetitions: int = 3  #: at the most
    paths: tuple[str, ...] = ("four", "straight")


@dataclass(frozen=True)
class Run:
    """One process: what it handed back and what it cost, children included."""

    peer: str
    path: str
    outcome: Outcome
    cpu: float  #: s, user and system, from start to exit
    wall: float  #: s
    peak: float  #: MB, largest resident set


class RunFailed(RuntimeError):
    """A peer ended without an outcome; the sentence is the last line of its output."""


def measured(peer: Peer, path: str, python: str) -> Run:
    """Run a peer once; raises `RunFailed`."""
    environment = {name: os.environ[name] for name in ("HOME", "LANG", "TMPDIR") if name in os.environ}
    environment["PATH"] = f"{Path(python).absolute().parent}:{os.environ['PATH']}"
    environment |= {f"{name}_NUM_THREADS": "1" for name in THREADS}
    with tempfile.TemporaryDirectory() as folder:
        out, log = Path(folder, "outcome.json"), Path(folder, "log")
        command = [python, "-m", f"benchmarks.peers.{peer.module}", path, str(out), *peer.options]
        with log.open("w") as output:
            begin = perf_counter()
            process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=output, stderr=output)
            _, status, used = os.wait4(process.pid, 0)
            wall = perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode or not out.exists():
            lines = log.read_text(errors="replace").strip().splitlines() or ["without output"]
            raise RunFailed(f"{peer.name}, {path}: exit status {process.returncode}: {lines[-1]}")
        outcome = outcome_of(json.loads(out.read_text(encoding="utf-8")))
    return Run(peer.name, path, outcome, used.ru_utime + used.ru_stime, wall, used.ru_maxrss / 1024)


def plan(peers: Sequence[Peer], rounds: int, done: Sequence[Run]) -> list[tuple[Peer, str]]:
    """What is still to be run, interleaved: every peer once, then every peer again."""
    left = []
    for number in range(rounds):
        for peer in peers:
            for path in peer.paths:
                before = sum(run.peer == peer.name and run.path == path for run in done)
                if before <= number < peer.repetitions:
                    left.append((peer, path))
    return left


def middle(runs: Sequence[Run]) -> Run:
    """The medians of several runs of one peer on one path; what does not vary is taken from the first.

    Raises ValueError where runs of one program on one mesh counted differently: they are not one sample.
    """
    first = runs[0]
    if any(run.outcome.factorizations != first.outcome.factorizations for run in runs):
        raise ValueError(f"{first.peer}, {first.path}: the runs took different numbers of factorizations")
    seconds = {
        name: median(getattr(run.outcome, name) for run in runs) for name in ("set_up_cpu", "solve_cpu", "solve_wall")
    }
    outcome = Outcome(**{**asdict(first.outcome), **seconds})
    whole = {name: median(getattr(run, name) for run in runs) for name in ("cpu", "wall", "peak")}
    return Run(first.peer, first.path, outcome, **whole)


def outcome_of(written: dict) -> Outcome:
    """An outcome as JSON gives it back."""
    answers = {pressure: tuple(answer) for pressure, answer in written["answers"].items()}
    return Outcome(**{**written, "answers": answers})


@dataclass
class Session:
    """What has been run so far, and where."""

    machine: str
    runs: list[Run] = field(default_factory=list)
    missing: dict[str, str] = field(default_factory=dict)  #: peer: why there is no run of it

    @classmethod
    def load(cls, path: Path) -> "Session":
        """A session that was kept."""
        written = json.loads(path.read_text(encoding="utf-8"))
        runs = [Run(**{**run, "outcome": outcome_of(run["outcome"])}) for run in written["runs"]]
        return cls(written["machine"], runs, written["missing"])

    def save(self, path: Path) -> None:
        """Keep the session, whole."""
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(".part")
        fresh.write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")
        fresh.replace(path)
