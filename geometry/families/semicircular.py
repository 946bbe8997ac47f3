"""Semicircular arm with a row of chambers: a half disc on a base plate, solid partitions, smooth outside."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, pi
from typing import ClassVar, final

from geometry.design import DesignError, SymmetricDesign, check_less, check_numbers
from geometry.grading import Grading
from geometry.meshing.mirror import Repetition
from geometry.meshing.solid import Box, RoundBar, Shape, Solid, mesh_solid


@final
@dataclass(frozen=True)
class Semicircular(SymmetricDesign):
    """A half disc extruded along x on a base plate of the same width, with a row of chambers; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, outer. The paper shows this body without dimensions, so
    all of them are assumed; width, length and air channel are those of the pneu-net. A cell extends from the middle of
    one partition to the middle of the next.
    """

    family: ClassVar[str] = "semicircular"

    chambers: int = 11  #: number of chambers
    radius: float = 7.5  #: outer radius of the half disc; the base plate is twice as wide
    chamber_length: float = 8.0  #: length of a cavity along x
    partition: float = 2.0  #: thickness of the solid between two cavities
    end_wall: float = 2.0  #: thickness of the solid at each end
    base: float = 2.0  #: thickness of the base plate; the material curve runs at half of it
    wall: float = 1.0  #: thickness of the round wall
    channel: float = 2.0  #: width and height of the air channel on the base plate

    def __post_init__(self) -> None:
        check_numbers(self, counts=["chambers"])
        check_less(self, "wall", "radius", because="the wall leaves no cavity")
        corner, inner = hypot(self.channel, self.channel / 2), self.radius - self.wall
        if not corner < inner:
            raise DesignError(
                ("channel", "radius", "wall"),
                f"channel {self.channel:g} mm must be less than {inner / hypot(1, 0.5):.3g} mm "
                f"to lie inside the cavity of radius {inner:g} mm",
            )

    @property
    def length(self) -> float:
        return self.chambers * self.chamber_length + (self.chambers - 1) * self.partition + 2 * self.end_wall

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.base + self.radius, 2 * self.radius)

    @property
    def curve_y(self) -> float:
        return self.base / 2

    @property
    def pitch(self) -> float:
        return self.chamber_length + self.partition

    @property
    def solid_volume(self) -> float:
        section = 2 * self.radius * self.base + pi / 2 * self.radius**2
        return section * self.length - self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        cavities = self.chambers * self.chamber_length * pi / 2 * (self.radius - self.wall) ** 2
        return {"cavity": cavities + (self.chambers - 1) * self.partition * self.channel**2}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.base, self.partition, self.end_wall)

    def repetition(self, size: float, grading: Grading) -> Repetition:
        middle = self.end_wall + self.chamber_length / 2
        edge = middle + self.pitch / 2
        return Repetition(mesh_solid(self._drawing(middle, edge), size, grading), middle, edge, 2 * (self.chambers - 1))

    def _drawing(self, middle: float, edge: float) -> Solid:
        """The end piece and the half cell that are repeated.

        The end piece reaches to the middle of the first chamber (x = middle, mm). With more than one chamber the half
        cell reaches from there to the middle of the first partition (x = edge, mm).
        """
        near, far = self.end_wall, self.end_wall + self.chamber_length
        end = dome(0, middle, self.radius, self.base)
        hollow: list[Shape] = [cavity(near, middle, self.radius - self.wall, self.base)]
        if self.chambers == 1:
            return Solid({"end": end}, {"cavity": hollow})
        hollow += [
            cavity(middle, far, self.radius - self.wall, self.base),
            Box((far, self.base, 0), (edge, self.base + self.channel, self.channel / 2)),
        ]
        return Solid({"end": end, "cell": dome(middle, edge, self.radius, self.base)}, {"cavity": hollow})


def dome(start: float, stop: float, radius: float, base: float) -> list[list[Shape]]:
    """The half z >= 0 of a base plate, cut at half its thickness, with a half disc on it; start <= x <= stop, in mm."""
    return [
        [Box((start, 0, 0), (stop, base / 2, radius))],
        [Box((start, base / 2, 0), (stop, base, radius)), cavity(start, stop, radius, base)],
    ]


def cavity(start: float, stop: float, radius: float, base: float) -> RoundBar:
    """The half z >= 0 of a half disc on the base plate; start <= x <= stop, in mm."""
    return RoundBar(start, stop, base, radius, bottom=base)
