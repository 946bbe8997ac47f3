"""Rectangular arm with a row of chambers, solid partitions, smooth outside: another reading of the paper's drawing."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from geometry.errors import DesignError
from geometry.families.dimensions import not_less
from geometry.families.partitioned import PartitionedDesign
from geometry.meshing.shapes import Box, Shape


@final
@dataclass(frozen=True)
class Rectangular(PartitionedDesign):
    """A rectangular bar with a row of chambers, parted by solid partitions; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, outer. Width and length are those of the pneu-net, the
    other dimensions are assumed. A cell extends from the middle of one partition to the middle of the next.
    """

    family: ClassVar[str] = "rectangular"

    chambers: Annotated[int, "number of chambers"] = 11
    width: Annotated[float, "across"] = 15.0
    height: Annotated[float, "of the whole arm"] = 17.0
    chamber_length: Annotated[float, "of the cavity, along x"] = 8.0
    partition: Annotated[float, "thickness of the solid between two cavities"] = 2.0
    end_wall: Annotated[float, "thickness of the solid at each end"] = 2.0
    base: Annotated[float, "thickness of the plate below the cavities; the material curve runs at half of it"] = 3.0
    side_wall: Annotated[float, "thickness of the walls across z"] = 2.0
    roof: Annotated[float, "thickness of the wall above the cavities"] = 2.0
    channel: Annotated[float, "width and height of the air channel on the base plate"] = 2.0

    def _impossible(self) -> Iterator[DesignError]:
        yield from not_less(self, "side_wall", "width", 0.5, "the two side walls leave no cavity")
        solid, across = self.base + self.roof, self.width - 2 * self.side_wall
        if not solid < self.height:
            sentence = f"base + roof = {solid:g} mm must be less than height, {self.height:g} mm"
            yield DesignError(("base", "roof", "height"), sentence)
        if 0 < min(self.height - solid, across) <= self.channel:
            cavity = f"must be less than height and width of the cavity, {self.height - solid:g} and {across:g} mm"
            yield DesignError(("channel", "height", "width"), f"{self.channel:g} mm {cavity}")

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.height, self.width)

    @property
    def solid_volume(self) -> float:
        return self.length * self.height * self.width - self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        section = (self.height - self.base - self.roof) * (self.width - 2 * self.side_wall)
        return {"cavity": self.chambers * self.chamber_length * section + self.channel_volume}

    @property
    def thinnest_wall(self) -> float:
        return min(self.partition, self.end_wall, self.base, self.side_wall, self.roof)

    def _bar(self, start: float, stop: float) -> list[list[Shape]]:
        plate, bottom = self.base_plate(start, stop)
        return [*plate, [Box((start, bottom, 0), (stop, self.height, self.width / 2))]]

    def _cavity(self, start: float, stop: float) -> Box:
        return Box((start, self.base, 0), (stop, self.height - self.roof, self.width / 2 - self.side_wall))
