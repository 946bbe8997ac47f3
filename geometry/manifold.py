"""Checks that a mesh is one body with a closed surface."""

import numpy as np

from geometry.mesh import Mesh, MeshError
from geometry.topology import row_keys, triangle_edges


def check_manifold(mesh: Mesh) -> None:
    """Raise `MeshError` unless the mesh is connected and each edge of its surface belongs to two boundary triangles."""
    pairs = triangle_edges(mesh.boundary)
    _, first, counts = np.unique(row_keys(pairs, len(mesh.points)), return_index=True, return_counts=True)
    if (counts != 2).any():
        x, y, z = mesh.points[pairs[first[counts != 2][0]]].mean(axis=0)
        raise MeshError(
            f"the surface of the body is not manifold: an edge near ({x:.3g}, {y:.3g}, {z:.3g}) mm belongs to "
            f"{counts[counts != 2][0]} boundary triangles; parts that touch along a line must be joined or parted"
        )
    components = count_components(mesh)
    if components > 1:
        raise MeshError(f"the mesh holds {components} solids that share no vertex; unite them to one")


def count_components(mesh: Mesh) -> int:
    """Number of connected components: sets of tetrahedra that share no vertex with the others."""
    a, b = mesh.edges.T
    lowest = np.arange(len(mesh.points))  # smallest vertex known to be in the same component
    while True:
        before = lowest.copy()
        np.minimum.at(lowest, a, before[b])
        np.minimum.at(lowest, b, before[a])
        lowest = lowest[lowest]  # the vertex it points to may point to a smaller one
        if np.array_equal(lowest, before):
            return len(np.unique(lowest))
