"""Where the chambers of an arm lie along x: the wide parts of a cavity, between which only narrow channels lead.

The section of the air at a plane is the part, projected on this plane, of the walls that lie behind it: the divergence
theorem for a body that is cut there. Walls in the planes y = 0 and z = 0 do not count, and a cavity that is open in the
plane of the clamp needs no lid, because all of its walls behind a plane are there.
"""

from collections.abc import Iterable
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from geometry.arrays import Array, Index

#: smallest and largest x, mm
Range: TypeAlias = tuple[float, float]

#: part of the section of the smaller of two neighbouring chambers below which what lies between them is a channel
NARROW = 0.5
#: part of the section within the outside of a body on either side below which what lies between them is a gap
NOTCH = 0.8
#: part of the largest section of a cavity that a chamber has at least, or of the median of the sections within an
#: outside; what is smaller widens a channel
SMALLEST = 0.2
#: planes along a cavity at which its section is compared
PLANES = 400
#: halvings of the distance of two planes to find where a chamber begins or ends
HALVINGS = 16
#: decimals of distances in mm
ROUNDED = 3
#: distance (mm) from a length with fewer decimals below which that was drawn
NEAR_DRAWN = 1e-3
#: length of a cavity or chamber over that of the arm from which on it runs through all of it
WHOLE = 0.75


def sections(points: Array, walls: Index, x: Array) -> Array:
    """Section (mm2) of the air within walls (k, 3) at planes x (n,), mm, none of them in the plane of a wall."""
    corners = points[walls]
    edges = corners[:, 1:] - corners[:, :1]
    projected = 0.5 * (edges[:, 0, 1] * edges[:, 1, 2] - edges[:, 0, 2] * edges[:, 1, 1])
    facing = projected != 0.0
    low, middle, high = np.sort(corners[facing][:, :, 0], axis=1).T
    projected = projected[facing]
    areas = np.zeros(len(x))
    for number, plane in enumerate(x):
        cut = (low < plane) & (plane < high)
        a, b, c = low[cut], middle[cut], high[cut]
        with np.errstate(divide="ignore", invalid="ignore"):  # of the branch that is not taken
            beyond_b = (c - plane) ** 2 / ((c - b) * (c - a))
            before_b = 1.0 - (plane - a) ** 2 / ((b - a) * (c - a))
        behind = np.where(plane > b, beyond_b, before_b)
        areas[number] = projected[low >= plane].sum() + (projected[cut] * behind).sum()
    return np.abs(areas)


def chambers_of(points: Array, walls: Index) -> tuple[Range, ...]:
    """Smallest and largest x of each chamber of the cavity within walls (k, 3), by increasing x, mm.

    A cavity without narrow channels is one chamber.
    """
    low, high, planes = _along(points, walls)
    areas = sections(points, walls, planes)
    peaks = _peaks(areas, NARROW, SMALLEST * float(areas.max()))
    if len(peaks) == 1:
        return ((low, high),)
    lowest = [p + int(np.argmin(areas[p:q])) for p, q in pairwise(peaks)]
    levels = NARROW * areas[peaks]
    begins, ends = np.array([low, *planes[lowest]]), np.array([*planes[lowest], high])
    return tuple(
        zip(
            _crossings(points, walls, planes[peaks], begins, levels).tolist(),
            _crossings(points, walls, planes[peaks], ends, levels).tolist(),
            strict=True,
        )
    )


def has_gaps(points: Array, outside: Index) -> bool:
    """Whether the section within the outside (k, 3) of a body is smaller between two places than at both, as that of an
    arm with gaps between its chambers is."""
    _, _, planes = _along(points, outside)
    areas = sections(points, outside, planes)
    return len(_peaks(areas, NOTCH, SMALLEST * float(np.median(areas)))) > 1  # a flange may be many times as large


def _along(points: Array, walls: Index) -> tuple[float, float, Array]:
    """Smallest and largest x of walls, and planes between them."""
    low, high = (float(bound(points[walls, 0])) for bound in (np.min, np.max))
    return low, high, np.linspace(low, high, 2 * PLANES + 1)[1::2]


def _peaks(areas: Array, narrow: float, smallest: float) -> list[int]:
    """Where sections are largest, and larger than `smallest`.

    What lies between two of them is less than the part `narrow` of both.
    """
    peaks, highest, lowest = list[int](), 0, 0
    is_rising = True
    for number, area in enumerate(areas):
        if is_rising:
            highest = number if area > areas[highest] else highest
            if area < narrow * areas[highest]:
                peaks.append(highest)
                is_rising, lowest = False, number
        else:
            lowest = number if area < areas[lowest] else lowest
            if narrow * area > areas[lowest]:
                is_rising, highest = True, number
    peaks += [highest] if is_rising else []
    return [peak for peak in peaks if areas[peak] > smallest]


def _crossings(points: Array, walls: Index, wide: Array, narrow: Array, levels: Array) -> Array:
    """x (n,), mm, where sections fall below levels (n,) between the widest plane of a chamber and a narrow one."""
    for _ in range(HALVINGS):
        middle = (wide + narrow) / 2
        is_wide = sections(points, walls, middle) > levels
        wide, narrow = np.where(is_wide, middle, wide), np.where(is_wide, narrow, middle)
    return narrow


def distances(middles: Iterable[float]) -> list[float]:
    """Distances (mm) between the middles (mm) of neighbouring chambers."""
    return [round(after - before, ROUNDED) for before, after in pairwise(middles)]


def as_drawn(length: float) -> float:
    """A measured length or position (mm) as it was drawn: with few decimals if it is that near to such a number."""
    rounded = (round(length, decimals) for decimals in range(ROUNDED))
    return next((drawn for drawn in rounded if abs(drawn - length) < NEAR_DRAWN), length)


def middles_of(chambers: Iterable[Range], length: float) -> list[float]:
    """x (mm) of the middles of the chambers that follow one another along an arm of a length (mm).

    Chambers beside one another are one, and those that run through all of the arm do not count.
    """
    groups: list[Range] = []
    for low, high in sorted(chamber for chamber in chambers if not runs_through(chamber, length)):
        if groups and low < groups[-1][1]:
            low, high = groups[-1][0], max(high, groups.pop()[1])
        groups.append((low, high))
    return [(low + high) / 2 for low, high in groups if not runs_through((low, high), length)]


def runs_through(chamber: Range, length: float) -> bool:
    """Whether a chamber runs through all of an arm of a length (mm)."""
    return chamber[1] - chamber[0] >= WHOLE * length
