"""Clamp and tip of an arm with its own law, as the solver reads them."""

import numpy as np

from geometry.arrays import Array
from rod.along import Position
from rod.arm.end_kernels import EndArrays
from rod.arm_law.curves import ClampCurve, TipCurve, TipState


def tip_state(tip: TipCurve, position: Position) -> TipState:
    """The tip that is free, held along x or at a height, or along both in one point."""
    x, y, _ = position
    if x is None and y is None:
        return tip.free
    if x is None:
        return tip.held
    return tip.held_along_x if y is None else tip.pinned


def end_arrays(clamp: ClampCurve, tip: TipState) -> EndArrays:
    """Both ends of an arm with a plane of symmetry."""
    n = len(tip.couple)
    zero = np.zeros((n, 1))
    table = np.column_stack([tip.couple, tip.acts_at, zero, tip.beside[:, -1], zero])
    values, slopes = tip.over_turns(table)
    lateral = clamp.lateral_compliance if clamp.lateral_compliance.size else np.zeros((2, 2))
    return EndArrays(
        False,
        _copied(clamp.moment),
        _copied(np.column_stack([clamp.rotation, clamp.offset])),
        _copied(np.column_stack([clamp.rotation_by_moment, clamp.offset_by_moment])),
        _copied(lateral),
        np.zeros((1, 1, 6)),
        _copied(values),
        _copied(slopes),
        _copied(tip.by_pull[-1]),
    )


def polynomial_ends(table: Array, to_end: Array) -> EndArrays:
    """Both ends of an arm without a plane of symmetry.

    table: (i, j, 6) as in `EndArrays`; to_end: (3,) mm, from the end of the axis to that of the material curve.
    """
    clamp = np.array([-1.0, 1.0]), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 2))
    rows = np.tile(np.concatenate([[0.0], to_end, to_end]), (2, 1))
    return EndArrays(True, *clamp, _copied(table), rows, np.zeros_like(rows), np.zeros(2))


def rigid_ends(angle: float) -> EndArrays:
    """A clamp that does not give way, at an angle (rad), and a force on the end of the axis."""
    clamp = np.array([-1.0, 1.0]), np.tile([angle, 0.0, 0.0], (2, 1)), np.zeros((2, 3)), np.zeros((2, 2))
    return EndArrays(False, *clamp, np.zeros((1, 1, 6)), np.zeros((2, 7)), np.zeros((2, 7)), np.zeros(2))


def _copied(values: Array) -> Array:
    """A copy that may be written, row by row in memory; for other arrays numba would compile the solver again."""
    return np.array(values, order="C", dtype=float)
