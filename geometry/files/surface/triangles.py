"""Closed surfaces of triangles from a file: which faults are named, how thick the walls are, and tetrahedra inside.

Triangles are sorted into smooth patches, which Gmsh meshes anew: those of CAD programs are often long and thin. The
patches keep the shape of the triangles and the edges between them; elements on round patches have curved edges.
"""

from dataclasses import dataclass
from math import pi, radians
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import CurvedEdges
from geometry.errors import MeshError
from geometry.files.mesh.reader import FileMesh
from geometry.files.shells import enclosed, find_crossing, outside_first, shells, windings
from geometry.meshing.solid import collect_mesh, optimize, session, told
from geometry.topology import crossings, normals, open_edges, parts_of_graph, row_keys, triangle_edges

#: what a file of a surface may end with
SUFFIXES = (".stl", ".ply", ".obj", ".off")
#: vertices nearer to each other than this, over the size of the body, are one
SAME = 1e-6
#: vertices of open edges nearer to each other than this, over the size of the body, are one: files have six digits, the
#: last of which is 1e-5 of a length of 100 mm
ROUNDED = 2e-5
#: but never vertices farther apart than this part of the shortest side of the triangles at the open edges
SHORTER = 1 / 3
#: how triangles are sorted into patches, in the order that is tried, because Gmsh cannot use every sorting: the angle
#: from which on neighbours belong to different patches, degrees, and whether patches are cut in the middle across z.
#: With 20 degrees the facets of round walls are patches, and a bellows has three times the elements that it has with 50
SORTINGS = ((30, False), (30, True), (40, False), (50, False), (60, False), (20, False), (20, True), (15, False))
#: a mesh with a tetrahedron of a smaller radius ratio than this is optimized once more
FLAT = 0.1
#: distance of a middle from the straight edge, over the length of the edge, up to which it is rounding of the file
ROUNDING = 1e-3
#: what helps where Gmsh does not fill a surface in which no fault is found
ANOTHER_WAY = "the surface is closed and was not found to pass through itself; try another mesh.size, or give a mesh"
#: at most this many places are measured for the thickness of the walls
PLACES = 300


@dataclass(frozen=True)
class Surface:
    """A closed surface, its outside and the walls around its air."""

    points: Array  #: (n, 3)
    parts: tuple[Index, ...]  #: triangles (k, 3) of each closed part, facing out of the material; the outside first

    @property
    def triangles(self) -> Index:
        """(k, 3) all of them."""
        return np.vstack(self.parts)

    @property
    def volume(self) -> float:
        """Volume of the material, in the cube of the unit of the points."""
        return enclosed(self.points, self.triangles)


def read_surface(path: Path) -> Surface:
    """Read a closed surface. Raises `MeshError` where it is missing, has a hole, or is not that of one body."""
    import trimesh  # here: what reads no surface does not wait for its import

    if not path.is_file():
        raise MeshError(f"the surface file {path} does not exist")
    try:
        content = trimesh.load_mesh(path, process=False, skip_materials=True)
        points, triangles = np.asarray(content.vertices, dtype=np.float64), np.asarray(content.faces, dtype=np.int64)
    except Exception as error:
        raise MeshError(f"the surface file {path} cannot be read ({error}); save it again") from error
    if not len(triangles):
        raise MeshError(f"the surface file {path} has no triangles")
    return of_parts(*_merged(points, triangles))


def of_parts(points: Array, triangles: Index) -> Surface:
    """The surface of triangles (k, 3) in any order and direction. Raises `MeshError` unless it is that of one body."""
    _check_closed(points, triangles)
    return _oriented(points, triangles)


def _merged(points: Array, triangles: Index) -> tuple[Array, Index]:
    """Points at the same position as one, and the triangles that still have three. Raises `MeshError`."""
    if not np.isfinite(points).all():
        raise MeshError("a point of the surface is not a finite number")
    size = float(np.ptp(points, axis=0).max())
    if not size > 0:
        raise MeshError("all points of the surface are the same")
    _, first, same = np.unique(np.round(points / (SAME * size)), axis=0, return_index=True, return_inverse=True)
    points, triangles = _compact(points[first], same.reshape(-1)[triangles])
    if not len(triangles):
        raise MeshError("the surface has no triangle with three different corners")
    rim = np.unique(open_edges(triangles, len(points)))
    if not len(rim):
        return points, triangles
    same = np.arange(len(points))
    same[rim] = rim[_welded(points[rim], min(ROUNDED * size, SHORTER * _shortest_side(points, triangles, rim)))]
    return _compact(points, same[triangles])


