"""Checks that a mesh is one body with a closed surface, and that its elements do not overlap."""

import numpy as np

from geometry.arrays import Index
from geometry.errors import MeshError, position_text
from geometry.mesh import Mesh
from geometry.topology import OUTWARD, parts_of_graph, row_keys, triangle_edges


def check_manifold(mesh: Mesh) -> None:
    """Raise `MeshError` unless the mesh is connected and each edge of its surface belongs to two boundary triangles."""
    pairs = triangle_edges(mesh.boundary)
    _, first, counts = np.unique(row_keys(pairs, len(mesh.points)), return_index=True, return_counts=True)
    if (counts != 2).any():
        where = _position(mesh, pairs[first[counts != 2][0]])
        edge = f"an edge near {where} belongs to {counts[counts != 2][0]} boundary triangles"
        raise MeshError(f"the surface is not manifold: {edge}; join or part what touches along a line")
    components = count_components(mesh)
    if components > 1:
        raise MeshError(f"the mesh holds {components} solids that share no vertex; unite them to one")


def check_untangled(mesh: Mesh) -> None:
    """Raise `MeshError` where two tetrahedra lie on the same side of the face that they share.

    One of them is turned inside out then, whatever the order of its vertices in the file. Without such a pair the
    outward faces inside the body cancel, so that the volumes of the tetrahedra add up to that inside the boundary; with
    one they add up to more.
    """
    triangles = mesh.tets[:, OUTWARD].reshape(-1, 3)
    order = np.argsort(row_keys(triangles, len(mesh.points)), kind="stable")
    keys = row_keys(triangles, len(mesh.points))[order]
    shared = np.flatnonzero(keys[1:] == keys[:-1])
    first, second = triangles[order[shared]], triangles[order[shared + 1]]
    # a rotation of the three vertices keeps the normal: two of them suffice to tell whether it is reversed
    at = (second == first[:, :1]).argmax(axis=1)
    same_side = second[np.arange(len(second)), (at + 1) % 3] == first[:, 1]
    if not same_side.any():
        return
    overlapping = first[same_side]
    at = f"at {len(overlapping)} of their faces, such as near {_position(mesh, overlapping[0])}"
    raise MeshError(f"the elements of the mesh are tangled: {at}, both neighbours lie on the same side; mesh it again")


def count_components(mesh: Mesh) -> int:
    """Number of connected components: sets of tetrahedra that share no vertex with the others."""
    return int(parts_of_graph(len(mesh.points), mesh.edges).max()) + 1


def _position(mesh: Mesh, triangle: Index) -> str:
    return position_text(mesh.points[triangle].mean(axis=0))
