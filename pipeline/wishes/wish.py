"""What is wanted of an arm, in which limits, and what may be changed for it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.config.config import Config
from pipeline.config.units import ANGLE, CURVATURE, FORCE, LENGTH, STIFFNESS, Dimension

#: what can be wanted, by its key in a file
QUANTITIES: dict[str, Dimension] = {
    "kappa_0": CURVATURE,
    "angle": ANGLE,
    "tip": LENGTH,
    "force": FORCE,
    "stiffness": STIFFNESS,
}
#: how each of them is told: a factor and its unit
SHOWN = {"1/mm": (1e3, "1/m"), "deg": (1.0, "°"), "mm": (1.0, "mm"), "N": (1.0, "N"), "N/mm": (1e3, "N/m")}
#: in front of the name of a free pressure, as dimensions have `geometry.`
PRESSURE = "pressure."


@dataclass(frozen=True)
class Free:
    """A dimension or a pressure that may be changed, in mm or kPa."""

    key: str  #: geometry.wall, or pressure.NAME
    low: float
    high: float
    start: float

    @property
    def unit(self) -> str:
        """Of the values."""
        return "kPa" if self.key.startswith(PRESSURE) else "mm"


@dataclass(frozen=True)
class Wish:
    """One number, or place, that the arm is to have at a pressure."""

    quantity: str  #: one of QUANTITIES
    target: tuple[float, ...]  #: in the unit of the quantity; two numbers of a tip
    within: float  #: in the same unit
    at: float | str  #: kPa, or the name of a free pressure
    height_mm: float = 0.0  #: of the end that is held, of a force

    @property
    def is_power(self) -> bool:
        """Whether the number follows a power of the dimensions rather than a straight line."""
        return self.quantity in ("kappa_0", "force", "stiffness") and self.target[0] != 0.0

    def pressure(self, values: Mapping[str, float]) -> float:
        """kPa; values: of what is free, by key."""
        return values[f"{PRESSURE}{self.at}"] if isinstance(self.at, str) else self.at

    def miss(self, values: Array) -> float:
        """How far values (1,) or (2,) are from the wanted ones, over what is allowed."""
        return float(np.linalg.norm(values - np.array(self.target)) / self.within)

    @property
    def name(self) -> str:
        """In tables."""
        at = f"{self.at:g} kPa" if isinstance(self.at, float) else self.at
        held = f" with the end at {self.height_mm:g} mm" if self.quantity == "force" else ""
        return f"{self.quantity} at {at}{held}"

    def text(self, values: Any) -> str:
        """Values in words, with their unit."""
        factor, unit = SHOWN[QUANTITIES[self.quantity].unit]
        shown = [f"{factor * float(value):.4g}" for value in np.atleast_1d(values)]
        joined = shown[0] if len(shown) == 1 else f"({', '.join(shown)})"
        return f"{joined}{unit}" if unit == "°" else f"{joined} {unit}"


@dataclass(frozen=True)
class Limits:
    """What an arm must not exceed; None where nothing is asked."""

    largest_stretch: float | None = None  #: of a cell without moment, at the highest pressure
    mass_g: float | None = None
    smallest_wall_mm: float | None = None
    bears: float | None = None  #: times the highest pressure, which cell and ends must bear


#: what is made as small as possible, by its key; "" where wishes are met as nearly as possible
OBJECTIVES = ("pressure", "mass", "sensitivity")


@dataclass(frozen=True)
class Wishes:
    """What the file of a wish says, complete."""

    free: tuple[Free, ...]
    wishes: tuple[Wish, ...]
    limits: Limits
    minimize: str  #: one of OBJECTIVES; "" for none
    starts: int  #: points from which is begun at most

    @property
    def pressures(self) -> dict[str, Free]:
        """The free pressures by name."""
        return {one.key.removeprefix(PRESSURE): one for one in self.free if one.key.startswith(PRESSURE)}

    @property
    def dimensions(self) -> tuple[str, ...]:
        """The keys of the free dimensions."""
        return tuple(one.key for one in self.free if not one.key.startswith(PRESSURE))

    def values(self, point: Array) -> dict[str, float]:
        """A point (n,) by the keys of what is free."""
        return {one.key: float(value) for one, value in zip(self.free, point, strict=True)}

    def pressures_kPa(self, point: Array) -> tuple[float, ...]:
        """Of all wishes, ascending, at a point (n,)."""
        values = self.values(point)
        return tuple(sorted({wish.pressure(values) for wish in self.wishes}))

    def highest_kPa(self, point: Array) -> float:
        """The largest pressure that the arm has to bear."""
        return self.pressures_kPa(point)[-1] * (self.limits.bears or 1.0)

    @property
    def bounds(self) -> Array:
        """(n, 2)"""
        return np.array([(one.low, one.high) for one in self.free])

    @property
    def start(self) -> Array:
        """(n,)"""
        return np.array([one.start for one in self.free])

    def parts(self, numbers: Array) -> list[Array]:
        """The numbers of all wishes, one after the other, by wish."""
        ends = np.cumsum([len(wish.target) for wish in self.wishes])
        return np.split(numbers, ends[:-1])

    def misses(self, numbers: Array) -> Array:
        """(w,) of each wish."""
        return np.array([wish.miss(part) for wish, part in zip(self.wishes, self.parts(numbers), strict=True)])


def exact_limits(wishes: Wishes, config: Config) -> dict[str, tuple[float, float]]:
    """Mass and wall of a design over their limits, each not above 1 where it is kept, with the value in g or mm."""
    limits, found = wishes.limits, {}
    if limits.mass_g is not None and config.mass_tonne is not None:
        mass = 1e6 * config.mass_tonne
        found["mass"] = mass / limits.mass_g, mass
    if limits.smallest_wall_mm is not None:
        wall = config.design.thinnest_wall
        found["smallest_wall"] = limits.smallest_wall_mm / wall, wall
    return found
