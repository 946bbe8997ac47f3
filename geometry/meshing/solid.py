"""Solids described as data and meshed by Gmsh; only this module imports Gmsh."""

import ctypes
import os
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import NO_CURVED_EDGES, CurvedEdges, curved_edges
from geometry.errors import MeshError
from geometry.grading import OFF, Grading
from geometry.meshing.round_walls import divide_round_walls
from geometry.meshing.shapes import Shape, Volume, drawn
from geometry.meshing.size_field import Graded, find_graded, set_size_field

#: A graded mesh with a tetrahedron of a smaller radius ratio than this is optimized once more.
POOR = 0.1
#: A tetrahedron of a smaller radius ratio than this has no volume.
DEGENERATE = 1e-9

#: what helps where Gmsh cannot mesh
SMALLER = "a smaller mesh.size follows thin or round walls better"

_ONE_SESSION = threading.Lock()  # Gmsh has one global state per process


@dataclass(frozen=True)
class Solid:
    """Material minus air.

    `material` maps the names of regions to blocks, each the union of some shapes. Faces between two blocks remain faces
    of the mesh (so that vertices lie on them), faces inside a block vanish. `air` maps the name of the wall around it
    to empty shapes; where material and air overlap there is air.
    """

    material: Mapping[str, Sequence[Sequence[Shape]]]
    air: Mapping[str, Sequence[Shape]]


@dataclass(frozen=True)
class SolidMesh:
    """A meshed solid, before it is assembled to a body."""

    points: Array  #: (n, 3), mm
    regions: Mapping[str, Index]  #: region -> (m, 4) tetrahedra
    walls: Mapping[str, Index]  #: name of the air -> (k, 3) triangles of the material around it
    curved: CurvedEdges  #: edges on round walls


@contextmanager
def session() -> Iterator[Any]:
    """A silent, deterministic, single-threaded Gmsh session; yields the `gmsh` module.

    Raises `MeshError` for every error of Gmsh.
    """
    import gmsh

    with _ONE_SESSION, _silenced():
        gmsh.initialize([], readConfigFiles=False, run=False, interruptible=False)
        _restore_signals()
        try:
            for option, value in _OPTIONS.items():
                gmsh.option.setNumber(option, value)
            with told("Gmsh cannot work with the body", "try another mesh.size, or repair the body in its own program"):
                yield gmsh
        finally:
            gmsh.finalize()


@contextmanager
def told(failure: str, remedy: str, kind: type[MeshError] = MeshError) -> Iterator[None]:
    """Raise `MeshError`, or a kind of it, with a sentence for an error of Gmsh in the block."""
    try:
        yield
    except Exception as error:
        if type(error) is not Exception:  # Gmsh raises nothing more special than that
            raise
        raise kind(f"{failure} ({error}); {remedy}") from error


@contextmanager
def _silenced() -> Iterator[None]:
    """Redirect the standard output to nowhere: libraries inside Gmsh write there whatever its verbosity is."""
    c = ctypes.CDLL(None)
    c.fflush(None)
    stdout, devnull = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(devnull, 1)
    try:
        yield
    finally:
        c.fflush(None)
        os.dup2(stdout, 1)
        os.close(stdout)
        os.close(devnull)


def _restore_signals() -> None:
    """Give back to Python the signals that Gmsh handles once started: with its handlers a broken pipe would end the
    process without a message.
    """
    if threading.current_thread() is threading.main_thread():  # others may not set handlers
        for number in (signal.SIGHUP, signal.SIGPIPE, signal.SIGTERM):
            signal.signal(number, signal.getsignal(number))


_OPTIONS = {
    "General.Terminal": 0,
    "General.Verbosity": 0,
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.Algorithm": 6,  # frontal Delaunay on surfaces
    "Mesh.Algorithm3D": 10,  # HXT: leaves a radius ratio of 0.2-0.3, Delaunay with Netgen's optimiser 0.03-0.2
    "Mesh.Optimize": 1,
    "Mesh.MeshSizeExtendFromBoundary": 0,  # else the 1 mm walls would refine everything near them
}

#: other values of Mesh.Algorithm3D: a mesh without inner points, and Delaunay's algorithm
_INITIAL, _DELAUNAY = 3, 1


def mesh_solid(solid: Solid, size: float, grading: Grading = OFF) -> SolidMesh:
    """Mesh the material of `solid` with element edges of about `size` mm at most, smaller where `grading` says so."""
    with session() as gmsh:
        occ = gmsh.model.occ
        blocks = [(name, _block(occ, shapes)) for name, region in solid.material.items() for shapes in region]
        voids = [(name, drawn(occ, shape)) for name, shapes in solid.air.items() for shape in shapes]
        parents = [(name, volume) for name, volumes in blocks for volume in volumes] + voids
        _, children = occ.fragment([volume for _, volume in parents], [])
        owners = [(name, child) for (name, _), parts in zip(parents, children, strict=True) for child in parts]
        air = {child: name for name, child in owners if name in solid.air}
        material = {child: name for name, child in owners if name in solid.material and child not in air}
        occ.synchronize()
        walls = walls_between(gmsh, material, air)
        gmsh.model.occ.remove(list(air), recursive=True)
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), size)  # without it Gmsh refines to a tenth of the body
        rounded = divide_round_walls(gmsh, size, grading)
        known = _graded_of(repr(solid))
        if grading not in known:
            known[grading] = find_graded(gmsh, grading)
        set_size_field(gmsh, size, grading, known[grading], rounded)
        with told("Gmsh could not mesh the body", SMALLER):
            gmsh.model.mesh.generate(3)
        optimize(gmsh, 0.0 if grading == OFF else POOR)
        return collect_mesh(gmsh, material, walls, list(solid.material), list(solid.air))


