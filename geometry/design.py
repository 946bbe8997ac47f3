"""Designs: dimensions that are checked on birth, and the meshed body they give."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from math import isfinite
from typing import Any, ClassVar

import numpy as np

from geometry.grading import OFF, Grading
from geometry.mesh import Mesh, MeshError
from geometry.topology import Array

#: A mesh with more elements than this does not fit the memory of the machines this program is written for.
MOST_TETS = 3_000_000
#: Volume of a regular tetrahedron over the cube of its edge.
REGULAR_TET = 1 / (6 * 2**0.5)
#: Tetrahedra that walls thinner than the elements cost, over half the surface of the box around the body in squares of
#: the element size: 10 to 38 in bodies of all four families with elements of 2.5 to 8 mm.
TETS_PER_SQUARE = 15.0
#: Dimensions in mm between which Gmsh is known to draw these bodies: a micrometre and a kilometre.
SHORTEST, LONGEST = 1e-3, 1e6
#: A chamber has 140 elements at least (measured), so twice as many cannot be meshed with elements of any size.
MOST_CHAMBERS = 10_000


class DesignError(ValueError):
    """Dimensions that no body can have.

    `keys` are the names of the dimensions as they stand in a config (`("wall", "chamber_length")`), `sentence` says
    what is allowed.
    """

    def __init__(self, keys: str | Sequence[str], sentence: str) -> None:
        self.keys: tuple[str, ...] = (keys,) if isinstance(keys, str) else tuple(keys)
        self.sentence = sentence
        super().__init__(f"{', '.join(self.keys)}: {sentence}")


@dataclass(frozen=True)
class Body:
    """A meshed body in its frame: x along the length from the clamp, y up, z across, z = 0 the plane of symmetry.

    Raises `MeshError` when the material curve y = curve_y, z = 0, 0 <= x <= length does not run along mesh edges.
    """

    mesh: Mesh
    name: str
    length: float  #: of the material curve, mm
    pitch: float  #: length of the repeated cell, over which curvature is averaged, mm
    curve_y: float  #: height of the material curve, mm
    half: bool = True  #: only z >= 0 is meshed
    cavities: tuple[str, ...] = ("cavity",)  #: names of the face groups that enclose air

    def __post_init__(self) -> None:
        missing = [
            name for name in ("clamp", "tip", *self.cavities, *(["sym"] * self.half)) if name not in self.mesh.faces
        ]
        if missing:
            raise MeshError(f"the body {self.name} has no face named {missing[0]}; it has {', '.join(self.mesh.faces)}")
        _ = self.curve_vertices

    @cached_property
    def curve_vertices(self) -> Array:
        """Indices (k,) of the mesh vertices on the material curve, by increasing x."""
        points, tolerance = self.mesh.points, 1e-7 * self.length
        on = (np.abs(points[:, 1] - self.curve_y) < tolerance) & (np.abs(points[:, 2]) < tolerance)
        found = np.flatnonzero(on)
        found = found[np.argsort(points[found, 0], kind="stable")]
        x = points[found, 0]
        if len(found) < 2 or abs(x[0]) > tolerance or abs(x[-1] - self.length) > tolerance:
            raise MeshError(
                f"the material curve y = {self.curve_y:g} mm, z = 0 from x = 0 to {self.length:g} mm "
                "has no mesh vertex at each of its ends; cut the body along that line before meshing it"
            )
        if not self.mesh.has_edges(np.column_stack([found[:-1], found[1:]])).all():
            raise MeshError(
                f"the material curve y = {self.curve_y:g} mm, z = 0 does not run along mesh edges; "
                "cut the body along that line before meshing it"
            )
        found.setflags(write=False)
        return found

    def full(self) -> "Body":
        """The whole body, mirrored at z = 0 (itself when it is whole already)."""
        if not self.half:
            return self
        return Body(self.mesh.mirrored(), self.name, self.length, self.pitch, self.curve_y, False, self.cavities)


class Design(ABC):
    """The dimensions of one family of bodies, all lengths in mm.

    A final class is a frozen dataclass whose fields carry the names of the keys of a config. Impossible dimensions
    raise `DesignError` on birth.
    """

    family: ClassVar[str]

    @property
    @abstractmethod
    def cavities(self) -> tuple[str, ...]:
        """Names of the face groups that enclose air; the first is the one that is pressurised."""

    @property
    @abstractmethod
    def length(self) -> float:
        """Length of the body along x, which is the rest length of the material curve, mm."""

    @property
    @abstractmethod
    def extent(self) -> tuple[float, float, float]:
        """Size of the whole body along x, y and z, mm."""

    @property
    @abstractmethod
    def curve_y(self) -> float:
        """Height of the material curve (it runs along y = curve_y, z = 0 from x = 0 to length), mm."""

    @property
    @abstractmethod
    def pitch(self) -> float:
        """Length of one cell, mm."""

    @property
    @abstractmethod
    def cells(self) -> Array:
        """Boundaries along x of the cells over which curvature is averaged, increasing, (k,), mm."""

    @property
    @abstractmethod
    def solid_volume(self) -> float:
        """Volume of the material of the whole body, exact, mm3."""

    @property
    @abstractmethod
    def cavity_volume(self) -> float:
        """Volume of the air in the whole body that is pressurised, exact, mm3."""

    @abstractmethod
    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The meshed body; `size` is the largest length of an element edge that the mesher aims at, mm.

        Raises `DesignError` on the key `mesh.size` when the size does not suit the body.
        """

    @property
    def width(self) -> float:
        """Size of the whole body along z, mm."""
        return self.extent[2]


