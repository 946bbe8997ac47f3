"""Dead loads on sections of an arm, and supports that hold them."""

import reprlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from geometry.arrays import Array
from rod.checked import Given, finite
from rod.errors import LoadError, RodError

#: (x, y, z)
Triple = tuple[float, float, float]
#: x, y and z of a point that is held, mm; None along an axis on which it is free
Position = tuple[float | None, float | None, float | None]
#: distance from the clamp and from the end, over the length, below which a place is theirs
APART = 1e-4


def is_triple(value: object) -> bool:
    """Whether it has three parts, and is no text."""
    return isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and np.shape(value)[:1] == (3,)


def triple(values: object, name: str, unit: str = "") -> Triple:
    """x, y and z, given as for `finite`; z is 0 where it is left out. Raises `RodError` for anything else."""
    try:
        x, y, *rest = (finite(value, name, unit) for value in values)  # type: ignore[attr-defined]
        (z,) = rest or [0.0]
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} has finite numbers x and y, in space also z; {reprlib.repr(values)} has not.") from None
    return x, y, z


def pair(values: Sequence[Any], name: str, unit: str = "") -> tuple[float, float]:
    """(x, y) as finite floats, given as for `finite`. Raises `RodError`, naming what they are, for anything else."""
    try:
        x, y = (finite(value, name, unit) for value in values)
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} is a pair of finite numbers, x and y; {reprlib.repr(values)} is not.") from None
    return x, y


def scaled(values: Sequence[float], part: float) -> Triple:
    """A part of three components."""
    x, y, z = values
    return part * x, part * y, part * z


@final
@dataclass(frozen=True)
class PointLoad:
    """A dead load on one section, in numbers or texts with units. Raises `RodError` for anything else."""

    s: Given  #: mm, rest arc length from the clamp
    force: Sequence[Given] = (0.0, 0.0, 0.0)  #: N, (x, y, z), or (x, y) in the plane
    couple: Sequence[Given] = (0.0, 0.0, 0.0)  #: N mm; keeps its direction
    #: mm, where the force acts beside the material curve without load, along and normal to the arm
    beside: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "s", finite(self.s, "s", "mm"))
        _check(self, "N", "N*mm")

    @property
    def breaks(self) -> tuple[float, ...]:
        """mm: where it acts."""
        return (self.s,)

    def shares(self, s: Array) -> Array:
        """(N,) parts of the load on nodes at s (N,) mm; between two nodes by its distances from them."""
        i = int(np.clip(np.searchsorted(s, self.s) - 1, 0, len(s) - 2))
        part = min(1.0, (self.s - float(s[i])) / float(s[i + 1] - s[i]))
        parts = np.zeros(len(s))
        parts[i : i + 2] = 1.0 - part, part
        return parts


@final
@dataclass(frozen=True)
class LineLoad:
    """A dead load that is even over a part of an arm, in numbers or texts with units. Raises `RodError`."""

    start: Given  #: mm, rest arc length from the clamp
    end: Given  #: mm
    force: Sequence[Given]  #: N/mm, (x, y, z), or (x, y) in the plane
    couple: Sequence[Given] = (0.0, 0.0, 0.0)  #: N mm/mm; keeps its direction
    #: mm, where the force acts beside the material curve without load, along and normal to the arm
    beside: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        start, end = (finite(s, name, "mm") for s, name in ((self.start, "start"), (self.end, "end")))
        if not 0.0 <= start < end:
            raise LoadError(
                f"A line load goes from 0 mm or more to an end beyond it; {start:g} to {end:g} mm does not."
            )
        object.__setattr__(self, "start", start)
        object.__setattr__(self, "end", end)
        _check(self, "N/mm", "N")

    @property
    def breaks(self) -> tuple[float, ...]:
        """mm: where it begins and ends."""
        return self.start, self.end

    def shares(self, s: Array) -> Array:
        """(N,) mm: the length with the load that belongs to nodes at s (N,) mm."""
        edges = np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])
        return np.diff(np.clip(edges, self.start, self.end))


AlongLoad: TypeAlias = PointLoad | LineLoad


