"""Runs in separate processes that are measured from outside."""

import json
import os
import resource
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from benchmarks.peers.problem import Outcome

ROOT = Path(__file__).resolve().parents[2]
THREADS = ("OMP", "MKL", "OPENBLAS", "NUMBA")


@dataclass(frozen=True)
class Peer:
    """One row of the table."""

    name: str  #: as the rows call it
    module: str
    own: bool = False  #: runs with the project's Python, not with the peers'


@dataclass(frozen=True)
class Run:
    """One process: what it handed back and what it cost, children included."""

    peer: str
    path: str
    outcome: Outcome
    cpu: float  #: s, user and system, from start to exit
    wall: float  #: s
    peak: float  #: MB, largest resident set
    number: int  #: of the round


#: CPU over wall seconds of a path above which more than one thread computed
ONE_THREAD = 1.03


class RunFailed(RuntimeError):
    """A peer ended without an outcome; the sentence is the last line of its output."""


def measured(peer: Peer, path: str, python: str, number: int) -> Run:
    """Run a peer once in a round; raises `RunFailed`, also where more than one thread computed."""
    written, used, wall = processed(peer, python, path)
    outcome = Outcome(**{**written, "answers": {p: tuple(answer) for p, answer in written["answers"].items()}})
    check_threads(peer.name, path, outcome)
    return Run(peer.name, path, outcome, used.ru_utime + used.ru_stime, wall, used.ru_maxrss / 1024, number)


def processed(peer: Peer, python: str, path: str) -> tuple[dict[str, Any], resource.struct_rusage, float]:
    """What the module of a peer writes in a process of its own, what that used, and the wall seconds.

    Raises `RunFailed`.
    """
    environment = {name: os.environ[name] for name in ("HOME", "LANG", "TMPDIR") if name in os.environ}
    environment["PATH"] = f"{Path(python).absolute().parent}:{os.environ['PATH']}"
    environment |= {f"{library}_NUM_THREADS": "1" for library in THREADS}
    with tempfile.TemporaryDirectory() as folder:
        out, log = Path(folder, "outcome.json"), Path(folder, "log")
        command = [python, "-m", f"benchmarks.peers.{peer.module}", path, str(out)]
        with log.open("w") as output:
            begin = perf_counter()
            process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=output, stderr=output)
            _, status, used = os.wait4(process.pid, 0)
            wall = perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode or not out.exists():
            lines = log.read_text(errors="replace").strip().splitlines() or ["without output"]
            raise RunFailed(f"{peer.name}, {path}: exit status {process.returncode}: {lines[-1]}")
        return json.loads(out.read_text(encoding="utf-8")), used, wall


def check_threads(name: str, path: str, outcome: Outcome) -> None:
    """Raise `RunFailed` where threads computed at the same time: seconds would not be those of the others.

    One after the other they may: numba runs parallel loops in a thread of its own, while the main thread waits.
    """
    if outcome.solve_cpu > ONE_THREAD * outcome.solve_wall + 0.05:
        spent = f"{outcome.solve_cpu:.2f} s of CPU in {outcome.solve_wall:.2f} s by {outcome.threads} threads"
        raise RunFailed(f"{name}, {path}: more than one thread computed ({spent})")


@dataclass(frozen=True)
class Spread:
    """The median of several numbers, with the smallest and the largest."""

    median: float
    least: float
    largest: float

    @classmethod
    def of(cls, numbers: Sequence[float]) -> "Spread":
        """Of at least one number."""
        return cls(median(numbers), min(numbers), max(numbers))

    def text(self, digits: int = 1) -> str:
        """The median, and the range in brackets where there is one."""
        if self.least == self.largest:
            return f"{self.median:.{digits}f}"
        return f"{self.median:.{digits}f} ({self.least:.{digits}f} to {self.largest:.{digits}f})"


def fresh(run: Run) -> float:
    """CPU seconds of the whole process."""
    return run.cpu


def warm(run: Run) -> float:
    """CPU seconds of the path in a process in which everything is loaded."""
    return run.outcome.solve_cpu


def ratios(runs: Sequence[Run], own: Sequence[Run], seconds: Callable[[Run], float]) -> Spread:
    """Seconds of a peer's runs over those of our own in the same round.

    Raises ValueError where no round has both.
    """
    ours = {run.number: seconds(run) for run in own}
    shared = [seconds(run) / ours[run.number] for run in runs if run.number in ours]
    if not shared:
        raise ValueError(f"{runs[0].peer}, {runs[0].path}: no round in which pneurod ran too")
    return Spread.of(shared)


def checked(runs: Sequence[Run]) -> Run:
    """The first of several runs of one peer on one path, for what does not vary.

    Raises ValueError where runs of one program on one mesh counted differently: they are not one sample.
    """
    first = runs[0]
    if any(run.outcome.factorizations != first.outcome.factorizations for run in runs):
        raise ValueError(f"{first.peer}, {first.path}: the runs took different numbers of factorizations")
    return first
