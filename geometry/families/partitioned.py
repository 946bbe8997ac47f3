"""Arms that are smooth outside, with chambers parted by solid partitions or with one cavity: what families share."""

from abc import abstractmethod
from collections.abc import Callable

from geometry.families.design import OnBasePlate, SymmetricDesign, usual_cell
from geometry.meshing.mirror import slices
from geometry.meshing.moving import Drawing
from geometry.meshing.shapes import Box, Shape
from geometry.meshing.solid import Solid


class Bar(SymmetricDesign):
    """A bar with closed ends. A family is a dataclass with the fields named in its classes, all lengths in mm, and
    defines the solid bar."""

    end_wall: float

    @abstractmethod
    def _bar(self, start: float, stop: float) -> list[list[Shape]]:
        """The half z >= 0 of the solid without cavities, cut at the material curve; start <= x <= stop, in mm."""

    @property
    @abstractmethod
    def _cells(self) -> tuple[int, float]:
        """Number of cells and their length, mm."""

    @property
    def cell_count(self) -> int:
        return self._cells[0]

    @property
    def pitch(self) -> float:
        return self._cells[1]

    def _undivided(self, cavities: Callable[[float, float], list[Shape]]) -> Drawing:
        """The end piece and the half cell of a bar whose cavities go from one end wall to the other."""
        middle = self.end_wall + self.pitch / 2
        edge = middle + self.pitch / 2
        material, hollow = {"end": self._bar(0, middle)}, [cavities(self.end_wall, middle)]
        if self.cell_count > 1:
            material["cell"] = self._bar(middle, edge)
            hollow.append(cavities(middle, edge))
        air = dict(zip(self.cavities, map(list, zip(*hollow, strict=True)), strict=True))
        return Drawing(Solid(material, air), middle, edge)


class PartitionedDesign(Bar, OnBasePlate):
    """A bar with a row of equal chambers, one behind the other along x, that an air channel on the base plate joins.

    A cell extends from the middle of one partition to the middle of the next; those of a single chamber are nominal.
    """

    chambers: int
    chamber_length: float
    partition: float
    channel: float

    @abstractmethod
    def _cavity(self, start: float, stop: float) -> Shape:
        """The half z >= 0 of a cavity; start <= x <= stop, in mm."""

    @property
    def length(self) -> float:
        return self.chambers * self.chamber_length + (self.chambers - 1) * self.partition + 2 * self.end_wall

    @property
    def _cells(self) -> tuple[int, float]:
        if self.chambers > 1:
            return self.chambers, self.chamber_length + self.partition
        width = max(self.extent[1:])  # thinner cells than a quarter of it have flat elements
        return slices(self.chamber_length, min(2 / 3 * width, max(width / 4, usual_cell(self.length))))

    @property
    def channel_volume(self) -> float:
        """Volume of the air in all partitions together, mm3."""
        return (self.chambers - 1) * self.partition * self.channel**2

    @property
    def drawing(self) -> Drawing:
        if self.chambers == 1:
            return self._undivided(lambda start, stop: [self._cavity(start, stop)])
        near, far = self.end_wall, self.end_wall + self.chamber_length
        middle = self.end_wall + self.chamber_length / 2
        edge = middle + self.pitch / 2
        channel = Box((far, self.base, 0), (edge, self.base + self.channel, self.channel / 2))
        hollow = [self._cavity(near, middle), self._cavity(middle, far), channel]
        material = {"end": self._bar(0, middle), "cell": self._bar(middle, edge)}
        return Drawing(Solid(material, {"cavity": hollow}), middle, edge)


class UndividedDesign(Bar):
    """A round bar without partitions, whose cells are nominal: equal parts of its cavities, 2/3 of its width long."""

    length: float
    radius: float

    @abstractmethod
    def _cavities(self, start: float, stop: float) -> list[Shape]:
        """The half z >= 0 of each cavity in the order of `cavities`; start <= x <= stop, in mm."""

    @property
    def _cells(self) -> tuple[int, float]:
        return slices(self.length - 2 * self.end_wall, 4 / 3 * self.radius)

    @property
    def drawing(self) -> Drawing:
        return self._undivided(self._cavities)