@final
@dataclass(frozen=True)
class Support:
    """Holds an arm in one section; numbers or texts with units. Raises `RodError`, also where it holds nothing."""

    s: Given  #: mm, rest arc length from the clamp
    x: Given = None  #: mm, where it holds the curve; None: free, and so are the others
    y: Given = None  #: mm
    z: Given = None  #: mm, across the plane of the arm
    angle: Given = None  #: rad, of the cross section's normal, as `theta` of a solution; in the plane alone
    #: mm, where it holds the arm beside the material curve without load, along and normal to the arm
    beside: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "s", finite(self.s, "s", "mm"))
        for name in ("x", "y", "z", "angle"):
            at, unit = getattr(self, name), "rad" if name == "angle" else "mm"
            object.__setattr__(self, name, None if at is None else finite(at, name, unit))
        _check_beside(self)
        if not self.held:
            raise RodError("A support holds x, y, z or the angle of a section; this one holds none of them.")

    @property
    def breaks(self) -> tuple[float, ...]:
        """mm: where it stands."""
        return (self.s,)

    @property
    def position(self) -> Position:
        """x, y and z, mm."""
        return self.x, self.y, self.z

    @property
    def held(self) -> dict[int, float]:
        """What is held, 0 to 2 for x to z and 5 for the angle, and its value."""
        values = {0: self.x, 1: self.y, 2: self.z, 5: self.angle}
        return {axis: at for axis, at in values.items() if at is not None}

    def seen_from(self, start: Sequence[float]) -> "Support":
        """These loads where x, y and z are measured from a start."""
        x, y, z = (None if at is None else at - origin for at, origin in zip(self.position, start, strict=True))
        return replace(self, x=x, y=y, z=z)


#: what `Rod.solve` takes along an arm
Along: TypeAlias = PointLoad | LineLoad | Support


class Reaction(NamedTuple):
    """What a support exerts on an arm."""

    s: float  #: mm, where it stands
    force: Triple  #: N
    couple: float  #: N mm, of a support that holds the angle


def reactions_of(supports: Sequence[Support], values: Array) -> tuple[Reaction, ...]:
    """Reactions by support; values: (k,) N or N mm, of all that is held."""
    found, left = [], iter(values.tolist())
    for one in supports:
        of = dict.fromkeys((0, 1, 2, 5), 0.0) | {axis: next(left) for axis in one.held}
        found.append(Reaction(one.s, (of[0], of[1], of[2]), of[5]))
    return tuple(found)


def are_heights(supports: Sequence[Support]) -> bool:
    """Whether heights are held as in experiment III, and neither places along x nor angles."""
    return any(one.y is not None for one in supports) and all(one.x is one.angle is None for one in supports)


def check_supports(supports: Sequence[Support], begin: float, length: float) -> None:
    """Raise `LoadError` for supports off the arm between two places (mm), and for two at one place."""
    places, inside = sorted(one.s for one in supports), f"{begin:.3g} < s <= {length:g} mm"
    for s in places:
        if not begin < s <= length * (1 + 1e-9):
            raise LoadError(f"A support of this arm stands at {inside}; s = {s:g} mm is outside.")
    for s, following in pairwise(places):
        if following - s <= APART * length:
            raise LoadError(f"Two supports stand at s = {s:g} mm; write all that is held there as one.")


def _check(load: AlongLoad, force_unit: str, couple_unit: str) -> None:
    """Give the force three components; raise `RodError` for what is no finite number."""
    object.__setattr__(load, "force", triple(load.force, "force", force_unit))
    object.__setattr__(load, "couple", triple(load.couple, "couple", couple_unit))
    _check_beside(load)


def _check_beside(one: Along) -> None:
    if np.shape(one.beside) != (2,) or not np.all(np.isfinite(one.beside)):
        raise RodError(f"beside is a pair of finite numbers, along and normal to the arm; {one.beside!r} is not.")


def resultant(along: Sequence[AlongLoad], s: Array) -> Array:
    """(3,) N: the sum of the forces of loads on nodes at s (N,) mm."""
    return np.asarray(sum((one.shares(s).sum() * np.array(one.force) for one in along), np.zeros(3)))


def leaves_plane(one: Along) -> bool:
    """Whether a load moves an arm out of its plane, or a support holds it there."""
    return one.z is not None if isinstance(one, Support) else any((one.force[2], *one.couple[:2]))


def part_of(along: Sequence[AlongLoad], part: float) -> tuple[AlongLoad, ...]:
    """A part of loads."""
    return tuple(replace(one, force=scaled(one.force, part), couple=scaled(one.couple, part)) for one in along)


def split_along(along: object) -> tuple[tuple[AlongLoad, ...], tuple[Support, ...]]:
    """Loads and supports. Raises `RodError` for anything else."""
    if not isinstance(along, Sequence) or not all(isinstance(one, PointLoad | LineLoad | Support) for one in along):
        raise RodError(f"along is a list of rod.PointLoad, rod.LineLoad and rod.Support; {along!r} is not.")
    supports = tuple(one for one in along if isinstance(one, Support))
    return tuple(one for one in along if not isinstance(one, Support)), supports


def check_inside(load: AlongLoad, length: float) -> None:
    """Raise `LoadError` for a load off the arm."""
    s = load.breaks[-1]
    if not 0.0 < s <= length * (1 + 1e-9):
        raise LoadError(f"A load acts at 0 < s <= {length:g} mm along the arm; s = {s:g} mm is outside.")
