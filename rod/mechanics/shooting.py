"""The rod's equations integrated from the clamp to the tip, with the derivatives Newton's method needs.

All quantities here are dimensionless: lengths over l, moments over B/l, forces over B/l^2, with B a rigidity of the
rod. The state is (theta, M, x, y); behind it stand its derivatives by the three unknowns M(0), F_x, F_y:

    theta' = kappa_0 + Delta                                   x' = lambda cos theta
    M'     = lambda (n_x sin theta - n_y cos theta) + c_x cos theta + c_y sin theta
                                                               y' = lambda sin theta

with n(s) = F + q (1 - s), c = h q of a weight at the height h above the curve, and the stretch
lambda = lambda_0 + e Delta, which is 1 on an inextensible rod. Where the rod bends by dDelta it gets longer by
e dDelta, so that the moment about the neutral axis bends it, which is at the distance e from the curve:

    Delta = (M + e N - M_0 - m0)/alpha,    N = n_x cos theta + n_y sin theta

M_0 is this moment where the rod has kappa_0, zero unless it has that under its own weight (`own_weight`).

The steps of the scheme (`luther`) are chosen by the caller so that every break (d, the samples of kappa_0) lies on a
step boundary; nothing jumps inside a step. Speed may cost clarity here: numba compiles these functions
(`rod.compiled`), and in plain Python, too, numbers are taken out of arrays before they are used several times.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Mask
from rod.compiled import CompiledLater
from rod.mechanics.luther import ABSCISSAE, STAGE_ABSCISSA, STAGES, WEIGHTS

#: calls in plain Python, 50 ms each, after which these functions are compiled: one rod takes two to ten
_PLAIN_CALLS = 20


class RodArrays(NamedTuple):
    """A dimensionless rod as the integrator reads it; one row or entry per step.

    numba's cache on disk refers to this class and to `_Section` by name: renaming one makes old caches unreadable.
    """

    s: Array  #: (n + 1,) step boundaries from 0 to 1
    kappa_0: Array  #: (n, 6) at ABSCISSAE of every step
    rest_stretch: Array  #: (n, 6) lambda_0 at ABSCISSAE
    alpha: Array  #: (n,)
    m0: Array  #: (n,)
    rest_moment: Array  #: (n, 6) M_0 at ABSCISSAE
    fade: float  #: moment below which the intercepts fade to zero
    eccentricity: float
    theta0: float  #: rad, tangent angle at the clamp


class _Section(NamedTuple):
    """The rod at one cross-section, the force n that acts on it, and the couple c of its weight per length."""

    kappa_0: float
    rest_stretch: float
    alpha: float
    m0: float
    rest_moment: float
    nx: float
    ny: float
    cx: float
    cy: float


def _rate(z: Array, section: _Section, fade: float, eccentricity: float, out: Array) -> None:
    """Right-hand side for the state z[0:4] and its three derivatives z[4:16] (theta, M, x, y for each unknown)."""
    angle = float(z[0])
    m0, nx, ny = section.m0, section.nx, section.ny
    cosine, sine = math.nan, math.nan
    if math.isfinite(angle):
        cosine, sine = math.cos(angle), math.sin(angle)
    along, across = nx * cosine + ny * sine, nx * sine - ny * cosine
    moment = float(z[1]) + eccentricity * along - section.rest_moment  # what bends the rod
    slope = 1.0 / section.alpha
    size = abs(moment)
    if size < fade:  # the intercept fades to nothing with the moment
        slope = (1.0 - m0 * (math.copysign(1.0, moment) if moment != 0.0 else 0.0) / fade) / section.alpha
        m0 = m0 * size / fade
    deviation = (moment - m0) / section.alpha
    stretch, by_moment = section.rest_stretch + eccentricity * deviation, eccentricity * slope
    c, s = stretch * cosine, stretch * sine
    out[0] = section.kappa_0 + deviation
    out[1] = stretch * across + section.cx * cosine + section.cy * sine
    couple_rate = section.cy * cosine - section.cx * sine
    out[2] = c
    out[3] = s
    axial = stretch * along
    for unknown in range(3):
        j = 4 + 4 * unknown
        angle_rate = float(z[j])
        moment_rate = float(z[j + 1]) - eccentricity * across * angle_rate
        if unknown == 1:
            moment_rate += eccentricity * cosine
        elif unknown == 2:
            moment_rate += eccentricity * sine
        stretch_rate = by_moment * moment_rate
        out[j] = slope * moment_rate
        out[j + 1] = (axial + couple_rate) * angle_rate + across * stretch_rate
        out[j + 2] = cosine * stretch_rate - s * angle_rate
        out[j + 3] = sine * stretch_rate + c * angle_rate
    out[9] += s  # M' by F_x
    out[13] -= c  # M' by F_y


def _sweep(rod: RodArrays, unknowns: Array, weight: Array, states: Array, end: Array) -> None:
    """Integrate from clamp to tip: fills states (n + 1, 4) and end (16,), the last state with its derivatives.

    unknowns = (M(0), F_x, F_y); weight = (q_x, q_y, h q_x, h q_y), a dead load per length at the height h.
    """
    z = end
    z[:] = 0.0
    z[0], z[1] = rod.theta0, unknowns[0]
    fx, fy, qx, qy = float(unknowns[1]), float(unknowns[2]), float(weight[0]), float(weight[1])
    cx, cy = float(weight[2]), float(weight[3])
    z[5] = 1.0  # M(0) by itself
    k = np.empty((7, 16))
    stage = np.empty(16)
    states[0] = z[:4]
    for step in range(len(rod.alpha)):
        start, alpha, m0 = float(rod.s[step]), float(rod.alpha[step]), float(rod.m0[step])
        h = float(rod.s[step + 1]) - start
        for i in range(7):
            stage[:] = z
            for j in range(i):
                a = h * STAGES[i, j]
                if a != 0.0:
                    for n in range(16):
                        stage[n] += a * k[j, n]
            at = STAGE_ABSCISSA[i]
            beyond = 1.0 - start - h * ABSCISSAE[at]
            kappa_0, rest_stretch = float(rod.kappa_0[step, at]), float(rod.rest_stretch[step, at])
            rest_moment = float(rod.rest_moment[step, at])
            nx, ny = fx + qx * beyond, fy + qy * beyond
            section = _Section(kappa_0, rest_stretch, alpha, m0, rest_moment, nx, ny, cx, cy)
            _rate(stage, section, rod.fade, rod.eccentricity, k[i])
        for i in range(7):
            if WEIGHTS[i] != 0.0:
                weighted = h * WEIGHTS[i]
                for n in range(16):
                    z[n] += weighted * k[i, n]
        states[step + 1] = z[:4]


def _residual(end: Array, target: Array, free: Mask, r: Array, jac: Array) -> None:
    """r = (M, x, y at the tip) - target, with its matrix; a component of F that is given keeps a trivial row."""
    for row in range(3):
        if free[row]:
            r[row] = end[row + 1] - target[row]
            for column in range(3):
                jac[row, column] = end[4 + 4 * column + row + 1] if free[column] else 0.0
        else:
            r[row] = 0.0
            for column in range(3):
                jac[row, column] = 1.0 if row == column else 0.0


def _determinant(a: Array) -> float:
    return (
        a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
        - a[0, 1] * (a[1, 0] * a[2, 2] - a[1, 2] * a[2, 0])
        + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
    )


def _converge(
    rod: RodArrays, unknowns: Array, weight: Array, target: Array, free: Mask, states: Array
) -> tuple[bool, float]:
    """Newton's method for unknowns (3,) = (M(0), F_x, F_y), changed in place; fills states (n + 1, 4).

    Returns whether it converged, and the determinant of the last matrix. target (3,) = (M, x, y) at the tip; free (3,)
    says which of the unknowns are solved for (the first always is); weight (4,) as in `_sweep`.
    """
    end, r, jac, column = np.empty(16), np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    worst = math.inf
    for _ in range(16):
        _sweep(rod, unknowns, weight, states, end)
        _residual(end, target, free, r, jac)
        determinant = _determinant(jac)
        if not math.isfinite(determinant) or determinant == 0.0:
            return False, 0.0
        scale = 1.0 + abs(unknowns[0]) + abs(unknowns[1]) + abs(unknowns[2])
        # quadratic convergence: after a correction of 1e-7 the next one is of the size of rounding, unless errors grow
        # along the rod
        if worst < 1e-7 * scale and max(abs(r[0]), abs(r[1]), abs(r[2])) < 1e-10 * scale:
            return True, determinant
        worst = 0.0
        for i in range(3):
            column[:] = jac
            column[:, i] = -r
            correction = _determinant(column) / determinant
            unknowns[i] += correction
            worst = max(worst, abs(correction))
        if not math.isfinite(worst) or worst > 1e6 * scale:
            return False, 0.0
    return False, 0.0


#: `_sweep` and `_converge`, in plain Python for a few rods and compiled for many
sweep = CompiledLater(_sweep, (_rate,), _PLAIN_CALLS)
converge = CompiledLater(_converge, (_rate, _sweep, _residual, _determinant), _PLAIN_CALLS)
