"""How a piece comes to a pressure along the volume of its air, where increments of the pressure do not lead on.

The energy W(V, phi) of a piece by the volume V of its air and the angle phi of its plane has the pressure and the
moment as its derivatives. Without moment the piece is stable under a given pressure while the Hessian of W is positive.
On the way along the volume the pressure has a maximum where it stops being so, the limit pressure, and perhaps a
minimum from which on the piece is stable again: between both it snaps from one form to the other. All states are
regular points of this way, with the volume prescribed. Its parameter is ln V.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, log
from typing import final

import numpy as np

from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import Slopes, slopes
from fem.equations.linear import SingularMatrix
from fem.path.limit import difference
from fem.path.predictor import PathPoint, extrapolate, weighted_sum
from geometry import Reason

#: first step of ln V, the smallest and the largest one
FIRST, SMALLEST, LARGEST = 0.15, 0.01, 0.5
#: difference of a state from the predicted one, relative, for which steps are made
ERROR = 4e-3
#: change of the step after an error, least and most
SHRINKS, GROWS = 0.4, 2.0
#: largest error of an extreme pressure to first order, relative, and how many states are solved for one at the most
EXACT, MOST_STATES = 1e-6, 12
#: air over that at rest beyond which no piece is followed
MOST_AIR = 300.0


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class FreePoint:
    """A state of a piece on the way along its air, about without moment, with its slopes."""

    state: PieceState
    slopes: Slopes
    air: float  #: ln of the volume in mm3
    turns: bool  #: whether the angle of its plane follows from the moment

    @classmethod
    def of(cls, piece: BendingPiece, state: PieceState) -> "FreePoint":
        """One factorization. Raises `PieceFailed` where the tangent is singular."""
        try:
            return cls(state, slopes(piece, state), log(piece.volume(state.state)), piece.start != "free")
        except SingularMatrix as failure:
            why = Reason("tangent_singular", {"why": str(failure)})
            raise PieceFailed(piece.where(state), why) from None

    @property
    def lack(self) -> float:
        """rad, from the angle to the one without moment at this volume, to first order."""
        return -self.state.moment / self.slopes.energy_hessian[1, 1] if self.turns else 0.0

    @property
    def pressure(self) -> float:
        """MPa, without moment at this volume, to first order."""
        return self.state.pressure + self.slopes.energy_hessian[0, 1] * self.lack

    @property
    def turn(self) -> float:
        """rad, change of the angle without moment by ln V."""
        hessian = self.slopes.energy_hessian
        return -hessian[0, 1] / hessian[1, 1] * exp(self.air) if self.turns else 0.0

    @property
    def rise(self) -> float:
        """MPa, change of the pressure without moment by ln V; positive where the piece is stable under a pressure."""
        hessian = self.slopes.energy_hessian
        return hessian[0, 0] * exp(self.air) + hessian[0, 1] * self.turn

    @property
    def is_stable(self) -> bool:
        """Whether it is stable under a given pressure."""
        return self.rise > 0.0 and not self.state.negative_pivots

    @property
    def path_point(self) -> PathPoint:
        by_volume, by_angle = self.slopes.rates_at_volume
        rate = weighted_sum([(exp(self.air), by_volume), (self.turn, by_angle)])
        return PathPoint(self.air, 1.0, self.state.state, self.state.touches, rate)


def free_at(piece: BendingPiece, air: float, before: FreePoint | None, last: FreePoint) -> tuple[FreePoint, float]:
    """The piece at another volume, ln V, about without moment, and how far it is from the predicted state."""
    step = air - last.air
    bend = 0.0 if before is None else (last.turn - before.turn) / (last.air - before.air)
    angle = last.state.angle + last.lack + step * (last.turn + 0.5 * step * bend)
    predicted = extrapolate(None if before is None else before.path_point, last.path_point, air)
    assert predicted is not None
    state = piece.solve_at_volume(exp(air), angle, predicted, last.state)
    return FreePoint.of(piece, state), difference(state.state, predicted)


def followed(piece: BendingPiece) -> Iterator[FreePoint]:
    """States by growing volume, from rest on. Raises `PieceFailed` where no state follows."""
    before, last = None, FreePoint.of(piece, piece.rest())
    yield last
    most, step = last.air + log(MOST_AIR), FIRST
    while last.air < most:
        try:
            point, error = free_at(piece, last.air + step, before, last)
        except PieceFailed:
            step *= SHRINKS
            if step < SMALLEST:
                raise
            continue
        before, last = last, point
        step = min(LARGEST, step * float(np.clip((ERROR / error) ** 0.25, SHRINKS, GROWS)))
        yield last


def extremum(piece: BendingPiece, before: FreePoint, last: FreePoint) -> FreePoint:
    """Where the pressure without moment has a maximum or a minimum between two states. Raises `PieceFailed`."""
    ends = [before, last]
    for _ in range(MOST_STATES):
        part = ends[0].rise / (ends[0].rise - ends[1].rise)
        air = ends[0].air + part * (ends[1].air - ends[0].air)
        point, _ = free_at(piece, air, *ends)
        if abs(point.rise * (ends[1].air - ends[0].air)) < EXACT * point.pressure:
            break
        ends[int((point.rise > 0.0) == (ends[1].rise > 0.0))] = point
    return point