class SymmetricDesign(Design):
    """A design whose two halves about z = 0 are mirror images, so that only z >= 0 is meshed."""

    @abstractmethod
    def half_mesh(self, size: float, grading: Grading) -> Mesh:
        """Mesh of the half z >= 0 with elements of at most `size` mm (already checked against the body)."""

    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The meshed half z >= 0; `size` is the largest length of an element edge that Gmsh aims at, mm.

        Raises `DesignError` on the key `mesh.size` when the size does not suit the body.
        """
        check_size(size, self.extent, self.solid_volume / 2)
        mesh = self.half_mesh(size, grading)
        return Body(mesh, self.family, self.length, self.pitch, self.curve_y, True, self.cavities)


def expected_tets(size: float, extent: Sequence[float], volume: float) -> float:
    """About how many elements of `size` mm a body of that extent (mm, along x, y, z) and meshed volume (mm3) has."""
    return max(volume / (REGULAR_TET * size**3), TETS_PER_SQUARE * _sides(extent) / size**2)


def _sides(extent: Sequence[float]) -> float:
    """Half the surface of the box around a body, mm2."""
    length, height, width = extent
    return length * height + height * width + width * length


def check_size(size: float, extent: Sequence[float], volume: float) -> None:
    """Refuse a mesh size (mm) that does not suit a body of that extent (mm, along x, y, z) and meshed volume (mm3)."""
    measures, largest = " x ".join(f"{side:g}" for side in extent), min(extent)
    if not SHORTEST <= size <= LONGEST:
        raise DesignError("mesh.size", f"must be a length from {SHORTEST:g} mm to {LONGEST:g} mm, not {size:g} mm")
    if size > largest:
        raise DesignError(
            "mesh.size",
            f"{size:g} mm is larger than the body, which measures {measures} mm; at most {largest:g} mm",
        )
    count, least = (expected_tets(one, extent, volume) for one in (size, largest))
    if least > MOST_TETS:
        raise DesignError(
            "mesh.size",
            f"a body of {measures} mm has about {least:.0e} elements even where they are as large as it is thick, and "
            f"at most {MOST_TETS:.0e} fit into memory; choose a shorter body",
        )
    if count > MOST_TETS:
        filled, walled = volume / (REGULAR_TET * MOST_TETS), TETS_PER_SQUARE * _sides(extent) / MOST_TETS
        enough = max(filled ** (1 / 3), walled**0.5)
        raise DesignError(
            "mesh.size",
            f"{size:g} mm would give about {count:.0e} elements in a body of {measures} mm; at least {enough:.2g} mm",
        )


def check_numbers(design: Any, counts: Sequence[str] = ()) -> None:
    """Every field of a dataclass must be a length that can be drawn; those named in `counts` a whole number from 1."""
    for field in fields(design):
        value = getattr(design, field.name)
        if field.name in counts:
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise DesignError(field.name, f"must be a whole number of at least 1, not {value!r}")
            if value > MOST_CHAMBERS:
                raise DesignError(field.name, f"at most {MOST_CHAMBERS} fit into memory")
        elif isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value) or value <= 0:
            raise DesignError(field.name, f"must be a positive length, not {value!r}")
        elif not SHORTEST <= value <= LONGEST:
            raise DesignError(field.name, f"must lie between {SHORTEST:g} mm and {LONGEST:g} mm, not be {value:g} mm")


def check_less(design: Any, small: str, large: str, share: float = 1.0, because: str = "") -> None:
    """The field `small` must be less than `share` times the field `large`."""
    value, bound = getattr(design, small), share * getattr(design, large)
    if not value < bound:
        part = {1.0: "", 0.5: "half of "}[share]
        raise DesignError(
            (small, large),
            f"{small} {value:g} mm must be less than {part}{large}, {bound:g} mm{because and ': ' + because}",
        )
