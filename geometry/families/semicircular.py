"""Half discs on a base plate: what both families of them share, and the one with a row of chambers."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot, pi
from typing import Annotated, ClassVar, final

from geometry.errors import DesignError
from geometry.families.design import OnBasePlate
from geometry.families.dimensions import not_less
from geometry.families.partitioned import PartitionedDesign
from geometry.meshing.shapes import Box, RoundBar, Shape


class HalfDisc(OnBasePlate):
    """A half disc extruded along x on a base plate of the same width. A family has the fields named here, in mm."""

    radius: float  #: of the outside
    wall: float  #: thickness of the round wall

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.base + self.radius, 2 * self.radius)

    @property
    def solid_volume(self) -> float:
        section = 2 * self.radius * self.base + pi / 2 * self.radius**2
        return section * self.length - self.cavity_volume

    def _bar(self, start: float, stop: float) -> list[list[Shape]]:
        (plate, bottom), disc = self.base_plate(start, stop), self._disc(start, stop, self.radius)
        whole = bottom == self.base
        return [*plate, [disc] if whole else [Box((start, bottom, 0), (stop, self.base, self.radius)), disc]]

    def _cavity(self, start: float, stop: float) -> Shape:
        return self._disc(start, stop, self.radius - self.wall)

    def _disc(self, start: float, stop: float, radius: float) -> RoundBar:
        """The half z >= 0 of a half disc on the base plate; start <= x <= stop, in mm."""
        return RoundBar(start, stop, self.base, radius, bottom=self.base)


@final
@dataclass(frozen=True)
class Semicircular(HalfDisc, PartitionedDesign):
    """A half disc extruded along x on a base plate of the same width, with a row of chambers; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, outer. The paper shows this body without dimensions, so
    all of them are assumed; width, length and air channel are those of the pneu-net. A cell extends from the middle of
    one partition to the middle of the next.
    """

    family: ClassVar[str] = "semicircular"

    chambers: Annotated[int, "number of chambers"] = 11
    radius: Annotated[float, "outer radius of the half disc; the base plate is twice as wide"] = 7.5
    chamber_length: Annotated[float, "length of a cavity along x"] = 8.0
    partition: Annotated[float, "thickness of the solid between two cavities"] = 2.0
    end_wall: Annotated[float, "thickness of the solid at each end"] = 2.0
    base: Annotated[float, "thickness of the base plate; the material curve runs at half of it"] = 2.0
    wall: Annotated[float, "thickness of the round wall"] = 1.0
    channel: Annotated[float, "width and height of the air channel on the base plate"] = 2.0

    def _impossible(self) -> Iterator[DesignError]:
        yield from not_less(self, "wall", "radius", because="the wall leaves no cavity")
        corner, inner = hypot(self.channel, self.channel / 2), self.radius - self.wall
        if 0 < inner <= corner:
            allowed = f"must be less than {inner / hypot(1, 0.5):.3g} mm in a cavity of radius {inner:g} mm"
            yield DesignError(("channel", "radius", "wall"), f"{self.channel:g} mm {allowed}")

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        cavities = self.chambers * self.chamber_length * pi / 2 * (self.radius - self.wall) ** 2
        return {"cavity": cavities + self.channel_volume}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.base, self.partition, self.end_wall)
