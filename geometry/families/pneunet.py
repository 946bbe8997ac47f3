"""Pneu-net with gaps between its chambers ("fast" pneu-net), the first arm of the paper."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import Annotated, ClassVar, final

from geometry.body import Body
from geometry.errors import DesignError
from geometry.families.design import OnBasePlate
from geometry.families.dimensions import not_less
from geometry.grading import OFF, Grading
from geometry.meshing.mirror import Repetition, name_faces
from geometry.meshing.moving import Drawing
from geometry.meshing.shapes import Box, Fillet, Shape
from geometry.meshing.solid import Solid, mesh_solid

#: smallest radius of a rounded edge, mm; elements beside it are as small as a third of its arc
SMALLEST_FILLET = 0.1


@dataclass(frozen=True)
class _Chamber:
    """Where a chamber begins and ends along x, and its height above the strip, mm."""

    start: float
    stop: float
    height: float


@final
@dataclass(frozen=True)
class PneuNet(OnBasePlate):
    """A row of chambers with gaps between them, on a strip, on a base plate; all lengths in mm.

    Faces: clamp (x = 0), tip (x = length), sym (z = 0), cavity, gap (the facing walls of neighbouring chambers and the
    strip between them), outer. Width, height, strip, gap and chamber length are those of the paper (w, H, t, t1, t2);
    the other dimensions, which the paper does not give, are assumed. Fillets round the edges where chamber walls stand
    on the strip; those next to the ends of the arm belong to outer, all others to gap. A cell extends from the middle
    of one gap to the middle of the next.

    Lists, one entry per chamber or gap from the clamp on, make chambers that are not equal. Such an arm is meshed as a
    whole and repeats no cell; its pitch is the mean one.
    """

    family: ClassVar[str] = "pneunet"
    lists: ClassVar[Mapping[str, str]] = {
        "chamber_lengths": "chamber_length",
        "chamber_heights": "chamber_height",
        "gaps": "gap",
    }

    chambers: Annotated[int, "number of chambers"] = 11
    width: Annotated[float, "of the arm across z, w"] = 15.0
    chamber_length: Annotated[float, "outer length of a chamber along x, t2"] = 8.0
    gap: Annotated[float, "between chambers, and length of the strip without a chamber at each end, t1"] = 2.0
    chamber_height: Annotated[float, "outer height of a chamber above the strip, H"] = 12.0
    strip: Annotated[float, "thickness of the strip, t"] = 3.0
    base: Annotated[float, "thickness of the base plate under it, b; the material curve runs at half of it"] = 2.0
    wall: Annotated[float, "thickness of chamber walls across x"] = 1.0
    side_wall: Annotated[float, "thickness of chamber walls across z"] = 2.0
    roof: Annotated[float, "thickness of chamber roofs"] = 2.0
    channel: Annotated[float, "width and height of the air channel"] = 2.0
    fillet: Annotated[float, "radius of rounded edges below the chamber walls; 0 (sharp edges) or at least 0.1 mm"] = (
        0.0
    )
    chamber_lengths: Annotated[tuple[float, ...], "of each chamber from the clamp on, instead of `chamber_length`"] = ()
    chamber_heights: Annotated[tuple[float, ...], "of each chamber from the clamp on, instead of `chamber_height`"] = ()
    gaps: Annotated[tuple[float, ...], "instead of `gap`: at the clamp, between chambers, and at the tip"] = ()

    def _impossible(self) -> Iterator[DesignError]:
        for name, usual in self.lists.items():
            given, count = len(getattr(self, name)), self._count(usual)
            if given not in (0, count):
                needed = f"must have {count} entries for {self.chambers} chambers, not {given}"
                yield DesignError((name, "chambers"), f"{needed}; give all of them, or {usual} alone for equal ones")
        yield from not_less(self, "wall", self._name("chamber_length"), 0.5, "the two walls leave no cavity")
        yield from not_less(self, "side_wall", "width", 0.5, "the two side walls leave no cavity")
        yield from not_less(self, "roof", self._name("chamber_height"), because="the cavity must rise above the strip")
        yield from not_less(self, "channel", "strip", because="a channel as high as the strip would open into the gaps")
        if 0 < self.fillet < SMALLEST_FILLET:
            allowed = f"must be 0 for sharp edges or at least {SMALLEST_FILLET:g} mm, not {self.fillet:g} mm"
            yield DesignError("fillet", f"{allowed}: elements are as small as a third of its arc")
        yield from not_less(self, "fillet", self._name("gap"), 0.5, "the fillets at both sides of a gap meet")
        rounded = "it rounds the edge below the chamber's wall"
        yield from not_less(self, "fillet", self._name("chamber_height"), because=rounded)
        across = self.width - 2 * self.side_wall
        if 0 < across <= self.channel:
            allowed = f"must be less than the width of the cavity, width - 2 side_wall = {across:g} mm"
            yield DesignError(("channel", "width", "side_wall"), f"{self.channel:g} mm {allowed}")

    def _count(self, dimension: str) -> int:
        """How many chambers or gaps have this dimension."""
        return self.chambers + 1 if dimension == "gap" else self.chambers

    def _name(self, dimension: str) -> str:
        """The name of the list that is given instead of a dimension, or of the dimension."""
        return f"{dimension}s" if getattr(self, f"{dimension}s") else dimension

    def _each(self, dimension: str) -> list[float]:
        """Every entry of a dimension of the chambers or gaps, mm."""
        return list(getattr(self, f"{dimension}s") or [getattr(self, dimension)] * self._count(dimension))

    def _mean(self, dimension: str) -> float:
        """The mean of all entries of a dimension, mm."""
        entries = self._each(dimension)
        return entries[0] if len(set(entries)) == 1 else sum(entries) / len(entries)

    @property
    def _chambers(self) -> list[_Chamber]:
        """The chambers from the clamp on."""
        chambers, x = [], 0.0
        for gap, length, height in zip(
            self._each("gap"), self._each("chamber_length"), self._each("chamber_height"), strict=False
        ):
            chambers.append(_Chamber(x + gap, x + gap + length, height))
            x += gap + length
        return chambers

    @property
    def has_equal_cells(self) -> bool:
        """Whether all chambers and all gaps are equal."""
        return all(len(set(self._each(dimension))) == 1 for dimension in self.lists.values())

    @property
    def cell_count(self) -> int:
        return self.chambers

    @property
    def repeats(self) -> bool:
        return self.has_equal_cells and super().repeats

    @property
    def why_no_cell(self) -> str:
        if self.has_equal_cells:
            return super().why_no_cell
        return "the chambers or the gaps of the arm are not equal, so that it repeats no cell"

    @property
    def length(self) -> float:
        return self._mean("chamber_length") * self.chambers + self._mean("gap") * (self.chambers + 1)

    @property
    def extent(self) -> tuple[float, float, float]:
        return (self.length, self.base + self.strip + max(self._each("chamber_height")), self.width)

    @property
    def pitch(self) -> float:
        return self._mean("gap") + self._mean("chamber_length")

    @property
    def solid_volume(self) -> float:
        plates = self.length * self.width * (self.base + self.strip)
        blocks = self.width * sum((chamber.stop - chamber.start) * chamber.height for chamber in self._chambers)
        fillets = 2 * self.chambers * self.width * (1 - pi / 4) * self.fillet**2
        return plates + blocks + fillets - self.cavity_volume

    @property
    def cavity_volumes(self) -> Mapping[str, float]:
        across = self.width - 2 * self.side_wall
        cavities = across * sum(
            (chamber.stop - chamber.start - 2 * self.wall) * (self.strip + chamber.height - self.roof)
            for chamber in self._chambers
        )
        channels = sum(gap + 2 * self.wall for gap in self._each("gap")[1:-1]) * self.channel**2
        return {"cavity": cavities + channels}

    @property
    def thinnest_wall(self) -> float:
        return min(self.wall, self.side_wall, self.roof, self.base, self.strip)

    @property
    def outer_corners(self) -> bool:
        return True

    def body(self, size: float, grading: Grading = OFF) -> Body:
        if self.has_equal_cells:
            return super().body(size, grading)
        self.check_size(size)
        solid = mesh_solid(self._solid({"arm": (0.0, self.length)}), size, grading)
        planes = {"clamp": (0, 0.0), "tip": (0, self.length), "sym": (2, 0.0)}
        return self._body(
            name_faces(solid.points, solid.regions["arm"], solid.walls, planes, solid.curved), self.length, True
        )

    def repetition(self, size: float, grading: Grading) -> Repetition:
        if not self.has_equal_cells:
            raise DesignError(next(name for name in self.lists if getattr(self, name)), self.why_no_cell)
        return super().repetition(size, grading)

    @property
    def drawing(self) -> Drawing:
        gap, chamber_length = self._each("gap")[0], self._each("chamber_length")[0]
        middle, edge = gap + chamber_length / 2, 1.5 * gap + chamber_length
        regions = {"end": (0.0, middle), "cell": (middle, edge)} if self.chambers > 1 else {"end": (0.0, middle)}
        return Drawing(self._solid(regions), middle, edge)

    def _solid(self, regions: Mapping[str, tuple[float, float]]) -> Solid:
        """The half z >= 0 of the arm between two x (mm) for each region."""
        air: dict[str, list[Shape]] = {"cavity": [], "gap": []}
        for start, stop in regions.values():
            air["cavity"] += self._cavities(start, stop)
            air["gap"] += self._gaps(start, stop)
        material = {name: self._blocks(start, stop) for name, (start, stop) in regions.items()}
        return Solid(material, {name: shapes for name, shapes in air.items() if shapes})

    def _blocks(self, start: float, stop: float) -> list[list[Shape]]:
        """The base plate, and the strip with chambers and fillets, without cavities."""
        plate, bottom = self.base_plate(start, stop)
        top, z = self.base + self.strip, self.width / 2
        blocks: list[Shape] = [Box((start, bottom, 0.0), (stop, top, z))]
        for chamber in self._chambers:
            low, high = max(start, chamber.start), min(stop, chamber.stop)
            if low < high:
                blocks.append(Box((low, bottom, 0.0), (high, top + chamber.height, z)))
            blocks += self._fillets({chamber.start: -1, chamber.stop: 1}, start, stop)
        return [*plate, blocks]

    def _cavities(self, start: float, stop: float) -> list[Shape]:
        """The air in chambers, and then that in channels."""
        wall, channel = self.wall, (self.base + self.channel, self.channel / 2)
        top, z = self.base + self.strip, self.width / 2 - self.side_wall
        ranges = [(c.start + wall, c.stop - wall, top + c.height - self.roof, z) for c in self._chambers]
        ranges += [(one.stop - wall, two.start + wall, *channel) for one, two in pairwise(self._chambers)]
        cut = [(max(start, low), min(stop, high), y, z) for low, high, y, z in ranges]
        return [Box((low, self.base, 0.0), (high, y, z)) for low, high, y, z in cut if low < high]

    def _gaps(self, start: float, stop: float) -> list[Shape]:
        """The air in gaps up to the higher one of the chambers beside them."""
        top, shapes = self.base + self.strip, list[Shape]()
        for before, behind in pairwise(self._chambers):
            low, high = max(start, before.stop), min(stop, behind.start)
            if low < high:
                upper = (high, top + max(before.height, behind.height), self.width / 2)
                fillets = self._fillets({before.stop: 1, behind.start: -1}, start, stop)
                shapes.append(Box((low, top, 0.0), upper, fillets))
        return shapes

    def _fillets(self, walls: Mapping[float, int], start: float, stop: float) -> list[Fillet]:
        """Of the edges below walls between start and stop, each by the side (1 or -1) of its outside."""
        top, z = self.base + self.strip, self.width / 2
        within = {x: side for x, side in walls.items() if start < x <= stop and self.fillet}
        return [Fillet(x, top, self.fillet, side, z) for x, side in within.items()]
