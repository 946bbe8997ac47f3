"""The tangent of the body, compiled by numba: most of what an iteration costs beside the factorization.

Axes and addressing as in `fem.kernels.element`. Elements are taken `LANES` at a time and ``lane`` is the number within
such a group: it is the last axis of all work space, so that the innermost loops run over elements and the compiler
turns them into vector instructions, whatever the law and the number of nodes. (It does so only where the number of
elements in a group, here `lanes`, is not a constant of the compilation.)

At each stress point the material tangent and the stress make one tensor A of the reference configuration,

    A_iKjL = F_iM C_MKNL F_jN + S_KL delta_ij,    k_ab,ij = sum w grad N_a,K A_iKjL grad N_b,L,

the tangent of the first Piola-Kirchhoff stress by the displacement gradient. Only node pairs a <= b are computed.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from fem.kernels.element import FAST, VOIGT, ElementArrays, ReducedMatrix
from geometry.arrays import Array, Index

#: elements in a group: one vector register of eight doubles, or two of four
LANES = 8
#: largest number of nodes of an element, and of its node pairs a <= b
NODES, PAIRS = 10, 55
#: (3, 3) Voigt component of each pair of axes
COMPONENT = np.zeros((3, 3), dtype=np.int64)
COMPONENT[VOIGT[:, 0], VOIGT[:, 1]] = COMPONENT[VOIGT[:, 1], VOIGT[:, 0]] = np.arange(6)


class LawArrays(NamedTuple):
    """What the law gives the tangent."""

    stress: Array  #: (e, q, v) second Piola-Kirchhoff stress of the geometric term, MPa
    tangent: Array  #: (e, q, v, v) dS/dE, MPa; (1, q or 1, v, v) where it is the same in all elements


class Product(NamedTuple):
    """The tangent times an increment of the displacement, made beside the tangent."""

    du: Array  #: (n, 3) mm; (0, 3) where no product is needed
    force: Array  #: (n, 3) N, changed in place


@njit(cache=True, inline="always")
def _gather(nodes: Index, u: Array, begin: int, lanes: int, values: Array) -> None:
    """Displacements values (3 a + i, lane) of the nodes of the elements from `begin` on."""
    for lane in range(lanes):
        for a in range(nodes.shape[1]):
            for i in range(3):
                values[3 * a + i, lane] = u[nodes[begin + lane, a], i]


@njit(cache=True, inline="always")
def _deformation(reference: Array, values: Array, inverse: Array, lanes: int, along: Array, f: Array) -> None:
    """F (3 i + j, lane) from displacements values (3 a + i, lane) and the inverse Jacobian (3 k + j, lane)."""
    along[:] = 0.0
    for a in range(reference.shape[0]):
        r0, r1, r2 = reference[a, 0], reference[a, 1], reference[a, 2]
        for lane in range(lanes):
            for i in range(3):
                value = values[3 * a + i, lane]
                along[3 * i, lane] += value * r0
                along[3 * i + 1, lane] += value * r1
                along[3 * i + 2, lane] += value * r2
    for i in range(3):
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            for lane in range(lanes):
                f[3 * i + j, lane] = (
                    unit
                    + along[3 * i, lane] * inverse[j, lane]
                    + along[3 * i + 1, lane] * inverse[3 + j, lane]
                    + along[3 * i + 2, lane] * inverse[6 + j, lane]
                )


@njit(cache=True, inline="always")
def _tensor(c: Array, s: Array, f: Array, lanes: int, A: Array) -> None:
    """A (3 j + L, 3 i + K, lane) from the weighted material tangent c (6 v + m, lane) and stress s (v, lane)."""
    for j in range(3):
        for L in range(3):
            n0, n1, n2 = COMPONENT[0, L], COMPONENT[1, L], COMPONENT[2, L]
            for lane in range(lanes):
                f0, f1, f2 = f[3 * j, lane], f[3 * j + 1, lane], f[3 * j + 2, lane]
                x0 = c[n0, lane] * f0 + c[n1, lane] * f1 + c[n2, lane] * f2
                x1 = c[6 + n0, lane] * f0 + c[6 + n1, lane] * f1 + c[6 + n2, lane] * f2
                x2 = c[12 + n0, lane] * f0 + c[12 + n1, lane] * f1 + c[12 + n2, lane] * f2
                x3 = c[18 + n0, lane] * f0 + c[18 + n1, lane] * f1 + c[18 + n2, lane] * f2
                x4 = c[24 + n0, lane] * f0 + c[24 + n1, lane] * f1 + c[24 + n2, lane] * f2
                x5 = c[30 + n0, lane] * f0 + c[30 + n1, lane] * f1 + c[30 + n2, lane] * f2
                for i in range(3):
                    g0, g1, g2 = f[3 * i, lane], f[3 * i + 1, lane], f[3 * i + 2, lane]
                    A[3 * j + L, 3 * i, lane] = g0 * x0 + g1 * x3 + g2 * x5
                    A[3 * j + L, 3 * i + 1, lane] = g0 * x3 + g1 * x1 + g2 * x4
                    A[3 * j + L, 3 * i + 2, lane] = g0 * x5 + g1 * x4 + g2 * x2
            for lane in range(lanes):
                A[3 * j + L, 3 * j, lane] += s[n0, lane]
                A[3 * j + L, 3 * j + 1, lane] += s[n1, lane]
                A[3 * j + L, 3 * j + 2, lane] += s[n2, lane]


@njit(cache=True, inline="always")
def _add_pairs(reference: Array, inverse: Array, A: Array, lanes: int, g: Array, t: Array, k: Array) -> None:
    """Add the contribution of a stress point to k (pair, 3 i + j, lane).

    Work space: g (3 a + K, lane) for the gradients of the shape functions, t (9 j + 3 i + K, lane) for A grad N_b.
    """
    n = reference.shape[0]
    for b in range(n):
        r0, r1, r2 = reference[b, 0], reference[b, 1], reference[b, 2]
        for lane in range(lanes):
            for K in range(3):
                g[3 * b + K, lane] = r0 * inverse[K, lane] + r1 * inverse[3 + K, lane] + r2 * inverse[6 + K, lane]
        for j in range(3):
            for lane in range(lanes):
                g0, g1, g2 = g[3 * b, lane], g[3 * b + 1, lane], g[3 * b + 2, lane]
                for m in range(9):
                    t[9 * j + m, lane] = (
                        A[3 * j, m, lane] * g0 + A[3 * j + 1, m, lane] * g1 + A[3 * j + 2, m, lane] * g2
                    )
        for a in range(b + 1):
            pair = a * n - a * (a + 1) // 2 + b
            for lane in range(lanes):
                g0, g1, g2 = g[3 * a, lane], g[3 * a + 1, lane], g[3 * a + 2, lane]
                for i in range(3):
                    for j in range(3):
                        k[pair, 3 * i + j, lane] += (
                            g0 * t[9 * j + 3 * i, lane]
                            + g1 * t[9 * j + 3 * i + 1, lane]
                            + g2 * t[9 * j + 3 * i + 2, lane]
                        )


@njit(cache=True, inline="always")
def _scatter(matrix: ReducedMatrix, nodes: Index, starts: Index, k: Array, begin: int, lanes: int) -> None:
    """Add the pairs k (pair, 3 i + j, lane) of the elements from `begin` on to the reduced upper triangle.

    starts (e, pair, i): where the columns of the pair begin in row i, -1 where that row is prescribed.
    """
    node_dof, row_start, free, data = matrix.node_dof, matrix.row_start, matrix.free, matrix.data
    pair = 0
    for a in range(nodes.shape[1]):
        for b in range(a, nodes.shape[1]):
            for lane in range(lanes):
                first, second = nodes[begin + lane, a], nodes[begin + lane, b]
                if a == b:
                    for i in range(3):
                        row = node_dof[first, i]
                        if row >= 0:
                            for j in range(i, 3):
                                column = node_dof[first, j]
                                if column >= 0:
                                    data[row_start[row] + column - row] += k[pair, 3 * i + j, lane]
                    continue
                swap = second < first
                columns = first if swap else second
                along, across = (1, 3) if swap else (3, 1)
                for i in range(3):
                    start = starts[begin + lane, pair, i]
                    if start >= 0:
                        if free[columns] == 3:
                            data[start] += k[pair, i * along, lane]
                            data[start + 1] += k[pair, i * along + across, lane]
                            data[start + 2] += k[pair, i * along + 2 * across, lane]
                        else:
                            for j in range(3):
                                if node_dof[columns, j] >= 0:
                                    data[start] += k[pair, i * along + j * across, lane]
                                    start += 1
            pair += 1


@njit(cache=True, inline="always")
def _times(nodes: Index, k: Array, lane: int, du: Array, force: Array) -> None:
    """Add the element's tangent times du to force (n, 3)."""
    pair = 0
    for a in range(nodes.shape[0]):
        for b in range(a, nodes.shape[0]):
            for i in range(3):
                for j in range(3):
                    force[nodes[a], i] += k[pair, 3 * i + j, lane] * du[nodes[b], j]
                    if a != b:
                        force[nodes[b], j] += k[pair, 3 * i + j, lane] * du[nodes[a], i]
            pair += 1


