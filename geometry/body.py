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
        points, tolerance = self.mesh.points, 1e-7 * self.length
        on_curve = (np.abs(points[:, 1] - self.curve_y) < tolerance) & (np.abs(points[:, 2]) < tolerance)
        vertices = np.flatnonzero(on_curve)
        vertices = vertices[np.argsort(points[vertices, 0], kind="stable")]
        x = points[vertices, 0]
        curve = f"the material curve y = {self.curve_y:g} mm, z = 0; cut the body along it before meshing it"
        if len(vertices) < 2 or abs(x[0]) > tolerance or abs(x[-1] - self.length) > tolerance:
            raise MeshError(f"the mesh has no vertex at each end of {curve}")
        if not self.mesh.has_edges(np.column_stack([vertices[:-1], vertices[1:]])).all():
            raise MeshError(f"the mesh has no edges along {curve}")
        vertices.setflags(write=False)
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
