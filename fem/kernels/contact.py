"""The loops over pairs of a node and the triangle that it faces, compiled by numba.

A pair is a row of `corners` (k, 4): the node is number 0, the triangle 1 to 3. `sign` (k,) is what the z coordinate of
the node is multiplied by: -1 where its mirror image at z = 0 faces the triangle.
"""

import math

import numpy as np
from numba import njit

from geometry.arrays import Array, Index


@njit(cache=True, inline="always")
def _frame(corners: Index, sign: float, x: Array, first: Array, second: Array, normal: Array, reach: Array) -> float:
    """Edges, unit normal and the way from corner 1 to the node, each (3,), of one pair; returns the gap."""
    node, a, b, c = corners[0], corners[1], corners[2], corners[3]
    for i in range(3):
        first[i] = x[b, i] - x[a, i]
        second[i] = x[c, i] - x[a, i]
        reach[i] = (x[node, i] * sign if i == 2 else x[node, i]) - x[a, i]
    normal[0] = first[1] * second[2] - first[2] * second[1]
    normal[1] = first[2] * second[0] - first[0] * second[2]
    normal[2] = first[0] * second[1] - first[1] * second[0]
    size = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    for i in range(3):
        normal[i] /= size
    return reach[0] * normal[0] + reach[1] * normal[1] + reach[2] * normal[2]


@njit(cache=True, inline="always")
def _barycentric(first: Array, second: Array, reach: Array, shape: Array, slope: Array) -> None:
    """Of one pair: minus the barycentric coordinates of the foot, shape (4,), and their gradients, slope (4, 3)."""
    g11, g12, g22 = 0.0, 0.0, 0.0
    for i in range(3):
        g11 += first[i] * first[i]
        g12 += first[i] * second[i]
        g22 += second[i] * second[i]
    det = g11 * g22 - g12**2
    shape[0], shape[2], shape[3] = 1.0, 0.0, 0.0
    for i in range(3):
        slope[0, i] = 0.0
        slope[2, i] = (g22 * first[i] - g12 * second[i]) / det
        slope[3, i] = (g11 * second[i] - g12 * first[i]) / det
        slope[1, i] = -slope[2, i] - slope[3, i]
        shape[2] -= slope[2, i] * reach[i]
        shape[3] -= slope[3, i] * reach[i]
    shape[1] = -1.0 - shape[2] - shape[3]


@njit(cache=True)
def facing_gaps(corners: Index, sign: Array, x: Array, gap: Array) -> None:
    """Signed gaps (k,) at positions x (n, 3), mm, into the last argument."""
    first, second, normal, reach = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for k in range(corners.shape[0]):
        gap[k] = _frame(corners[k], sign[k], x, first, second, normal, reach)


@njit(cache=True)
def facing_motion(corners: Index, sign: Array, x: Array, dx: Array, gap: Array, change: Array) -> None:
    """Gaps (k,) at x (n, 3) and their changes (k,) with a motion dx (n, 3) to first order, into the last arguments."""
    first, second, normal, reach = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    shape, slope = np.empty(4), np.empty((4, 3))
    for k in range(corners.shape[0]):
        gap[k] = _frame(corners[k], sign[k], x, first, second, normal, reach)
        _barycentric(first, second, reach, shape, slope)
        change[k] = 0.0
        for a in range(4):
            for i in range(3):
                moved = dx[corners[k, a], i] * (sign[k] if a == 0 and i == 2 else 1.0)
                change[k] += shape[a] * normal[i] * moved


@njit(cache=True)
def facing_derivatives(
    corners: Index, sign: Array, x: Array, gap: Array, normals: Array, shape: Array, slope: Array, derivative: Array
) -> None:
    """Gap (k,), normal (k, 3), shape (k, 4), slope (k, 4, 3) and the derivative of the gap by the positions of its four
    nodes (k, 4, 3), as `fem.effects.facing_pairs.LocalPairs` has them."""
    first, second, reach = np.empty(3), np.empty(3), np.empty(3)
    for k in range(corners.shape[0]):
        gap[k] = _frame(corners[k], sign[k], x, first, second, normals[k], reach)
        _barycentric(first, second, reach, shape[k], slope[k])
        for a in range(4):
            for i in range(3):
                derivative[k, a, i] = shape[k, a] * normals[k, i]
        derivative[k, 0, 2] *= sign[k]


@njit(cache=True)
def add_forces(corners: Index, derivative: Array, force: Array, out: Array) -> None:
    """Add force (k,) times the derivative (k, 4, 3) of each gap to out (n, 3)."""
    for k in range(corners.shape[0]):
        for a in range(4):
            for i in range(3):
                out[corners[k, a], i] += force[k] * derivative[k, a, i]


