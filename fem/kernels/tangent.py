"""The tangent of the body, compiled by numba: most of what an iteration costs beside the factorization.

Axes and addressing as in `fem.kernels.element`. The tangent of one element is k (i, a, j, b), the last axis contiguous,
so that the inner loops run over nodes and can be vectorised by the compiler.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from fem.kernels.element import (
    FAST,
    ElementArrays,
    ReducedMatrix,
    at_nodes,
    deformation_gradient,
    gradients,
    scatter_block,
)
from geometry.arrays import Array, Index


class LawArrays(NamedTuple):
    """What the law gives the tangent."""

    stress: Array  #: (e, q, v) second Piola-Kirchhoff stress of the geometric term, MPa
    tangent: Array  #: (e, q, v, v) dS/dE, MPa; (1, q or 1, v, v) where it is the same in all elements
    lame: Array  #: (q, 2) lambda and mu, MPa, where the tangent is lambda 1 x 1 + 2 mu I everywhere; (0, 2) elsewhere


class Product(NamedTuple):
    """The tangent times an increment of the displacement, made beside the tangent."""

    du: Array  #: (n, 3) mm; (0, 3) where no product is needed
    force: Array  #: (n, 3) N, changed in place


@njit(cache=True, inline="always")
def _strain_matrix(f: Array, grad_n: Array, b: Array, row: int) -> None:
    """B (v, 3 n), components before nodes, into the rows of b from `row` on: E to first order is B du at F = f."""
    n = grad_n.shape[0]
    for a in range(n):
        g0, g1, g2 = grad_n[a, 0], grad_n[a, 1], grad_n[a, 2]
        for i in range(3):
            r = i * n + a
            b[row, r] = f[i, 0] * g0
            b[row + 1, r] = f[i, 1] * g1
            b[row + 2, r] = f[i, 2] * g2
            b[row + 3, r] = f[i, 0] * g1 + f[i, 1] * g0
            b[row + 4, r] = f[i, 1] * g2 + f[i, 2] * g1
            b[row + 5, r] = f[i, 0] * g2 + f[i, 2] * g0


@njit(cache=True, inline="always")
def _weighted_tangent_times(c: Array, w: float, b: Array, row: int, cb: Array) -> None:
    """w C B, for the six rows of b from `row` on, into those of cb; c (v, v) has zeros for many laws."""
    for v in range(6):
        cb[row + v] = 0.0
        for m in range(6):
            cvm = c[v, m] * w
            if cvm != 0.0:
                cb[row + v] += cvm * b[row + m]


@njit(cache=True, inline="always")
def _weighted_stress_times(s: Array, w: float, g: Array, row: int, sg: Array) -> None:
    """w S grad N_a, for the gradients in the three rows of g (.., a) from `row` on, into those of sg."""
    for a in range(g.shape[1]):
        g0, g1, g2 = g[row, a], g[row + 1, a], g[row + 2, a]
        sg[row, a] = w * (s[0] * g0 + s[3] * g1 + s[5] * g2)
        sg[row + 1, a] = w * (s[3] * g0 + s[1] * g1 + s[4] * g2)
        sg[row + 2, a] = w * (s[5] * g0 + s[4] * g1 + s[2] * g2)


@njit(cache=True, inline="always")
def _transposed(grad_n: Array, g: Array, row: int) -> None:
    """The gradients grad_n (a, i) into the three rows of g (.., a) from `row` on."""
    for i in range(3):
        for a in range(grad_n.shape[0]):
            g[row + i, a] = grad_n[a, i]


@njit(cache=True, inline="always")
def _mirrored(k: Array, n: int) -> None:
    """The n x n blocks of k (3 n, 3 n) below the diagonal from those above it."""
    for i in range(1, 3):
        for j in range(i):
            for a in range(n):
                for b in range(n):
                    k[i * n + a, j * n + b] = k[j * n + b, i * n + a]


@njit(cache=True)
def _element_tangent(elements: ElementArrays, law: LawArrays, e: int, u: Array, k: Array) -> None:
    """sum_q w (B^T C B + G(S)) of element e into k (3 n, 3 n), components before nodes.

    The strain matrices of all points stand below each other, so that each of the two parts is one matrix product.
    """
    nodes, inverse, reference = elements.nodes[e], elements.inverse[e], elements.reference
    weight, stress, tangent = elements.weight[e], law.stress[e], law.tangent[e if law.tangent.shape[0] > 1 else 0]
    n, points = nodes.shape[0], reference.shape[0]
    f = np.empty((3, 3))
    b = np.empty((6 * points, 3 * n))
    cb = np.empty((6 * points, 3 * n))
    g = np.empty((3 * points, n))
    sg = np.empty((3 * points, n))
    grad_n = np.empty((n, 3))
    values = np.empty((n, 3))
    at_nodes(nodes, u, values)
    for q in range(points):
        w = weight[q]
        at = inverse[q if inverse.shape[0] > 1 else 0]
        gradients(at, reference[q], grad_n)
        deformation_gradient(at, reference[q], values, f)
        _strain_matrix(f, grad_n, b, 6 * q)
        _weighted_tangent_times(tangent[q if tangent.shape[0] > 1 else 0], w, b, 6 * q, cb)
        _transposed(grad_n, g, 3 * q)
        _weighted_stress_times(stress[q], w, g, 3 * q, sg)
    np.dot(b.T, cb, k)
    geometric = np.dot(g.T, sg)
    for i in range(3):
        for a in range(n):
            for bb in range(n):
                k[i * n + a, i * n + bb] += geometric[a, bb]


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _isotropic_element_tangent(elements: ElementArrays, law: LawArrays, e: int, u: Array, k: Array) -> None:
    """The same for C = lambda 1 x 1 + 2 mu I, constant at each point.

    With h_a = F grad N_a the block of two nodes is lambda h_a h_b^T + mu h_b h_a^T + mu (grad N_a . grad N_b) F F^T.
    Blocks above the diagonal and on it are computed, the others are their mirror images.
    """
    nodes, inverse, reference = elements.nodes[e], elements.inverse[e], elements.reference
    weight, stress, lame = elements.weight[e], law.stress[e], law.lame
    n = nodes.shape[0]
    f = np.empty((3, 3))
    ff = np.empty((3, 3))
    grad_n = np.empty((n, 3))
    values = np.empty((n, 3))
    g = np.empty((3, n))
    h = np.empty((3, n))
    sg = np.empty((3, n))
    k[:] = 0.0
    at_nodes(nodes, u, values)
    for q in range(reference.shape[0]):
        w = weight[q]
        lam, mu = lame[q, 0] * w, lame[q, 1] * w
        at = inverse[q if inverse.shape[0] > 1 else 0]
        gradients(at, reference[q], grad_n)
        deformation_gradient(at, reference[q], values, f)
        _transposed(grad_n, g, 0)
        for i in range(3):
            for a in range(n):
                h[i, a] = f[i, 0] * g[0, a] + f[i, 1] * g[1, a] + f[i, 2] * g[2, a]
            for j in range(3):
                ff[i, j] = mu * (f[i, 0] * f[j, 0] + f[i, 1] * f[j, 1] + f[i, 2] * f[j, 2])
        _weighted_stress_times(stress[q], w, g, 0, sg)
        for a in range(n):
            g0, g1, g2 = g[0, a], g[1, a], g[2, a]
            h0, h1, h2 = h[0, a], h[1, a], h[2, a]
            for b in range(n):
                product = g0 * g[0, b] + g1 * g[1, b] + g2 * g[2, b]
                geometric = g0 * sg[0, b] + g1 * sg[1, b] + g2 * sg[2, b]
                k[a, b] += (lam + mu) * h0 * h[0, b] + ff[0, 0] * product + geometric
                k[n + a, n + b] += (lam + mu) * h1 * h[1, b] + ff[1, 1] * product + geometric
                k[2 * n + a, 2 * n + b] += (lam + mu) * h2 * h[2, b] + ff[2, 2] * product + geometric
                k[a, n + b] += lam * h0 * h[1, b] + mu * h1 * h[0, b] + ff[0, 1] * product
                k[a, 2 * n + b] += lam * h0 * h[2, b] + mu * h2 * h[0, b] + ff[0, 2] * product
                k[n + a, 2 * n + b] += lam * h1 * h[2, b] + mu * h2 * h[1, b] + ff[1, 2] * product
    _mirrored(k, n)


@njit(cache=True, inline="always")
def _scatter(matrix: ReducedMatrix, nodes: Index, k: Array, offset: Index, block: Array) -> None:
    """Add k (3 n, 3 n) to the reduced upper triangle; offset (pair,), block (3, 3) is work space."""
    node_dof, row_start, free, data = matrix.node_dof, matrix.row_start, matrix.free, matrix.data
    n = nodes.shape[0]
    pair = 0
    for a in range(n):
        for b in range(a, n):
            swap = nodes[b] < nodes[a]
            first, second = (b, a) if swap else (a, b)
            low, high = nodes[first], nodes[second]
            if a != b and free[low] == 3 and free[high] == 3:
                for i in range(3):
                    start = row_start[node_dof[low, 0] + i] + 3 - i + offset[pair]
                    data[start] += k[i * n + first, second]
                    data[start + 1] += k[i * n + first, n + second]
                    data[start + 2] += k[i * n + first, 2 * n + second]
            else:
                for i in range(3):
                    for j in range(3):
                        block[i, j] = k[i * n + first, j * n + second]
                scatter_block(matrix, block, low, high, offset[pair])
            pair += 1


@njit(cache=True, inline="always")
def _times(nodes: Index, k: Array, du: Array, force: Array) -> None:
    """Add k du to force (n, 3)."""
    n = nodes.shape[0]
    for a in range(n):
        for i in range(3):
            value = 0.0
            for b in range(n):
                for j in range(3):
                    value += k[i * n + a, j * n + b] * du[nodes[b], j]
            force[nodes[a], i] += value


@njit(cache=True, parallel=True)
def tangent_matrix(
    elements: ElementArrays, law: LawArrays, u: Array, offset: Index, matrix: ReducedMatrix, product: Product
) -> None:
    """Add the tangent at displacements u (n, 3) to the reduced upper triangle, and K du to the product's force.

    offset (e, pair) as `fem.equations.pattern` gives it, the pairs of nodes a <= b of an element in order.
    """
    colours, chunks, nodes = elements.colours, elements.chunks, elements.nodes
    n = nodes.shape[1]
    for c in range(colours.shape[0] - 1):
        for chunk in prange(colours[c], colours[c + 1]):
            k = np.empty((3 * n, 3 * n))
            block = np.empty((3, 3))
            for e in range(chunks[chunk], chunks[chunk + 1]):
                if law.lame.shape[0] > 0:
                    _isotropic_element_tangent(elements, law, e, u, k)
                else:
                    _element_tangent(elements, law, e, u, k)
                _scatter(matrix, nodes[e], k, offset[e], block)
                if product.du.shape[0] > 0:
                    _times(nodes[e], k, product.du, product.force)
