"""Vertices, edges and faces of tetrahedra as arrays of vertex indices."""

import numpy as np

from geometry.arrays import Array, Index, Mask
from geometry.errors import MeshError

#: Local vertices of the four faces of a positively oriented tetrahedron, each with its normal pointing out of it.
OUTWARD: Index = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
#: Local vertices of the six edges of a tetrahedron.
EDGES: Index = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
#: part of the size of a triangle, and of an edge, by which they may miss each other and still cross: on the plane of
#: symmetry of half a body they meet edge to edge
ON_EDGE = 1e-9


def find_rows(queries: Index, rows: Index, count: int) -> Index:
    """Index in `rows` of each row of `queries`, the order within a row being irrelevant; -1 where there is none.

    Both hold vertex indices below `count`; shapes (k, c) and (n, c) -> (k,). Rows of `queries` with a negative index
    match none.
    """
    keys, query_keys = row_keys(rows, count), row_keys(queries, count)
    order = np.argsort(keys)
    candidate = np.searchsorted(keys, query_keys, sorter=order)
    candidate = order[np.minimum(candidate, len(keys) - 1)]
    matches = (keys[candidate] == query_keys) & (np.asarray(queries) >= 0).all(axis=1)
    return np.where(matches, candidate, -1)


def row_keys(rows: Index, count: int) -> Index:
    """One integer per row of vertex indices (k, c) below `count`, independent of their order in the row, (k,).

    Raises `MeshError` when the integers would not fit into 64 bits.
    """
    if count ** rows.shape[1] >= 2**63:
        raise MeshError(f"the mesh has {count} points, more than this program can number; save it with fewer")
    keys = np.zeros(len(rows), dtype=np.int64)
    for column in np.sort(rows, axis=1).T:
        keys = keys * count + column
    return keys


def signed_volumes(points: Array, tets: Index) -> Array:
    """Volumes of tetrahedra (m, 4) on points (n, 3), negative for inverted ones, (m,)."""
    a, b, c = (points[tets[:, i]] - points[tets[:, 0]] for i in (1, 2, 3))
    return np.einsum("ij,ij->i", a, cross(b, c)) / 6


def normals(corners: Array) -> Array:
    """Normals (k, 3) of triangles with the corners (k, 3, 3); their length is twice the area."""
    return cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def triangle_edges(triangles: Index) -> Index:
    """The three directed edges of each triangle (k, 3), triangle after triangle, (3 k, 2)."""
    return triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)


def parts_of_graph(count: int, pairs: Index) -> Index:
    """The number of the part to which each of `count` nodes belongs, (count,); pairs (m, 2) are connected.

    Parts are numbered in the order of their first nodes.
    """
    import scipy.sparse.csgraph  # its import takes longer than most of what needs no parts

    graph = scipy.sparse.coo_array((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, number = scipy.sparse.csgraph.connected_components(graph, directed=False)
    return np.asarray(number, dtype=np.int64)


def open_edges(triangles: Index, count: int) -> Index:
    """Edges (e, 2) that belong to only one of the triangles (k, 3) on `count` points."""
    pairs = triangle_edges(triangles)
    _, first, counts = np.unique(row_keys(pairs, count), return_index=True, return_counts=True)
    return pairs[first[counts == 1]]


def cross(a: Array, b: Array) -> Array:
    """Cross products of vectors (..., 3) with others of the same shape or one alone (3,).

    The numbers are those of `numpy.cross`, which takes three to five times as long for a hundred vectors or fewer.
    """
    a1, a2, a3 = a[..., 0], a[..., 1], a[..., 2]
    b1, b2, b3 = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty(a.shape)
    product[..., 0] = a2 * b3 - a3 * b2
    product[..., 1] = a3 * b1 - a1 * b3
    product[..., 2] = a1 * b2 - a2 * b1
    return product


def passes_through(edges: Array, triangles: Array) -> Mask:
    """Whether the edges (m, 2, 3) end on different sides of the triangles (m, 3, 3) and pass them inside, (m,)."""
    return np.isfinite(crossings(edges, triangles))


def crossings(edges: Array, triangles: Array) -> Array:
    """The part of each edge (m, 2, 3) at which it passes a triangle (m, 3, 3); infinite where it does not, (m,).

    Source: T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graph. Tools 2 (1997).
    """
    way, first, second = (pair[:, 1] - pair[:, 0] for pair in (edges, triangles[:, :2], triangles[:, ::2]))
    start = edges[:, 0] - triangles[:, 0]
    across, around = cross(way, second), cross(start, first)
    volume = np.einsum("mi,mi->m", first, across)
    with np.errstate(divide="ignore", invalid="ignore"):  # an edge along the plane of the triangle
        a, b, part = (
            np.einsum("mi,mi->m", u, v) / volume for u, v in ((start, across), (way, around), (second, around))
        )
        low, high = -ON_EDGE, 1.0 + ON_EDGE
        met = (a >= low) & (b >= low) & (a + b <= high) & (part >= low) & (part <= high)
        return np.where(met, part, np.inf)
