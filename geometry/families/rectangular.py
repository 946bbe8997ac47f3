"""Rectangular arm with a row of chambers, solid partitions, smooth outside: another reading of the paper's drawing."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, final

from geometry.design import DesignError, SymmetricDesign, check_less, check_numbers
from geometry.grading import Grading
from geometry.meshing.mirror import Repetition
from geometry.meshing.solid import Box, Shape, Solid, mesh_solid


@final
@dataclass(frozen=True)
class Rectangular(SymmetricDesign):
    """A rectangular bar with a row of chambers, parted by solid partitions; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, outer. Width and length are those of the pneu-net, the
    other dimensions are assumed. A cell extends from the middle of one partition to the middle of the next.
    """

    family: ClassVar[str] = "rectangular"

    chambers: int = 11  #: number of chambers
    width: float = 15.0  #: across
    height: float = 17.0  #: of the whole arm
    chamber_length: float = 8.0  #: of the cavity, along x
    partition: float = 2.0  #: thickness of the solid between two cavities
    end_wall: float = 2.0  #: thickness of the solid at each end
    base: float = 3.0  #: thickness of the plate below the cavities; the material curve runs at half of it
    side_wall: float = 2.0  #: thickness of the walls across z
    roof: float = 2.0  #: thickness of the wall above the cavities
    channel: float = 2.0  #: width and height of the air channel on the base plate

    def __post_init__(self) -> None:
        check_numbers(self, counts=["chambers"])
        check_less(self, "side_wall", "width", 0.5, "the two side walls leave no cavity")
        solid, across = self.base + self.roof, self.width - 2 * self.side_wall
        if not solid < self.height:
            raise DesignError(
                ("base", "roof", "height"),
                f"base + roof = {solid:g} mm must be less than height {self.height:g} mm: they leave no cavity",
            )
        if not self.channel < min(self.height - solid, across):
            raise DesignError(
                ("channel", "height", "width"),
                f"channel {self.channel:g} mm must be less than height and width of the cavity, "
                f"{self.height - solid:g} and {across:g} mm",
            )

    @property
    def length(self) -> float:
        return self.chambers * self.chamber_length + (self.chambers - 1) * self.partition + 2 * self.end_wall

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.height, self.width)

    @property
    def curve_y(self) -> float:
        return self.base / 2

    @property
    def pitch(self) -> float:
        return self.chamber_length + self.partition

    @property
    def solid_volume(self) -> float:
        return self.length * self.height * self.width - self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        section = (self.height - self.base - self.roof) * (self.width - 2 * self.side_wall)
        channels = (self.chambers - 1) * self.partition * self.channel**2
        return {"cavity": self.chambers * self.chamber_length * section + channels}

    @property
    def thinnest_wall(self) -> float:
        return min(self.partition, self.end_wall, self.base, self.side_wall, self.roof)

    def repetition(self, size: float, grading: Grading) -> Repetition:
        middle = self.end_wall + self.chamber_length / 2
        edge = middle + self.pitch / 2
        return Repetition(mesh_solid(self._drawing(middle, edge), size, grading), middle, edge, 2 * (self.chambers - 1))

    def _drawing(self, middle: float, edge: float) -> Solid:
        """The end piece to the middle of the first chamber (x = middle, mm), and the half cell that is repeated.

        With more than one chamber the half cell reaches from there to the middle of the first partition (x = edge, mm).
        """
        near, far = self.end_wall, self.end_wall + self.chamber_length
        hollow: list[Shape] = [self._cavity(near, middle)]
        if self.chambers == 1:
            return Solid({"end": self._bar(0, middle)}, {"cavity": hollow})
        channel = Box((far, self.base, 0), (edge, self.base + self.channel, self.channel / 2))
        hollow += [self._cavity(middle, far), channel]
        return Solid({"end": self._bar(0, middle), "cell": self._bar(middle, edge)}, {"cavity": hollow})

    def _bar(self, start: float, stop: float) -> list[list[Shape]]:
        """The half z >= 0 of the solid without cavities, cut at the material curve; start <= x <= stop, in mm."""
        return [
            [Box((start, 0, 0), (stop, self.base / 2, self.width / 2))],
            [Box((start, self.base / 2, 0), (stop, self.height, self.width / 2))],
        ]

    def _cavity(self, start: float, stop: float) -> Box:
        """The half z >= 0 of a cavity; start <= x <= stop, in mm."""
        return Box((start, self.base, 0), (stop, self.height - self.roof, self.width / 2 - self.side_wall))
