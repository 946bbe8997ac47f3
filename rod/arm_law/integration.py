"""The rod with the arm's own law, integrated from its end to the clamp (`rod.compiled`).

State (theta, M, x, y) at rest arc length s, all in mm, N and rad:

    theta' = kappa,   r' = lambda t + gamma n,   M' = y' F_x - x' F_y,

with t = (cos theta, sin theta), n = (-sin theta, cos theta), axial force N = F . t, shear force Q = F . n, and

    kappa from M = w'(kappa) - N lambda'(kappa),   lambda = lambda(kappa) + N/EA,   gamma = Q/GA.

With a weight of the arm F is the force on the end and the weight beyond s, and M' has the couple h (q_x cos theta + q_y
sin theta) of its height h above the curve besides. The first is kappa(M_e) with the effective moment M_e = M + N
dlambda/dkappa, found by iteration, since N is small against EA. Fourth-order Runge-Kutta steps of equal length.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Mask
from rod.compiled import CompiledLater

#: most iterations for the effective moment, and its change over the step of the law with which they end: each gains a
#: factor of about a thousand, and less near kinks of the stretch
ITERATIONS, SETTLED = 8, 1e-6
#: Newton's method at the end: largest correction, iterations, and relative step of the difference quotients
TOLERANCE, MAX_ITERATIONS, DIFFERENCE = 1e-8, 12, 1e-6
#: calls of Newton's method in plain Python, 50 ms each, after which it is compiled: one rod takes two to ten
_PLAIN_CALLS = 20


class LawArrays(NamedTuple):
    """A `SectionLaw` as the integrator reads it."""

    first: float  #: N mm, smallest moment
    step: float  #: N mm, between two moments
    kappa: Array  #: (n,) 1/mm
    kappa_slope: Array  #: (n,) 1/(N mm2)
    stretch: Array  #: (n,)
    stretch_slope: Array  #: (n,) 1/(N mm)
    axial: Array  #: (n,) N
    shear: Array  #: (n,) N


def _cubic(values: Array, slopes: Array, i: int, t: float, step: float) -> tuple[float, float]:
    """Value and slope of the cubic in interval i at t."""
    a, b, da, db = float(values[i]), float(values[i + 1]), step * float(slopes[i]), step * float(slopes[i + 1])
    value = (1 + 2 * t) * (1 - t) ** 2 * a + t * (1 - t) ** 2 * da + t * t * (3 - 2 * t) * b + t * t * (t - 1) * db
    slope = (6 * t * t - 6 * t) * (a - b) + (3 * t * t - 4 * t + 1) * da + (3 * t * t - 2 * t) * db
    return value, slope / step


def _rate(law: LawArrays, z: Array, acting: Array, out: Array) -> float:
    """Right-hand side for z = (theta, M, x, y); returns by how much the effective moment leaves the table, N mm.

    acting: (4,) force in N and couple per length in N.
    """
    fx, fy = float(acting[0]), float(acting[1])
    angle, moment = float(z[0]), float(z[1])
    if not (math.isfinite(angle) and math.isfinite(moment)):
        out[:] = math.nan
        return math.inf
    cosine, sine = math.cos(angle), math.sin(angle)
    axial, across = fx * cosine + fy * sine, fy * cosine - fx * sine
    last = len(law.kappa) - 1
    effective, kappa, stretch, i, t = moment, 0.0, 1.0, 0, 0.0
    for _ in range(ITERATIONS):
        position = (effective - law.first) / law.step
        if not math.isfinite(position):
            out[:] = math.nan
            return math.inf
        i = min(max(math.floor(position), 0), last - 1)
        t = position - i
        if t < 0.0 or t > 1.0:  # outside: the end value, and the caller is told
            t = min(max(t, 0.0), 1.0)
        kappa, kappa_slope = _cubic(law.kappa, law.kappa_slope, i, t, law.step)
        stretch, stretch_slope = _cubic(law.stretch, law.stretch_slope, i, t, law.step)
        outside = max(law.first - effective, effective - law.first - law.step * last, 0.0)
        before, effective = effective, moment + axial * stretch_slope / kappa_slope
        if abs(effective - before) < SETTLED * law.step:
            break
    EA = (1 - t) * law.axial[i] + t * law.axial[i + 1]
    GA = (1 - t) * law.shear[i] + t * law.shear[i + 1]
    length, slip = stretch + axial / EA, across / GA
    out[0] = kappa
    out[2] = length * cosine - slip * sine
    out[3] = length * sine + slip * cosine
    out[1] = out[3] * fx - out[2] * fy + acting[2] * cosine + acting[3] * sine
    return outside


def integrate(law: LawArrays, load: "EndLoad", force: Array, end: Array, states: Array) -> float:
    """Integrate from s = length, where the state is end (4,), to s = 0; fills states (n + 1, 4) by increasing s.

    force: (2,) N, on the end. Returns by how much the moment leaves the law at the most, N mm.
    """
    n = len(states) - 1
    h = -load.length / n
    k, acting = np.empty((4, 4)), np.empty(4)
    z, stage = end.copy(), np.empty(4)
    states[n] = z
    outside = 0.0
    for step in range(n):
        before, beyond = load.weight[n - step], load.weight[n - 1 - step]
        for j in range(2):
            acting[2 + j] = (before[2 + j] - beyond[2 + j]) / h
        for i in range(4):
            part = 0.0 if i == 0 else (1.0 if i == 3 else 0.5)
            for j in range(2):
                acting[j] = force[j] + before[j] + part * (beyond[j] - before[j])
            stage[:] = z
            if i > 0:
                factor = h if i == 3 else 0.5 * h
                for j in range(4):
                    stage[j] += factor * k[i - 1, j]
            outside = max(outside, _rate(law, stage, acting, k[i]))
        for j in range(4):
            z[j] += h / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])
        states[n - 1 - step] = z
    return outside


class EndArrays(NamedTuple):
    """The two ends of the arm as the solver reads them."""

    moment: Array  #: (k,) N mm, of the clamped end
    rotation: Array  #: (k,) rad
    rotation_slope: Array  #: (k,)
    offset: Array  #: (k, 2) mm
    offset_slope: Array  #: (k, 2)
    position: float  #: s of the deciding moment, mm
    #: (n + 1, 5) over equally spaced turns of the tip from -pi to pi: couple of its support, N mm; from the end of the
    #: axis to the point in which a force acts and to the end of the material curve, along and normal to the axis, mm
    tip: Array
    tip_slope: Array  #: (n + 1, 5) per rad
    tip_by_pull: Array  #: (2,) displacement of the end of the material curve by an axial force, along and normal, mm/N


class EndLoad(NamedTuple):
    """What acts on the end s = length, or holds it, and the weight of the arm."""

    length: float  #: mm
    force: Array  #: (2,) N, where it is given
    couple: float  #: N mm
    held: Mask  #: (2,) whether the coordinate is prescribed and the force component unknown
    target: Array  #: (2,) mm, prescribed coordinates
    #: (n + 1, 4) of the part between each of the states and the end: its weight, x and y in N, and the same times the
    #: height of its mass above the curve, N mm
    weight: Array


def _clamp(ends: EndArrays, moment: float, axial: float, offset: Array) -> tuple[float, float]:
    """Rotation at a moment under a force along the arm (N), and the offset (2,) there; by how much the moment leaves
    the curve, N mm.

    A moment moves the clamped end along the arm, so that by the reciprocal theorem a force along the arm turns it.
    """
    last = len(ends.moment) - 1
    outside = max(ends.moment[0] - moment, moment - ends.moment[last], 0.0)
    at = min(max(moment, ends.moment[0]), ends.moment[last])
    i = min(max(np.searchsorted(ends.moment, at) - 1, 0), last - 1)
    step = ends.moment[i + 1] - ends.moment[i]
    t = (at - ends.moment[i]) / step
    offset[1] = _cubic(ends.offset[:, 1], ends.offset_slope[:, 1], i, t, step)[0]
    offset[0], by_moment = _cubic(ends.offset[:, 0], ends.offset_slope[:, 0], i, t, step)
    return _cubic(ends.rotation, ends.rotation_slope, i, t, step)[0] + axial * by_moment, outside


def tip_levers(ends: EndArrays, turn: float, acting: Array) -> tuple[Array, Array, float]:
    """At a turn of the tip in rad, under a force (2,) in N: from the end of the axis to the end of the material curve,
    and to the point in which a force acts, (2,) mm each; and the couple of the support, N mm."""
    last = len(ends.tip) - 1
    step = 2.0 * math.pi / last
    position = (turn + math.pi) / step
    position -= last * math.floor(position / last)
    i = min(math.floor(position), last - 1)
    values = np.empty(5)
    for k in range(5):
        values[k] = _cubic(ends.tip[:, k], ends.tip_slope[:, k], i, position - i, step)[0]
    cosine, sine = math.cos(turn), math.sin(turn)
    pull = acting[0] * cosine + acting[1] * sine
    for k in range(2):  # such a force acts on the end of the curve
        values[1 + k] += pull * ends.tip_by_pull[k]
        values[3 + k] += pull * ends.tip_by_pull[k]
    force = np.array([values[1] * cosine - values[2] * sine, values[1] * sine + values[2] * cosine])
    end = np.array([values[3] * cosine - values[4] * sine, values[3] * sine + values[4] * cosine])
    return end, force, values[0]


def residual(law: LawArrays, ends: EndArrays, load: EndLoad, unknowns: Array, states: Array, missed: Array) -> float:
    """Integrate for unknowns (3,) = (angle of the axis at the end, F_x, F_y); fills states (n + 1, 4), shifted to the
    clamp, and missed (3,): the angle at the clamp (rad), and prescribed coordinates of the end over the length.

    Returns by how much a moment leaves the law, N mm.
    """
    force, offset = np.empty(2), np.empty(2)
    for k in range(2):
        force[k] = unknowns[1 + k] if load.held[k] else load.force[k]
    to_end, lever, of_support = tip_levers(ends, unknowns[0], force)
    couple = of_support + load.couple + lever[0] * force[1] - lever[1] * force[0]
    outside = integrate(law, load, force, np.array([unknowns[0], couple, 0.0, 0.0]), states)
    n = len(states) - 1
    position = ends.position / load.length * n
    i = min(math.floor(position), n - 1)
    decides = states[i, 1] + (position - i) * (states[i + 1, 1] - states[i, 1])
    rotation, beyond = _clamp(ends, decides, float(force[0] + load.weight[0, 0]), offset)
    shift = np.array([offset[0] - states[0, 2], offset[1] - states[0, 3]])
    for row in range(n + 1):
        states[row, 2] += shift[0]
        states[row, 3] += shift[1]
    missed[0] = states[0, 0] - rotation
    for k in range(2):
        missed[1 + k] = (states[n, 2 + k] + to_end[k] - load.target[k]) / load.length if load.held[k] else 0.0
    return max(outside, beyond)


def _converge(
    law: LawArrays, ends: EndArrays, load: EndLoad, unknowns: Array, size: Array, states: Array
) -> tuple[bool, float, float]:
    """Newton's method with difference quotients for unknowns (3,), changed in place; fills states (n + 1, 4).

    size (3,): changes of the unknowns that count as one. Returns whether it converged, by how much a moment leaves the
    law, N mm, and the determinant of the last matrix: its sign changes where the path becomes unstable.
    """
    missed, moved, matrix = np.empty(3), np.empty(3), np.eye(3)
    determinant = 0.0
    trial = np.empty(3)
    for _ in range(MAX_ITERATIONS):
        outside = residual(law, ends, load, unknowns, states, missed)
        for k in range(3):
            if k > 0 and not load.held[k - 1]:
                continue
            trial[:] = unknowns
            trial[k] += DIFFERENCE * size[k]
            residual(law, ends, load, trial, states, moved)
            for row in range(3):
                matrix[row, k] = (moved[row] - missed[row]) / DIFFERENCE
        for k in range(2):
            if not load.held[k]:
                matrix[1 + k, :] = 0.0
                matrix[:, 1 + k] = 0.0
                matrix[1 + k, 1 + k] = 1.0
        determinant = float(np.linalg.det(matrix))
        if abs(determinant) < 1e-300:
            return False, outside, determinant
        correction = np.linalg.solve(matrix, -missed)
        largest = np.abs(correction).max()
        if not largest < 10.0:
            return False, outside, determinant
        unknowns += correction * size
        if largest < TOLERANCE:
            return True, residual(law, ends, load, unknowns, states, missed), determinant
    return False, outside, determinant


#: `_converge`, in plain Python for a few rods and compiled for many
converge = CompiledLater(_converge, (_cubic, _rate, integrate, _clamp, tip_levers, residual), _PLAIN_CALLS)
