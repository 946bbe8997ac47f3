"""Pneu-net with gaps between its chambers ("fast" pneu-net), the first arm of the paper."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import ClassVar, final

from geometry.design import DesignError, SymmetricDesign, check_less, check_numbers
from geometry.grading import Grading
from geometry.meshing.mirror import Repetition
from geometry.meshing.shapes import Box, Fillet, Shape
from geometry.meshing.solid import Solid, mesh_solid

#: smallest radius of a rounded edge, mm; elements beside it are as small as a third of its arc
SMALLEST_FILLET = 0.1


@final
@dataclass(frozen=True)
class PneuNet(SymmetricDesign):
    """A row of chambers with gaps between them, on a strip, on a base plate; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, gap (the facing walls of neighbouring chambers and the
    strip between them), outer. Width, height, strip, gap and chamber length are those of the paper (w, H, t, t1, t2);
    the other dimensions, which the paper does not give, are assumed. Fillets round the edges where chamber walls stand
    on the strip; those next to the ends of the arm belong to outer, all others to gap. A cell extends from the middle
    of one gap to the middle of the next.
    """

    family: ClassVar[str] = "pneunet"

    chambers: int = 11  #: number of chambers
    width: float = 15.0  #: of the arm across z, w
    chamber_length: float = 8.0  #: outer length of a chamber along x, t2
    gap: float = 2.0  #: between chambers, and thickness of the solid at each end, t1
    chamber_height: float = 12.0  #: outer height of a chamber above the strip, H
    strip: float = 3.0  #: thickness of the strip, t
    base: float = 2.0  #: thickness of the base plate under it, b; the material curve runs at half of it
    wall: float = 1.0  #: thickness of chamber walls across x
    side_wall: float = 2.0  #: thickness of chamber walls across z
    roof: float = 2.0  #: thickness of chamber roofs
    channel: float = 2.0  #: width and height of the air channel
    fillet: float = 0.0  #: radius of rounded edges below the chamber walls; 0 (sharp edges) or at least 0.1 mm

    def __post_init__(self) -> None:
        check_numbers(self, counts=["chambers"], or_zero=["fillet"])
        check_less(self, "wall", "chamber_length", 0.5, "the two walls leave no cavity")
        check_less(self, "side_wall", "width", 0.5, "the two side walls leave no cavity")
        check_less(self, "roof", "chamber_height", because="the cavity must rise above the strip")
        check_less(self, "channel", "strip", because="a channel as high as the strip would open into the gaps")
        if 0 < self.fillet < SMALLEST_FILLET:
            raise DesignError(
                "fillet",
                f"must be 0 for sharp edges or at least {SMALLEST_FILLET:g} mm, not {self.fillet:g} mm: elements at "
                "a rounded edge are as small as a third of its arc",
            )
        check_less(self, "fillet", "gap", 0.5, "the fillets at both sides of a gap meet")
        check_less(self, "fillet", "chamber_height", because="it rounds the edge below the chamber's wall")
        across = self.width - 2 * self.side_wall
        if not self.channel < across:
            raise DesignError(
                ("channel", "width", "side_wall"),
                f"channel {self.channel:g} mm must be less than the width of the cavity, "
                f"width - 2 side_wall = {across:g} mm",
            )

    @property
    def length(self) -> float:
        return self.chambers * self.chamber_length + (self.chambers + 1) * self.gap

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.base + self.strip + self.chamber_height, self.width)

    @property
    def curve_y(self) -> float:
        return self.base / 2

    @property
    def pitch(self) -> float:
        return self.gap + self.chamber_length

    @property
    def solid_volume(self) -> float:
        plates = self.length * self.width * (self.base + self.strip)
        blocks = self.chambers * self.chamber_length * self.width * self.chamber_height
        fillets = 2 * self.chambers * self.width * (1 - pi / 4) * self.fillet**2
        return plates + blocks + fillets - self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        inside = self.chamber_length - 2 * self.wall
        across = self.width - 2 * self.side_wall
        cavities = self.chambers * inside * across * (self.strip + self.chamber_height - self.roof)
        channels = (self.chambers - 1) * (self.gap + 2 * self.wall) * self.channel**2
        return {"cavity": cavities + channels}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.side_wall, self.roof, self.base, self.strip)

    @property
    def base_top(self) -> float:
        return self.base

    @property
    def outer_corners(self) -> bool:
        return True

    def repetition(self, size: float, grading: Grading) -> Repetition:
        middle = self.gap + self.chamber_length / 2
        edge = 1.5 * self.gap + self.chamber_length
        return Repetition(mesh_solid(self._drawing(middle, edge), size, grading), middle, edge, 2 * (self.chambers - 1))

    def _drawing(self, middle: float, edge: float) -> Solid:
        """The end piece and the half cell that are repeated.

        The end piece reaches to the middle of the first chamber (x = middle, mm). With more than one chamber the half
        cell reaches from there to the middle of the first gap (x = edge, mm).
        """
        z, ceiling = self.width / 2, self.base + self.strip + self.chamber_height
        near, far = self.gap, self.gap + self.chamber_length

        def fillet(x: float, side: int) -> list[Fillet]:
            return [Fillet(x, self.base + self.strip, self.fillet, side, z)] if self.fillet else []

        def plates_and_block(
            start: float, stop: float, chamber: tuple[float, float], fillets: list[Fillet]
        ) -> list[list[Shape]]:
            plate, bottom = self.base_plate(start, stop)
            return [
                *plate,
                [
                    Box((start, bottom, 0), (stop, self.base + self.strip, z)),
                    Box((chamber[0], bottom, 0), (chamber[1], ceiling, z)),
                    *fillets,
                ],
            ]

        def cavity(start: float, stop: float) -> Box:
            return Box((start, self.base, 0), (stop, ceiling - self.roof, z - self.side_wall))

        end = plates_and_block(0, middle, (near, middle), fillet(near, -1))
        if self.chambers == 1:
            return Solid({"end": end}, {"cavity": [cavity(near + self.wall, middle)]})
        inner = far - self.wall
        channel = Box((inner, self.base, 0), (edge, self.base + self.channel, self.channel / 2))
        return Solid(
            material={"end": end, "cell": plates_and_block(middle, edge, (middle, far), fillet(far, 1))},
            air={
                "cavity": [cavity(near + self.wall, middle), cavity(middle, inner), channel],
                "gap": [Box((far, self.base + self.strip, 0), (edge, ceiling, z), fillet(far, 1))],
            },
        )
