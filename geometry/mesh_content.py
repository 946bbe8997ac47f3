"""Mesh files, which meshio reads and writes: points, tetrahedra and named triangles."""

import contextlib
import io
import warnings
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError


def read_content(path: Path, name: Path | None = None) -> Any:
    """What meshio reads in a mesh file. Raises `MeshError`, with `name` if given, where it cannot be read."""
    name = path if name is None else name
    if not path.is_file():
        raise MeshError(f"the mesh file {name} does not exist")
    try:
        # meshio prints remarks and warns of its own rounding; the library functions of this project print nothing
        with (
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(io.StringIO()),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")
            return _meshio().read(path)
    except ModuleNotFoundError as error:
        raise MeshError(f"the mesh file {name} cannot be read without {error.name}; save VTU") from error
    except (Exception, SystemExit) as error:
        reason = "" if isinstance(error, SystemExit) else " ".join(str(error).split())  # its number tells nothing
        said = f" (meshio: {reason})" if reason else ""
        raise MeshError(f"the file {name} cannot be read: empty, cut off or unknown{said}; save it again") from error


def read_text(path: Path, text: str) -> Any:
    """What meshio reads in a file with this text instead of its own. Raises `MeshError`."""
    with TemporaryDirectory() as folder:
        plain = Path(folder) / path.name
        plain.write_text(text, encoding="utf-8")
        return read_content(plain, name=path)


def read_mesh(path: Path) -> tuple[Array, Index, dict[str, Index]]:
    """Points (n, 3), tetrahedra (m, 4) and named triangles {name: (k, 3)} of a mesh file; see `Mesh.read`."""
    content = read_content(path)
    points, tets = _tetrahedra(path, content)
    faces = named_triangles(content)
    if not faces:
        raise MeshError(f"the mesh file {path} has no named faces; name its surfaces by groups (clamp, cavity, ...)")
    return points, tets, faces


def read_tetrahedra(path: Path) -> tuple[Array, Index]:
    """Points (n, 3) and the corners (m, 4) of the tetrahedra of a mesh file. Raises `MeshError`."""
    return _tetrahedra(path, read_content(path))


def _tetrahedra(path: Path, content: Any) -> tuple[Array, Index]:
    tets = [block.data[:, :4] for block in content.cells if block.type in ("tetra", "tetra10")]
    if not tets:
        raise MeshError(f"the mesh file {path} has no tetrahedra; mesh the volume and save it with its physical groups")
    return np.asarray(content.points, float), np.vstack(tets)


def named_triangles(content: Any) -> dict[str, Index]:
    """The triangles of each named physical group; a triangle in several groups is listed under each of their names."""
    groups = named_rows(content, 2, ("triangle", "triangle6"))
    return {
        name: np.vstack([content.cells[number].data[rows, :3] for number, rows in parts.items()])
        for name, parts in groups.items()
    }


def named_rows(content: Any, dimension: int, kinds: tuple[str, ...]) -> dict[str, dict[int, Index]]:
    """For each named physical group of a dimension its rows in each block of these kinds of cells, by the number of the
    block; a cell in several groups is listed under each of their names."""
    groups: dict[str, dict[int, Index]] = {}
    for name in content.field_data:
        sets = zip(content.cells, content.cell_sets.get(name, []), strict=False)
        parts = {
            number: np.asarray(rows, dtype=np.int64)
            for number, (block, rows) in enumerate(sets)
            if block.type in kinds and rows is not None and len(rows)
        }
        if not parts and "gmsh:physical" in content.cell_data and content.field_data[name][1] == dimension:
            tags = zip(content.cells, content.cell_data["gmsh:physical"], strict=True)
            parts = {
                number: np.flatnonzero(np.asarray(of) == content.field_data[name][0])
                for number, (block, of) in enumerate(tags)
                if block.type in kinds
            }
        if sum(map(len, parts.values())):
            groups[name.strip()] = parts  # MED pads with blanks
    return groups


def write_mesh(path: Path, points: Array, tets: Index, faces: Mapping[str, Index]) -> None:
    """Write a .msh with physical groups or a .vtu of the tetrahedra; see `Mesh.write`."""
    meshio = _meshio()
    if path.suffix == ".vtu":
        meshio.Mesh(points, [("tetra", tets)]).write(path, file_format="vtu")
        return
    if path.suffix != ".msh":
        raise MeshError(f"a mesh is written as .msh or .vtu, not as {path.name}")
    cells = [("triangle", triangles) for triangles in faces.values()] + [("tetra", tets)]
    tags = [np.full(len(data), tag, dtype=np.int32) for tag, (_, data) in enumerate(cells, start=1)]
    names = {name: np.array([tag, 2]) for tag, name in enumerate(faces, start=1)}
    names["solid"] = np.array([len(cells), 3])
    content = meshio.Mesh(points, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names)
    meshio.write(path, content, file_format="gmsh22", binary=False)


def _meshio() -> Any:
    import meshio

    return meshio
