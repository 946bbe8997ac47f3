"""Dead loads on sections of an arm between its ends."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, final

import numpy as np

from geometry.arrays import Array
from rod.checked import finite
from rod.errors import LoadError, RodError

#: (x, y, z)
Triple = tuple[float, float, float]


def triple(values: object, name: str) -> Triple:
    """Three finite numbers. Raises `RodError`, naming what they are, for anything else."""
    try:
        x, y, z = (finite(value, name) for value in values)  # type: ignore[attr-defined]
    except (TypeError, ValueError):  # a RodError is a ValueError
        raise RodError(f"{name} has three finite numbers, x, y and z; {values!r} has not.") from None
    return x, y, z


def scaled(values: Sequence[float], part: float) -> Triple:
    """A part of three components."""
    x, y, z = values
    return part * x, part * y, part * z


@final
@dataclass(frozen=True)
class PointLoad:
    """A dead load on one section of an arm. Raises `RodError` for what is no finite number."""

    s: float  #: mm, rest arc length from the clamp
    force: Sequence[float] = (0.0, 0.0, 0.0)  #: N, (x, y, z), or (x, y) in the plane
    couple: Triple = (0.0, 0.0, 0.0)  #: N mm; keeps its direction
    #: mm, where the force acts beside the material curve without load, along and normal to the arm
    beside: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        finite(self.s, "s")
        _check(self)

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
    """A dead load that is spread evenly over a part of an arm. Raises `RodError` for what is no finite number."""

    start: float  #: mm, rest arc length from the clamp
    end: float  #: mm
    force: Sequence[float]  #: N/mm, (x, y, z), or (x, y) in the plane
    couple: Triple = (0.0, 0.0, 0.0)  #: N mm/mm; keeps its direction
    #: mm, where the force acts beside the material curve without load, along and normal to the arm
    beside: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        start, end = (finite(s, name) for s, name in ((self.start, "start"), (self.end, "end")))
        if not 0.0 <= start < end:
            raise LoadError(
                f"A line load goes from 0 mm or more to an end beyond it; {start:g} to {end:g} mm does not."
            )
        _check(self)

    @property
    def breaks(self) -> tuple[float, ...]:
        """mm: where it begins and ends."""
        return self.start, self.end

    def shares(self, s: Array) -> Array:
        """(N,) mm: the length with the load that belongs to nodes at s (N,) mm."""
        edges = np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])
        return np.diff(np.clip(edges, self.start, self.end))


AlongLoad: TypeAlias = PointLoad | LineLoad


def _check(load: AlongLoad) -> None:
    """Give the force three components; raise `RodError` for what is no finite number."""
    force = (*load.force, 0.0) if np.shape(load.force) == (2,) else load.force
    object.__setattr__(load, "force", triple(force, "force"))
    object.__setattr__(load, "couple", triple(load.couple, "couple"))
    if np.shape(load.beside) != (2,) or not np.all(np.isfinite(load.beside)):
        raise RodError(f"beside is a pair of finite numbers, along and normal to the arm; {load.beside!r} is not.")


def resultant(along: Sequence[AlongLoad], s: Array) -> Array:
    """(3,) N: the sum of the forces of loads on nodes at s (N,) mm."""
    return np.asarray(sum((one.shares(s).sum() * np.array(one.force) for one in along), np.zeros(3)))


def leaves_plane(load: AlongLoad) -> bool:
    """Whether a load moves an arm out of its plane."""
    return any((load.force[2], *load.couple[:2]))


def part_of(along: Sequence[AlongLoad], part: float) -> tuple[AlongLoad, ...]:
    """A part of loads."""
    return tuple(replace(one, force=scaled(one.force, part), couple=scaled(one.couple, part)) for one in along)


def checked_along(along: object) -> tuple[AlongLoad, ...]:
    """Loads as a tuple. Raises `RodError` for anything else."""
    if not isinstance(along, Sequence) or not all(isinstance(one, PointLoad | LineLoad) for one in along):
        raise RodError(f"along is a list of rod.PointLoad and rod.LineLoad; {along!r} is not.")
    return tuple(along)


def check_inside(load: AlongLoad, length: float) -> None:
    """Raise `LoadError` for a load off the arm."""
    s = load.breaks[-1]
    if not 0.0 < s <= length * (1 + 1e-9):
        raise LoadError(f"A load acts at 0 < s <= {length:g} mm along the arm; s = {s:g} mm is outside.")
