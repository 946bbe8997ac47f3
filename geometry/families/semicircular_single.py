"""Semicircular arm with a single cavity: a half disc on a base plate."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi
from typing import Annotated, ClassVar, final

from geometry.errors import DesignError
from geometry.families.dimensions import not_less
from geometry.families.partitioned import UndividedDesign
from geometry.families.semicircular import HalfDisc
from geometry.meshing.shapes import Shape


@final
@dataclass(frozen=True)
class SemicircularSingle(HalfDisc, UndividedDesign):
    """A half disc extruded along x on a base plate of the same width, with a single cavity; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, outer. The paper gives no dimensions, so those of the
    semicircular arm with chambers are assumed. The cells are nominal.
    """

    family: ClassVar[str] = "semicircular_single"

    length: Annotated[float, "of the arm"] = 112.0
    radius: Annotated[float, "outer radius of the half disc; the base plate is twice as wide"] = 7.5
    end_wall: Annotated[float, "thickness of the solid at each end"] = 2.0
    base: Annotated[float, "thickness of the base plate; the material curve runs at half of it"] = 2.0
    wall: Annotated[float, "thickness of the round wall"] = 1.0

    def _impossible(self) -> Iterator[DesignError]:
        yield from not_less(self, "wall", "radius", because="the wall leaves no cavity")
        yield from not_less(self, "end_wall", "length", 0.5, "the two end walls leave no cavity")

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        return {"cavity": pi / 2 * (self.radius - self.wall) ** 2 * (self.length - 2 * self.end_wall)}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.base, self.end_wall)

    def _cavities(self, start: float, stop: float) -> list[Shape]:
        return [self._cavity(start, stop)]
