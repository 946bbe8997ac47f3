"""Whether a mesh is one body with a proper surface."""

import numpy as np

from geometry.mesh import Mesh, MeshError
from geometry.topology import row_keys


def check_manifold(mesh: Mesh) -> None:
    """Raise `MeshError` unless the mesh is one piece and each edge of its surface belongs to two boundary triangles."""
    pairs = mesh.boundary[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, first, counts = np.unique(row_keys(pairs, len(mesh.points)), return_index=True, return_counts=True)
    if (counts != 2).any():
        x, y, z = mesh.points[pairs[first[counts != 2][0]]].mean(axis=0)
        raise MeshError(
            f"the surface of the body is not manifold: an edge near ({x:.3g}, {y:.3g}, {z:.3g}) mm belongs to "
            f"{counts[counts != 2][0]} boundary triangles; parts that touch along a line must be joined or parted"
        )
    pieces = count_pieces(mesh)
    if pieces > 1:
        raise MeshError(f"the mesh holds {pieces} solids that share no vertex; unite them to one")


def count_pieces(mesh: Mesh) -> int:
    """Number of pieces that are not connected by a common vertex."""
    a, b = mesh.edges.T
    lowest = np.arange(len(mesh.points))  # smallest vertex known to be in the same piece
    while True:
        before = lowest.copy()
        np.minimum.at(lowest, a, before[b])
        np.minimum.at(lowest, b, before[a])
        lowest = lowest[lowest]  # the vertex it points to may know of a smaller one
        if np.array_equal(lowest, before):
            return len(np.unique(lowest))
