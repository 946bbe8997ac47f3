"""Both ends of an arm, as the solver reads them.

*Clamp.* The axis begins at a place and in a direction that follow from what acts there. In an arm with a plane of
symmetry the bending moment at the end of the first element decides on rotation and offset (`rod.arm_law.curves`); a
force along the arm turns the end as a moment shifts it, by reciprocity; out of the plane the end turns about its start.
In other arms both moments at the start decide.

*Tip.* From the end of the axis to the point in which a force acts, and to the end of the material curve; the support
that holds an edge at a height has a couple. They are tables over the turn of the end.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.arm.rotations import cross_into, exponential, multiply, turn_matrix

#: columns of the table of the tip: couple of its support; lever of a force and end of the curve, along the frame (3)
TIP_COLUMNS = 7


class EndArrays(NamedTuple):
    """Clamp and tip."""

    is_polynomial: bool  #: whether the clamp is that of an arm without a plane of symmetry
    moment: Array  #: (k,) N mm
    clamped: Array  #: (k, 3) rotation in rad, offset along and normal to the arm in mm
    clamped_slope: Array  #: (k, 3) by the moment
    lateral: Array  #: (2, 2) turns out of the plane by the moments about x and y, rad/(N mm)
    table: Array  #: (i, j, 6) coefficients of M_y^i M_z^j of turns (rad) and shifts (mm) along x, y and z
    tip: Array  #: (n + 1, TIP_COLUMNS) over equal turns from -pi to pi; N mm and mm
    tip_slope: Array  #: (n + 1, TIP_COLUMNS) per rad
    tip_pull: Array  #: (2,) displacement of both points by an axial force, along and normal, mm/N


def _cubic(values: Array, slopes: Array, t: float, step: float, out: Array) -> None:
    """Value, slope and second derivative (3,) of the cubic between two rows (2,) at t."""
    a, b, da, db = values[0], values[1], step * slopes[0], step * slopes[1]
    c2, c3 = 3.0 * (b - a) - 2.0 * da - db, 2.0 * (a - b) + da + db
    out[0] = a + t * (da + t * (c2 + t * c3))
    out[1] = (da + t * (2.0 * c2 + 3.0 * t * c3)) / step
    out[2] = (2.0 * c2 + 6.0 * t * c3) / (step * step)


def clamp_turn(ends: EndArrays, moment: float, axial: float, out: Array, work: Array) -> float:
    """Rotation and offset (3,) at a moment under a force along the arm, and their slopes, as out (3, 3).

    out[0]: rotation (rad), offset (2) (mm); out[1]: by the moment; out[2]: by the force. work: (3,). Returns by how
    much the moment leaves the curve, N mm.
    """
    last = len(ends.moment) - 1
    at = min(max(moment, ends.moment[0]), ends.moment[last])
    i = min(max(np.searchsorted(ends.moment, at) - 1, 0), last - 1)
    step = ends.moment[i + 1] - ends.moment[i]
    t = (at - ends.moment[i]) / step
    within = 1.0 if at == moment else 0.0
    out[2] = 0.0
    for k in range(3):
        _cubic(ends.clamped[i : i + 2, k], ends.clamped_slope[i : i + 2, k], t, step, work)
        out[0, k], out[1, k] = work[0], within * work[1]
        if k == 1:
            out[0, 0] += axial * work[1]
            out[1, 0] += within * axial * work[2]
            out[2, 0] = work[1]
    return abs(moment - at)


def clamp_in_plane(ends: EndArrays, acting: Array, place: Array, by_acting: Array, work: Array) -> float:
    """Where the axis begins, x, y and angle (3,), under acting (3,) = F_x, F_y, M at the end of the first element.

    by_acting: (3, 3), derivatives. work: (4, 3). Returns by how much the moment leaves the curve, N mm.
    """
    outside = clamp_turn(ends, acting[2], acting[0], work[:3], work[3])
    by_acting[:] = 0.0
    place[0], place[1], place[2] = work[0, 1], work[0, 2], work[0, 0]
    by_acting[0, 2], by_acting[1, 2], by_acting[2, 2] = work[1, 1], work[1, 2], work[1, 0]
    by_acting[2, 0] = work[2, 0]
    return outside


def clamp_in_space(
    ends: EndArrays, frame: Array, start: Array, end: Array, place: Array, turned: Array, by_start: Array, by_end: Array
) -> float:
    """Where the axis begins, and its frame there, under force and moment (6,) at the start and at the end of the first
    element; and derivatives (6, 6) of place and turn by both.

    frame: (3, 3), of the start as it is. Returns by how much a moment leaves what is known, N mm.
    """
    by_start[:] = 0.0
    by_end[:] = 0.0
    turn, spin = np.zeros(3), np.empty((3, 3))
    if ends.is_polynomial:
        values = np.zeros((3, 6))
        inside = np.empty(2)
        for k in range(2):
            inside[k] = frame[0, 1 + k] * start[3] + frame[1, 1 + k] * start[4] + frame[2, 1 + k] * start[5]
        _two_variables(ends.table, inside, values)
        for i in range(3):
            turn[i], place[i] = values[0, i], values[0, 3 + i]
        exponential(turn, turned)
        _left_jacobian(turn, spin)
        for k in range(2):
            for j in range(3):
                for i in range(3):
                    by_start[i, 3 + j] += values[1 + k, 3 + i] * frame[j, 1 + k]
                    by_start[3 + i, 3 + j] += frame[j, 1 + k] * (
                        spin[i, 0] * values[1 + k, 0] + spin[i, 1] * values[1 + k, 1] + spin[i, 2] * values[1 + k, 2]
                    )
        return 0.0
    work, across, along = np.empty((4, 3)), np.empty((3, 3)), np.empty((3, 3))
    outside = clamp_turn(ends, end[5], end[0], work[:3], work[3])
    place[0], place[1], place[2] = work[0, 1], work[0, 2], 0.0
    for i in range(2):
        turn[i] = ends.lateral[i, 0] * start[3] + ends.lateral[i, 1] * start[4]
    exponential(turn, across)
    _left_jacobian(turn, spin)
    turn[0], turn[1], turn[2] = 0.0, 0.0, work[0, 0]
    exponential(turn, along)
    multiply(across, along, turned)
    by_end[0, 5], by_end[1, 5] = work[1, 1], work[1, 2]
    for i in range(3):
        by_end[3 + i, 5] = across[i, 2] * work[1, 0]
        by_end[3 + i, 0] = across[i, 2] * work[2, 0]
        for j in range(2):
            by_start[3 + i, 3 + j] = spin[i, 0] * ends.lateral[0, j] + spin[i, 1] * ends.lateral[1, j]
    return outside


def _two_variables(table: Array, at: Array, out: Array) -> None:
    """Polynomials (c,) of two variables and their derivatives by both, out (3, c)."""
    first = 1.0
    for i in range(table.shape[0]):
        both = first
        for j in range(table.shape[1]):
            for c in range(table.shape[2]):
                value = table[i, j, c]
                out[0, c] += both * value
                if i > 0:
                    out[1, c] += i * at[0] ** (i - 1) * at[1] ** j * value
                if j > 0:
                    out[2, c] += j * at[0] ** i * at[1] ** (j - 1) * value
            both *= at[1]
        first *= at[0]


def _left_jacobian(turn: Array, out: Array) -> None:
    """(3, 3): the turn by which the rotation of a vector (3,) changes, by changes of that vector."""
    square = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]
    angle = math.sqrt(square)
    if angle < 1e-3:
        first, second = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    else:
        first, second = (1.0 - math.cos(angle)) / square, (angle - math.sin(angle)) / (square * angle)
    turn_matrix(turn, first, second, out)


def tip_levers(ends: EndArrays, frame: Array, acting: Array, out: Array, work: Array) -> None:
    """Levers of the end with a frame (3, 3) under a force (3,), out (3, 3).

    out[0]: moment of the force and of the support about the end of the axis, N mm; out[1]: lever of the force; out[2]:
    from the end of the axis to that of the material curve, mm. work: (5, TIP_COLUMNS).
    """
    last = len(ends.tip) - 1
    step = 2.0 * math.pi / last
    position = (math.atan2(frame[1, 0], frame[0, 0]) + math.pi) / step
    i = min(max(math.floor(position), 0), last - 1)
    values, cubic = work[0], work[1]
    for k in range(TIP_COLUMNS):
        _cubic(ends.tip[i : i + 2, k], ends.tip_slope[i : i + 2, k], position - i, step, cubic)
        values[k] = cubic[0]
    pull = frame[0, 0] * acting[0] + frame[1, 0] * acting[1] + frame[2, 0] * acting[2]
    for part in range(2):
        for k in range(2):
            values[1 + 3 * part + k] += pull * ends.tip_pull[k]
        for i in range(3):
            out[1 + part, i] = (
                frame[i, 0] * values[1 + 3 * part]
                + frame[i, 1] * values[2 + 3 * part]
                + frame[i, 2] * values[3 + 3 * part]
            )
    cross_into(out[1], acting, out[0])
    out[0, 2] += values[0]


#: in the order in which they call each other, innermost first
CALLS = (_cubic, clamp_turn, clamp_in_plane, _two_variables, _left_jacobian, clamp_in_space, tip_levers)
