"""Weight on an arm: how its mass is spread along it, which way gravity acts, and a mass that hangs on its end."""

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.units import USUAL, with_unit
from rod.along import Triple, is_triple, pair, triple
from rod.checked import finite
from rod.errors import LoadError, RodError

#: N/g
WEIGHT_OF_GRAM = 9.81e-3
#: degrees by which the arm rises from its clamp to its end, at rest
ORIENTATIONS = {"hanging": -90.0, "lying": 0.0, "standing": 90.0}
NO_DIRECTION = "The direction of gravity must not be zero."
#: masses that hang along an arm: where, in mm or as "0.5 l", and how much, in g or as "5 g"
Hung: TypeAlias = Sequence[tuple[float | str, float | str]]


@dataclass(frozen=True, eq=False)  # arrays inside
class Mass:
    """The mass of an arm between its end and other places, and its height above the material curve. Read-only arrays.

    Raises `RodError` unless the distances rise from 0 and no mass is negative.
    """

    #: mm, rest arc length from the end, rising from 0
    from_end: Annotated[Array, "from_end_mm", "k"] = field(repr=False)
    grams: Annotated[Array, "mass_g", "k"] = field(repr=False)  #: of the part between the end and there
    #: g mm, the same times the height of each bit above the material curve
    heights: Annotated[Array, "mass_times_height_g_mm", "k"] = field(repr=False)

    def __post_init__(self) -> None:
        for name in ("from_end", "grams", "heights"):
            array = np.array(getattr(self, name), float)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        rises = np.all(np.diff(self.from_end) > 0.0) and np.all(np.diff(self.grams) >= 0.0)
        if not (rises and self.from_end[0] == self.grams[0] == 0.0 < self.grams[-1]):
            raise RodError("The mass of an arm is given from its end on, at distances that rise from 0, and grows.")

    @staticmethod
    def even(length: float, grams: float, height: float = 0.0) -> "Mass":
        """A mass that is spread evenly along a length, at a height above the material curve, mm."""
        return Mass(*(np.array([0.0, value]) for value in (length, grams, grams * height)))

    def within(self, from_end: Array) -> tuple[Array, Array]:
        """`grams` and `heights` at distances (n,) from the end, mm; of a longer arm its mean goes on."""
        beyond = np.maximum(0.0, from_end / self.from_end[-1] - 1.0)
        return tuple(np.interp(from_end, self.from_end, v) + beyond * v[-1] for v in (self.grams, self.heights))


def gravity_vector(value: Any) -> tuple[float, float] | Triple:
    """`gravity_direction`, or x, y and z of a direction with three components. Raises `RodError` as that does."""
    if not is_triple(value):
        return gravity_direction(value)
    x, y, z = triple(value, "The direction of gravity")
    size = math.hypot(x, y, z)
    if size == 0.0:
        raise RodError(NO_DIRECTION)
    return x / size, y / size, z / size


def gravity_direction(value: Any) -> tuple[float, float]:
    """x and y of the direction of gravity in the frame of the arm, x along it from the clamp and y up as drawn.

    value: "hanging" (end down), "lying" or "standing" (end up); how far the arm at rest rises from its clamp to its
    end, as "30 deg"; or a pair x, y of any length. Raises `RodError` for anything else.
    """
    if isinstance(value, str):
        angle = ORIENTATIONS.get(value) if value in ORIENTATIONS else with_unit(value, USUAL["deg"])
        if angle is None:
            allowed = f"{', '.join(ORIENTATIONS)}, an angle such as 30 deg, or a direction x, y"
            raise RodError(f"{reprlib.repr(value)} is no orientation of an arm; allowed are {allowed}.")
        x, y = (-round(f(math.radians(angle)), 15) + 0.0 for f in (math.sin, math.cos))
        return x, y
    x, y = pair(value, "The direction of gravity")
    size = math.hypot(x, y)
    if size == 0.0:
        raise RodError(NO_DIRECTION)
    return x / size, y / size


def in_grams(value: Any) -> float:
    """g, of a number or of a text such as "20 g". Raises `RodError` for anything else and below zero."""
    grams = with_unit(value, USUAL["g"]) if isinstance(value, str) else finite(value, "tip_mass")
    if grams is None or grams < 0.0:
        raise RodError(f"{reprlib.repr(value)} is no mass; write it in g, or with its unit such as 20 g.")
    return grams


def checked_hung(hung: Hung) -> tuple[tuple[float | str, float], ...]:
    """Places and masses in g. Raises `RodError` for anything else."""
    if isinstance(hung, str) or any(isinstance(one, str) or np.shape(one) != (2,) for one in hung):
        raise RodError(f"hung is a list of places and masses, such as [('0.5 l', '5 g')]; {reprlib.repr(hung)} is not.")
    return tuple((s, in_grams(mass)) for s, mass in hung)


def position_along(value: float | str, length: float) -> float:
    """mm from the clamp, of a number, of a text such as "56 mm", or of a part of the length such as "0.5 l".

    Raises `LoadError` for anything else.
    """
    s = with_unit(value, {**USUAL["mm"], "l": length}) if isinstance(value, str) else finite(value, "s")
    if s is None:
        raise LoadError(f"{reprlib.repr(value)} is no place along an arm; write it as 56 mm or 0.5 l.")
    return s
