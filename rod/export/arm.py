"""A rod with five parameters over its pressures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from geometry.arrays import Array
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
    smooth: tuple[Array, ...] = ()  #: (m, 2) columns s and kappa_0 averaged over a cell, per pressure; empty: not known
    #: the same at more pressures, for files whose program interpolates between theirs; None: at these
    finer: "Arm | None" = None

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

    @property
    def tabulated(self) -> "Arm":
        """The arm at the pressures between which a program interpolates linearly."""
        return self if self.finer is None else self.finer

    def smoothed(self) -> "Arm":
        """The arm with the averaged kappa_0 and an unchanged rotation of the end. Raises `RodError` without one."""
        if not self.smooth:
            raise RodError("The file has no rest curvature averaged over the cells.")
        rods = tuple(_with_curve(rod, curve) for rod, curve in zip(self.rods, self.smooth, strict=True))
        return replace(self, rods=rods, finer=None if self.finer is None else self.finer.smoothed())


def _with_curve(rod: Rod, curve: Array) -> Rod:
    """The rod with kappa_0 (m, 2) that ends short of both ends; constant there, and shifted to the same rotation."""
    s = np.concatenate([[0.0], curve[:, 0], [rod.length]])
    kappa = np.concatenate([curve[:1, 1], curve[:, 1], curve[-1:, 1]])
    free = rod.solve()
    missing = free.theta[-1] - free.theta[0] - np.trapezoid(kappa, s)
    return replace(rod, kappa_0=np.column_stack([s, kappa + missing / rod.length]))