@njit(cache=True)
def gap_blocks(
    corners: Index,
    sign: Array,
    local: tuple[Array, Array, Array, Array, Array],
    weights: Array,
    rows: Index,
    columns: Index,
    values: Array,
) -> None:
    """Blocks values (10 k, 3, 3) of weights[0] (k,) times dg dg plus weights[1] (k,) times d2g by node pairs.

    local: gap, normal, shape, slope and derivative, as `facing_derivatives` gives them; rows <= columns (10 k,). A node
    that faces the mirror image of its own triangle is there twice: both blocks belong on the diagonal.

    From dn = -sum_k slope_k (n . dx_k) and d2g = 2 dn . w - g |dn|^2, with w = sum_k shape_k dx_k the motion at the
    foot.
    """
    gap, normal, shape, slope, derivative = local
    block = np.empty((3, 3))
    m = 0
    for k in range(corners.shape[0]):
        n = normal[k]
        for a in range(4):
            for b in range(a, 4):
                turn = 0.0
                for i in range(3):
                    turn += slope[k, a, i] * slope[k, b, i]
                turn *= gap[k]
                for i in range(3):
                    for j in range(3):
                        across = shape[k, b] * n[i] * slope[k, a, j]
                        along = shape[k, a] * slope[k, b, i] * n[j]
                        bent = -across - along - turn * n[i] * n[j]
                        if a == 0 and i == 2:
                            bent *= sign[k]
                        if b == 0 and j == 2:
                            bent *= sign[k]
                        block[i, j] = weights[0, k] * derivative[k, a, i] * derivative[k, b, j] + weights[1, k] * bent
                first, second = corners[k, a], corners[k, b]
                rows[m], columns[m] = min(first, second), max(first, second)
                for i in range(3):
                    for j in range(3):
                        values[m, i, j] = block[j, i] if first > second else block[i, j]
                if first == second and a != b:
                    for i in range(3):
                        for j in range(3):
                            values[m, i, j] = block[i, j] + block[j, i]
                m += 1


@njit(cache=True, inline="always")
def _barrier(distance: float, width: float, continuation: float) -> tuple[float, float, float]:
    """phi(d) and its first two derivatives; see `continued_barrier`."""
    if distance >= width:
        return 0.0, 0.0, 0.0
    start = continuation * width
    inside = max(distance, start)
    r = (inside / width) ** 2
    log = -math.log(r)
    slope_r = -2 * (1 - r) * log - (1 - r) ** 2 / r
    curvature_r = 2 * log + 4 * (1 - r) / r + (1 - r) ** 2 / r**2
    r1, r2 = 2 * inside / width**2, 2 / width**2
    value = width * (1 - r) ** 2 * log
    slope = width * slope_r * r1
    curvature = width * (curvature_r * r1**2 + slope_r * r2)
    below = min(distance - start, 0.0)
    return value + slope * below + 0.5 * curvature * below**2, slope + curvature * below, curvature


@njit(cache=True)
def continued_barriers(distance: Array, width: Array, continuation: float, out: Array) -> None:
    """phi(d) = w (1 - r)^2 (-ln r), r = (d / w)^2, with first and second derivative, into out (3, k).

    0 beyond the width w, quadratic below `continuation` times w; d (k,) and w (k,) in mm.
    """
    for k in range(distance.shape[0]):
        out[0, k], out[1, k], out[2, k] = _barrier(distance[k], width[k], continuation)


@njit(cache=True)
def gaps_at_pressures(
    gap: Array, pressure: Array, width: Array, overlap: float, continuation: float, compliance: float, most: int
) -> None:
    """Solve e - gap = c (p(e) - pressure) for e (k,), which replaces `gap`, in at most so many iterations.

    p(e) is minus the slope of the barrier whose `width` (k,) lies behind the wall by the part `overlap`; c is its
    compliance where it is quadratic times `compliance`.
    """
    for k in range(gap.shape[0]):
        dhat = width[k] * (1.0 - overlap)
        now = -width[k]
        _, _, stiffest = _barrier(now + overlap * width[k], width[k], continuation)
        c = compliance / stiffest
        if gap[k] - c * pressure[k] >= dhat:  # the solution where the barrier does not press
            gap[k] -= c * pressure[k]
            continue
        for _ in range(most):  # monotone from the quadratic part, because p is convex
            _, slope, curvature = _barrier(now + overlap * width[k], width[k], continuation)
            change = (now - gap[k] + c * (slope + pressure[k])) / (1.0 + c * curvature)
            now = now - change
            if abs(change) < 1e-9 * dhat:
                break
        gap[k] = now
