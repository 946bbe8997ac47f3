"""What acts on an arm besides its pressure, as one value: end force, end couple, dead weight, loads along it.

The rod in equilibrium takes all, the moment of a curve (`moment_from_load`) the first three. In an identification the
weight acts in experiment II as well as in III; the end force in III alone (`rod.curves.curve.moment_between`).
"""

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, TypeVar

import numpy as np

from rod.along import Along, AlongLoad, Support, leaves_plane, split_along, triple
from rod.checked import Amount, finite
from rod.errors import LoadError, RodError
from rod.spatial import SpatialLoad, is_triple

AnyLoad = TypeVar("AnyLoad", "Load", SpatialLoad)
#: on the end, N: its components, or one amount that acts upwards
Force: TypeAlias = Amount | Sequence[Amount]


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
        for name, unit in (("force", "N"), ("weight", "N/mm")):
            object.__setattr__(self, name, pair(getattr(self, name), name, unit))
        object.__setattr__(self, "couple", finite(self.couple, "The end moment", "N*mm"))
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
    """The load in the plane that arguments of `solve` name. Raises `RodError` for what is none."""
    return Load(pair(_components(force), "force", "N"), finite(moment, "The end moment", "N*mm"))


def _components(force: Force | None) -> Sequence[Amount]:
    """Of the force on the end; one amount acts upwards."""
    upwards = 0.0 if force is None else force
    return (0.0, finite(upwards, "force", "N")) if isinstance(upwards, float | int | str) else upwards


def spatially_requested(force: Force | None, moment: Amount | Sequence[Amount]) -> SpatialLoad:
    """The load in space that arguments of `solve` name; a moment alone turns about z, and a pair acts in the plane.

    Raises `RodError` for what is no three numbers.
    """
    couple = triple(moment if is_triple(moment) else (0.0, 0.0, moment), "moment", "N*mm")
    components = _components(force)
    if np.shape(components) == (2,):
        components = (*components, 0.0)
    return SpatialLoad(triple(components, "force", "N"), couple)
