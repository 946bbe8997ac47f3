"""Designs: the checked dimensions of a body family, and the meshed body they give."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import fields, replace
from itertools import pairwise
from typing import ClassVar, Self

import numpy as np

from geometry.arrays import Array
from geometry.body import Body
from geometry.errors import DesignError, raise_together
from geometry.families.dimensions import LONGEST, SHORTEST, check_design
from geometry.grading import OFF, Grading
from geometry.mesh import Mesh
from geometry.meshing.mirror import Repetition
from geometry.meshing.moving import Drawing, Movement, movements
from geometry.meshing.shapes import Box, Shape
from geometry.meshing.solid import mesh_solid

#: Largest number of elements that is meshed: more do not fit into the memory of a workstation.
MOST_TETS = 3_000_000
#: Volume of a regular tetrahedron over the cube of its edge.
REGULAR_TET = 1 / (6 * 2**0.5)
#: Elements of a body whose walls are thinner than the element size h, per area h^2 of half the surface of its bounding
#: box. Bodies of all families have at least 9.
TETS_PER_SQUARE = 15.0
#: Part of a pitch that is rounding, of a length read off a drawing for example.
ROUNDING_OF_PITCH = 0.01
#: Change of a dimension in difference quotients of the drawing, over it.
STEP_OF_DIMENSION = 1e-3


class Design(ABC):
    """The dimensions of one body family, all lengths in mm.

    A family is a frozen dataclass whose fields have the names of the config keys, each with its meaning beside its type
    (`Annotated`). It defines the members below that are abstract, and its constructor raises `DesignError` for
    impossible dimensions.
    """

    family: ClassVar[str]  #: the name of the family in a config
    lists: ClassVar[Mapping[str, str]] = {}  #: dimensions that are lists, and those that they are given instead of
    #: the regions that are parts of the mesh; no dimension, and given by `with_regions`
    regions = ()  # type: tuple[str, ...]
    is_from_file: ClassVar[bool] = False  #: whether a file describes the body
    has_drawing: ClassVar[bool] = True  #: whether walls can be measured and cut, unlike those of a mesh or a surface

    @property
    def digest(self) -> str:
        """SHA-256 of the file that describes the body; empty where there is none."""
        return ""

    @property
    def is_turned(self) -> bool:
        """Whether the arm is clamped at its larger x, so that x of the body runs against x of the file."""
        return False

    @property
    def is_reoriented(self) -> bool:
        """Whether x, y and z of the arm are other directions of the file."""
        return False

    @property
    def has_parts(self) -> bool:
        """Whether solids of a drawing are of another material."""
        return False

    @property
    def edges(self) -> tuple[tuple[float, str], ...]:
        """Length (mm) of each edge of a drawing from a file, and where its middle is, the shortest first."""
        return ()

    @property
    def left_out(self) -> str:
        """Where the solids of a drawing are that are its air and left out, in mm; empty where there are none."""
        return ""

    @property
    def given_element_size(self) -> float | None:
        """Longest edge of the elements of a ready mesh, mm; None for a body that is meshed with a size."""
        return None

    @property
    def is_resizable(self) -> bool:
        """Whether the body can be meshed with elements of another size."""
        return self.given_element_size is None

    @property
    def has_equal_cells(self) -> bool:
        """Whether all cells are equal; nominal ones are."""
        return True

    @property
    def straightened(self) -> Array:
        """Middles (k, 3) of curved edges of a file that are taken as straight, as an element would fold, mm."""
        return np.empty((0, 3))

    @property
    @abstractmethod
    def length(self) -> float:
        """Length of the body along x, which is the rest length of the material curve, mm."""

    @property
    @abstractmethod
    def extent(self) -> tuple[float, float, float]:
        """Size of the body (both halves) along x, y and z, mm."""

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
    def solid_volume(self) -> float:
        """Exact volume of the material of the body (both halves), mm3."""

    @property
    def meshed_volume(self) -> float:
        """Volume of the solid that is meshed: here the half z >= 0 alone, mm3."""
        return self.solid_volume / 2

    @property
    @abstractmethod
    def cavity_volumes(self) -> Mapping[str, float]:
        """Exact volume of the air (both halves) by the name of the face around it, mm3; the first is pressurised."""

    @property
    @abstractmethod
    def thinnest_wall(self) -> float:
        """Thickness of the thinnest wall of the body, mm."""

    @property
    def is_open_at_clamp(self) -> bool:
        """Whether a cavity is open in the plane of the clamp, which then carries the pressure on the opening."""
        return False

    @property
    def plug_depths(self) -> Mapping[str, float]:
        """Depth (mm) to which an inlet is filled with the material of the body, by its name."""
        return {}

    @property
    def cavity_pitch(self) -> float:
        """Largest distance along x between the middles of neighbouring chambers, mm; 0 where none follow one another,
        or where it is not needed because the cells are known."""
        return 0.0

    @property
    def reason_for_pitch(self) -> str:
        """Why the program averages curvature over `pitch`; empty where the family or the user gives it."""
        return ""

    @property
    def averages_within_cavities(self) -> bool:
        """Whether curvature is averaged over less than the distance of the cavities, by more than rounding."""
        return self.pitch < (1.0 - ROUNDING_OF_PITCH) * self.cavity_pitch

    @property
    def base_top(self) -> float | None:
        """Height of the base plate, mm, which is the region `base` (0 <= y <= base_top); None for a body without."""
        return None

    @property
    def region_volumes(self) -> Mapping[str, float]:
        """Exact volume (both halves) of each region that may have a material of its own, mm3."""
        length, _, width = self.extent
        return {} if self.base_top is None else {"base": length * self.base_top * width}

    def with_regions(self, names: Iterable[str]) -> Self:
        """This design, with these regions as parts of the mesh (`Mesh.regions`), faces between them and the
        rest.

        Raises `DesignError` for a region that the body does not have.
        """
        divided = copy(self)
        object.__setattr__(divided, "regions", tuple(names))  # a frozen dataclass, of which it is no field
        kept = "; mesh files keep them as .msh, .med, .unv or .inp" * self.is_from_file
        known = f"it has {', '.join(self.region_volumes)}" if self.region_volumes else f"it has none{kept}"
        unknown = [name for name in divided.regions if name not in self.region_volumes]
        raise_together(
            DesignError(f"materials.{name}", f"this body has no region of that name; {known}") for name in unknown
        )
        return divided

    @property
    def outer_corners(self) -> bool:
        """Whether the outside has re-entrant edges, as at the gaps between chambers."""
        return False

    @abstractmethod
    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The meshed body; `size` is the element edge that the mesher aims at, mm.

        Raises `DesignError` on the key `mesh.size` when the size does not suit the body.
        """

    def check_size(self, size: float) -> None:
        """Raise `DesignError` on `mesh.size` unless the body can be meshed with elements of `size` mm."""
        extent, volume = self.extent, self.meshed_volume
        largest = min(extent)
        if not SHORTEST <= size <= LONGEST:
            raise DesignError("mesh.size", f"must be a length from {SHORTEST:g} mm to {LONGEST:g} mm, not {size:g} mm")
        if size > largest:
            raise DesignError("mesh.size", f"{size:g} mm is larger than the body; at most {largest:g} mm")
        count, least = expected_tets(size, extent, volume), expected_tets(largest, extent, volume)
        if count > MOST_TETS:
            filled, walled = volume / (REGULAR_TET * MOST_TETS), TETS_PER_SQUARE * _half_surface(extent) / MOST_TETS
            smallest = max(filled ** (1 / 3), walled**0.5)
            remedy = "choose a shorter body" if least > MOST_TETS else f"at least {smallest:.2g} mm"
            too_many = f"{size:g} mm gives {count:.0e} elements, of which {MOST_TETS:.0e} fit into memory"
            raise DesignError("mesh.size", f"{too_many}; {remedy}")

    @property
    def repeats(self) -> bool:
        """Whether the body repeats a cell that is symmetric about its own middle; it has a `repetition` then."""
        return False

    @property
    def halves_differ(self) -> bool:
        """Whether the user says that both halves of the body about z = 0 differ."""
        return False

    @property
    def why_no_cell(self) -> str:
        """Why a body repeats no cell, where it does not, and what can be done; a sentence without full stop."""
        return (
            "it is not known where the cells of this body lie; name the planes of one, for example "
            "geometry.cell: {from: 40 mm, to: 44 mm}, in the middle of a cell and between two cells"
        )

    def repetition(self, size: float, grading: Grading) -> Repetition:
        """The ends and the half cell with elements of at most `size` mm, a size that `check_size` accepts.

        Raises `DesignError` for a body whose cells are not known.
        """
        raise DesignError("cell", "it is not known where the cells of the body lie")

    @property
    def dimensions(self) -> dict[str, float]:
        """The lengths that can be changed a little, mm, by the keys of the config."""
        return {}

    def with_dimension(self, name: str, value: float) -> Self:
        """This design with another length, mm. Raises `DesignError`."""
        return replace(self, **{name: value}).with_regions(self.regions)  # type: ignore[type-var]

    def movements(self, repetition: Repetition) -> dict[str, Movement | DesignError]:
        """How the meshed pieces move with each of the dimensions, or why a small change of it is not possible."""
        return {}

    def half_cell(self, repetition: Repetition) -> Body:
        """Half a cell of these meshed pieces, between two planes of mirror symmetry: its faces `clamp` and `tip`.

        Raises `DesignError` for a body without an inner cell.
        """
        if not repetition.half_cells:
            key = "cell" if self.is_from_file else "chambers" if hasattr(self, "chambers") else "length"
            raise DesignError(key, "the body has no inner cell: it needs two cells at least")
        return self._body(repetition.half_cell(), repetition.half_pitch, repetition.half)

    def end_piece(self, half_cells: int, repetition: Repetition) -> Body:
        """The clamped end of these meshed pieces with `half_cells` half cells; its face `tip` is a plane of mirror
        symmetry. Raises ValueError for more half cells than the body has.
        """
        _check_room(half_cells, repetition)
        length = repetition.middle + half_cells * repetition.half_pitch
        return self._body(repetition.end_piece(half_cells), length, repetition.half)

    def tip_piece(self, half_cells: int, repetition: Repetition) -> Body:
        """The other end with an odd number of half cells, as its mirror image: its face `clamp` is the end of the body,
        its face `tip` a plane of mirror symmetry. Raises as `end_piece` does.
        """
        _check_room(half_cells, repetition)
        length = repetition.beyond + half_cells * repetition.half_pitch
        return self._body(repetition.tip_piece(half_cells), length, repetition.half)

    def of_pieces(self, repetition: Repetition) -> Body:
        """The whole body, put together from its meshed pieces."""
        return self._body(repetition.mesh(), self.length, repetition.half)

    def _body(self, mesh: Mesh, length: float, half: bool) -> Body:
        if "base" in self.regions and self.base_top is not None:
            below = mesh.points[mesh.tets, 1].mean(axis=1) < self.base_top
            mesh = replace(mesh, regions={"base": np.flatnonzero(below)})
        return Body(mesh, self.family, length, self.pitch, self.curve_y, half, self.cavities)

    @property
    def cavities(self) -> tuple[str, ...]:
        """Names of the faces that enclose air; the first is the one that is pressurised."""
        return tuple(self.cavity_volumes)

    @property
    def cavity_volume(self) -> float:
        """Exact volume of the pressurised air (both halves), mm3."""
        return self.cavity_volumes[self.cavities[0]]


