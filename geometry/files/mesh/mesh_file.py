"""A body from a mesh file: its faces by planes, or by the names that the file has."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Annotated, ClassVar, Self, final

import numpy as np

from geometry.arrays import Array
from geometry.body import Body
from geometry.errors import DesignError, MeshError
from geometry.files.chambers import Range, chambers_of, has_gaps
from geometry.files.from_file import FileDesign
from geometry.files.mesh.placing import Placed, doubt_of, placed_body, turned
from geometry.files.mesh.reader import FileMesh, read_mesh_file
from geometry.files.shells import opens_at
from geometry.grading import OFF, Grading
from geometry.mesh import Mesh
from geometry.topology import find_rows


@final
@dataclass(frozen=True)
class MeshFile(FileDesign):
    """A mesh of tetrahedra with 4 or 10 nodes from a file (VTK, VTU, Abaqus, Nastran, Gmsh, MED, ...); lengths in mm.

    Its ends are flat faces in the planes x = clamp and x = tip, its cavities closed surfaces within it, chosen by a
    point in their air where there are several. A Gmsh file may name its faces instead, by physical groups: clamp, tip,
    cavity, further cavities whose names begin with cavity, and sym in the plane z = 0 of a half body. Named groups of
    elements (volumes of Gmsh, groups of MED and UNV, sets of Abaqus) are regions, which may have their own materials.
    Elements through which the material curve (y = curve, z = 0) passes are divided so that it runs along edges; all
    others stay as they are. The constructor reads and checks the file; its `DesignError` names the config key to
    change. The cells are nominal: equal parts of the length, about `cell` long.
    """

    family: ClassVar[str] = "mesh_file"
    has_drawing: ClassVar[bool] = False
    fills_inlets: ClassVar[bool] = False

    symmetric: Annotated[bool, "whether the file holds one half alone, z >= 0 or z <= 0"] = False
    cell: Annotated[float | None, "length over which curvature is averaged; that of equal chambers, or up to 10 mm"] = (
        None
    )
    plug: Annotated[bool, "whether an inlet in the plane of the clamp is closed there"] = False

    def _read(self) -> None:
        _ = self.fixed_body

    @cached_property
    def fixed_body(self) -> Body:
        """The body, moved along x so that its clamp is at x = 0, with the regions of `with_regions`."""
        mesh, half = self._placed.mesh, "sym" in self._placed.mesh.faces
        return Body(mesh, self.family, self.length, self.pitch, self.curve, half, self._placed.cavities)

    @cached_property
    def _placed(self) -> Placed:
        try:
            content = self._content
            chosen = replace(content, regions={name: content.regions[name] for name in self.regions})
            return placed_body(chosen, self, self.symmetric or "sym" in content.faces)
        except MeshError as error:
            raise DesignError("file", f"{error}{doubt_of(read_mesh_file(Path(self.file)))}") from error
        except DesignError as error:
            told = error.sentence + doubt_of(self._content) * error.keys[0].startswith("air")
            raise DesignError(error.keys, told, error.others) from error

    @cached_property
    def _content(self) -> FileMesh:
        """What the file says, in mm and in the directions of the arm; without names of faces if any is told by keys."""
        content = read_mesh_file(Path(self.file))
        if self.clamp is not None or self.tip is not None or self.air or self.plug:
            content = replace(content, faces={})
        return turned(content, self, self.symmetric or "sym" in content.faces)

    @cached_property
    def is_open_at_clamp(self) -> bool:
        """Whether a cavity is open in the plane of the clamp; the names of a file may say so too."""
        mesh, cavities = self.fixed_body.mesh, self.fixed_body.cavities
        return any(opens_at(mesh.points, mesh.faces[name], [(0, 0.0)]) for name in cavities)

    @property
    def given_element_size(self) -> float:
        return self.fixed_body.mesh.quality.longest_edge

    @property
    def why_no_cell(self) -> str:
        return "the law of a cell needs a drawing that can be cut between its cells; this body is a ready mesh"

    @property
    def is_turned(self) -> bool:
        return self._placed.turned

    @property
    def length(self) -> float:
        return self._placed.length

    @property
    def extent(self) -> tuple[float, float, float]:
        x, y, z = (float(side) for side in np.ptp(self.fixed_body.mesh.points, axis=0))
        return (x, y, 2 * z if self.fixed_body.half else z)

    @property
    def solid_volume(self) -> float:
        return self.fixed_body.volume

    @cached_property
    def cavity_volumes(self) -> Mapping[str, float]:
        return {name: self._halves * self.fixed_body.mesh.enclosed_volume(name) for name in self.fixed_body.cavities}

    @cached_property
    def chamber_ranges(self) -> Mapping[str, tuple[Range, ...]]:
        mesh = self._placed.mesh
        return {name: chambers_of(mesh.points, mesh.faces[name]) for name in self._placed.cavities}

    @cached_property
    def outer_corners(self) -> bool:
        mesh, cavities = self._placed.mesh, self._placed.cavities
        walls = np.vstack([mesh.faces[name] for name in cavities])
        return has_gaps(mesh.points, mesh.boundary[find_rows(mesh.boundary, walls, len(mesh.points)) < 0])

    @property
    def thinnest_wall(self) -> float:
        """The smallest side of the body, mm: a mesh does not tell its walls."""
        return min(self.extent)

    @property
    def straightened(self) -> Array:
        return self._content.straightened

    @property
    def _halves(self) -> int:
        """Number of times that the meshed volume is in the body."""
        return 2 if self.fixed_body.half else 1

    @cached_property
    def region_volumes(self) -> Mapping[str, float]:
        """Volume of each named group of elements (both halves), mm3."""
        points, content = self._content.points, self._content
        parts = {name: content.tets[rows] for name, rows in content.regions.items()}
        return {
            name: self._halves * Mesh(points, tets, {}, content.curved.usable(points, tets)).volume
            for name, tets in parts.items()
        }

    def with_regions(self, names: Iterable[str]) -> Self:
        chosen = super().with_regions(names)
        groups = self._content.regions
        for first, second in combinations(chosen.regions, 2):
            if np.intersect1d(groups[first], groups[second]).size:
                raise DesignError(
                    f"materials.{second}", f"the mesh has elements that belong to {first} and to {second}"
                )
        if chosen.regions:  # elements between regions are divided in another way
            for name in ("_placed", "fixed_body"):
                chosen.__dict__.pop(name, None)
            _ = chosen.fixed_body
        return chosen

    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The mesh of the file; `size` and `grading` are not used."""
        return self.fixed_body
