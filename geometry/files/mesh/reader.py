"""The tetrahedra in a mesh file of any format that meshio or Gmsh reads."""

import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.curved import NO_CURVED_EDGES, CurvedEdges, curved_edges
from geometry.errors import MeshError
from geometry.files.mesh.abaqus import only_body
from geometry.mesh_content import named_rows, named_triangles, read_content, read_text
from geometry.meshing.solid import session, told
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
#: values of an array of numbers up to which it tells parts of the body
MOST_PARTS = 20
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
    content = _content(path)
    _refuse_other_volumes(path, content)
    if np.any(content.point_data.get("nastran:ref", 0)):
        raise MeshError(f"the mesh file {path} has nodes in a coordinate system of their own (CP of GRID)")
    blocks = [block.data for block in content.cells if block.type in TETRAHEDRA]
    points = np.asarray(content.points, dtype=np.float64)
    return _collected(path, points, blocks, named_triangles(content), _named_rows(content))


def _content(path: Path) -> Any:
    """What meshio reads, of some formats in a file that it does read. Raises `MeshError`."""
    suffix = path.suffix.lower()
    if not path.is_file():
        raise MeshError(f"the mesh file {path} does not exist")
    if suffix == ".inp":
        text, sets = only_body(path)
        content = read_text(path, text)
        sizes = [len(block.data) for block in content.cells]
        content.cell_sets |= {
            name: [np.arange(n * (name == of)) for n, of in zip(sizes, sets, strict=True)] for name in sets if name
        }
        return content
    if suffix in OF_GMSH:
        return _by_gmsh(path)
    try:
        return read_content(path)
    except MeshError:
        if suffix not in OF_BOTH:
            raise
        with suppress(MeshError):
            return _by_gmsh(path)
        raise


def _by_gmsh(path: Path) -> Any:
    """The content of a file that Gmsh reads. Raises `MeshError`."""
    with session() as gmsh, TemporaryDirectory() as folder:
        with told(f"the mesh file {path} cannot be read", "save it again"):
            gmsh.merge(str(path))
        for option in ("SaveAll", "Binary"):
            gmsh.option.setNumber(f"Mesh.{option}", 1)
        gmsh.write(f"{folder}/body.msh")
        return read_content(Path(folder) / "body.msh", name=path)


def _named_rows(content: Any) -> dict[str, Index]:
    """Rows of the tetrahedra of each physical volume of Gmsh or set of elements; without any, by arrays of numbers."""
    sizes = [len(block.data) if block.type in TETRAHEDRA else 0 for block in content.cells]
    first, sets = np.concatenate([[0], np.cumsum(sizes)]), content.cell_sets.items()
    groups = {name: {k: rows for k, rows in enumerate(parts) if sizes[k] and len(rows)} for name, parts in sets}
    groups = named_rows(content, 3, TETRAHEDRA) if "gmsh:physical" in content.cell_data else groups
    joined = {name: [first[k] + rows for k, rows in parts.items()] for name, parts in groups.items()}
    named = {name: np.concatenate(rows) for name, rows in joined.items() if rows and not name.startswith("gmsh:")}
    return named or _numbered_rows(content)


def _numbered_rows(content: Any) -> dict[str, Index]:
    """Rows of the tetrahedra by the values of arrays that number parts, as VTK, Medit and Nastran have them."""
    is_tetra, found = [block.type in TETRAHEDRA for block in content.cells], dict[str, Index]()
    for name, parts in content.cell_data.items():
        arrays = [np.asarray(part) for part, is_one in zip(parts, is_tetra, strict=True) if is_one]
        if not arrays or arrays[0].ndim > 1 or name == "gmsh:geometrical":
            continue
        numbers = np.concatenate(arrays)
        values = np.unique(numbers)
        if 1 < len(values) <= MOST_PARTS and np.array_equal(values, np.round(values)):
            title = re.sub(r"\W+", "_", name)
            found |= {f"{title}_{value:.0f}": np.flatnonzero(numbers == value) for value in values}
    return found


def _refuse_other_volumes(path: Path, content: Any) -> None:
    """Raise `MeshError` where there are volume elements that are no tetrahedra with 4 or 10 nodes."""
    others = [block for block in content.cells if block.dim == 3 and block.type not in TETRAHEDRA]
    if others:
        kinds = ", ".join(f"{len(block.data)} {block.type}" for block in others)
        allowed = "allowed are tetrahedra with 4 or 10 nodes, or a surface as STL"
        raise MeshError(f"the mesh file {path} has {kinds}; {allowed}")


def _collected(
    path: Path, points: Array, blocks: list[Index], faces: Mapping[str, Index], regions: Mapping[str, Index]
) -> FileMesh:
    """The elements blocks (m, 4) and (m, 10) in one. Raises `MeshError` where there are none or middles lie wrong."""
    blocks = [np.asarray(block, dtype=np.int64) for block in blocks if len(block)]
    if not blocks:
        raise MeshError(f"the mesh file {path} has no tetrahedra; mesh the volume, or give the surface as STL")
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
        order = "allowed is the order of VTK: the corners, then the middles of 12, 23, 13, 14, 24 and 34"
        raise MeshError(f"the mesh file {path} has a middle node ({where}) that lies far from its edge; {order}")
    return curved_edges(points, pairs, middles)