@njit(cache=True, parallel=True, error_model="numpy", fastmath=FAST)
def tangent_matrix(
    elements: ElementArrays, law: LawArrays, u: Array, starts: Index, matrix: ReducedMatrix, product: Product
) -> None:
    """Add the tangent at displacements u (n, 3) to the reduced upper triangle, and K du to the product's force.

    starts (e, pair, 3) as `fem.equations.pattern` gives them, the pairs of nodes a <= b of an element in order.
    """
    colours, chunks, nodes = elements.colours, elements.chunks, elements.nodes
    reference, weight, stress, tangent = elements.reference, elements.weight, law.stress, law.tangent
    points = reference.shape[0]
    for colour in range(colours.shape[0] - 1):
        for chunk in prange(colours[colour], colours[colour + 1]):
            values = np.empty((3 * NODES, LANES))
            inverse = np.empty((9, LANES))
            along = np.empty((9, LANES))
            f = np.empty((9, LANES))
            c = np.empty((36, LANES))
            s = np.empty((6, LANES))
            A = np.empty((9, 9, LANES))
            g = np.empty((3 * NODES, LANES))
            t = np.empty((27, LANES))
            k = np.empty((PAIRS, 9, LANES))
            end = chunks[chunk + 1]
            for begin in range(chunks[chunk], end, LANES):
                lanes = min(LANES, end - begin)
                k[:] = 0.0
                _gather(nodes, u, begin, lanes, values)
                for q in range(points):
                    for lane in range(lanes):
                        e = begin + lane
                        w = weight[e, q]
                        at = elements.inverse[e, q if elements.inverse.shape[1] > 1 else 0]
                        law_at = tangent[e if tangent.shape[0] > 1 else 0, q if tangent.shape[1] > 1 else 0]
                        for i in range(3):
                            for j in range(3):
                                inverse[3 * i + j, lane] = at[i, j]
                        for v in range(6):
                            s[v, lane] = w * stress[e, q, v]
                            for m in range(6):
                                c[6 * v + m, lane] = w * law_at[v, m]
                    _deformation(reference[q], values, inverse, lanes, along, f)
                    _tensor(c, s, f, lanes, A)
                    _add_pairs(reference[q], inverse, A, lanes, g, t, k)
                _scatter(matrix, nodes, starts, k, begin, lanes)
                if product.du.shape[0] > 0:
                    for lane in range(lanes):
                        _times(nodes[begin + lane], k, lane, product.du, product.force)
