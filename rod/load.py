"""What acts on an arm besides its pressure, as one value: end force, end couple, dead weight, loads along it.

The rod in equilibrium takes all, the moment of a curve (`moment_from_load`) the first three. In an identification the
weight acts in experiment II as well as in III; the end force in III alone (`rod.curves.curve.moment_between`).
"""

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from rod.along import Along, AlongLoad, Support, leaves_plane, split_along, triple
from rod.checked import finite, numbers_in
from rod.errors import LoadError, RodError
from rod.spatial import SpatialLoad, is_triple

AnyLoad = TypeVar("AnyLoad", "Load", SpatialLoad)


@dataclass(frozen=True)
class Load:
    """A dead load on a clamped arm (the full body, both halves). Raises `RodError` for numbers that are not finite."""

    force: tuple[float, float] = (0.0, 0.0)  #: N, F_x and F_y on the end s = l
    couple: float = 0.0  #: N mm, on the end
    weight: tuple[float, float] = (0.0, 0.0)  #: N/mm, q_x and q_y per rest length, all along the arm
    weight_height: float = 0.0  #: mm, of the mass above the material curve, along the normal of the curve
    along: tuple[AlongLoad, ...] = ()  #: on sections of the arm, in its plane
    supports: tuple[Support, ...] = ()  #: that hold sections of the arm, and its end

    def __post_init__(self) -> None:
        for name in ("force", "weight"):
            object.__setattr__(self, name, pair(getattr(self, name), name))
        object.__setattr__(self, "couple", finite(self.couple, "The end moment"))
        object.__setattr__(self, "weight_height", finite(self.weight_height, "weight_height"))
        along, more = split_along(self.along)
        object.__setattr__(self, "along", along)
        object.__setattr__(self, "supports", (*self.supports, *more))
        if any(map(leaves_plane, (*self.along, *self.supports))):
            raise LoadError("A load across the plane of the arm is none of a rod in its plane; solve the rod in space.")

    @property
    def own_weight(self) -> "Load":
        """The weight alone."""
        return Load(weight=self.weight, weight_height=self.weight_height)

    @property
    def in_space(self) -> SpatialLoad:
        """The same load with three components."""
        couple, weight = (0.0, 0.0, self.couple), (*self.weight, 0.0)
        return SpatialLoad((*self.force, 0.0), couple, weight, self.weight_height, self.along, self.supports)

    @property
    def force_size(self) -> float:
        """N, |F|."""
        return math.hypot(*self.force)


def with_along(load: AnyLoad, more: Sequence[Along], length: float) -> AnyLoad:
    """The load with more along the arm, mm; forces on its end join the force there, unless a support bears them."""
    along: list[AlongLoad] = []
    loads: tuple[AlongLoad, ...]
    supports: tuple[Support, ...]
    one: AlongLoad
    loads, supports = split_along(more)
    force = np.array(load.force)
    for one in (*load.along, *loads):
        if one.breaks == (length,) and not any((*one.couple, *one.beside)):
            force += one.force[: len(force)]
        else:
            along.append(one)
    both = replace(load, along=tuple(along), supports=(*load.supports, *supports))
    held = SpatialLoad(supports=both.supports).end_at(length)
    joined: Any = tuple(0.0 if at is not None else float(f) for f, at in zip(force, held, strict=False))
    return replace(both, force=joined)


def pair(values: Sequence[float | None], name: str) -> tuple[float, float]:
    """(x, y) as finite floats. Raises `RodError`, naming what they are, for anything else."""
    try:
        x, y = (finite(value, name) for value in values)
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} is a pair of finite numbers, x and y; {reprlib.repr(values)} is not.") from None
    return x, y


def held_end(
    length: float, force: object, end: Sequence[float | None] | None, end_x: float | None, end_y: float | None
) -> tuple[Support, ...]:
    """What holds the end of an arm (mm) by the arguments of `solve`; nothing where it is free.

    Raises `LoadError` where the arguments contradict each other, and `RodError` for what is no number.
    """
    if end is not None and (end_x is not None or end_y is not None):
        raise LoadError("Give either end = (x, y) or one of end_x and end_y, not both.")
    if force is not None and any(value is not None for value in (end, end_x, end_y)):
        raise LoadError("Give either the force on the end or its position, not both: one follows from the other.")
    if end is None:
        x, y = (None if at is None else finite(at, name) for at, name in ((end_x, "end_x"), (end_y, "end_y")))
        return () if x is y is None else (Support(length, x, y),)
    places = numbers_in(end)
    if places is None or places.shape not in ((2,), (3,)):
        raise RodError(f"end is x and y, in space also z, None where it is free; {reprlib.repr(end)} is not.")
    x, y, z = (*end, None)[:3]
    return (Support(length, x, y, z),)


def requested(force: Sequence[float] | None, moment: float | Sequence[float]) -> Load:
    """The load in the plane that arguments of `solve` name. Raises `RodError` for what is none."""
    return Load((0.0, 0.0) if force is None else pair(force, "force"), finite(moment, "The end moment"))


def spatially_requested(force: Sequence[float] | None, moment: float | Sequence[float]) -> SpatialLoad:
    """The load in space that arguments of `solve` name; a moment alone turns about z, and a pair acts in the plane.

    Raises `RodError` for what is no three numbers.
    """
    couple = triple(moment if is_triple(moment) else (0.0, 0.0, moment), "moment")
    if force is not None and np.shape(force) == (2,):
        force = (*force, 0.0)
    return SpatialLoad((0.0, 0.0, 0.0) if force is None else triple(force, "force"), couple)
