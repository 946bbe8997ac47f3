"""A meshed body in its frame, with the material curve along mesh edges."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError
from geometry.mesh import Mesh


@dataclass(frozen=True)
class Body:
    """A meshed body in its frame: x along the length from the clamp, y up, z across, z = 0 the plane of symmetry.

    Raises `MeshError` when a named face is missing, or when the material curve (y = curve_y, z = 0, 0 <= x <= length)
    does not run along mesh edges.
    """

    mesh: Mesh
    name: str
    length: float  #: of the material curve, mm
    pitch: float  #: length of the repeated cell, over which curvature is averaged, mm
    curve_y: float  #: height of the material curve, mm
    half: bool = True  #: only z >= 0 is meshed
    cavities: tuple[str, ...] = ("cavity",)  #: names of the faces that enclose air; the first is pressurised

    def __post_init__(self) -> None:
        required = ("clamp", "tip", *self.cavities, *(["sym"] * self.half))
        missing = [name for name in required if name not in self.mesh.faces]
        if missing:
            raise MeshError(f"the body {self.name} has no face named {missing[0]}; it has {', '.join(self.mesh.faces)}")
        _ = self.curve_vertices

    @property
    def volume(self) -> float:
        """Volume of the material (both halves), mm3."""
        return (2 if self.half else 1) * self.mesh.volume

    @cached_property
    def curve_vertices(self) -> Index:
        """Indices (k,) of the mesh vertices on the material curve, by increasing x; read-only."""
        vertices, gap = curve_in(self.mesh, self.curve_y, self.length)
        if gap is not None:
            curve = f"the material curve y = {self.curve_y:g} mm, z = 0, from x = {gap[0]:.4g} to {gap[1]:.4g} mm"
            raise MeshError(f"the mesh has no edges along {curve}; cut the body along it before meshing it")
        return vertices

    def edge(self, face: str) -> Array:
        """Vertices (k, 3) of a named face at the height of the material curve, by increasing z, mm."""
        points = self.mesh.points[np.unique(self.mesh.faces[face])]
        on = points[np.abs(points[:, 1] - self.curve_y) < 1e-7 * self.length]
        return np.asarray(on[np.argsort(on[:, 2])])

    @property
    def top(self) -> Array:
        """(3,) the highest vertex of the plane z = 0, mm."""
        points = self.mesh.points[np.abs(self.mesh.points[:, 2]) < 1e-9 * self.length]
        return np.asarray(points[int(np.argmax(points[:, 1]))])

    def full(self) -> "Body":
        """The body with both halves, mirrored at z = 0; itself when both halves are meshed already."""
        if not self.half:
            return self
        return Body(self.mesh.mirrored(), self.name, self.length, self.pitch, self.curve_y, False, self.cavities)


def curve_in(mesh: Mesh, curve_y: float, length: float) -> tuple[Index, tuple[float, float] | None]:
    """The vertices (k,) on the line y = curve_y, z = 0, by increasing x, read-only, and from where to where (x, mm) it
    does not run along edges for the first time; None where it does from 0 to `length`."""
    points, tolerance = mesh.points, 1e-7 * length
    on = np.flatnonzero((np.abs(points[:, 1] - curve_y) < tolerance) & (np.abs(points[:, 2]) < tolerance))
    on = on[np.argsort(points[on, 0], kind="stable")]
    on.setflags(write=False)
    stops = [0.0, *map(float, points[on, 0]), length]
    pairs = np.column_stack([on[:-1], on[1:]])
    inner = mesh.has_edges(pairs) if len(pairs) else np.zeros(0, dtype=bool)
    filled = [abs(stops[1]) <= tolerance, *inner, abs(stops[-2] - length) <= tolerance]
    return on, next(((stops[k], stops[k + 1]) for k, ok in enumerate(filled) if not ok), None)
