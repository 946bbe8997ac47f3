"""Loads on a rod in space, and the rod in equilibrium under them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from geometry.arrays import Array
from rod.along import AlongLoad, Triple, checked_along, part_of, scaled, triple
from rod.checked import finite
from rod.errors import LoadError, RodError

#: x, y and z of an end that is held, mm; None along an axis on which it is free
Position = tuple[float | None, float | None, float | None]


def is_triple(value: object) -> bool:
    """Whether it has three parts, and is no text."""
    return isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and np.shape(value)[:1] == (3,)


@final
@dataclass(frozen=True)
class SpatialLoad:
    """A dead load on a clamped arm. Raises `RodError` for what is no three finite numbers."""

    force: Triple = (0.0, 0.0, 0.0)  #: N, on the end
    couple: Triple = (0.0, 0.0, 0.0)  #: N mm, on the end; keeps its direction
    weight: Triple = (0.0, 0.0, 0.0)  #: N/mm, per rest length, all along the arm
    weight_height: float = 0.0  #: mm, of the mass above the material curve, along the normal of the curve
    along: tuple[AlongLoad, ...] = ()  #: on sections of the arm

    def __post_init__(self) -> None:
        for name in ("force", "couple", "weight"):
            object.__setattr__(self, name, triple(getattr(self, name), name))
        finite(self.weight_height, "weight_height")
        object.__setattr__(self, "along", checked_along(self.along))

    def plus(self, other: "SpatialLoad", part: float) -> "SpatialLoad":
        """Together with a part of another one; a weight acts at the height of this one, if this one has any."""
        mine, others = ((one.force, one.couple, one.weight) for one in (self, other))
        force, couple, weight = (tuple(np.add(a, scaled(b, part))) for a, b in zip(mine, others, strict=True))
        height = self.weight_height if any(self.weight) else other.weight_height
        return SpatialLoad(force, couple, weight, height, (*self.along, *part_of(other.along, part)))


def held_at(x: float | None, y: float | None) -> tuple[float | None, float | None]:
    """Where an end is held, mm, None along an axis on which it is free. Raises `RodError` for what is no number."""
    end_x, end_y = (None if v is None else finite(v, name) for v, name in ((x, "end_x"), (y, "end_y")))
    return end_x, end_y


def is_third_experiment(held: Sequence[float | None]) -> bool:
    """Whether the height of an end alone is held, as in experiment III, where curvature and height grow together."""
    return held[0] is None and held[1] is not None


def spatially_requested(
    force: Sequence[float] | None,
    moment: float | Sequence[float],
    end: Sequence[float | None] | None,
    end_x: float | None,
    end_y: float | None,
) -> tuple[SpatialLoad, Position]:
    """The load and the position of the end that the arguments of `solve` name; a moment alone turns about z.

    A pair acts in the plane: the third component of its force is 0, and its end is free along z.

    Raises `LoadError` where they contradict each other, and `RodError` for what is no three numbers.
    """
    if end is not None and (end_x is not None or end_y is not None):
        raise LoadError("Give either end = (x, y, z) or one of end_x and end_y, not both.")
    if force is not None and any(value is not None for value in (end, end_x, end_y)):
        raise LoadError("Give either the force on the end or its position, not both: one follows from the other.")
    couple = triple(moment if is_triple(moment) else (0.0, 0.0, moment), "moment")
    if force is not None and np.shape(force) == (2,):
        force = (*force, 0.0)
    load = SpatialLoad((0.0, 0.0, 0.0) if force is None else triple(force, "force"), couple)
    if end is None:
        return load, (*held_at(end_x, end_y), None)
    if len(end) == 2:
        end = (*end, None)
    if not is_triple(end):
        raise RodError(f"In space an end is x, y and z, None where it is free; {end!r} is not.")
    x, y, z = (None if value is None else finite(value, "end") for value in end)
    return load, (x, y, z)


class Held(NamedTuple):
    """What acts on an arm and holds it."""

    load: SpatialLoad
    position: Position  #: mm


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Stability:
    """Of a rod in equilibrium: the lowest eigenvalue of the second variation of its energy over the elastic part."""

    lowest: float  #: 1 without loads, 0 where the rod buckles, below 0 beyond
    motion: Array  #: (n, 3) of the axis that belongs to it, of largest component 1

    @property
    def is_stable(self) -> bool:
        """Whether the rod returns from small motions."""
        return self.lowest > 0.0
