"""Air that flows into an arm, or is shut in it."""

import math
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from geometry.arrays import Array
from rod.checked import numbers_in, positive
from rod.errors import RodError


def over_time(given: Any, columns: int, name: str, unit: str) -> Array:
    """(T, 1 + columns): rows of a time in s and numbers, of one row from 0 s on for a number, or one for each column.

    Raises `RodError` for anything else, and where times do not rise from 0 s.
    """
    rows = numbers_in(given)
    if rows is not None and rows.ndim < 2:
        rows = np.append(0.0, rows)[None]
    if rows is None or rows.ndim != 2 or rows.shape[1] != 1 + columns or not np.all(np.isfinite(rows)):
        asked = f"a number in {unit}" if columns == 1 else f"{columns} numbers in {unit}"
        raise RodError(f"{name} is {asked}, or rows of a time in s and {asked}.")
    if rows[0, 0] != 0.0 or np.any(np.diff(rows[:, 0]) <= 0.0):
        raise RodError(f"{name}: its times must rise from row to row, from 0 s on.")
    return rows


@final
@dataclass(frozen=True)
class Air:
    """Air in an arm with one pressure; without flow and supply the air stays in it.

    V dp/dt + n p dV/dt = n p_0 Q for the absolute pressure p, the volume V and the inflow Q of free air at p_0. Raises
    `RodError` for an exponent that is not from 1 to 1.4, and for times that do not rise.
    """

    flow: Any = 0.0  #: Q, mm3/s of free air; a number, or rows of a time in s and a number, and so is the supply
    supply: Any = 0.0  #: kPa above that around the arm, behind a tube
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
        for name, unit in (("flow", "mm3/s"), ("supply", "kPa")):
            object.__setattr__(self, name, over_time(getattr(self, name), 1, f"The {name} of air", unit))

    def growth(self, time: float, pressure: float, volume: float) -> float:
        """1/s, of the logarithm of p V^n, at a pressure in kPa and a volume of the arm in mm3."""
        flow, supply = (float(np.interp(time, *rows.T)) for rows in (self.flow, self.supply))
        inflow = flow + self.conductance * (supply - pressure)
        amount = (self.atmosphere + pressure) * (volume + self.dead_volume)
        return self.exponent * self.atmosphere * inflow / amount

    def amount(self, pressure: float, volume: float) -> float:
        """The logarithm of p V^n."""
        return math.log(self.atmosphere + pressure) + self.exponent * math.log(volume + self.dead_volume)
