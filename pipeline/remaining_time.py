"""How long a run will still take, estimated from the pressures that it has solved."""

import time
from collections.abc import Sequence
from math import inf
from typing import Any, final


@final
class RemainingTime:
    """Estimates the remaining time of the pressures requested so far, from those that were solved.

    Once an experiment has stopped, pressures from that one on are not counted: others may not bear them either, and how
    long it takes to find out is not known.
    """

    def __init__(self) -> None:
        self._begin()

    def _begin(self) -> None:
        self._began = time.monotonic()
        self._waiting: dict[str, list[float]] = {}  #: kPa, requested and not reached, by experiment
        self._lowest_end = inf  #: kPa
        self._solved = 0

    def follow(self, what: str, arguments: tuple[Any, ...]) -> None:
        """Take a message of `pipeline.progress`; a stage begins anew where all pressures before are reached."""
        match what:
            case "stage" if self.is_over:
                self._begin()
            case "experiment":
                self.add(*arguments)
            case "step_done":
                self.reach(*arguments)
            case "stopped":
                self.stop(*arguments[:2])

    def add(self, experiment: str, pressures: Sequence[float]) -> None:
        """Pressures in kPa that an experiment is to reach."""
        if not self._waiting:
            self._began = time.monotonic()
        self._waiting[experiment] = [*self._waiting.get(experiment, ()), *pressures]

    def reach(self, experiment: str, pressure_kPa: float, seconds: float) -> None:
        """One of them is reached; `seconds` is 0 where its state was stored by an earlier run."""
        self._drop(experiment, [pressure_kPa])
        self._solved += seconds > 0.0

    def stop(self, experiment: str, pressures: Sequence[float]) -> None:
        """These pressures of an experiment will not be reached."""
        self._drop(experiment, pressures)
        self._lowest_end = min((self._lowest_end, *pressures))

    def remaining(self) -> str:
        """The time until all of them are reached, in words; empty where it is not known or over. Experiments that begin
        later are not in it."""
        if self._solved == 0 or self.is_over:
            return ""
        pace = (time.monotonic() - self._began) / self._solved
        return f"{duration(pace * self._left)} left"

    @property
    def is_over(self) -> bool:
        """Whether all of them are reached."""
        return self._left == 0

    @property
    def _left(self) -> int:
        return sum(pressure < self._lowest_end for waiting in self._waiting.values() for pressure in waiting)

    def _drop(self, experiment: str, pressures: Sequence[float]) -> None:
        waiting = self._waiting.get(experiment, ())
        self._waiting[experiment] = [pressure for pressure in waiting if pressure not in pressures]


def remaining_of_points(seconds: Sequence[float], remaining: int, workers: int, elapsed: float) -> float | None:
    """Seconds until the remaining points of a sweep have ended.

    seconds: on its worker, of each point that has ended. remaining: points that have not ended, those that workers are
    at among them. elapsed: seconds since the first points were begun. None before one round of workers has ended.
    """
    busy = min(workers, remaining)
    if len(seconds) < max(1, workers) or not busy:
        return None
    mean = sum(seconds) / len(seconds)
    done = min(max(elapsed * workers - sum(seconds), 0.0), mean * busy)  # of the points that workers are at
    return (mean * remaining - done) / busy


def duration(seconds: float) -> str:
    """Seconds in words."""
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes >= 2 else f"{round(seconds)} s"
