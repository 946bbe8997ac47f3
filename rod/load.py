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

from rod.along import AlongLoad, checked_along, leaves_plane
from rod.checked import finite
from rod.errors import LoadError, RodError
from rod.spatial import SpatialLoad, held_at

AnyLoad = TypeVar("AnyLoad", "Load", SpatialLoad)


@dataclass(frozen=True)
class Load:
    """A dead load on a clamped arm (the full body, both halves). Raises `RodError` for numbers that are not finite."""

    force: tuple[float, float] = (0.0, 0.0)  #: N, F_x and F_y on the end s = l
    couple: float = 0.0  #: N mm, on the end
    weight: tuple[float, float] = (0.0, 0.0)  #: N/mm, q_x and q_y per rest length, all along the arm
    weight_height: float = 0.0  #: mm, of the mass above the material curve, along the normal of the curve
    along: tuple[AlongLoad, ...] = ()  #: on sections of the arm, in its plane

    def __post_init__(self) -> None:
        for name in ("force", "weight"):
            object.__setattr__(self, name, pair(getattr(self, name), name))
        object.__setattr__(self, "couple", finite(self.couple, "The end moment"))
        object.__setattr__(self, "weight_height", finite(self.weight_height, "weight_height"))
        object.__setattr__(self, "along", checked_along(self.along))
        if any(map(leaves_plane, self.along)):
            raise LoadError("A load across the plane of the arm is none of a rod in its plane; solve the rod in space.")

    @property
    def own_weight(self) -> "Load":
        """The weight alone."""
        return Load(weight=self.weight, weight_height=self.weight_height)

    @property
    def in_space(self) -> SpatialLoad:
        """The same load with three components."""
        return SpatialLoad(
            (*self.force, 0.0), (0.0, 0.0, self.couple), (*self.weight, 0.0), self.weight_height, self.along
        )

    def on_free_axes(self, end: tuple[float | None, float | None]) -> "Load":
        """The load with its force on the end along the axes on which the end is free."""
        fx, fy = (0.0 if held is not None else force for force, held in zip(self.force, end, strict=True))
        return replace(self, force=(fx, fy))

    @property
    def force_size(self) -> float:
        """N, |F|."""
        return math.hypot(*self.force)


def with_along(load: AnyLoad, more: Sequence[AlongLoad], length: float) -> AnyLoad:
    """The load with more along the arm, mm; forces on its end join the force there."""
    along: list[AlongLoad] = []
    force = np.array(load.force)
    one: AlongLoad
    for one in (*load.along, *more):
        if one.breaks == (length,) and not any((*one.couple, *one.beside)):
            force += one.force[: len(force)]
        else:
            along.append(one)
    joined: Any = tuple(force.tolist())
    return replace(load, force=joined, along=tuple(along))


def pair(values: Sequence[float | None], name: str) -> tuple[float, float]:
    """(x, y) as finite floats. Raises `RodError`, naming what they are, for anything else."""
    try:
        x, y = (finite(value, name) for value in values)
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} is a pair of finite numbers, x and y; {reprlib.repr(values)} is not.") from None
    return x, y


def requested(
    force: Sequence[float] | None,
    moment: float | Sequence[float],
    end: Sequence[float | None] | None,
    end_x: float | None = None,
    end_y: float | None = None,
) -> tuple[Load, tuple[float | None, float | None]]:
    """The load and the prescribed position of the end that the arguments of `solve` name.

    Raises `LoadError` where they contradict each other.
    """
    if end is not None and (end_x is not None or end_y is not None):
        raise LoadError("Give either end = (x, y) or one of end_x and end_y, not both.")
    if force is not None and any(value is not None for value in (end, end_x, end_y)):
        raise LoadError("Give either the force on the end or its position, not both: one follows from the other.")
    load = Load((0.0, 0.0) if force is None else pair(force, "force"), finite(moment, "The end moment"))
    return load, held_at(end_x, end_y) if end is None else pair(end, "end")