@lru_cache(maxsize=4)
def _graded_of(solid: str) -> dict[Grading, Graded]:
    """What is graded of a solid with that representation, for its meshes of other sizes; who finds it adds it."""
    return {}


def generate(gmsh: Any, several: bool = False) -> None:
    """Mesh the volumes of the session: by HXT, or by Delaunay's algorithm where edges of the surfaces need more points.

    HXT corrupts its memory where it puts such points (Steiner points) on the edges between surfaces, and ends the
    process. A mesh without inner points, which takes a hundredth of a second, shows whether some are needed.
    several: whether solids of a drawing share their faces; HXT ends the process at some sheets between them, too.
    Raises `MeshError`.
    """
    mesh = gmsh.model.mesh
    with told("Gmsh could not mesh the body", SMALLER):
        mesh.generate(2)
        count = len(mesh.getNodes()[0])
        gmsh.option.setNumber("Mesh.Algorithm3D", _INITIAL)
        mesh.generate(3)
        needs_points = len(mesh.getNodes()[0]) > count
        algorithm = _DELAUNAY if needs_points or several else _OPTIONS["Mesh.Algorithm3D"]
        gmsh.option.setNumber("Mesh.Algorithm3D", algorithm)
        mesh.clear([] if needs_points else gmsh.model.getEntities(3))  # the points have changed the surfaces
        mesh.generate(3)


def optimize(gmsh: Any, minimum: float) -> None:
    """Optimize the mesh of the session with Netgen if a tetrahedron has a radius ratio below `minimum`.

    HXT sometimes leaves such tetrahedra in thin walls, and now and then one without volume, its corners in one plane.
    At such an element Netgen ends the process, and the volumes are meshed by Delaunay's algorithm instead. Raises
    `MeshError` if that leaves one, too.
    """
    mesh = gmsh.model.mesh
    smallest = _smallest_ratio(gmsh)
    if smallest < DEGENERATE:
        gmsh.option.setNumber("Mesh.Algorithm3D", _DELAUNAY)
        mesh.clear(gmsh.model.getEntities(3))
        mesh.generate(3)
        smallest = _smallest_ratio(gmsh)
        if smallest < DEGENERATE:
            raise MeshError("Gmsh leaves an element without volume; mesh the body with another size")
    if smallest < minimum:
        mesh.optimize("Netgen")


def _smallest_ratio(gmsh: Any) -> float:
    """The smallest radius ratio of a tetrahedron of the session."""
    tags, _ = gmsh.model.mesh.getElementsByType(4)
    return float(min(gmsh.model.mesh.getElementQualities(tags, "gamma")))


def _block(occ: Any, shapes: Sequence[Shape]) -> list[Volume]:
    first, *rest = (drawn(occ, shape) for shape in shapes)
    return occ.fuse([first], rest)[0] if rest else [first]


def walls_between(gmsh: Any, material: Mapping[Volume, str], air: Mapping[Volume, str]) -> dict[int, str]:
    """The tags of the faces between a material volume and an air volume, with the name of the air."""
    solid_faces = {tag for volume in material for _, tag in _faces(gmsh, volume)}
    return {tag: name for volume, name in air.items() for _, tag in _faces(gmsh, volume) if tag in solid_faces}


def _faces(gmsh: Any, volume: Volume) -> list[tuple[int, int]]:
    return gmsh.model.getBoundary([volume], oriented=False)


def collect_mesh(
    gmsh: Any, material: Mapping[Volume, str], walls: Mapping[int, str], regions: Sequence[str], names: Sequence[str]
) -> SolidMesh:
    """The mesh of the session: the tetrahedra of each region, the triangles of the walls by name."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags] = np.arange(len(tags))

    def elements(dimension: int, entity: int, corners: int) -> Index:
        kind = {3: 4, 2: 2}[dimension]
        nodes = gmsh.model.mesh.getElementsByType(kind, entity)[1]
        return index[nodes].reshape(-1, corners)

    tets = {
        region: np.vstack([elements(3, tag, 4) for (_, tag), name in material.items() if name == region])
        for region in regions
    }
    triangles = {
        name: np.vstack(
            [np.empty((0, 3), dtype=np.int64)] + [elements(2, tag, 3) for tag in walls if walls[tag] == name]
        )
        for name in names
    }
    points = coordinates.reshape(-1, 3)
    curved = _curved_edges(gmsh, index, points).usable(points, np.vstack(list(tets.values())))
    return SolidMesh(points, tets, triangles, curved)


def _curved_edges(gmsh: Any, index: Index, points: Array) -> CurvedEdges:
    """The edges of the session's mesh on round walls, with their middles on the drawing; index: number of each point
    (n, 3), mm, by the tag of its node."""
    if all(gmsh.model.getType(*face) == "Plane" for face in gmsh.model.getEntities(2)):
        return NO_CURVED_EDGES
    corners = index[gmsh.model.mesh.getElementsByType(2)[1].reshape(-1, 3)]
    gmsh.model.mesh.setOrder(2)  # the triangles keep their order, and their vertices their positions
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    position = np.empty((int(tags.max()) + 1, 3))
    position[tags] = coordinates.reshape(-1, 3)
    triangles = gmsh.model.mesh.getElementsByType(9)[1].reshape(-1, 6)
    return curved_edges(points, corners[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2), position[triangles[:, 3:].ravel()])
