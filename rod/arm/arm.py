"""What every arm at one pressure answers, whichever law it follows."""

from typing import Protocol

from rod.arm.response import Posed
from rod.load import Load
from rod.solution import RodSolution, SpatialSolution
from rod.spatial import Position, SpatialLoad


class Arm(Posed, Protocol):
    """A clamped arm whose clamp is the origin. Raises `RodError` for what its law does not know."""

    @property
    def has_own_law(self) -> bool:
        """Whether its law was measured on a cell; other arms have two straight lines."""

    @property
    def carried(self) -> tuple[float, float]:
        """N/mm, x and y of a weight that always acts, and that another direction of gravity replaces."""

    def in_plane(
        self, load: Load, held: tuple[float | None, float | None], *, together: bool | None = None
    ) -> RodSolution:
        """The equilibrium under a load; held: (x, y) of the end in mm, None where it is free.

        together: the rest shape grows with the load from the straight arm; None: as in the experiments.
        """

    def solve_in_space(self, load: SpatialLoad, position: Position = (None, None, None)) -> SpatialSolution:
        """The equilibrium in space; position: (x, y, z) of the end in mm, None where it is free."""
