"""What acts on an arm besides its pressure, as one value: end force, end couple, dead weight, loads along it.

The rod in equilibrium takes all, the moment of a curve (`moment_from_load`) the first three. In an identification the
weight acts in experiment II as well as in III; the end force in III alone (`rod.curves.curve.moment_between`).
"""

import math
import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, final

import numpy as np

from rod.along import (
    APART,
    Along,
    AlongLoad,
    PointLoad,
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
from rod.weight import WEIGHT_OF_GRAM, Hung, Mass, checked_hung, gravity_vector, in_grams, position_along

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


@final
@dataclass(frozen=True)
class Loading:
    """Loads and supports of an arm, in numbers or texts with units; equal ones are one key.

    Raises `RodError` for what is no number, and `LoadError` where the end is both loaded and held.
    """

    force: Given = None  #: N, dead, on the end: x and y, in space also z; one amount acts upwards
    moment: Given = 0.0  #: N mm, on the end, about z; in space about x, y and z
    #: mm, where the end is held: x and y, in space also z, None along an axis on which it is free; None: it is free
    end: Given = None
    along: Sequence[Along] = ()  #: loads and supports along the arm
    direction: Given = None  #: of gravity, as `Rod.solve` takes it; None: no weight but one that always acts
    tip_mass: Given = 0.0  #: g, on the end; in a motion with its inertia
    hung: Hung = ()  #: masses along the arm, as `Rod.solve` takes them

    def __post_init__(self) -> None:
        is_upwards = isinstance(self.force, float | int | str)
        force = (0.0, finite(self.force, "force", "N")) if is_upwards else self.force
        load = Load((0.0, 0.0) if force is None else force, self.moment)
        self._put("force", None if force is None else load.force[: 3 if is_triple(force) else 2])
        self._put("moment", load.couple if is_triple(self.moment) else load.couple[2])
        self._put("along", sum(split_along(self.along), ()))
        if self.direction is not None:
            gravity_vector(self.direction)  # refuses what is none
            self._put("direction", self.direction if isinstance(self.direction, str) else tuple(self.direction))
        self._put("tip_mass", in_grams(self.tip_mass))
        self._put("hung", checked_hung(self.hung))
        self._put("end", None if self.end is None else _place(self.end))
        if self.end is not None and self.force is not None:
            raise LoadError("Give either the force on the end or its position, not both: one follows from the other.")

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    @property
    def is_spatial(self) -> bool:
        """Whether it has a part across the plane of the arm, though it be zero, or holds the arm there."""
        given = (self.force, self.moment, self.end, self.direction)
        return any(map(is_triple, given)) or any(map(leaves_plane, self.along))

    def on(self, length: float, mass: Mass | None, carried: tuple[float, float], *, weight: bool = True) -> Load:
        """The load on an arm of a length (mm) and a mass; weight: whether its own acts in a direction of gravity.

        carried: N/mm, x and y of a weight that always acts, and not where a direction is given. Raises `LoadError` for
        the weight of an arm whose mass is not known, and for a place that is none.
        """
        load = Load(self.force or (0.0, 0.0), self.moment)
        if self.direction is not None:
            down = WEIGHT_OF_GRAM * np.array(triple(gravity_vector(self.direction), "direction"))
            force = np.array(load.force) + self.tip_mass * down
            hung = [PointLoad(position_along(s, length), (float(grams) * down).tolist()) for s, grams in self.hung]
            without, height = -np.array(triple(carried, "weight")), 0.0
            if weight:
                if mass is None:
                    raise LoadError(
                        "The mass of the arm is not known: give material.density in its configuration and run it."
                    )
                (own,), (height,) = mass.within(np.array([length]))
                without, height = without + own / length * down, height / own
            load = Load(force, load.couple, without, height, tuple(hung))
        end = () if self.end is None else (Support(length, *self.end),)
        return with_along(load, (*self.along, *end), length)


def _place(end: Any) -> tuple[float | None, ...]:
    """x and y of an end that is held, in space also z, mm; None along an axis on which it is free."""
    place = () if isinstance(end, str) or not np.iterable(end) else tuple(end)
    if len(place) not in (2, 3):
        raise RodError(f"end is x and y, in space also z, None where it is free; {reprlib.repr(end)} is not.")
    return Support(1.0, *place).position[: len(place)]


def held_place(end: object, end_x: Amount | None, end_y: Amount | None) -> object:
    """Where the end is held by the arguments of `solve`, as `Loading.end`. Raises `LoadError` for two of them."""
    held = tuple(None if at is None else finite(at, name, "mm") for at, name in ((end_x, "end_x"), (end_y, "end_y")))
    if held == (None, None):
        return end
    if end is not None:
        raise LoadError("Give either end = (x, y) or one of end_x and end_y, not both.")
    return held


def with_end(load: Load, length: float, end_x: float | None, end_y: float | None) -> Load:
    """The load, of whose force the components act along which the end of an arm (mm) is not held."""
    return load if end_x is end_y is None else with_along(load, (Support(length, end_x, end_y),), length)
