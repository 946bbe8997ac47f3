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
    for f in range(faces.shape[0]):
        volume[f] = 0.0
        for q in range(weight.shape[0]):
            p = np.zeros(3)
            t = np.zeros((2, 3))
            for a in range(faces.shape[1]):
                for i in range(3):
                    p[i] += shape[q, a] * x[faces[f, a], i]
                    t[0, i] += derivative[q, a, 0] * x[faces[f, a], i]
                    t[1, i] += derivative[q, a, 1] * x[faces[f, a], i]
            n = np.cross(t[0], t[1])
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
    for f in prange(faces.shape[0]):
        t = np.empty((2, 3))
        full = np.zeros((n, n, 3, 3))
        for q in range(weight.shape[0]):
            t[:] = 0.0
            for a in range(n):
                for i in range(3):
                    t[0, i] += derivative[q, a, 0] * x[faces[f, a], i]
                    t[1, i] += derivative[q, a, 1] * x[faces[f, a], i]
            for a in range(n):
                w = weight[q] * shape[q, a]
                for b in range(n):
                    # d(t0 x t1)/dx_b = N_b,xi (e_j x t1) - N_b,eta (e_j x t0)
                    d0 = w * (derivative[q, b, 0] * t[1, 0] - derivative[q, b, 1] * t[0, 0])
                    d1 = w * (derivative[q, b, 0] * t[1, 1] - derivative[q, b, 1] * t[0, 1])
                    d2 = w * (derivative[q, b, 0] * t[1, 2] - derivative[q, b, 1] * t[0, 2])
                    full[a, b, 0, 1] += d2
                    full[a, b, 0, 2] -= d1
                    full[a, b, 1, 0] -= d2
                    full[a, b, 1, 2] += d0
                    full[a, b, 2, 0] += d1
                    full[a, b, 2, 1] -= d0
        pair = 0
        for a in range(n):
            for b in range(a, n):
                for i in range(3):
                    for j in range(3):
                        values[f, pair, i, j] = 0.5 * (full[a, b, i, j] + full[b, a, j, i])
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