def _welded(points: Array, distance: float) -> Index:
    """For each of the points (n, 3) the first one that is the same, (n,): those within `distance`, and those within
    `distance` of these, are one."""
    from scipy.spatial import KDTree  # as above

    group = parts_of_graph(len(points), KDTree(points).query_pairs(distance, output_type="ndarray"))
    _, earliest = np.unique(group, return_index=True)
    return np.asarray(earliest[group], dtype=np.int64)


def _shortest_side(points: Array, triangles: Index, vertices: Index) -> float:
    """Length of the shortest side of the triangles (k, 3) that have one of the vertices (v,)."""
    ends = points[triangle_edges(triangles[np.isin(triangles, vertices).any(axis=1)])]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).min())


def _compact(points: Array, triangles: Index) -> tuple[Array, Index]:
    """The triangles (k, 3) with three different vertices, each once, and the points that they use."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (a != c)]
    _, kept = np.unique(row_keys(triangles, len(points)), return_index=True)
    used, numbers = np.unique(triangles[np.sort(kept)], return_inverse=True)
    return points[used], numbers.reshape(-1, 3).astype(np.int64)


def _check_closed(points: Array, triangles: Index) -> None:
    """Raise `MeshError` with a position unless every edge belongs to two triangles."""
    pairs = triangle_edges(triangles)
    _, first, counts = np.unique(row_keys(pairs, len(points)), return_index=True, return_counts=True)
    for wrong, what in (
        (counts == 1, "has a hole: {} edges belong to one triangle only"),
        (counts > 2, "is not manifold: {} edges belong to three or more triangles"),
    ):
        if wrong.any():
            where = _place(points[pairs[first[wrong][0]]])
            raise MeshError(f"the surface {what.format(wrong.sum())}, one near {where}; repair it in CAD")


def _oriented(points: Array, triangles: Index) -> Surface:
    """The closed parts, the outside facing outward and the others towards the air inside it. Raises `MeshError`."""
    outside, *inner = (
        _facing(points, part, outward=k == 0)
        for k, part in enumerate(outside_first(points, shells(triangles, len(points))))
    )
    corners = points[outside].reshape(-1, 3)
    for part in inner:
        at, where = points[part[0]].mean(axis=0), _place(points[part].reshape(-1, 3))
        if windings(at, points[outside]) < 0.5:
            raise MeshError(f"the surface has a part near {where} outside of the largest one; save one body alone")
        if (points[part] < corners.min(axis=0)).any() or (points[part] > corners.max(axis=0)).any():
            raise MeshError(f"the walls around {where} in the surface pass through its outside; repair it in CAD")
        if any(abs(windings(at, points[other])) > 0.5 for other in inner if other is not part):
            raise MeshError(f"the surface has a part near {where} in a cavity; remove it in CAD")
    return Surface(points, (outside, *inner))


def _place(points: Array) -> str:
    """The middle of points (n, 3), for sentences."""
    return "(" + ", ".join(f"{x:.4g}" for x in points.mean(axis=0)) + ")"


def _facing(points: Array, part: Index, outward: bool) -> Index:
    """The triangles (k, 3) of a closed part, all facing outward or all inward. Raises `MeshError`."""
    count, edges = len(part), triangle_edges(part)
    first, second = np.argsort(row_keys(edges, int(part.max()) + 1), kind="stable").reshape(-1, 2).T
    same = (edges[first, 0] == edges[second, 0]).astype(np.int64)  # both pass the edge in the same direction
    # each triangle as it is and turned, k and k + count: neighbours that fit are connected
    pairs = [np.column_stack([first // 3 + count * k, second // 3 + count * (k ^ same)]) for k in (0, 1)]
    number = parts_of_graph(2 * count, np.vstack(pairs))
    if number[0] == number[count]:
        raise MeshError("the surface has one side only, as a Moebius strip has; save the body as a solid")
    part = np.where((number[:count] == number[0])[:, None], part, part[:, ::-1])
    return part if (enclosed(points, part) > 0) == outward else part[:, ::-1]


def thinnest(surface: Surface) -> float:
    """Thickness of the thinnest wall, from the middles of up to PLACES triangles straight through the material."""
    triangles = surface.triangles
    corners = surface.points[triangles]
    across = normals(corners)
    area = np.linalg.norm(across, axis=1)
    chosen = np.argsort(-area, kind="stable")[:: max(1, len(area) // PLACES)]
    size = float(np.ptp(surface.points, axis=0).max())
    thicknesses = []
    for k in chosen:
        if area[k] > 0:
            start, way = corners[k].mean(axis=0), -2 * size * across[k] / area[k]
            ray = np.broadcast_to([start + 1e-6 * way, start + way], (len(corners), 2, 3))
            thicknesses.append(2 * size * float(crossings(ray, corners).min()))
    return min(thicknesses, default=np.inf)


def fill(surface: Surface, size: float) -> FileMesh:
    """Mesh the material with element edges of about `size` (in the unit of the points) at most.

    Raises `MeshError` where the surface passes through itself, and `NotFilled` where Gmsh fails without a known cause.
    """
    failures = []
    for degrees, cut in SORTINGS:
        try:
            return _filled(surface, size, radians(degrees), cut=cut)
        except MeshError as error:
            failures.append(error)
    if (where := find_crossing(surface.points, surface.triangles)) is not None:
        raise MeshError(f"the surface passes through itself near {_place(where[None])}; repair it in CAD")
    raise NotFilled(str(failures[0])) from failures[0]


class NotFilled(MeshError):
    """Gmsh could not fill a surface in which no fault was found."""


def _filled(surface: Surface, size: float, edge: float, *, cut: bool) -> FileMesh:
    """The mesh; edge: the angle between patches, rad; cut: whether none goes through the middle of the body across
    z."""
    with session() as gmsh:
        _draw(gmsh, surface, edge, cut)
        volume = _volume(gmsh, surface)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        with told("Gmsh could not fill the surface", ANOTHER_WAY):
            gmsh.model.mesh.generate(3)
        if not len(gmsh.model.mesh.getElementsByType(4)[0]):
            raise MeshError(f"Gmsh put no tetrahedra into the surface; {ANOTHER_WAY}")
        optimize(gmsh, FLAT)
        mesh = collect_mesh(gmsh, {(3, volume): "body"}, {}, ["body"], [])
    tets = mesh.regions["body"]
    return FileMesh(mesh.points, tets, {}, _without_rounding(mesh.points, mesh.curved))


def _draw(gmsh: Any, surface: Surface, edge: float, cut: bool) -> None:
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
    with told("Gmsh could not sort the triangles into smooth patches", ANOTHER_WAY):
        gmsh.model.mesh.classifySurfaces(edge, True, True, pi)
        gmsh.model.mesh.createGeometry()


def _volume(gmsh: Any, surface: Surface) -> int:
    """The tag of the volume between the outside and the walls of the air."""
    part_of = np.zeros(len(surface.points) + 1, dtype=np.int64)
    for k, part in enumerate(surface.parts):
        part_of[part + 1] = k
    patches: dict[int, list[int]] = {}
    for _, patch in gmsh.model.getEntities(2):
        nodes = gmsh.model.mesh.getElementsByType(2, patch)[1]
        of_most = int(np.bincount(part_of[nodes[nodes < len(part_of)].astype(np.int64)]).argmax())
        patches.setdefault(of_most, []).append(patch)
    loops = [gmsh.model.geo.addSurfaceLoop(patches[k]) for k in sorted(patches)]
    volume = int(gmsh.model.geo.addVolume(loops))
    gmsh.model.geo.synchronize()
    return volume


def _without_rounding(points: Array, curved: CurvedEdges) -> CurvedEdges:
    """Curved edges without those of flat walls, whose vertices the file rounds."""
    ends = points[curved.ends]
    away = np.linalg.norm(curved.middles - ends.mean(axis=1), axis=1)
    kept = away > ROUNDING * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return CurvedEdges(curved.ends[kept], curved.middles[kept])
