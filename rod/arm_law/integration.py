"""The rod with the arm's own law, integrated from its end to the clamp (numba).

State (theta, M, x, y) at rest arc length s, all in mm, N and rad:

    theta' = kappa,   r' = lambda t + gamma n,   M' = y' F_x - x' F_y,

with t = (cos theta, sin theta), n = (-sin theta, cos theta), axial force N = F . t, shear force Q = F . n, and

    kappa from M = w'(kappa) - N lambda'(kappa),   lambda = lambda(kappa) + N/EA,   gamma = Q/GA.

The first is kappa(M_e) with the effective moment M_e = M + N dlambda/dkappa, found by iteration, since N is small
against EA. Fourth-order Runge-Kutta steps of equal length.
"""

import math
from typing import NamedTuple

import numba
import numpy as np

from geometry.arrays import Array

#: iterations for the effective moment; each one gains a factor N (dlambda/dkappa)^2 / (dM/dkappa), a thousandth
ITERATIONS = 3


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


@numba.njit(cache=True, inline="always")
def _cubic(values: Array, slopes: Array, i: int, t: float, step: float) -> tuple[float, float]:
    """Value and slope of the cubic in interval i at t."""
    a, b, da, db = values[i], values[i + 1], step * slopes[i], step * slopes[i + 1]
    value = (1 + 2 * t) * (1 - t) ** 2 * a + t * (1 - t) ** 2 * da + t * t * (3 - 2 * t) * b + t * t * (t - 1) * db
    slope = (6 * t * t - 6 * t) * (a - b) + (3 * t * t - 4 * t + 1) * da + (3 * t * t - 2 * t) * db
    return value, slope / step


@numba.njit(cache=True)
def _rate(law: LawArrays, z: Array, fx: float, fy: float, out: Array) -> float:
    """Right-hand side for z = (theta, M, x, y); returns by how much the effective moment leaves the table, N mm."""
    cosine, sine = math.cos(z[0]), math.sin(z[0])
    axial, across = fx * cosine + fy * sine, fy * cosine - fx * sine
    last = len(law.kappa) - 1
    effective, kappa, stretch, i, t = z[1], 0.0, 1.0, 0, 0.0
    for _ in range(ITERATIONS):
        position = (effective - law.first) / law.step
        i = min(max(math.floor(position), 0), last - 1)
        t = position - i
        if t < 0.0 or t > 1.0:  # outside: the end value, and the caller is told
            t = min(max(t, 0.0), 1.0)
        kappa, kappa_slope = _cubic(law.kappa, law.kappa_slope, i, t, law.step)
        stretch, stretch_slope = _cubic(law.stretch, law.stretch_slope, i, t, law.step)
        outside = max(law.first - effective, effective - law.first - law.step * last, 0.0)
        effective = z[1] + axial * stretch_slope / kappa_slope
    EA = (1 - t) * law.axial[i] + t * law.axial[i + 1]
    GA = (1 - t) * law.shear[i] + t * law.shear[i + 1]
    length, slip = stretch + axial / EA, across / GA
    out[0] = kappa
    out[2] = length * cosine - slip * sine
    out[3] = length * sine + slip * cosine
    out[1] = out[3] * fx - out[2] * fy
    return outside


@numba.njit(cache=True)
def integrate(law: LawArrays, length: float, force: Array, end: Array, states: Array) -> float:
    """Integrate from s = length, where the state is end (4,), to s = 0; fills states (n + 1, 4) by increasing s.

    Returns by how much the moment leaves the law at the most, N mm.
    """
    n = len(states) - 1
    h = -length / n
    k = np.empty((4, 4))
    z, stage = end.copy(), np.empty(4)
    states[n] = z
    outside = 0.0
    for step in range(n):
        for i in range(4):
            stage[:] = z
            if i > 0:
                factor = h if i == 3 else 0.5 * h
                for j in range(4):
                    stage[j] += factor * k[i - 1, j]
            outside = max(outside, _rate(law, stage, force[0], force[1], k[i]))
        for j in range(4):
            z[j] += h / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])
        states[n - 1 - step] = z
    return outside
