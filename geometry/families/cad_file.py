"""A body from a CAD file (STEP or BREP)."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from math import isfinite
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from geometry.design import Body, Design, DesignError, check_size
from geometry.foreign.file import SUFFIXES as MESH_SUFFIXES
from geometry.foreign.surface import SUFFIXES as SURFACE_SUFFIXES
from geometry.grading import OFF, Grading
from geometry.manifold import check_manifold
from geometry.meshing.cad import SUFFIXES, CadBody, CadMeasures, Point, measure, measure_thinnest_wall, mesh_cad
from geometry.meshing.cells import CellPlanes, Cells, find_cells, mesh_cells
from geometry.meshing.mirror import Repetition, slices


@final
@dataclass(frozen=True)
class CadFile(Design):
    """One solid from a STEP or BREP file; all lengths in mm.

    It is drawn in the frame of all bodies: x along the length, y up, z across, and symmetric about z = 0 (or the half
    z >= 0) unless `symmetric` is false. The constructor reads and checks the file; its `DesignError` names the config
    key to change. Faces: clamp, tip, sym, the cavities by their names, outer. The cells are nominal: equal parts of
    the length, about `cell` long, unless `cell` are two planes of mirror symmetry: then the body is meshed from equal
    cells and its two ends.
    """

    family: ClassVar[str] = "cad_file"

    file: str  #: path of the .step, .stp, .brep or .brp file
    clamp: float  #: x of the clamped end face
    tip: float  #: x of the other end face
    curve: float  #: y of the material curve
    air: Mapping[str, Point]  #: a point (x, y, z) in each cavity by its name; the first is pressurised
    symmetric: bool = True  #: whether only the half z >= 0 is meshed
    cell: float | CellPlanes = 10.0  #: nominal length of a cell, or two planes of [its symmetry](cell.md#own-bodies)
    unit: float = 1.0  #: mm per unit of length of a BREP file, which does not store its unit

    def __post_init__(self) -> None:
        path = Path(self.file)
        if path.suffix.lower() not in SUFFIXES:
            raise DesignError(
                "file",
                f"{path.name} is not a CAD file that can be read ({', '.join(SUFFIXES)}), nor a mesh "
                f"({', '.join(MESH_SUFFIXES)}) or a surface ({', '.join(SURFACE_SUFFIXES)})",
            )
        if not path.is_file():
            raise DesignError("file", f"{path} does not exist")
        for key, value in (("cell", self.cell), ("unit", self.unit)):
            if not isinstance(value, CellPlanes) and not (isfinite(value) and value > 0):
                raise DesignError(key, f"must be a positive length, not {value!r}")
        if not self.tip > self.clamp:
            raise DesignError(
                ("clamp", "tip"), f"the tip x = {self.tip:g} mm must lie beyond the clamp, {self.clamp:g} mm"
            )
        if not self.air:
            raise DesignError(
                "air", "name at least one cavity by a point in it, for example cavity: [50 mm, 8 mm, 0 mm]"
            )
        object.__setattr__(self, "air", dict(self.air))
        _ = self.measures, self.cells

    @cached_property
    def measures(self) -> CadMeasures:
        """Bounds (mm) and volumes (mm3) of the body (both halves)."""
        return measure(self._cad)

    @cached_property
    def cells(self) -> Cells | None:
        """Where the cells lie; None where it is not known."""
        return find_cells(self._cad, self.cell) if isinstance(self.cell, CellPlanes) else None

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file, so that results of an older file of the same name are not reused."""
        return sha256(Path(self.file).read_bytes()).hexdigest()

    @property
    def _cad(self) -> CadBody:
        return CadBody(Path(self.file), self.unit, self.clamp, self.tip, self.curve, self.symmetric, self.air)

    @property
    def length(self) -> float:
        return self.tip - self.clamp

    @property
    def extent(self) -> tuple[float, float, float]:
        x, y, z = (float(side) for side in np.subtract(self.measures.high, self.measures.low))
        return (x, y, z)

    @property
    def curve_y(self) -> float:
        return self.curve

    @property
    def pitch(self) -> float:
        if isinstance(self.cell, CellPlanes):
            return 2 * self.cell.half_pitch
        return slices(self.length, self.cell)[1]

    @property
    def solid_volume(self) -> float:
        return self.measures.solid_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        return {name: self.measures.air_volumes[name] for name in self.air}

    @cached_property
    def thinnest_wall(self) -> float:
        return measure_thinnest_wall(self._cad)

    @property
    def repeats(self) -> bool:
        return self.cells is not None

    def repetition(self, size: float, grading: Grading) -> Repetition:
        if self.cells is None:
            return super().repetition(size, grading)
        if (size, grading) not in self._meshed:
            self._meshed[size, grading] = mesh_cells(self._cad, self.cells, size, grading)
        return self._meshed[size, grading]

    @cached_property
    def _meshed(self) -> dict[tuple[float, Grading], Repetition]:
        """Repetitions by size and grading, because a CAD file takes long to read and cut."""
        return {}

    def body(self, size: float, grading: Grading = OFF) -> Body:
        check_size(size, self.extent, self.solid_volume / (2 if self.symmetric else 1))
        mesh = self.repetition(size, grading).mesh() if self.repeats else mesh_cad(self._cad, size, grading)
        check_manifold(mesh)
        return self._body(mesh, self.length, self.symmetric)
