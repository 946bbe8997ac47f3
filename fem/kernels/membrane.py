"""The loops over the triangles of a membrane, compiled by numba.

Array axes: ``f`` triangle, ``q`` stress point, ``a``/``b`` node of the triangle, ``i``/``j`` component in space,
``v`` Voigt component in the membrane's plane at rest (11, 22, 12; strains carry the factor 2 on the last).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from geometry.arrays import Array, Index

PLANE = np.array([[0, 0], [1, 1], [0, 1]])


class MembraneArrays(NamedTuple):
    """The triangles of a membrane."""

    nodes: Index  #: (f, a)
    gradients: Array  #: (f, q, a, 2) of the shape functions in an orthonormal frame of each triangle, 1/mm
    weight: Array  #: (f, q) fractions of the membrane's volume, mm3
    law: Array  #: (f, q, v, v) elasticity in the plane, MPa


@njit(cache=True, inline="always")
def _tangents(gradients: Array, nodes: Index, x: Array, t: Array) -> None:
    """t[i, j] = d x_i / d X_j for the in-plane gradients[a, j]."""
    for i in range(3):
        for j in range(2):
            t[i, j] = 0.0
            for a in range(nodes.shape[0]):
                t[i, j] += x[nodes[a], i] * gradients[a, j]


@njit(cache=True)
def membrane_strain(membrane: MembraneArrays, x: Array, strain: Array) -> None:
    """Green-Lagrange strain (f, q, v) at positions x (n, 3), written into strain."""
    nodes, gradients = membrane.nodes, membrane.gradients
    t = np.empty((3, 2))
    for f in range(nodes.shape[0]):
        for q in range(gradients.shape[1]):
            _tangents(gradients[f, q], nodes[f], x, t)
            for v in range(3):
                k, m = PLANE[v, 0], PLANE[v, 1]
                value = t[0, k] * t[0, m] + t[1, k] * t[1, m] + t[2, k] * t[2, m]
                strain[f, q, v] = 0.5 * (value - 1.0) if v < 2 else value


@njit(cache=True)
def membrane_linearised_strain(membrane: MembraneArrays, x: Array, dx: Array, strain: Array) -> None:
    """Change of the strain (f, q, v) at x to first order in dx (n, 3), written into strain."""
    nodes, gradients = membrane.nodes, membrane.gradients
    t, d = np.empty((3, 2)), np.empty((3, 2))
    for f in range(nodes.shape[0]):
        for q in range(gradients.shape[1]):
            _tangents(gradients[f, q], nodes[f], x, t)
            _tangents(gradients[f, q], nodes[f], dx, d)
            for v in range(3):
                k, m = PLANE[v, 0], PLANE[v, 1]
                value = 0.0
                for i in range(3):
                    value += t[i, k] * d[i, m] + d[i, k] * t[i, m]
                strain[f, q, v] = 0.5 * value if v < 2 else value


@njit(cache=True)
def membrane_force(membrane: MembraneArrays, x: Array, stress: Array, force: Array) -> None:
    """Add the nodal forces of the second Piola-Kirchhoff stress (f, q, v), MPa, to force (n, 3), N."""
    nodes, gradients, weight = membrane.nodes, membrane.gradients, membrane.weight
    t = np.empty((3, 2))
    for f in range(nodes.shape[0]):
        for q in range(gradients.shape[1]):
            _tangents(gradients[f, q], nodes[f], x, t)
            s, w = stress[f, q], weight[f, q]
            for a in range(nodes.shape[1]):
                along = w * (s[0] * gradients[f, q, a, 0] + s[2] * gradients[f, q, a, 1])
                across = w * (s[2] * gradients[f, q, a, 0] + s[1] * gradients[f, q, a, 1])
                for i in range(3):
                    force[nodes[f, a], i] += t[i, 0] * along + t[i, 1] * across


@njit(cache=True)
def membrane_tangent(membrane: MembraneArrays, x: Array, stress: Array, values: Array) -> None:
    """sum_q w (B^T C B + G(S)) as blocks values (f, pair, 3, 3), pair running over a <= b.

    stress (f, q, v) is the one of the geometric term, MPa.
    """
    nodes, gradients, weight, law = membrane.nodes, membrane.gradients, membrane.weight, membrane.law
    n = nodes.shape[1]
    t = np.empty((3, 2))
    b = np.empty((3, 3 * n))
    for f in range(nodes.shape[0]):
        values[f] = 0.0
        for q in range(gradients.shape[1]):
            _tangents(gradients[f, q], nodes[f], x, t)
            g, s, w = gradients[f, q], stress[f, q], weight[f, q]
            for a in range(n):
                for i in range(3):
                    b[0, 3 * a + i] = t[i, 0] * g[a, 0]
                    b[1, 3 * a + i] = t[i, 1] * g[a, 1]
                    b[2, 3 * a + i] = t[i, 0] * g[a, 1] + t[i, 1] * g[a, 0]
            cb = np.dot(law[f, q], b)
            pair = 0
            for a in range(n):
                along = s[0] * g[a, 0] + s[2] * g[a, 1]
                across = s[2] * g[a, 0] + s[1] * g[a, 1]
                for c in range(a, n):
                    geometric = along * g[c, 0] + across * g[c, 1]
                    for i in range(3):
                        values[f, pair, i, i] += w * geometric
                        for j in range(3):
                            for v in range(3):
                                values[f, pair, i, j] += w * b[v, 3 * a + i] * cb[v, 3 * c + j]
                    pair += 1
