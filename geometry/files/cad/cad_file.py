"""A body from a CAD file (STEP or BREP)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, final

import numpy as np

from geometry.body import Body
from geometry.errors import DesignError, MeshError
from geometry.files.cad.body import CadMeasures, edges_of, measure, measure_gaps, measure_thinnest_wall, mesh_cad
from geometry.files.cad.cells import CellPlanes, Cells, find_cells, mesh_cells
from geometry.files.cad.solids import SUFFIXES, CadBody, CadSource, air_left_out, file_bounds
from geometry.files.chambers import Range, as_drawn
from geometry.files.frame import PITCHES, Point, rotation
from geometry.files.from_file import FileDesign
from geometry.files.mesh.reader import SUFFIXES as MESH_SUFFIXES
from geometry.files.surface.triangles import SUFFIXES as SURFACE_SUFFIXES
from geometry.grading import OFF, Grading
from geometry.manifold import check_manifold
from geometry.mesh import Mesh
from geometry.meshing.mirror import Repetition


@final
@dataclass(frozen=True)
class CadFile(FileDesign):
    """One solid from a STEP or BREP file, or several of which some are of another material; all lengths in mm.

    In the frame of the arm (`axes`, `middle`) x is along the length, y up, z across, and the body is symmetric about
    z = 0 unless `symmetric` is false; one half of such a body needs `symmetric` true. The constructor reads and checks
    the file; its `DesignError` names the config key to change. Faces: clamp, tip, sym, the cavities by their names,
    outer. The body is meshed from equal cells and its two ends where `cell` are two planes of mirror symmetry of the
    cells, or where it is not given and such planes are in and between equal chambers (three or more), or anywhere in an
    arm with one section. Otherwise the cells are nominal: equal parts of the length, about `cell` long.
    """

    family: ClassVar[str] = "cad_file"

    symmetric: Annotated[bool | None, "`true` if the file holds one half alone, `false` for halves that differ"] = None
    unite: Annotated[bool, "whether several solids that touch become one"] = False
    parts: Annotated[Mapping[str, Point], "a point in each solid of another material"] = field(default_factory=dict)

    def _read(self) -> None:
        clamp, tip = self._ends
        if isinstance(self.cell, CellPlanes) and tip < clamp:
            raise DesignError("cell", "must be a length where the arm is clamped at its larger x, or turn it with axes")
        _ = self.measures
        if isinstance(self.cell, CellPlanes):
            _ = self.cells

    def _wrong_values(self) -> Iterator[DesignError]:
        path = Path(self.file)
        if path.suffix.lower() not in SUFFIXES:
            known = ", ".join((*SUFFIXES, *MESH_SUFFIXES, *SURFACE_SUFFIXES))
            yield DesignError("file", f"{path.name} cannot be read; it may end with {known}")
        elif not path.is_file():
            yield DesignError("file", f"{path} does not exist")
        yield from super()._wrong_values()
        if self.parts and self.unite:
            yield DesignError(("parts", "unite"), "solids of another material stay apart; give one of the two")
        if self.parts and isinstance(self.cell, CellPlanes):
            yield DesignError("cell", "must be a length where the body has parts, and so no law of its own")

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """x of clamp and tip, mm, before the body is turned."""
        low, high = file_bounds(self._source())
        return self.ends_between(low[0], high[0])

    @cached_property
    def measures(self) -> CadMeasures:
        """Bounds (mm) and volumes (mm3) of the body (both halves)."""
        return measure(self._cad)

    @cached_property
    def edges(self) -> tuple[tuple[float, str], ...]:
        """Length (mm) of each edge of the body in the file, and where its middle is, the shortest first."""
        return edges_of(self._cad)

    @cached_property
    def left_out(self) -> str:
        return air_left_out(self._source())

    @property
    def cells(self) -> Cells | None:
        """Where the cells lie; None where it is not known."""
        return self._cells_or_reason[0]

    @property
    def pitch(self) -> float:
        """Pitch of the cells; the usual one for an arm that is too short for five parameters of such cells."""
        if self.cell is None and not self.has_equal_chambers:
            return super().pitch  # cells of an arm with one section are as long
        if self.cells is None or self.length < PITCHES * 2 * self.cells.half_pitch:
            return super().pitch
        return 2 * self.cells.half_pitch

    @property
    def why_no_cell(self) -> str:
        return self._cells_or_reason[1] or super().why_no_cell

    @cached_property
    def _cells_or_reason(self) -> tuple[Cells | None, str]:
        """The cells, or why equal chambers are not those of cells, if there are any."""
        if isinstance(self.cell, CellPlanes):
            return find_cells(self._cad, self.cell), ""
        middles = self.chamber_middles
        if self.cell is not None or self.parts or (middles and not self.has_equal_chambers):
            return None, ""
        middle, pitch = self.length / 2 + self._cad.clamp, super().pitch
        if middles:
            middle, pitch = as_drawn(middles[len(middles) // 2]), as_drawn(float(np.median(np.diff(middles))))
            for name, chambers in self.chamber_ranges.items():
                if not chambers[0][0] < middles[0] < middles[-1] < chambers[-1][1]:
                    return None, _unequal(pitch, f"the cavity {name} does not go through all of them")
        try:
            return find_cells(self._cad, CellPlanes(middle, middle + pitch / 2)), ""
        except (DesignError, MeshError) as refused:
            reason = refused.sentence if isinstance(refused, DesignError) else str(refused)
            return None, _unequal(pitch, reason) if middles else ""

    def _source(self, around: bool = False) -> CadSource:
        """around: whether the arm is turned about y by half a turn."""
        turn, shift = rotation(self.axes), -self.middle
        if around:
            turn, shift = np.diag([-1.0, 1.0, -1.0]) @ turn, self.middle
        return CadSource(Path(self.file), self.unit, turn, self.unite, bool(self.parts), shift)

    @cached_property
    def _cad(self) -> CadBody:
        """The body with its clamp at the smaller x.

        An arm that is clamped at its larger x is turned about y by half a turn; a symmetric one has its halves
        exchanged by that, so that z keeps its sign; a half z <= 0 is mirrored when it is read.
        """
        clamp, tip = self._ends
        air, parts, turned = dict(self.air), dict(self.parts), tip < clamp
        plugs = dict(self.plug) if isinstance(self.plug, Mapping) else {}
        if turned:
            clamp, tip = -clamp, -tip
            side = 1.0 if self._half else -1.0
            air, parts, plugs = (
                {name: (-x, y, side * z) for name, (x, y, z) in given.items()} for given in (air, parts, plugs)
            )
        return CadBody(
            self._source(turned),
            clamp=clamp,
            tip=tip,
            curve=self.curve,
            half=self._half,
            air=air,
            parts=parts,
            plug_at_clamp=self.is_open_at_clamp,
            plugs=plugs,
            turned=turned,
            says_half=self.symmetric is True,
        )

    @property
    def _half(self) -> bool:
        """Whether only the half z >= 0 is meshed."""
        return self.symmetric is not False

    @property
    def halves_differ(self) -> bool:
        return self.symmetric is False

    @property
    def has_parts(self) -> bool:
        return bool(self.parts)

    @property
    def is_turned(self) -> bool:
        return self._cad.turned

    @property
    def length(self) -> float:
        return self._cad.tip - self._cad.clamp

    @property
    def extent(self) -> tuple[float, float, float]:
        x, y, z = (float(side) for side in np.subtract(self.measures.high, self.measures.low))
        return (x, y, z)

    @property
    def solid_volume(self) -> float:
        return self.measures.solid_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        return {name: self.measures.air_volumes[name] for name in self._cad.cavities}

    @property
    def chamber_ranges(self) -> Mapping[str, tuple[Range, ...]]:
        return self.measures.chambers

    @property
    def region_volumes(self) -> Mapping[str, float]:
        return self.measures.part_volumes

    @property
    def plug_depths(self) -> Mapping[str, float]:
        return self.measures.plug_depths

    @cached_property
    def thinnest_wall(self) -> float:
        return measure_thinnest_wall(self._cad)

    @cached_property
    def outer_corners(self) -> bool:
        return measure_gaps(self._cad)

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

    @property
    def meshed_volume(self) -> float:
        return self.solid_volume / (2 if self._half else 1)

    def body(self, size: float, grading: Grading = OFF) -> Body:
        self.check_size(size)
        mesh = self._of_cells(size, grading) or self._checked(mesh_cad(self._cad, size, grading))
        return self._body(mesh, self.length, self._half)

    def _of_cells(self, size: float, grading: Grading) -> Mesh | None:
        """The mesh of equal cells; None where there are none, or where cells that nobody named cannot be meshed."""
        if not self.repeats:
            return None
        try:
            return self._checked(self.repetition(size, grading).mesh())
        except (DesignError, MeshError):
            if self.cell is not None:
                raise
            return None

    def _checked(self, mesh: Mesh) -> Mesh:
        mesh = replace(mesh, regions={name: mesh.regions[name] for name in self.regions})
        check_manifold(mesh)
        return mesh


def _unequal(pitch: float, reason: str) -> str:
    """Say why equal chambers are not those of cells."""
    return f"its chambers are {pitch:.4g} mm apart, but {reason}; name the planes of a cell with geometry.cell"