class SymmetricDesign(Design):
    """A design that is symmetric about z = 0, so that only z >= 0 is meshed, and repeats a cell that is symmetric about
    its own middle. A family defines `cell_count` and `repetition`."""

    def __post_init__(self) -> None:
        check_design(self, self._impossible)

    @abstractmethod
    def _impossible(self) -> Iterator[DesignError]:
        """What is wrong about several dimensions together."""

    @property
    @abstractmethod
    def cell_count(self) -> int:
        """Number of cells between the two ends, of which the first and the last hold half a cell each."""

    @property
    def repeats(self) -> bool:
        return self.cell_count > 1

    @property
    def why_no_cell(self) -> str:
        return "the arm has no inner cell; its own law needs two cells at least"

    @property
    def dimensions(self) -> dict[str, float]:
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: value for name, value in values.items() if isinstance(value, float) and value > 0.0}

    @property
    @abstractmethod
    def drawing(self) -> Drawing:
        """The end piece and the half cell, z >= 0."""

    def repetition(self, size: float, grading: Grading) -> Repetition:
        drawn = self.drawing
        return Repetition(mesh_solid(drawn.solid, size, grading), drawn.middle, drawn.edge, 2 * (self.cell_count - 1))

    def movements(self, repetition: Repetition) -> dict[str, Movement | DesignError]:
        drawn, changed, refused = self.drawing, dict[str, tuple[Drawing, Drawing, float]](), {}
        for name, value in self.dimensions.items():
            step = STEP_OF_DIMENSION * value
            try:
                less, more = (self.with_dimension(name, value + sign * step) for sign in (-1.0, 1.0))
            except DesignError as failure:
                refused[name] = failure
                continue
            changed[name] = less.drawing, more.drawing, 2.0 * step
        return movements(repetition, drawn, changed) | refused

    def base_plate(self, start: float, stop: float) -> tuple[list[list[Shape]], float]:
        """Blocks of the half z >= 0 of the base plate, start <= x <= stop, and the height up to which they reach, mm.

        That is the material curve, and the top of the plate where it is a region.
        """
        half = self.extent[2] / 2
        heights = [0.0, self.curve_y, *([self.base_top] if "base" in self.regions and self.base_top else [])]
        return [[Box((start, low, 0), (stop, high, half))] for low, high in pairwise(heights)], heights[-1]

    def body(self, size: float, grading: Grading = OFF) -> Body:
        """The meshed half z >= 0; `size` is the element edge that Gmsh aims at, mm.

        Raises `DesignError` on the key `mesh.size` when the size does not suit the body.
        """
        self.check_size(size)
        return self.of_pieces(self.repetition(size, grading))


class OnBasePlate(SymmetricDesign):
    """An arm on a base plate, in the middle of which the material curve runs. A family has the field `base`."""

    base: float  #: thickness of the plate, mm

    @property
    def curve_y(self) -> float:
        return self.base / 2

    @property
    def base_top(self) -> float:
        return self.base


def usual_cell(length: float) -> float:
    """Length (mm) over which curvature is averaged on an arm of that length (mm) of which no cell is known.

    Five parameters need 6.5 of them.
    """
    return min(10.0, length / 10)


def expected_tets(size: float, extent: Sequence[float], volume: float) -> float:
    """Estimated number of elements of `size` mm in a body of that extent (x, y, z, mm) and meshed volume (mm3)."""
    return max(volume / (REGULAR_TET * size**3), TETS_PER_SQUARE * _half_surface(extent) / size**2)


def _check_room(half_cells: int, repetition: Repetition) -> None:
    if not 0 <= half_cells <= repetition.half_cells:
        raise ValueError(f"half_cells = {half_cells}: the body has {repetition.half_cells}")


def _half_surface(extent: Sequence[float]) -> float:
    """Half the surface of the box around a body, mm2."""
    length, height, width = extent
    return length * height + height * width + width * length
