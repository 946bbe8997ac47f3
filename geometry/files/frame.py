"""The frame of a file: its unit and directions, and those of the arm."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.errors import DesignError

#: which directions of the file are x, y and z of the arm: ("x", "z", "-y")
Axes: TypeAlias = tuple[str, str, str]

SAME: Axes = ("x", "y", "z")
#: length of an arm, in lengths over which curvature is averaged, that five parameters need (`rod.too_few_pitches`)
PITCHES = 6.5


def rotation(axes: Sequence[str]) -> Array:
    """The matrix (3, 3) that turns a point of the file into the frame of the arm: its rows are the arm's x, y and z.

    Raises `DesignError` unless the three directions are perpendicular and right-handed.
    """
    rows = np.zeros((3, 3))
    for row, axis in zip(rows, axes, strict=True):
        row["xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    if not np.array_equal(rows @ rows.T, np.eye(3)):
        raise DesignError("axes", f"[{', '.join(axes)}] names a direction twice; allowed: each of x, y and z once")
    if np.linalg.det(rows) < 0:
        last = axes[2].removeprefix("-") if axes[2].startswith("-") else f"-{axes[2]}"
        raise DesignError(
            "axes",
            f"[{', '.join(axes)}] would mirror the body; write [{axes[0]}, {axes[1]}, {last}], which turns it",
        )
    return rows


def in_frame(points: Array, unit: float, axes: Sequence[str], middle: float) -> Array:
    """Points (n, 3) of a file with that unit (mm) in the frame of the arm, mm; middle: z of its middle, mm.

    Raises `DesignError` as `rotation`.
    """
    return points @ (unit * rotation(axes).T) - [0.0, 0.0, middle]


def usual_cell(length: float) -> float:
    """Length (mm) over which curvature is averaged on an arm of that length (mm) of which no cell is known.

    The five parameters need `PITCHES` of them.
    """
    return min(10.0, length / 10)
