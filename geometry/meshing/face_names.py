"""Names for the boundary triangles of a body, exactly one for each."""

from collections.abc import Mapping

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import NO_CURVED_EDGES, CurvedEdges
from geometry.mesh import Mesh
from geometry.topology import find_rows


def name_faces(
    points: Array,
    tets: Index,
    walls: Mapping[str, Index],
    planes: Mapping[str, tuple[int, float]],
    curved: CurvedEdges = NO_CURVED_EDGES,
) -> Mesh:
    """The mesh whose boundary triangles are named by the air they touch, else by the plane they lie in, else `outer`.

    points (n, 3), mm; tets (m, 4); walls: name of the air -> (k, 3) triangles, interior ones are ignored; planes:
    name -> (axis, position in mm). A name without triangles is left out.
    """
    boundary = Mesh(points, tets, {}).boundary
    free = np.ones(len(boundary), dtype=bool)
    tolerance = 1e-9 * np.ptp(points, axis=0).max()
    air: dict[str, Index] = {}
    for name, triangles in walls.items():
        rows = find_rows(triangles, boundary, len(points))
        rows = rows[rows >= 0]
        air[name] = boundary[rows]
        free[rows] = False
    flat: dict[str, Index] = {}
    for name, (axis, position) in planes.items():
        on_plane = (np.abs(points[boundary][:, :, axis] - position) < tolerance).all(axis=1) & free
        flat[name] = boundary[on_plane]
        free &= ~on_plane
    faces = flat | air | {"outer": boundary[free]}
    return Mesh(points, tets, {name: triangles for name, triangles in faces.items() if len(triangles)}, curved)
