"""The loops over faces under pressure, compiled by numba; tested against scikit-fem forms.

Array axes: ``f`` face, ``q`` quadrature point, ``a``/``b`` node of the face, ``i``/``j`` component.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from geometry.arrays import Array, Index


class FaceArrays(NamedTuple):
    """Triangles of a surface and their quadrature rule."""

    nodes: Index  #: (f, a)
    shape: Array  #: (q, a) shape functions at the quadrature points
    derivative: Array  #: (q, a, 2) their reference derivatives
    weight: Array  #: (q,)


@njit(cache=True)
def surface_pressure(surface: FaceArrays, x: Array, force: Array, volume: Array) -> None:
    """Area-weighted normals at positions x (n, 3), mm: force_a = int N_a (x_,xi x x_,eta) added to force (n, 3), mm2,
    and per face int x . (x_,xi x x_,eta) / 3 into volume (f,), mm3."""
    faces, shape, derivative, weight = surface.nodes, surface.shape, surface.derivative, surface.weight
    p, n = np.empty(3), np.empty(3)
    t = np.empty((2, 3))
    for f in range(faces.shape[0]):
        volume[f] = 0.0
        for q in range(weight.shape[0]):
            p[:] = 0.0
            t[:] = 0.0
            for a in range(faces.shape[1]):
                for i in range(3):
                    p[i] += shape[q, a] * x[faces[f, a], i]
                    t[0, i] += derivative[q, a, 0] * x[faces[f, a], i]
                    t[1, i] += derivative[q, a, 1] * x[faces[f, a], i]
            n[0] = t[0, 1] * t[1, 2] - t[0, 2] * t[1, 1]
            n[1] = t[0, 2] * t[1, 0] - t[0, 0] * t[1, 2]
            n[2] = t[0, 0] * t[1, 1] - t[0, 1] * t[1, 0]
            volume[f] += weight[q] * (p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / 3.0
            for a in range(faces.shape[1]):
                for i in range(3):
                    force[faces[f, a], i] += weight[q] * shape[q, a] * n[i]


@njit(cache=True, parallel=True)
def surface_pressure_tangent(surface: FaceArrays, x: Array, values: Array) -> None:
    """Symmetric part of d force / d x as blocks values (f, pair, 3, 3), pair running over a <= b.

    The antisymmetric part is an integral over the rim of the surface; it vanishes where the surface is closed or its
    rim stays in a symmetry plane, which is where pressure has a potential at all.
    """
    faces, shape, derivative, weight = surface.nodes, surface.shape, surface.derivative, surface.weight
    n = faces.shape[1]
    # d force_a / d x_b is the cross product with v_ab = sum_c m_abc x_c, m_abc the same for all faces; its symmetric
    # part is that with (v_ab - v_ba) / 2
    m = np.zeros((n, n, n))
    for q in range(weight.shape[0]):
        for a in range(n):
            for b in range(n):
                for c in range(n):
                    jacobian = derivative[q, b, 0] * derivative[q, c, 1] - derivative[q, b, 1] * derivative[q, c, 0]
                    m[a, b, c] += weight[q] * shape[q, a] * jacobian
    for f in prange(faces.shape[0]):
        pair = 0
        for a in range(n):
            for b in range(a, n):
                v0, v1, v2 = 0.0, 0.0, 0.0
                for c in range(n):
                    half = 0.5 * (m[a, b, c] - m[b, a, c])
                    v0 += half * x[faces[f, c], 0]
                    v1 += half * x[faces[f, c], 1]
                    v2 += half * x[faces[f, c], 2]
                for i in range(3):
                    values[f, pair, i, i] = 0.0
                values[f, pair, 0, 1] = v2
                values[f, pair, 1, 0] = -v2
                values[f, pair, 0, 2] = -v1
                values[f, pair, 2, 0] = v1
                values[f, pair, 1, 2] = v0
                values[f, pair, 2, 1] = -v0
                pair += 1


@njit(cache=True)
def axial_flux(surface: FaceArrays, x: Array, gradient: Array, flux: Array) -> None:
    """Flux of the field z e_z through the surface at positions x (n, 3), mm: per face int z n_z into flux (f,), mm3,
    and its derivative by the positions added to gradient (n, 3), mm2; n = x_,xi x x_,eta.

    The field has no flux through planes that contain the z axis direction, nor through z = 0, so that these need not be
    part of the surface: the flux through walls between such planes is the volume between them.
    """
    faces, shape, derivative, weight = surface.nodes, surface.shape, surface.derivative, surface.weight
    for f in range(faces.shape[0]):
        flux[f] = 0.0
        for q in range(weight.shape[0]):
            z = 0.0
            t = np.zeros((2, 2))
            for a in range(faces.shape[1]):
                z += shape[q, a] * x[faces[f, a], 2]
                for i in range(2):
                    t[0, i] += derivative[q, a, 0] * x[faces[f, a], i]
                    t[1, i] += derivative[q, a, 1] * x[faces[f, a], i]
            normal = t[0, 0] * t[1, 1] - t[0, 1] * t[1, 0]
            flux[f] += weight[q] * z * normal
            for a in range(faces.shape[1]):
                node, w = faces[f, a], weight[q] * z
                gradient[node, 0] += w * (derivative[q, a, 0] * t[1, 1] - derivative[q, a, 1] * t[0, 1])
                gradient[node, 1] += w * (derivative[q, a, 1] * t[0, 0] - derivative[q, a, 0] * t[1, 0])
                gradient[node, 2] += weight[q] * shape[q, a] * normal


@njit(cache=True)
def axial_flux_tangent(surface: FaceArrays, x: Array, values: Array) -> None:
    """Second derivative of the flux of z e_z as blocks values (f, pair, 3, 3), pair running over a <= b."""
    faces, shape, derivative, weight = surface.nodes, surface.shape, surface.derivative, surface.weight
    n = faces.shape[1]
    slope = np.empty((n, 2))  # derivative of n_z by x and y of a node
    for f in range(faces.shape[0]):
        values[f] = 0.0
        for q in range(weight.shape[0]):
            z = 0.0
            t = np.zeros((2, 2))
            for a in range(n):
                z += shape[q, a] * x[faces[f, a], 2]
                for i in range(2):
                    t[0, i] += derivative[q, a, 0] * x[faces[f, a], i]
                    t[1, i] += derivative[q, a, 1] * x[faces[f, a], i]
            for a in range(n):
                slope[a, 0] = weight[q] * (derivative[q, a, 0] * t[1, 1] - derivative[q, a, 1] * t[0, 1])
                slope[a, 1] = weight[q] * (derivative[q, a, 1] * t[0, 0] - derivative[q, a, 0] * t[1, 0])
            pair = 0
            for a in range(n):
                for b in range(a, n):
                    twist = derivative[q, a, 0] * derivative[q, b, 1] - derivative[q, a, 1] * derivative[q, b, 0]
                    values[f, pair, 0, 1] += weight[q] * z * twist
                    values[f, pair, 1, 0] -= weight[q] * z * twist
                    for i in range(2):
                        values[f, pair, i, 2] += slope[a, i] * shape[q, b]
                        values[f, pair, 2, i] += shape[q, a] * slope[b, i]
                    pair += 1
