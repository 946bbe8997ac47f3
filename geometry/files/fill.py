"""Tetrahedra in a closed surface of triangles, by Gmsh.

The triangles of the file are sorted into smooth patches, which are meshed anew: those of CAD programs are often long
and thin. The patches keep the shape of the triangles and the edges between them, and elements on round patches have
curved edges.
"""

from math import pi, radians
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import CurvedEdges
from geometry.errors import MeshError
from geometry.files.mesh_reader import FileMesh
from geometry.files.surface import Surface
from geometry.meshing.solid import collect_mesh, optimize, session, told

#: two triangles that are turned against each other by more than this belong to different patches, rad
EDGE = radians(30)
#: a mesh with a tetrahedron of a smaller radius ratio than this is optimized once more
FLAT = 0.1
#: distance of a middle from the straight edge, over the length of the edge, up to which it is rounding of the file
ROUNDING = 1e-3
#: why Gmsh may not fill a surface, and what helps
MAY_TOUCH = "it may touch itself or pass through itself: repair it, or try another mesh.size"


def fill(surface: Surface, size: float) -> FileMesh:
    """Mesh the material with element edges of about `size` (in the unit of the points) at most.

    Raises `MeshError` where Gmsh cannot.
    """
    try:
        return _filled(surface, size, cut=False)
    except _NoPatches:
        return _filled(surface, size, cut=True)


class _NoPatches(MeshError):
    """Gmsh could not make patches of the triangles."""


def _filled(surface: Surface, size: float, *, cut: bool) -> FileMesh:
    """The mesh; cut: whether no patch goes through the middle of the body across z."""
    with session() as gmsh:
        _draw(gmsh, surface, cut)
        volume = _volume(gmsh, surface)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        with told("Gmsh could not fill the surface", MAY_TOUCH):
            gmsh.model.mesh.generate(3)
        if not len(gmsh.model.mesh.getElementsByType(4)[0]):
            raise MeshError("Gmsh put no tetrahedra into the surface; does it pass through itself?")
        optimize(gmsh, FLAT)
        mesh = collect_mesh(gmsh, {(3, volume): "body"}, {}, ["body"], [])
    tets = mesh.regions["body"]
    return FileMesh(mesh.points, tets, {}, _without_rounding(mesh.points, mesh.curved))


def _draw(gmsh: Any, surface: Surface, cut: bool) -> None:
    """Put the triangles into the session, and patches over them.

    Gmsh fails at some flat faces with a hole, depending on how the rim is divided. `cut` gives it the triangles of both
    sides of the middle apart, so that it makes two patches of each such face.
    """
    z = surface.points[surface.triangles, 2].mean(axis=1)
    side = (z > (surface.points[:, 2].min() + surface.points[:, 2].max()) / 2) & cut
    nodes = np.arange(1, len(surface.points) + 1)
    for k, part in enumerate(filter(len, (surface.triangles[~side], surface.triangles[side]))):
        entity = gmsh.model.addDiscreteEntity(2)
        if k == 0:
            gmsh.model.mesh.addNodes(2, entity, nodes, surface.points.ravel())
        gmsh.model.mesh.addElementsByType(entity, 2, [], (part + 1).ravel())
    with told("Gmsh could not sort the triangles into smooth patches", MAY_TOUCH, _NoPatches):
        gmsh.model.mesh.classifySurfaces(EDGE, True, True, pi)
        gmsh.model.mesh.createGeometry()


def _volume(gmsh: Any, surface: Surface) -> int:
    """The tag of the volume between the outside and the walls of the air."""
    part_of = np.zeros(len(surface.points) + 1, dtype=np.int64)
    for k, part in enumerate(surface.parts):
        part_of[part + 1] = k
    patches: dict[int, list[int]] = {}
    for _, patch in gmsh.model.getEntities(2):
        nodes = gmsh.model.mesh.getElementsByType(2, patch)[1]
        patches.setdefault(_part(gmsh, nodes, part_of), []).append(patch)
    loops = [gmsh.model.geo.addSurfaceLoop(patches[k]) for k in sorted(patches)]
    volume = int(gmsh.model.geo.addVolume(loops))
    gmsh.model.geo.synchronize()
    return volume


def _part(gmsh: Any, nodes: Index, part_of: Index) -> int:
    """Number of the part of the surface to which most of the nodes belong."""
    return int(np.bincount(part_of[nodes[nodes < len(part_of)].astype(np.int64)]).argmax())


def _without_rounding(points: Array, curved: CurvedEdges) -> CurvedEdges:
    """Curved edges without those of flat walls, whose vertices the file rounds."""
    ends = points[curved.ends]
    away = np.linalg.norm(curved.middles - ends.mean(axis=1), axis=1)
    kept = away > ROUNDING * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return CurvedEdges(curved.ends[kept], curved.middles[kept])
