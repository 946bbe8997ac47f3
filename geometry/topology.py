"""Vertices, edges and faces of tetrahedra as arrays of vertex indices."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]

#: Local vertices of the four faces of a positively oriented tetrahedron, each with its normal pointing out of it.
OUTWARD = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
#: Local vertices of the six edges of a tetrahedron.
EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])


def find_rows(wanted: Array, rows: Array, count: int) -> Array:
    """Index in `rows` of each row of `wanted`, the order within a row being irrelevant; -1 where there is none.

    Both hold vertex indices below `count`, shapes (k, c) and (n, c) -> (k,).
    """
    keys, wanted_keys = row_keys(rows, count), row_keys(wanted, count)
    order = np.argsort(keys)
    at = np.searchsorted(keys, wanted_keys, sorter=order)
    at = order[np.minimum(at, len(keys) - 1)]
    found = (keys[at] == wanted_keys) & (np.asarray(wanted) >= 0).all(axis=1)
    return np.where(found, at, -1)


def row_keys(rows: Array, count: int) -> Array:
    """One whole number per row of vertex indices (k, c), the same for the same vertices in any order, (k,)."""
    if count ** rows.shape[1] >= 2**63:
        raise ValueError(f"the mesh has {count} points, more than this program can number")
    keys = np.zeros(len(rows), dtype=np.int64)
    for column in np.sort(rows, axis=1).T:
        keys = keys * count + column
    return keys


def signed_volumes(points: Array, tets: Array) -> Array:
    """Volumes of tetrahedra (m, 4), negative where they are turned inside out, (m,)."""
    a, b, c = (points[tets[:, i]] - points[tets[:, 0]] for i in (1, 2, 3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6


def normals(corners: Array) -> Array:
    """Normals of triangles (k, 3, 3), twice the area long, (k, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def open_edges(triangles: Array, count: int) -> Array:
    """Edges (k, 2) that belong to one triangle only."""
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, first, counts = np.unique(row_keys(pairs, count), return_index=True, return_counts=True)
    return pairs[first[counts == 1]]
