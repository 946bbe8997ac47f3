"""A body from the closed surface in a file, filled with elements."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, ClassVar, final

import numpy as np

from geometry.arrays import Array, Index
from geometry.body import Body
from geometry.errors import DesignError, MeshError
from geometry.files.chambers import Range, chambers_of, has_gaps
from geometry.files.frame import check_dimensions, misplaced, no_end_face
from geometry.files.from_file import FLAT, FileDesign
from geometry.files.mesh.placing import Placed, ends_of, placed_body, walls_of_air
from geometry.files.shells import enclosed, lies_in, parts_of
from geometry.files.surface.inlets import fill_surface_inlets
from geometry.files.surface.triangles import NotFilled, Surface, fill, read_surface, thinnest
from geometry.grading import OFF, Grading

#: largest difference between the volumes of the mesh (or its air) and of the surface, over that of the surface
LARGEST_ERROR = 0.01
#: what is tried where elements are too large for round walls, over the size that was asked for
FINER = (0.65, 0.4)


@final
@dataclass(frozen=True)
class SurfaceFile(FileDesign):
    """The closed surface of a body from a file (STL, PLY, OBJ or OFF): its outside and the walls of its air; mm.

    Gmsh fills it with elements. Its ends are flat faces in the planes x = clamp and x = tip; cavities are the closed
    parts of the surface inside, chosen by a point in their air where there are several. The constructor reads and
    checks the file; its `DesignError` names the config key to change. Both halves are meshed. The cells are nominal.
    """

    family: ClassVar[str] = "surface_file"
    has_drawing: ClassVar[bool] = False

    cell: Annotated[float | None, "length over which curvature is averaged; that of equal chambers, or up to 10 mm"] = (
        None
    )

    def _read(self) -> None:
        _ = self.surface, self.length
        low, high = self.surface.points.min(axis=0), self.surface.points.max(axis=0)
        if not low[2] < 0 < high[2] or min(-low[2], high[2]) <= FLAT * max(self.extent):
            raise misplaced(low, high, self.middle, self.is_reoriented)
        for name, x in zip(("clamp", "tip"), self._ends, strict=True):
            if not lies_in(self.surface.points, self.surface.triangles, (0, x), self._tolerance).any():
                raise no_end_face(name, x)
        _ = self.cavity_volumes

    @cached_property
    def surface(self) -> Surface:
        """The surface in mm and in the directions of the arm, with the inlets filled."""
        return self._plugged[0]

    @property
    def plug_depths(self) -> Mapping[str, float]:
        return self._plugged[1]

    @cached_property
    def _plugged(self) -> tuple[Surface, Mapping[str, float]]:
        """The surface, and the depths of the plugs in its inlets, mm."""
        surface = read_surface(Path(self.file))
        surface = replace(surface, points=self.in_frame(surface.points))
        check_dimensions(np.ptp(surface.points, axis=0))
        return fill_surface_inlets(surface, self.plug) if isinstance(self.plug, Mapping) else (surface, {})

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """x of clamp and tip, mm."""
        return ends_of(self.surface.points, self, {})

    @property
    def why_no_cell(self) -> str:
        return "the law of a cell needs a drawing that can be cut between its cells; this body is a surface"

    @property
    def is_turned(self) -> bool:
        return self._ends[1] < self._ends[0]

    @property
    def length(self) -> float:
        return abs(self._ends[1] - self._ends[0])

    @property
    def extent(self) -> tuple[float, float, float]:
        x, y, z = (float(side) for side in np.ptp(self.surface.points, axis=0))
        return (x, y, z)

    @property
    def solid_volume(self) -> float:
        return self.surface.volume

    @property
    def meshed_volume(self) -> float:
        return self.solid_volume

    @cached_property
    def cavity_volumes(self) -> Mapping[str, float]:
        points = self.surface.points - [self._ends[0], 0.0, 0.0]
        return {name: -enclosed(points, walls) for name, walls in self._cavities.items()}

    @cached_property
    def chamber_ranges(self) -> Mapping[str, tuple[Range, ...]]:
        direction, points = self._from_clamp
        return {
            name: tuple(sorted((min(direction * x), max(direction * x)) for x in np.array(chambers_of(points, walls))))
            for name, walls in self._cavities.items()
        }

    @cached_property
    def outer_corners(self) -> bool:
        return has_gaps(self._from_clamp[1], self._parts[0])

    @property
    def _from_clamp(self) -> tuple[float, Array]:
        """1, or -1 where the clamp is at the larger x, and the points with the clamp at the smaller one: where an inlet
        is open in its plane walls are missing there, and sections are those of what lies at larger x."""
        direction = -1.0 if self.is_turned else 1.0
        return direction, self.surface.points * [direction, 1.0, 1.0]

    @cached_property
    def _parts(self) -> tuple[Index, list[Index]]:
        """Triangles of the outside, and those around the air of each cavity."""
        clamp = self._ends[0] if self.is_open_at_clamp else None
        return parts_of(self.surface.points, self.surface.triangles, clamp, self._tolerance)

    @property
    def _tolerance(self) -> float:
        return FLAT * float(np.ptp(self.surface.points, axis=0).max())

    @cached_property
    def _cavities(self) -> Mapping[str, Index]:
        """Triangles (k, 3) around the air of each cavity, by its name. Raises `DesignError`."""
        points, triangles = self.surface.points, self.surface.triangles
        return walls_of_air(points, triangles, triangles, self._ends, self)

    @cached_property
    def thinnest_wall(self) -> float:
        return min(thinnest(self.surface), min(self.extent))

    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The meshed body; elements have one size, `grading` is not used.

        Where elements of `size` do not follow round walls (`LARGEST_ERROR`), smaller ones are taken, down to 0.4 of it.
        """
        self.check_size(size)
        placed, off = self._placed(size)
        for part in FINER:
            if off <= LARGEST_ERROR:
                break
            placed, off = self._placed(part * size)
        if off > LARGEST_ERROR:
            wrong = f"with {size:g} mm the mesh does not follow the round walls: its volume is off by {100 * off:.2g} %"
            raise DesignError("mesh.size", f"{wrong}; take at most {FINER[-1] * size / 1.5:.2g} mm")
        return Body(placed.mesh, self.family, placed.length, self.pitch, self.curve, False, placed.cavities)

    def _placed(self, size: float) -> tuple[Placed, float]:
        """The mesh, and by how much its volume or that of its air is off, over that of the surface."""
        try:
            placed = placed_body(fill(self.surface, size), self, half=False)
        except MeshError as error:
            key = "mesh.size" if isinstance(error, NotFilled) else "file"
            raise DesignError(key, str(error)) from error
        offs = [placed.mesh.volume / self.solid_volume - 1]
        offs += [placed.mesh.enclosed_volume(name) / air - 1 for name, air in self.cavity_volumes.items()]
        return placed, max(map(abs, offs))
