"""What acts on an arm besides its pressure, as one value: end force, end couple, dead weight, loads along it.

The rod in equilibrium takes all, the moment of a curve (`moment_from_load`) the first three. In an identification the
weight acts in experiment II as well as in III; the end force in III alone (`rod.curves.curve.moment_between`).
"""

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, final

import numpy as np

from rod.along import (
    APART,
    Along,
    AlongLoad,
    Position,
    Support,
    is_triple,
    leaves_plane,
    part_of,
    scaled,
    split_along,
    triple,
)
from rod.checked import Amount, Given, finite
from rod.errors import LoadError, RodError

#: on the end, N: its components, or one amount that acts upwards
Force: TypeAlias = Amount | Sequence[Amount]


@final
@dataclass(frozen=True)
class Load:
    """A dead load on a clamped arm (the full body, both halves), kept as x, y and z; z may be left out.

    Raises `RodError` for numbers that are not finite.
    """

    force: Given = (0.0, 0.0, 0.0)  #: N, on the end s = l
    couple: Given = (0.0, 0.0, 0.0)  #: N mm, on the end; keeps its direction; a number alone acts about z
    weight: Given = (0.0, 0.0, 0.0)  #: N/mm, per rest length, all along the arm
    weight_height: float = 0.0  #: mm, of the mass above the material curve, along the normal of the curve
    along: tuple[AlongLoad, ...] = ()  #: on sections of the arm
    supports: tuple[Support, ...] = ()  #: that hold sections of the arm, and its end

    def __post_init__(self) -> None:
        couple = self.couple if is_triple(self.couple) else (0.0, 0.0, finite(self.couple, "The end moment", "N*mm"))
        given = {"force": (self.force, "N"), "couple": (couple, "N*mm"), "weight": (self.weight, "N/mm")}
        for name, (value, unit) in given.items():
            object.__setattr__(self, name, triple(value, name, unit))
        object.__setattr__(self, "weight_height", finite(self.weight_height, "weight_height"))
        along, more = split_along(self.along)
        object.__setattr__(self, "along", along)
        object.__setattr__(self, "supports", (*self.supports, *more))

    @property
    def own_weight(self) -> "Load":
        """The weight alone."""
        return Load(weight=self.weight, weight_height=self.weight_height)

    @property
    def force_size(self) -> float:
        """N, |F|."""
        return math.hypot(*self.force)

    @property
    def leaves_plane(self) -> bool:
        """Whether it moves an arm out of its plane, or holds it there."""
        across = any((self.force[2], *self.couple[:2], self.weight[2]))
        return across or any(map(leaves_plane, (*self.along, *self.supports)))

    def refuse_out_of_plane(self) -> None:
        """Raise `LoadError` where it leaves the plane of the arm."""
        if self.leaves_plane:
            raise LoadError("A load across the plane of the arm is none of a rod in its plane; solve the rod in space.")

    def plus(self, other: "Load", part: float) -> "Load":
        """Together with a part of another one; supports are those of this one, and so is the height of its weight."""
        mine, others = ((one.force, one.couple, one.weight) for one in (self, other))
        force, couple, weight = (np.add(a, scaled(b, part)) for a, b in zip(mine, others, strict=True))
        height = self.weight_height if any(self.weight) else other.weight_height
        return Load(force, couple, weight, height, (*self.along, *part_of(other.along, part)), self.supports)

    def end_at(self, length: float) -> Position:
        """x, y and z where the end of an arm of a length (mm) is held."""
        at_end = (one.position for one in self.supports if one.s > (1.0 - APART) * length)
        return next(at_end, (None, None, None))


def with_along(load: Load, more: Sequence[Along], length: float) -> Load:
    """The load with more along the arm, mm; forces on its end join the force there, unless a support bears them."""
    loads, supports = split_along(more)
    along, force = list[AlongLoad](), np.array(load.force)
    for one in (*load.along, *loads):
        if one.breaks == (length,) and not any((*one.couple, *one.beside)):
            force += one.force
        else:
            along.append(one)
    both = replace(load, along=tuple(along), supports=(*load.supports, *supports))
    return replace(both, force=np.where([at is None for at in both.end_at(length)], force, 0.0))


def pair(values: Sequence[Amount | None], name: str, unit: str = "") -> tuple[float, float]:
    """(x, y) as finite floats, given as for `finite`. Raises `RodError`, naming what they are, for anything else."""
    try:
        x, y = (finite(value, name, unit) for value in values)
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} is a pair of finite numbers, x and y; {reprlib.repr(values)} is not.") from None
    return x, y


def held_end(
    length: float, force: object, end: Sequence[Amount | None] | None, end_x: Amount | None, end_y: Amount | None
) -> tuple[Support, ...]:
    """What holds the end of an arm (mm) by the arguments of `solve`; nothing where it is free.

    Raises `LoadError` where the arguments contradict each other, and `RodError` for what is no number.
    """
    if end is not None and (end_x is not None or end_y is not None):
        raise LoadError("Give either end = (x, y) or one of end_x and end_y, not both.")
    if force is not None and any(value is not None for value in (end, end_x, end_y)):
        raise LoadError("Give either the force on the end or its position, not both: one follows from the other.")
    if end is None:
        held = (None if at is None else finite(at, name, "mm") for at, name in ((end_x, "end_x"), (end_y, "end_y")))
        x, y = held
        return () if x is y is None else (Support(length, x, y),)
    if isinstance(end, str) or not np.iterable(end) or len(end) not in (2, 3):
        raise RodError(f"end is x and y, in space also z, None where it is free; {reprlib.repr(end)} is not.")
    return (Support(length, end[0], end[1], end[2] if len(end) == 3 else None),)


def requested(force: Force | None, moment: Amount | Sequence[Amount]) -> Load:
    """The load that arguments of `solve` name; one amount of force acts upwards. Raises `RodError` for what is none."""
    upwards = 0.0 if force is None else force
    return Load((0.0, finite(upwards, "force", "N")) if isinstance(upwards, float | int | str) else upwards, moment)
