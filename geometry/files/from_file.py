"""Bodies from files: what drawings, meshes and surfaces share."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from itertools import chain
from math import isfinite
from pathlib import Path
from typing import Annotated, ClassVar, TypeAlias

from geometry.arrays import Array
from geometry.errors import DesignError, MeshError, raise_together
from geometry.families.design import Design, usual_cell
from geometry.files.chambers import Range, distances, middles_of
from geometry.files.frame import PITCHES, SAME, Axes, CellPlanes, Directions, Point, rotation
from geometry.meshing.mirror import slices

#: largest difference of the distances of chambers, over the largest, with which these are the cells of the arm
EQUAL = 0.05
#: how far the vertices of a flat face may lie from their plane, over the size of the body: files have six digits
FLAT = 1e-5
#: names of faces that are no cavities
TAKEN = ("clamp", "tip", "sym", "outer")
#: suffixes of files that formats in several files put beside the one that is named (XDMF, TetGen)
COMPANIONS = (".h5", ".bin", ".node", ".ele")
#: whether an inlet in the plane of the clamp is closed there, or a point in the mouth of each inlet that is filled
Plug: TypeAlias = bool | Mapping[str, Point]


@dataclass(frozen=True)
class FileDesign(Design):
    """A body that a file describes; all lengths in mm. The constructor reads and checks the file."""

    is_from_file: ClassVar[bool] = True
    fills_inlets: ClassVar[bool] = True  #: whether `plug` may have points in the mouths of inlets

    file: Annotated[str, "path of the file"]
    curve: Annotated[float, "y of the material curve"]
    clamp: Annotated[float | None, "x of the clamped end face; without it the end with the smallest x"] = None
    tip: Annotated[float | None, "x of the other end face; without it the other end"] = None
    air: Annotated[Mapping[str, Point], "a point in each cavity; needed with several cavities"] = field(
        default_factory=dict
    )
    cell: Annotated[float | CellPlanes | None, "its length or [planes](cell.md#own-bodies), sought if left out"] = None
    unit: Annotated[float | None, "unit of length of the file, mm if left out; of STEP files in place of theirs"] = None
    axes: Annotated[Axes, "which directions of the file are x, y and z of the arm"] = SAME
    middle: Annotated[float, "z of the plane of symmetry in the file; all other z are measured from it"] = 0.0
    plug: Annotated[
        Plug, "`true` closes an inlet in the plane of the clamp; points in the mouths of inlets fill them"
    ] = False

    def __post_init__(self) -> None:
        raise_together(self._wrong_values())
        for name in ("air", "parts", "plug"):  # own copies, whatever happens to what was given
            if isinstance(given := getattr(self, name, None), Mapping):
                object.__setattr__(self, name, dict(given))
        if not isinstance(self.axes, Directions):
            object.__setattr__(self, "axes", tuple(self.axes))
        try:
            self._read()
        except MeshError as error:
            raise DesignError("file", str(error)) from error

    @abstractmethod
    def _read(self) -> None:
        """Read and check the file. Raises `DesignError`, and `MeshError` where the body cannot be used."""

    def _wrong_values(self) -> Iterator[DesignError]:
        """A `DesignError` for each value that no file makes right: lengths, points, names of cavities."""
        cell = None if isinstance(self.cell, CellPlanes) else self.cell
        for key, length in (("cell", cell), ("unit", self.unit)):
            if length is not None and not (isfinite(length) and length > 0):
                yield DesignError(key, f"must be a positive length, not {length!r}")
        if not isfinite(self.middle):
            yield DesignError("middle", f"must be a length, not {self.middle!r}")
        for key in ("air", "parts", "plug"):
            points = getattr(self, key, None)
            for name, point in points.items() if isinstance(points, Mapping) else ():
                if len(point) != 3 or not all(isfinite(coordinate) for coordinate in point):
                    yield DesignError(f"{key}.{name}", f"must be a point (x, y, z) in mm, not {point!r}")
        for name in TAKEN:
            if name in self.air:
                yield DesignError(f"air.{name}", f"a cavity cannot be named {name}; choose another name")

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file and those that it needs, so that results of older files are not reused."""
        path, digest = Path(self.file), sha256(Path(self.file).read_bytes())
        beside = (path.with_suffix(suffix) for suffix in COMPANIONS if path.suffix != suffix)
        for other in filter(Path.is_file, beside):
            digest.update(other.name.encode() + other.read_bytes())
        return digest.hexdigest()

    @property
    def curve_y(self) -> float:
        return self.curve

    @property
    def is_reoriented(self) -> bool:
        return self.axes != SAME

    def ends_between(
        self, low: float, high: float, clamp: float | None = None, tip: float | None = None
    ) -> tuple[float, float]:
        """x of clamp and tip (mm) of a body between two x, with the ends that its file names.

        Raises `DesignError` where both are the same.
        """
        clamp = next(x for x in (self.clamp, clamp, low) if x is not None)
        other = high if clamp <= (low + high) / 2 else low
        tip = next(x for x in (self.tip, tip, other) if x is not None)
        if abs(tip - clamp) <= FLAT * (high - low):
            raise DesignError(("clamp", "tip"), f"clamp and tip are both at x = {clamp:g} mm; they are the two ends")
        return clamp, tip

    def in_frame(self, points: Array) -> Array:
        """Points (n, 3) of the file in the frame of the arm, mm. Raises `DesignError` for axes that are none."""
        return points @ ((self.unit or 1.0) * rotation(self.axes).T) - [0.0, 0.0, self.middle]

    @property
    def is_open_at_clamp(self) -> bool:
        return self.plug is True

    @property
    @abstractmethod
    def chamber_ranges(self) -> Mapping[str, tuple[Range, ...]]:
        """Smallest and largest x of each chamber by the name of its cavity, mm; x as in the file or from the clamp."""

    @property
    def chamber_middles(self) -> list[float]:
        """x of the middles of chambers that follow one another, as in `chamber_ranges`."""
        return middles_of(chain.from_iterable(self.chamber_ranges.values()), self.length)

    @property
    def chamber_distances(self) -> list[float]:
        """Along x between the middles of neighbouring chambers, mm."""
        return distances(self.chamber_middles)

    @property
    def has_equal_chambers(self) -> bool:
        """Whether the arm has three chambers or more, at equal distances."""
        between = self.chamber_distances
        return len(between) > 1 and are_equal(between)

    @property
    def cavity_pitch(self) -> float:
        return max(self.chamber_distances, default=0.0)

    @property
    def pitch(self) -> float:
        if isinstance(self.cell, CellPlanes):
            return 2 * self.cell.half_pitch
        return self.cell or usual_pitch(self.length, self.chamber_distances)[0]

    @property
    def reason_for_pitch(self) -> str:
        return usual_pitch(self.length, self.chamber_distances)[1] if self.cell is None else ""


def usual_pitch(length: float, between: Sequence[float]) -> tuple[float, str]:
    """Length (mm) over which curvature is averaged where none is given, and the reason, a clause.

    The largest distance of neighbouring chambers (mm) where all are equal and the arm is long enough for five
    parameters of such cells; otherwise equal parts of the arm of about the usual length.
    """
    parts = slices(length, usual_cell(length))[1]
    if not between:
        return parts, "no chambers follow one another along the arm"
    longest = max(between)
    if not are_equal(between):
        return parts, "its chambers are not equally far apart"
    if length < PITCHES * longest:
        return parts, f"five parameters need {PITCHES:g} times the distance of its chambers, {longest:.3g} mm"
    return longest, f"this is the distance of its {len(between) + 1} chambers"


def are_equal(between: Sequence[float]) -> bool:
    """Whether the distances of neighbouring chambers (mm) may be those of equal cells."""
    return max(between) - min(between) <= EQUAL * max(between)
