"""The faces of a CAD body as triangles: its chambers and its gaps.

In a session of `geometry.meshing.solid`, which is of no use for a mesh afterwards.
"""

from collections.abc import Collection, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError
from geometry.files.cad.solids import bounds
from geometry.files.chambers import Range, chambers_of, has_gaps
from geometry.files.shells import enclosed
from geometry.meshing.shapes import Face, Volume
from geometry.meshing.solid import told

#: length of the body over that of the largest edges of the triangles
BODY_OVER_EDGES = 10
#: triangles around a full circle
AROUND = 16
#: largest difference between the volume within the triangles and that of the cavity, over the latter
INACCURATE = 0.1
#: Gmsh's type of triangles with three nodes
TRIANGLE = 2


def chambers(gmsh: Any, air: Mapping[Volume, str], length: float) -> dict[str, tuple[Range, ...]]:
    """Smallest and largest x (mm) of each chamber, by the name of the cavity; length: of the body, mm.

    A cavity is one chamber if Gmsh cannot divide its faces, or not into triangles around its volume.
    """
    of_cavity = dict[str, tuple[Range, ...]]()
    for volume, name in air.items():
        low, high = bounds(gmsh, [volume])
        of_cavity[name] = ((low[0], high[0]),)
        with suppress(MeshError):
            faces = gmsh.model.getBoundary([volume], combined=False, oriented=False)
            points, walls = triangles_of(gmsh, [volume], faces, length / BODY_OVER_EDGES)
            exact = float(gmsh.model.occ.getMass(*volume))
            if abs(enclosed(points, walls) - exact) <= INACCURATE * exact:
                of_cavity[name] = chambers_of(points, walls)
    return of_cavity


def gaps(gmsh: Any, volumes: Collection[Volume], length: float) -> bool:
    """Whether a body of solids and air has gaps on its outside; length: of the body, mm.

    It has none if Gmsh cannot divide its outer faces.
    """
    outside = gmsh.model.getBoundary(list(volumes), combined=True, oriented=False)
    with suppress(MeshError):
        return has_gaps(*triangles_of(gmsh, volumes, outside, length / BODY_OVER_EDGES))
    return False


def triangles_of(gmsh: Any, volumes: Collection[Volume], faces: Collection[Face], size: float) -> tuple[Array, Index]:
    """Points (n, 3), mm, and triangles (k, 3) of faces that each belong to one of the volumes, seen from outside."""
    gmsh.model.setVisibility(gmsh.model.getEntities(), 0)
    gmsh.model.setVisibility(faces, 1, recursive=True)
    for option, value in (("MeshOnlyVisible", 1), ("MeshSizeMax", size), ("MeshSizeFromCurvature", AROUND)):
        gmsh.option.setNumber(f"Mesh.{option}", value)
    with told("Gmsh could not divide the walls of the body", "repair the body in its own program"):
        for _, tag in volumes:
            gmsh.model.mesh.setOutwardOrientation(tag)
        gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    rows = np.zeros(int(tags.max()) + 1, dtype=int)
    rows[tags] = np.arange(len(tags))
    nodes = [gmsh.model.mesh.getElementsByType(TRIANGLE, tag)[1] for _, tag in faces]
    return coordinates.reshape(-1, 3), rows[np.concatenate(nodes)].reshape(-1, 3)
