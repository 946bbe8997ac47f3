"""A rod with five parameters over its pressures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from rod.errors import RodError
from rod.law import PARAMETER_COLUMNS
from rod.mechanics.equilibrium import Rod
from rod.pressurised_rod import IDENTIFIED

#: into how many parts a file with interpolation over the pressure divides the interval between two pressures. The
#: straight lines of its program are then a sixteenth as far from the cubics of the rod as those over whole intervals
PARTS = 4


def divide_pressures(pressures: Sequence[float]) -> tuple[float, ...]:
    """Rising pressures (n,) in kPa with those that divide each of their intervals into PARTS."""
    inner = [low + (high - low) * k / PARTS for low, high in pairwise(pressures) for k in range(PARTS)]
    return (*inner, pressures[-1])


@dataclass(frozen=True)
class Arm:
    """A rod with five parameters at one or several pressures.

    Raises `RodError` for pressures that do not rise from above 0.
    """

    pressures: tuple[float, ...]  #: kPa
    rods: tuple[Rod, ...]  #: with five parameters, one per pressure
    origin: str = IDENTIFIED  #: where the numbers at these pressures come from
    #: standard deviations by PARAMETER_NAMES, one per pressure; empty: not known
    deviations: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rise = np.diff([0.0, *self.pressures])
        if not self.pressures or len(self.rods) != len(self.pressures) or np.any(rise <= 0.0):
            raise RodError("The pressures of an arm must be above 0 and in ascending order, with one rod for each.")

    @property
    def length(self) -> float:
        """mm."""
        return self.rods[0].length

    @property
    def columns(self) -> dict[str, list[float]]:
        """The five parameters over the pressures by PARAMETER_COLUMNS, with their standard deviations if known."""
        columns: dict[str, list[float]] = {}
        for name, column in PARAMETER_COLUMNS.items():
            columns[column] = [getattr(rod.five, name) for rod in self.rods]
            if self.deviations:
                columns[f"{column}_std"] = list(self.deviations[name])
        return columns
