"""The designs that a search has tried, with their numbers."""

from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array
from pipeline.context import RunContext
from pipeline.wishes.measured import Numbers
from pipeline.wishes.step import exact_objective, exact_ratios, merit_of
from pipeline.wishes.wish_file import WishFile

COARSE, FINE, DELIVERED_LAW = "coarse", "fine", "delivered"


@dataclass(frozen=True)
class Trial:
    """One design that was tried."""

    start: int  #: from which the search came, from 1 on
    law: str  #: coarse: on the mesh of the configuration; fine: on that of the law; or delivered
    point: tuple[float, ...]  #: in mm and kPa
    values: tuple[float, ...]  #: of all wishes, one after the other; empty where the design has none
    misses: tuple[float, ...]  #: of each wish, over its tolerance
    limits: tuple[float, ...]  #: over 1 where one is exceeded
    objective: float  #: over that at the start; NaN where nothing is made small
    taken: bool  #: whether the search went on from here
    reason: str = ""  #: why it has no numbers

    @property
    def is_met(self) -> bool:
        """Whether it has every wish and keeps every limit."""
        return bool(self.values) and max(self.misses) <= 1.0 and all(ratio <= 1.0 for ratio in self.limits)

    @property
    def merit(self) -> float:
        """As `merit_of`; infinity where there are no numbers."""
        if not self.values:
            return np.inf
        return merit_of(np.array(self.misses), np.array(self.limits), self.objective)


@dataclass
class History:
    """The designs that a search has tried."""

    file: WishFile
    context: RunContext
    trials: list[Trial] = field(default_factory=list)

    def tried(self, start: int, law: str, point: Array, numbers: Numbers, sensitivity: float) -> Trial:
        """A design with its numbers."""
        wishes = self.file.wishes
        u, objective = np.log(point), np.nan
        if wishes.minimize:
            objective = sensitivity if wishes.minimize == "sensitivity" else exact_objective(self.file, u)
        limits = [float(ratio) for ratio in exact_ratios(self.file, u)]
        if wishes.limits.largest_stretch is not None:
            limits.append((numbers.stretch - 1.0) / (wishes.limits.largest_stretch - 1.0))
        values, misses = numbers.values, wishes.misses(numbers.values)
        return Trial(start, law, _floats(point), _floats(values), _floats(misses), tuple(limits), objective, taken=True)

    def record(self, trial: Trial) -> None:
        """Add to the history, and tell it."""
        self.trials.append(trial)
        misses = f"largest miss {max(trial.misses):.3g} tolerances" if trial.misses else trial.reason
        shown = ", ".join(
            f"{one.key.partition('.')[2]} {value:.4g} {one.unit}"
            for one, value in zip(self.file.wishes.free, trial.point, strict=True)
        )
        self.context.progress.remark(f"{len(self.trials)}. {trial.law}: {shown}: {misses}")

    def refuse(self, start: int, point: Array, law: str, reason: str) -> None:
        """Record a design without numbers."""
        self.record(Trial(start, law, _floats(point), (), (), (), np.nan, taken=False, reason=reason))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
