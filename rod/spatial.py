"""Loads on a rod in space, and the rod in equilibrium under them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.along import APART, AlongLoad, Position, Support, Triple, part_of, scaled, split_along, triple
from rod.checked import finite


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
    supports: tuple[Support, ...] = ()  #: that hold sections of the arm, and its end

    def __post_init__(self) -> None:
        for name in ("force", "couple", "weight"):
            object.__setattr__(self, name, triple(getattr(self, name), name))
        finite(self.weight_height, "weight_height")
        along, more = split_along(self.along)
        object.__setattr__(self, "along", along)
        object.__setattr__(self, "supports", (*self.supports, *more))

    def plus(self, other: "SpatialLoad", part: float) -> "SpatialLoad":
        """Together with a part of another one; supports are those of this one, and so is the height of its weight."""
        mine, others = ((one.force, one.couple, one.weight) for one in (self, other))
        force, couple, weight = (tuple(np.add(a, scaled(b, part))) for a, b in zip(mine, others, strict=True))
        height = self.weight_height if any(self.weight) else other.weight_height
        along = (*self.along, *part_of(other.along, part))
        return SpatialLoad(force, couple, weight, height, along, self.supports)

    def end_at(self, length: float) -> Position:
        """x, y and z where the end of an arm of a length (mm) is held."""
        at_end = (one.position for one in self.supports if one.s > (1.0 - APART) * length)
        return next(at_end, (None, None, None))


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
