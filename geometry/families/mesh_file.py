"""A body from a mesh file with named faces."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from math import isfinite
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from geometry.design import Body, Design, DesignError
from geometry.grading import OFF, Grading
from geometry.manifold import check_half, check_manifold, check_untangled
from geometry.mesh import Mesh, MeshError
from geometry.meshing.cad import LARGEST, SMALLEST
from geometry.meshing.mirror import slices


@final
@dataclass(frozen=True)
class MeshFile(Design):
    """A mesh of tetrahedra from a file (Gmsh .msh) whose physical groups name its faces; lengths in mm.

    Required groups: clamp and tip (flat, in planes x = const), cavity; further cavities are the groups whose names
    begin with cavity. A group sym in the plane z = 0 makes it a half body. The material curve (y = curve, z = 0, from
    clamp to tip) must run along element edges. The constructor reads and checks the file; its `DesignError` names the
    config key to change. The cells are nominal: equal parts of the length, about `cell` long.
    """

    family: ClassVar[str] = "mesh_file"

    file: str  #: path of the mesh
    curve: float  #: y of the material curve
    cell: float = 10.0  #: length over which curvature is averaged, nominal
    unit: float = 1.0  #: mm per unit of length in the file

    def __post_init__(self) -> None:
        for key in ("cell", "unit"):
            if not (isfinite(getattr(self, key)) and getattr(self, key) > 0):
                raise DesignError(key, f"must be a positive length, not {getattr(self, key)!r}")
        _ = self.fixed_body

    @cached_property
    def fixed_body(self) -> Body:
        """The body, moved along x so that its clamp is at x = 0."""
        try:
            return self._read()
        except MeshError as error:
            raise DesignError("file", str(error)) from error

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file, so that results of an older file of the same name are not reused."""
        return sha256(Path(self.file).read_bytes()).hexdigest()

    def _read(self) -> Body:
        mesh = Mesh.read(self.file)
        check_manifold(mesh)
        check_untangled(mesh)
        if "sym" in mesh.faces:
            check_half(mesh)
        mesh, length = self._in_frame(mesh)
        names = tuple(sorted(name for name in mesh.faces if name.startswith("cavity")))
        if "cavity" not in names:
            raise MeshError(f"the mesh has no face named cavity; it has {', '.join(mesh.faces)}")
        for name in names:
            if not mesh.enclosed_volume(name) > 0:
                raise MeshError(f"the face {name} encloses material, not air")
        pitch = slices(length, self.cell)[1]
        return Body(mesh, self.family, length, pitch, self.curve, "sym" in mesh.faces, names)

    def _in_frame(self, mesh: Mesh) -> tuple[Mesh, float]:
        """The mesh in mm, with its clamp at x = 0, and its length (mm). Raises `MeshError` or `DesignError`."""
        points = mesh.points * self.unit
        sides = np.ptp(points, axis=0)
        if not SMALLEST <= sides.max() <= LARGEST:
            measures = " x ".join(f"{side:.4g}" for side in sides)
            raise DesignError(
                ("file", "unit"), f"the body measures {measures} mm; is its file in another unit than {self.unit:g} mm?"
            )
        ends = []
        for name in ("clamp", "tip"):
            if name not in mesh.faces:
                raise MeshError(f"the mesh has no face named {name}; it has {', '.join(mesh.faces)}")
            x = points[np.unique(mesh.faces[name]), 0]
            if np.ptp(x) > 1e-6 * sides.max():
                raise MeshError(
                    f"the face {name} must be flat, in a plane x = const; its x varies by {np.ptp(x):.3g} mm"
                )
            ends.append(float(x.mean()))
        if not ends[1] > ends[0]:
            raise MeshError("the tip must lie at a greater x than the clamp")
        return Mesh(points - [ends[0], 0, 0], mesh.tets, mesh.faces), ends[1] - ends[0]

    @property
    def length(self) -> float:
        return self.fixed_body.length

    @property
    def extent(self) -> tuple[float, float, float]:
        x, y, z = (float(side) for side in np.ptp(self.fixed_body.mesh.points, axis=0))
        return (x, y, 2 * z if self.fixed_body.half else z)

    @property
    def curve_y(self) -> float:
        return self.curve

    @property
    def pitch(self) -> float:
        return self.fixed_body.pitch

    @property
    def solid_volume(self) -> float:
        return self._halves * self.fixed_body.mesh.volume

    @cached_property
    def cavity_volumes(self) -> Mapping[str, float]:
        return {name: self._halves * self.fixed_body.mesh.enclosed_volume(name) for name in self.fixed_body.cavities}

    @property
    def thinnest_wall(self) -> float:
        """The smallest side of the body, mm: a mesh does not tell its walls."""
        return min(self.extent)

    @property
    def _halves(self) -> int:
        """Number of times that the meshed volume is in the body."""
        return 2 if self.fixed_body.half else 1

    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The mesh of the file; `size` and `grading` are not used."""
        return self.fixed_body
