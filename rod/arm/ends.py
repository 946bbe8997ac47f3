"""Clamp and tip of an arm, as the solver reads them."""

import numpy as np

from geometry.arrays import Array
from rod.arm.end_kernels import EndArrays


def polynomial_ends(table: Array, to_end: Array) -> EndArrays:
    """Both ends of an arm without a plane of symmetry.

    table: (i, j, 6) as in `EndArrays`; to_end: (3,) mm, from the end of the axis to that of the material curve.
    """
    clamp = np.array([-1.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 2))
    rows = np.tile(np.concatenate([[0.0], to_end, to_end]), (2, 1))
    return EndArrays(True, *clamp, copied(table), rows, np.zeros_like(rows), np.zeros(2))


def rigid_ends(angle: float) -> EndArrays:
    """A clamp that does not give way, at an angle (rad), and a force on the end of the axis."""
    clamp = np.array([-1.0, 1.0]), np.tile([angle, 0.0, 0.0], (2, 1)), np.zeros((2, 3)), np.zeros((2, 2))
    return EndArrays(False, *clamp, np.zeros((1, 1, 6)), np.zeros((2, 7)), np.zeros((2, 7)), np.zeros(2))


def copied(values: Array) -> Array:
    """A copy that may be written, row by row in memory; for other arrays numba would compile the solver again."""
    return np.array(values, order="C", dtype=float)
