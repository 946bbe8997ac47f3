"""Bodies from files: what drawings, meshes and surfaces share."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property
from hashlib import sha256
from itertools import pairwise
from math import isfinite
from pathlib import Path
from typing import TypeAlias

from geometry.design import Design, DesignError
from geometry.foreign.companions import companions
from geometry.foreign.frame import Axes, usual_cell
from geometry.meshing.cad_import import Point
from geometry.meshing.cells import CellPlanes
from geometry.meshing.mirror import slices

#: length of a cavity over that of the arm from which on it runs through all of it
WHOLE = 0.75
#: names of faces that are no cavities
TAKEN = ("clamp", "tip", "sym", "outer")
#: whether an inlet in the plane of the clamp is closed there, or a point in the mouth of each inlet that is filled
Plug: TypeAlias = bool | Mapping[str, Point]


class FileDesign(Design):
    """A body that a file describes. A family is a dataclass with the fields named here, all lengths in mm."""

    file: str
    curve: float
    air: Mapping[str, Point]
    cell: float | CellPlanes | None
    unit: float
    axes: Axes
    plug: Plug

    def _wrong_values(self) -> Iterator[DesignError]:
        """A `DesignError` for each value that no file makes right: lengths, points, names of cavities."""
        if not isinstance(self.cell, CellPlanes):
            yield from self._not_positive("cell", self.cell)
        yield from self._not_positive("unit", self.unit)
        yield from wrong_points("air", self.air)
        if isinstance(self.plug, Mapping):
            yield from wrong_points("plug", self.plug)
        for name in TAKEN:
            if name in self.air:
                yield DesignError(f"air.{name}", f"a cavity cannot be named {name}; choose another name")

    def _not_positive(self, key: str, length: float | None) -> Iterator[DesignError]:
        if length is not None and not (isfinite(length) and length > 0):
            yield DesignError(key, f"must be a positive length, not {length!r}")

    def _keep_own_copies(self) -> None:
        """Keep the values of `air`, `axes` and `plug`, whatever happens to what was given."""
        object.__setattr__(self, "air", dict(self.air))
        object.__setattr__(self, "axes", tuple(self.axes))
        if isinstance(self.plug, Mapping):
            object.__setattr__(self, "plug", dict(self.plug))

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file and those that it needs, so that results of older files are not reused."""
        path = Path(self.file)
        digest = sha256(path.read_bytes())
        for other in companions(path):
            content = other.read_bytes()
            digest.update(f"{other.name} {len(content)}\n".encode())
            digest.update(content)
        return digest.hexdigest()

    @property
    def curve_y(self) -> float:
        return self.curve

    @property
    def is_open_at_clamp(self) -> bool:
        return self.plug is True

    @property
    @abstractmethod
    def cavity_ranges(self) -> Mapping[str, tuple[float, float]]:
        """Smallest and largest x of each cavity, mm, from where the file has its origin or from the clamp."""

    @property
    def cavity_pitch(self) -> float:
        groups: list[tuple[float, float]] = []  # those beside one another are one
        for low, high in sorted(self.cavity_ranges.values()):
            if groups and low < groups[-1][1]:
                low, high = groups[-1][0], max(high, groups.pop()[1])
            groups.append((low, high))
        middles = [(low + high) / 2 for low, high in groups if high - low < WHOLE * self.length]
        return max((after - before for before, after in pairwise(middles)), default=0.0)

    @property
    def pitch(self) -> float:
        if isinstance(self.cell, CellPlanes):
            return 2 * self.cell.half_pitch
        return averaging_length(self.length, self.cell)


def wrong_points(key: str, points: Mapping[str, Point]) -> Iterator[DesignError]:
    """A `DesignError` for each value of points by name that is no point."""
    for name, point in points.items():
        if len(point) != 3 or not all(isfinite(coordinate) for coordinate in point):
            yield DesignError(f"{key}.{name}", f"must be a point (x, y, z) in mm, not {point!r}")


def averaging_length(length: float, cell: float | None) -> float:
    """Length (mm) over which curvature is averaged: `cell`, or for None equal parts of about the usual length."""
    return cell or slices(length, usual_cell(length))[1]
