"""The tetrahedra in a mesh file of any format that meshio reads, or Gmsh where meshio needs more than is installed;
Abaqus files are read here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import NO_CURVED_EDGES, CurvedEdges, curved_edges
from geometry.errors import MeshError
from geometry.files.abaqus import read_abaqus
from geometry.mesh_content import named_rows, named_triangles, read_content
from geometry.meshing.solid import session
from geometry.topology import EDGES, row_keys

#: formats that Gmsh reads here: meshio has no UNV, and needs h5py for MED
OF_GMSH = (".med", ".unv")
#: formats of which Gmsh reads files that meshio refuses, such as Nastran's without its BEGIN BULK, or its own where
#: only some elements are in a group
OF_BOTH = (".bdf", ".nas", ".mesh", ".su2", ".msh")
#: what a mesh file may end with
SUFFIXES = (
    *(".msh", ".vtk", ".vtu", ".inp", ".bdf", ".nas", ".fem", ".mesh", ".meshb", ".su2", ".avs", ".vol", ".ugrid"),
    *(".xdmf", ".xmf", ".xml", ".dat", ".mdpa", ".f3grid", ".ele", ".node", ".e", ".exo", ".cgns"),
    *OF_GMSH,
)
#: meshio's names of tetrahedra with 4 and 10 nodes
TETRAHEDRA = ("tetra", "tetra10")
#: elements of a volume that are not used, as a user calls them, by the beginning of meshio's name
_OTHER_VOLUMES = {
    "hexahedron": "hexahedra",
    "wedge": "prisms",
    "pyramid": "pyramids",
    "polyhedron": "polyhedra",
    "tetra": "tetrahedra of a higher order",
    "VTK_LAGRANGE": "elements of a higher order",
}
#: the farthest that the middle of a quadratic edge may lie from halfway between its ends, over the edge's length
FARTHEST_MIDDLE = 0.45


@dataclass(frozen=True)
class FileMesh:
    """What a file says, in its own unit and directions."""

    points: Array  #: (n, 3)
    tets: Index  #: (m, 4)
    faces: Mapping[str, Index]  #: name -> (k, 3) triangles; empty where the file names none
    curved: CurvedEdges  #: edges of quadratic elements whose middle is not halfway between their ends
    regions: Mapping[str, Index] = field(default_factory=dict)  #: name -> (k,) rows of tets; empty without named groups
    #: (k, 3) middles of those edges that are taken as straight, because an element would fold or nearly be flat
    straightened: Array = field(default_factory=lambda: np.empty((0, 3)))


def read_mesh_file(path: Path) -> FileMesh:
    """Read the tetrahedra of a file, with 4 or 10 nodes; surface elements without a name are left out.

    Raises `MeshError` where the file is missing or cannot be read, has no tetrahedra, or has other volume elements.
    """
    if not path.is_file():
        raise MeshError(f"the mesh file {path} does not exist")
    if path.suffix.lower() in OF_GMSH:
        return _read_with_gmsh(path)
    if path.suffix.lower() == ".inp":
        points, blocks, others = read_abaqus(path)
        _refuse_other_volumes(path, others)
        return _collected(path, points, blocks, {}, {})
    try:
        content = read_content(path)
    except MeshError as refused:
        return _read_otherwise(path, refused)
    _refuse_other_volumes(path, _other_volumes(content))
    if np.any(content.point_data.get("nastran:ref", 0)):
        raise MeshError(
            f"the mesh file {path} has nodes in a coordinate system of their own (CP of GRID); save it with the basic "
            "coordinate system"
        )
    blocks = [block.data for block in content.cells if block.type in TETRAHEDRA]
    points = np.asarray(content.points, dtype=np.float64)
    return _collected(path, points, blocks, named_triangles(content), _named_rows(content))


def _named_rows(content: Any) -> dict[str, Index]:
    """Rows of the tetrahedra of each physical volume of Gmsh; sets of other formats are left out."""
    if "gmsh:physical" not in content.cell_data:
        return {}
    sizes = [len(block.data) if block.type in TETRAHEDRA else 0 for block in content.cells]
    first = np.concatenate([[0], np.cumsum(sizes)])
    groups = named_rows(content, 3, TETRAHEDRA)
    return {name: np.concatenate([first[k] + rows for k, rows in parts.items()]) for name, parts in groups.items()}


def _read_otherwise(path: Path, refused: MeshError) -> FileMesh:
    """A file that meshio does not read, as Gmsh reads it. Raises `refused` where that cannot either."""
    if path.suffix.lower() not in OF_BOTH:
        raise refused
    try:
        return _read_with_gmsh(path)
    except MeshError:
        raise refused from None


def _other_volumes(content: Any) -> dict[str, int]:
    """How many volume elements that are no tetrahedra with 4 or 10 nodes meshio has read, by what a user calls them."""
    counts: dict[str, int] = {}
    for block in content.cells:
        name = next((name for key, name in _OTHER_VOLUMES.items() if block.type.startswith(key)), None)
        if name is not None and block.type not in TETRAHEDRA:
            counts[name] = counts.get(name, 0) + len(block.data)
    return counts


def _refuse_other_volumes(path: Path, counts: Mapping[str, int]) -> None:
    """Raise `MeshError` where the file has such elements."""
    if counts:
        elements = " and ".join(f"{count} {name}" for name, count in counts.items())
        raise MeshError(
            f"the mesh file {path} has {elements}; allowed are tetrahedra with 4 or 10 nodes: mesh the body with them, "
            "or give its surface as STL and this program fills it"
        )


def _collected(
    path: Path, points: Array, blocks: list[Index], faces: Mapping[str, Index], regions: Mapping[str, Index]
) -> FileMesh:
    """The elements blocks (m, 4) and (m, 10) in one. Raises `MeshError` where there are none or middles lie wrong."""
    blocks = [np.asarray(block, dtype=np.int64) for block in blocks if len(block)]
    if not blocks:
        raise MeshError(
            f"the mesh file {path} has no tetrahedra; mesh the volume, or give the surface as STL and this program "
            "fills it"
        )
    curved = NO_CURVED_EDGES
    for block in blocks:
        if block.shape[1] == 10:
            curved = curved.joined(_curved(path, points, block))
    tets = np.vstack([block[:, :4] for block in blocks])
    if not np.isfinite(points[tets[(tets >= 0) & (tets < len(points))]]).all():
        raise MeshError(f"the mesh file {path} has a point whose coordinates are no numbers")
    used = np.unique(np.concatenate([tets.ravel(), *(triangles.ravel() for triangles in faces.values())]))
    if used[0] < 0 or used[-1] >= len(points):
        return FileMesh(points, tets, faces, curved, regions)  # refused with the file's own numbers
    number = np.full(len(points), -1)  # reference points and middles belong to no element
    number[used] = np.arange(len(used))
    points, tets, faces = points[used], number[tets], {name: number[of_name] for name, of_name in faces.items()}
    given = curved.renumbered(number)
    usable = given.usable(points, tets)
    left_out = ~np.isin(row_keys(given.ends, len(points)), row_keys(usable.ends, len(points)))
    return FileMesh(points, tets, faces, usable, regions, given.middles[left_out])


def _curved(path: Path, points: Array, tets: Index) -> CurvedEdges:
    """The curved edges of quadratic tetrahedra (m, 10), middles of 01, 12, 02, 03, 13 and 23 last."""
    if tets.min() < 0 or tets.max() >= len(points):
        raise MeshError(f"an element in the mesh file {path} uses a point that the file does not have")
    pairs, middles = tets[:, EDGES].reshape(-1, 2), points[tets[:, 4:].ravel()]
    ends = points[pairs]
    away = np.linalg.norm(middles - ends.mean(axis=1), axis=1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    if (away > FARTHEST_MIDDLE * lengths).any():
        worst = int(np.argmax(away - FARTHEST_MIDDLE * lengths))
        where = ", ".join(f"{x:.4g}" for x in middles[worst])
        raise MeshError(
            f"the mesh file {path} has a quadratic element whose middle node ({where}) lies far from its edge; allowed "
            "is the order of VTK: the middles of the edges 12, 23, 13, 14, 24 and 34 after the four corners"
        )
    return curved_edges(points, pairs, middles)


def _read_with_gmsh(path: Path) -> FileMesh:
    """The tetrahedra and named groups of a file that Gmsh reads. Raises `MeshError`."""
    with session() as gmsh:
        try:
            gmsh.merge(str(path))
        except Exception as error:
            raise MeshError(f"the mesh file {path} cannot be read: {error}") from error
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        if not len(tags):
            raise MeshError(f"the mesh file {path} cannot be read: Gmsh finds no points in it")
        index = np.full(int(tags.max()) + 1, -1)
        index[tags] = np.arange(len(tags))
        kinds, elements, nodes = gmsh.model.mesh.getElements(3)
        others = [gmsh.model.mesh.getElementProperties(kind)[0] for kind in kinds if kind not in (4, 11)]
        if others:
            raise MeshError(
                f"the mesh file {path} has volume elements of the kind {others[0]}; allowed are tetrahedra with 4 or "
                "10 nodes"
            )
        blocks = []
        for kind, numbers in zip(kinds, nodes, strict=True):
            block = index[numbers].reshape(-1, 4 if kind == 4 else 10)
            blocks.append(block[:, [*range(8), 9, 8]] if kind == 11 else block)  # Gmsh has 34 before 24
        faces = {}
        for _, group in gmsh.model.getPhysicalGroups(2):
            triangles = [
                index[numbers].reshape(-1, {2: 3, 9: 6}[kind])[:, :3]
                for entity in gmsh.model.getEntitiesForPhysicalGroup(2, group)
                for kind, numbers in zip(*gmsh.model.mesh.getElements(2, entity)[::2], strict=True)
                if kind in (2, 9)
            ]
            name = gmsh.model.getPhysicalName(2, group).strip()
            if name and triangles:
                faces[name] = np.vstack(triangles)
        numbers = np.concatenate([*elements, np.zeros(1, dtype=np.uint64)]).astype(np.int64)
        row = np.full(int(numbers.max()) + 1, -1)
        row[numbers[:-1]] = np.arange(len(numbers) - 1)
        regions = {}
        for _, group in gmsh.model.getPhysicalGroups(3):
            held = [
                row[numbers.astype(np.int64)]
                for entity in gmsh.model.getEntitiesForPhysicalGroup(3, group)
                for numbers in gmsh.model.mesh.getElements(3, entity)[1]
            ]
            name = gmsh.model.getPhysicalName(3, group).strip()  # MED pads with blanks
            if name and held:
                regions[name] = np.concatenate(held)
        return _collected(path, coordinates.reshape(-1, 3), blocks, faces, regions)
