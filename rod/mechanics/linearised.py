"""The rod's equations linearised at a solution: what small changes of the curvature do to the states.

Every change has a column with the derivatives of the states, which are integrated beside them by the same scheme
(`luther`), so that they are derivatives of the computed solution, its steps included:

    dtheta' = dM/alpha + p + q M_b,   dM' = (n_x cos theta + n_y sin theta + c_y cos theta - c_x sin theta) dtheta,
    dx' = -sin theta dtheta,          dy' = cos theta dtheta

for the change p + q M_b of the curvature, with M_b the moment that bends the rod. The rod is inextensible, and its
intercepts do not fade. The solution is known, so that all states are finite.
"""

import math

import numpy as np

from geometry.arrays import Array
from rod.compiled import CompiledLater
from rod.mechanics.luther import ABSCISSAE, STAGE_ABSCISSA, STAGES, WEIGHTS
from rod.mechanics.shooting import RodArrays


def _columns(
    rod: RodArrays,
    unknowns: Array,
    weight: Array,
    constant: Array,
    by_moment: Array,
    at_clamp: Array,
    states: Array,
    columns: Array,
) -> None:
    """Fills states (n + 1, 4), and columns (n + 1, 4, 3 + m) with their derivatives by the unknowns and by m changes.

    constant (n, 6, m): p at ABSCISSAE of every step; by_moment (n, m): q; at_clamp (m,): changes of theta at the clamp.
    unknowns and weight are those of `shooting`.
    """
    fx, fy, qx, qy = float(unknowns[1]), float(unknowns[2]), float(weight[0]), float(weight[1])
    cx, cy = float(weight[2]), float(weight[3])
    count = columns.shape[2]
    z, k, stage = np.zeros(4), np.empty((7, 4)), np.empty(4)
    d, rates, at_stage = np.zeros((4, count)), np.empty((7, 4, count)), np.empty((4, count))
    z[0], z[1] = rod.theta0, unknowns[0]
    d[0, 3:] = at_clamp
    d[1, 0] = 1.0  # M(0) by itself
    states[0] = z
    columns[0] = d
    for step in range(len(rod.alpha)):
        start, alpha, m0 = float(rod.s[step]), float(rod.alpha[step]), float(rod.m0[step])
        h = float(rod.s[step + 1]) - start
        for i in range(7):
            stage[:] = z
            at_stage[:] = d
            for j in range(i):
                a = h * STAGES[i, j]
                if a != 0.0:
                    stage += a * k[j]
                    at_stage += a * rates[j]
            at = STAGE_ABSCISSA[i]
            beyond = 1.0 - start - h * ABSCISSAE[at]
            nx, ny = fx + qx * beyond, fy + qy * beyond
            cosine, sine = math.cos(stage[0]), math.sin(stage[0])
            bending = float(stage[1]) - float(rod.rest_moment[step, at])
            k[i, 0] = float(rod.kappa_0[step, at]) + (bending - m0) / alpha
            k[i, 1] = nx * sine - ny * cosine + cx * cosine + cy * sine
            k[i, 2] = cosine
            k[i, 3] = sine
            turned = nx * cosine + ny * sine + cy * cosine - cx * sine
            for c in range(count):
                angle = at_stage[0, c]
                rates[i, 0, c] = at_stage[1, c] / alpha
                rates[i, 1, c] = turned * angle
                rates[i, 2, c] = -sine * angle
                rates[i, 3, c] = cosine * angle
            for c in range(count - 3):
                rates[i, 0, 3 + c] += constant[step, at, c] + by_moment[step, c] * bending
            rates[i, 1, 1] += sine  # M' by F_x
            rates[i, 1, 2] -= cosine  # M' by F_y
        for i in range(7):
            if WEIGHTS[i] != 0.0:
                z += h * WEIGHTS[i] * k[i]
                d += h * WEIGHTS[i] * rates[i]
        states[step + 1] = z
        columns[step + 1] = d


#: `_columns`, compiled by numba from the first call on: whoever needs derivatives solves many rods
integrate = CompiledLater(_columns, (), 0)
