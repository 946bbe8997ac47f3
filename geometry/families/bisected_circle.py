"""Round arm with two D-shaped cavities, separated by a flat wall through its axis."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import acos, pi, sqrt
from typing import Annotated, ClassVar, final

from geometry.errors import DesignError
from geometry.families.dimensions import not_less
from geometry.families.partitioned import UndividedDesign
from geometry.meshing.shapes import RoundBar, Shape


@final
@dataclass(frozen=True)
class BisectedCircle(UndividedDesign):
    """A disc extruded along x with a dividing wall in the plane y = 0 and a cavity on each side; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity (the upper one, which is pressurised), cavity_lower,
    outer. The paper gives no dimensions, so all of them are assumed. The cells are nominal.
    """

    family: ClassVar[str] = "bisected_circle"

    length: Annotated[float, "of the arm"] = 112.0
    radius: Annotated[float, "outer radius"] = 7.5
    end_wall: Annotated[float, "thickness of the solid at each end"] = 2.0
    wall: Annotated[float, "thickness of the round wall"] = 1.0
    divider: Annotated[float, "thickness of the dividing wall, in the middle of which the material curve runs"] = 1.5

    def _impossible(self) -> Iterator[DesignError]:
        yield from not_less(self, "wall", "radius", because="the wall leaves no cavity")
        yield from not_less(self, "end_wall", "length", 0.5, "the two end walls leave no cavity")
        across = 2 * (self.radius - self.wall)
        if 0 < across <= self.divider:
            keys = ("divider", "radius", "wall")
            yield DesignError(keys, f"{self.divider:g} mm must be less than the inner diameter, {across:g} mm")

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, 2 * self.radius, 2 * self.radius)

    @property
    def curve_y(self) -> float:
        return 0.0

    @property
    def solid_volume(self) -> float:
        return pi * self.radius**2 * self.length - 2 * self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        """A segment of the inner circle times the length between the end walls, for each of the two cavities, mm3."""
        inner, height = self.radius - self.wall, self.divider / 2
        segment = inner**2 * acos(height / inner) - height * sqrt(inner**2 - height**2)
        volume = segment * (self.length - 2 * self.end_wall)
        return {"cavity": volume, "cavity_lower": volume}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.divider, self.end_wall)

    def _bar(self, start: float, stop: float) -> list[list[Shape]]:
        return [[half] for half in self._halves(start, stop, self.radius, 0)]

    def _cavities(self, start: float, stop: float) -> list[Shape]:
        return self._halves(start, stop, self.radius - self.wall, self.divider / 2)

    @staticmethod
    def _halves(start: float, stop: float, radius: float, height: float) -> list[Shape]:
        """The parts y >= height and y <= -height of a round bar, start <= x <= stop, in mm."""
        return [RoundBar(start, stop, 0, radius, bottom=height), RoundBar(start, stop, 0, radius, top=-height)]
