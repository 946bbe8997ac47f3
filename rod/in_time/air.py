"""Air that flows into an arm, or is shut in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from rod.checked import numbers_in, positive
from rod.errors import RodError

#: a number, or rows of a time in s and a number, joined by straight lines
OverTime = float | Sequence[Sequence[float]]


@final
@dataclass(frozen=True)
class Air:
    """Air in an arm with one pressure; without flow and supply the air stays in it.

    V dp/dt + n p dV/dt = n p_0 Q for the absolute pressure p, the volume V and the inflow Q of free air at p_0. Raises
    `RodError` for an exponent that is not from 1 to 1.4, and for times that do not rise.
    """

    flow: OverTime = 0.0  #: Q, mm3/s of free air
    supply: OverTime = 0.0  #: kPa above that around the arm, behind a tube
    conductance: float = 0.0  #: mm3/s of free air per kPa, of this tube
    dead_volume: float = 0.0  #: mm3, beside that of the arm
    exponent: float = 1.0  #: n, 1 where the air keeps its temperature, 1.4 where it keeps its heat
    atmosphere: float = 101.325  #: p_0, kPa

    def __post_init__(self) -> None:
        positive(self.atmosphere, "The pressure around the arm in kPa")
        if not 1.0 <= self.exponent <= 1.4:
            raise RodError(f"The exponent of air is from 1 to 1.4, not {self.exponent:g}.")
        if not (self.conductance >= 0.0 and self.dead_volume >= 0.0):
            raise RodError("The conductance of a tube and a dead volume must not be negative.")
        for name in ("flow", "supply"):
            rows = numbers_in(getattr(self, name))
            if (
                rows is None
                or not np.all(np.isfinite(rows))
                or (rows.shape != () and (rows.ndim, *rows.shape[1:]) != (2, 2))
            ):
                raise RodError(f"The {name} of air is a number, or rows of a time in s and a number.")
            if rows.ndim and np.any(np.diff(rows[:, 0]) <= 0.0):
                raise RodError(f"The times of the {name} of air must rise from row to row.")

    def growth(self, time: float, pressure: float, volume: float) -> float:
        """1/s, of the logarithm of p V^n, at a pressure in kPa and a volume of the arm in mm3."""
        inflow = _at(self.flow, time) + self.conductance * (_at(self.supply, time) - pressure)
        amount = (self.atmosphere + pressure) * (volume + self.dead_volume)
        return self.exponent * self.atmosphere * inflow / amount

    def amount(self, pressure: float, volume: float) -> float:
        """The logarithm of p V^n."""
        return math.log(self.atmosphere + pressure) + self.exponent * math.log(volume + self.dead_volume)


def _at(given: OverTime, time: float) -> float:
    rows = np.asarray(given, float)
    return float(np.interp(time, rows[:, 0], rows[:, 1])) if rows.ndim else float(rows)
