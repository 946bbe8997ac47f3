"""The frame of a file: its unit and directions, and those of the arm; what a user writes where the body lies elsewhere.

Positions are in mm and in the directions of the arm: x along it, y up, z across, its middle at z = 0.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.errors import DesignError

Point: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Directions:
    """Directions in a file of any length: that of the arm, and one that is up; both may be oblique."""

    along: Point
    up: Point  #: its part perpendicular to `along` counts


#: which directions of the file are x, y and z of the arm: ("x", "z", "-y"), or two directions
Axes: TypeAlias = tuple[str, str, str] | Directions

SAME: Axes = ("x", "y", "z")
#: length of an arm, in lengths over which curvature is averaged, that five parameters need (`rod.too_few_pitches`)
PITCHES = 6.5
#: the value of `axes`, by the direction along which a body is longest and the one in which it is high
TURNS = {
    ("x", "z"): "[x, z, -y]",
    ("y", "x"): "[y, x, -z]",
    ("y", "z"): "[y, z, x]",
    ("z", "x"): "[z, x, y]",
    ("z", "y"): "[z, y, -x]",
}
#: the two sides of a symmetric body reach equally far but for this part of its size, because the bounds of splines are
#: those of triangles
UNEQUAL = 1e-3
#: smallest and largest size of an arm, mm, and that below which a body may be in another unit
SMALLEST, LARGEST, USUAL = 1.0, 3000.0, 10.0
#: sine of the smallest angle between the directions along and up
LEAST_ANGLE = 1e-3


@dataclass(frozen=True)
class CellPlanes:
    """Two neighbouring planes of mirror symmetry of the cells of a body."""

    start: float  #: x of the plane in the middle of a cell, mm, as in the file
    stop: float  #: x of the plane between this cell and the next or the one before, mm

    @property
    def half_pitch(self) -> float:
        """Half the length of a cell, mm."""
        return abs(self.stop - self.start)


def rotation(axes: Axes) -> Array:
    """The matrix (3, 3) that turns a point of the file into the frame of the arm: its rows are the arm's x, y and z.

    Raises `DesignError` unless three directions are perpendicular and right-handed, and two differ.
    """
    if isinstance(axes, Directions):
        return _between(axes)
    rows = np.zeros((3, 3))
    for row, axis in zip(rows, axes, strict=True):
        row["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    if not np.array_equal(rows @ rows.T, np.eye(3)):
        raise DesignError("axes", f"[{', '.join(axes)}] names a direction twice; allowed: each of x, y and z once")
    if np.linalg.det(rows) < 0:
        last = axes[2].removeprefix("-") if axes[2].startswith("-") else f"-{axes[2]}"
        raise DesignError("axes", f"[{', '.join(axes)}] mirrors the body; write [{axes[0]}, {axes[1]}, {last}]")
    return rows


def _between(directions: Directions) -> Array:
    along, up = np.array(directions.along, dtype=float), np.array(directions.up, dtype=float)
    lengths = np.linalg.norm(along), np.linalg.norm(up)
    if not (np.isfinite(lengths).all() and min(lengths) > 0):
        raise DesignError("axes", "along and up must be directions, three finite numbers that are not all zero")
    along /= lengths[0]
    up = up / lengths[1]
    up -= (up @ along) * along
    if np.linalg.norm(up) < LEAST_ANGLE:
        raise DesignError("axes", "up must be another direction than along")
    up /= np.linalg.norm(up)
    return np.stack([along, up, np.cross(along, up)])


def check_dimensions(sides: Array) -> None:
    """Raise `DesignError` unless the sides (3,) of a body, mm, are those of an arm."""
    if not SMALLEST <= sides.max() <= LARGEST:
        measures = " x ".join(f"{side:.4g}" for side in sides)
        raise DesignError(("file", "unit"), f"the body measures {measures} mm; is it in another unit? give unit")


def check_within(positions: dict[str, float | None], low: Array, high: Array, tolerance: float) -> None:
    """Raise `DesignError` for a position (clamp, tip, curve; mm) outside of the bounds (3,) of a body."""
    for key, position in positions.items():
        axis = 1 if key == "curve" else 0
        if position is not None and not low[axis] - tolerance <= position <= high[axis] + tolerance:
            doubt = "; is its unit right?" if (high - low).max() < USUAL else ""
            reach = f"which reaches from {low[axis]:.4g} to {high[axis]:.4g} mm{doubt}"
            raise DesignError(key, f"{'xy'[axis]} = {position + 0.0:g} mm lies outside the body, {reach}")


def no_end_face(name: str, x: float) -> DesignError:
    """The refusal of a body without a face in the plane of the end `name`; x: as the user gave it, mm."""
    plane = f"the body has no flat face in the plane x = {x + 0.0:g} mm"
    return DesignError(name, f"{plane}; cut a rounded end off, or turn it with axes")


def outside_material(curve: float, gap: tuple[float, float], advice: str = "") -> DesignError:
    """The refusal of a material curve at a height (mm) that leaves the material in a gap, mm from the clamp."""
    line = f"the line y = {curve:g} mm, z = 0 is outside the material"
    where = f"{line} from {gap[0]:.4g} to {gap[1]:.4g} mm behind the clamp"
    return DesignError("curve", f"{where}; give a height in a wall that runs from end to end{advice}")


def goes_on(name: str, x: float) -> DesignError:
    """The refusal of a body with material on both sides of the plane of the end `name`; x: as the user gave it, mm."""
    beyond = f"the body goes on beyond x = {x + 0.0:g} mm at the height of the material curve"
    return DesignError(name, f"{beyond}; give the x of its end there, or another height (curve)")


def misplaced(low: Array, high: Array, middle: float, is_reoriented: bool) -> DesignError:
    """The refusal of a body that does not have z = 0 in its middle, or at its side if it is a half.

    low, high: bounds (3,), mm; middle: the key.
    """
    position = middle + float(low[2] + high[2]) / 2
    sides = " or ".join(position_of(middle + float(side)) for side in (low[2], high[2]))
    turn = _turn(low, high) if not is_reoriented else ""
    reach = f"the body reaches from z = {low[2] + 0.0:.4g} to {high[2] + 0.0:.4g} mm"
    ways = [f"write axes: {turn} if it lies in that way"] if turn else []
    ways.append(
        f"write middle: {position_of(position)} for a whole arm, symmetric: true and middle: {sides} for one half"
    )
    return DesignError(("symmetric", "middle"), f"{reach}; {', '.join(ways)}")


def _turn(low: Array, high: Array) -> str:
    """The value of `axes` that turns a body; empty where it likely lies as it should.

    Its width is likely on both sides of zero, and most programs have z up.
    """

    def is_aside(axis: str) -> bool:
        k = "xyz".index(axis)
        return bool(abs(high[k] + low[k]) > UNEQUAL * (high - low).max())

    longest = "xyz"[int(np.argmax(high - low))]
    others = [axis for axis in "zyx" if axis != longest]
    return TURNS.get((longest, next(filter(is_aside, others), others[0])), "")


def position_of(position: float) -> str:
    """A position as the value of a key, mm."""
    return f"{round(position, 9) + 0.0:.9g} mm"
