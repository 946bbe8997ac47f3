"""How many half cells the two ends of an arm disturb."""

from dataclasses import dataclass, field
from typing import NamedTuple, final

import numpy as np

from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.cell.curves import ArmTasks, Measured, PieceCurves
from pipeline.cell.pieces import ArmPieces, NoArmLaw
from pipeline.parallel import Pending
from rod.arm_law.curves import CellCurve, ClampCurve

#: largest displacement of the arm's end, over its length, by which end pieces that differ by a cell may differ
DECAY = 5e-4
#: the same beyond which the arm is said to have no undisturbed cells
NOT_DECAYED = 1e-2


class Decayed(NamedTuple):
    """The end pieces in which the disturbance has decayed."""

    half_cells: int  #: in each of them
    error: float | None  #: of the arm's end by cells that they still disturb, over the length; None: not known
    limit: str  #: a sentence where it could not be seen, or has not decayed; empty otherwise


@final
@dataclass(eq=False)  # arrays inside
class Decay:
    """Clamped ends with few and with more half cells, without moment."""

    pieces: ArmPieces
    tasks: ArmTasks
    cell: CellCurve  #: beside the clamped ends
    _pending: dict[int, Pending[Measured[ClampCurve]]] = field(default_factory=dict, init=False)

    def begin(self, half_cells: int) -> None:
        """Submit the clamped ends with so many half cells and with two more, if the arm has so many."""
        for k in (half_cells, half_cells + 2):
            if half_cells + 2 <= self.pieces.repetition.half_cells and k not in self._pending:
                self._pending[k] = self.tasks.submit(PieceCurves.clamp_without_moment, self.cell, k)

    def decided(self) -> Decayed:
        """So many half cells that two more change the arm's end by less than DECAY. Raises `NoArmLaw`."""
        available, failure = self.pieces.repetition.half_cells, ""
        compared: tuple[int, float] | None = None  # half cells and error of the last pair that was solved
        for half_cells in range(1, available // 2 + 1, 2):
            if half_cells + 2 > available:
                return Decayed(half_cells, None, "the arm is too short to see how far its ends disturb the cells")
            self.begin(half_cells)
            try:
                shorter, longer = (self._pending[k].result().curve for k in (half_cells, half_cells + 2))
            except PieceFailed as failed:  # longer ones may have an equilibrium
                failure = str(failed).rstrip(".")
                continue
            error = difference(shorter, longer, self.cell, self.pieces.design.length)
            if error <= DECAY:
                return Decayed(half_cells, error, "")
            compared, failure = (half_cells, error), ""
        if compared is None:
            return Decayed(half_cells, None, f"how far the ends of the arm disturb its cells is not known: {failure}")
        half_cells, error = compared
        pair = f"end pieces of {half_cells} and {half_cells + 2} half cells"
        differ = f"{pair} differ by {100 * error:.2g} % of the length"
        if error > NOT_DECAYED:
            raise NoArmLaw(f"the two ends disturb all cells of the arm: {differ} at its end")
        why = f"longer ones were not solved ({failure})" if failure else "which has no room for longer ones"
        return Decayed(half_cells, error, f"{differ} at the end of the arm{';' if failure else ','} {why}")


def difference(first: ClampCurve, second: ClampCurve, cell: CellCurve, length: float) -> float:
    """Largest displacement of the end of an arm of `length` mm by exchanging its clamped end, over the length.

    Both without moment, to first order up to the moment that straightens the cell.
    """
    straight = abs(cell.at(0.0)[0]) * float(np.interp(0.0, cell.moment, cell.rigidity))

    def distance(name: str) -> float:
        """Of the values without moment, and of their slopes at that moment."""
        (value, rate), (other, other_rate) = (_without_moment(clamp, name) for clamp in (first, second))
        return float(np.linalg.norm(value - other) + straight * np.linalg.norm(rate - other_rate))

    return distance("rotation") + distance("offset") / length


def _without_moment(clamp: ClampCurve, name: str) -> tuple[Array, Array]:
    """A value without moment, to first order, and its rate, of the first state."""
    rate = getattr(clamp, f"{name}_by_moment")[0]
    return getattr(clamp, name)[0] - clamp.moment[0] * rate, rate
