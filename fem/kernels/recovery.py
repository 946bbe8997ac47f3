"""The hot loops of stress recovery, compiled by numba; axes as in `fem.kernels.element`.

``m`` is a term of a polynomial.
"""

from typing import NamedTuple

import numpy as np
from numba import njit, prange

from geometry.arrays import Array, Index

#: terms of a quadratic polynomial: 1, x, y, z, x^2, y^2, z^2, xy, yz, xz
TERMS = 10


class Patches(NamedTuple):
    """The patch of elements around every vertex v, and the frame of its polynomial."""

    begin: Index  #: (v + 1,) where the elements of each patch begin in `members`
    members: Index  #: (m,) elements
    origin: Array  #: (v, 3) mm
    scale: Array  #: (v,) mm


@njit(cache=True, inline="always")
def terms_at(x: Array, origin: Array, scale: float, p: Array) -> None:
    """The terms p (m,) at the position x (3,) from the origin (3,), in units of the scale (mm)."""
    for i in range(3):
        p[1 + i] = (x[i] - origin[i]) / scale
    p[0] = 1.0
    for i in range(3):
        p[4 + i] = p[1 + i] * p[1 + i]
    p[7], p[8], p[9] = p[1] * p[2], p[2] * p[3], p[1] * p[3]


@njit(cache=True, parallel=True)
def normal_equations(patches: Patches, positions: Array, values: Array, left: Array, right: Array) -> None:
    """Least squares of every patch, left (v, m, m) and right (v, m, c), for values (e, q, c) at positions (e, q, 3)."""
    begin, members, origin, scale = patches.begin, patches.members, patches.origin, patches.scale
    for v in prange(begin.shape[0] - 1):
        p = np.empty(TERMS)
        for k in range(begin[v], begin[v + 1]):
            e = members[k]
            for q in range(positions.shape[1]):
                terms_at(positions[e, q], origin[v], scale[v], p)
                for m in range(TERMS):
                    for n in range(TERMS):
                        left[v, m, n] += p[m] * p[n]
                    for c in range(values.shape[2]):
                        right[v, m, c] += p[m] * values[e, q, c]


@njit(cache=True, parallel=True)
def blended(
    patches: Patches, coefficients: Array, vertices: Index, shape: Array, positions: Array, values: Array
) -> None:
    """The polynomials with coefficients (v, m, c) of the four vertices (e, 4), weighed by their linear shape functions
    (q, 4), at positions (e, q, 3), into values (e, q, c)."""
    origin, scale = patches.origin, patches.scale
    for e in prange(vertices.shape[0]):
        p = np.empty(TERMS)
        for q in range(positions.shape[1]):
            for c in range(values.shape[2]):
                values[e, q, c] = 0.0
            for a in range(vertices.shape[1]):
                v = vertices[e, a]
                terms_at(positions[e, q], origin[v], scale[v], p)
                for m in range(TERMS):
                    for c in range(values.shape[2]):
                        values[e, q, c] += shape[q, a] * p[m] * coefficients[v, m, c]
