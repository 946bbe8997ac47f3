"""States of a piece with their slopes, and the one without moment."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

from fem.cell.air import air_volumes
from fem.cell.inflation import bent, inflated
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import Slopes, slopes
from fem.equations.linear import SingularMatrix
from fem.path.predictor import PathPoint
from geometry import Reason, Values
from geometry.arrays import Array
from pipeline.values.pressure import in_kPa
from pipeline.values.reasons import render

#: Newton's method for the angle without moment: largest error of the angle to first order, rad
STRAIGHT, MAX_ITERATIONS = 1e-8, 12
#: rad, largest change of the angle in one iteration
LARGEST_TURN = 0.2


@dataclass(frozen=True, eq=False)  # arrays inside
class PiecePoint:
    """One state of a piece with its slopes."""

    state: PieceState
    slopes: Slopes
    volumes: Array  #: (c,) mm3, air in each cavity of the piece; empty where it is not known

    @classmethod
    def of(cls, piece: BendingPiece, state: PieceState) -> "PiecePoint":
        """One factorization. Raises `PieceFailed` where the piece is not stable."""
        with stable(piece, state):
            known = slopes(piece, state)
        return PiecePoint(state, known, air_volumes(piece.body, piece.space, state.state.displacement))

    @property
    def moment(self) -> float:
        """N mm."""
        return self.state.moment

    @property
    def path_point(self) -> PathPoint:
        """The state and its tangent, on the path of the angle."""
        return PathPoint(self.state.angle, 1.0, self.state.state, self.state.touches, self.slopes.angle_rate)


Point = TypeVar("Point", bound=PiecePoint)
Value = TypeVar("Value")


@dataclass(frozen=True)
class KeptCurve(Generic[Value]):
    """A curve, or a number, and what it cost."""

    curve: Value
    limits: tuple[Reason, ...] = ()  #: why it was not followed further
    #: of the cubics between its states: of a cell over the largest curvature, of a clamped end in rad
    error: float = 0.0
    factorizations: int = 0
    seconds: float = 0.0
    unknowns: int = 0  #: displacement components of the piece
    #: derivatives by the design of the states of the curve, by parameter and quantity (`pipeline.law.piece.rates`)
    rates: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, repr=False)
    is_stored: bool = field(default=False, compare=False)  #: by an earlier run


def reason_of(failure: Exception) -> Reason:
    """Why a curve ends."""
    return Reason("piece_fails", {"why": str(failure).rstrip(".")})


def failure_of(failure: Exception | Reason) -> Reason:
    """Why a law lacks a pressure of its configuration."""
    return Reason(
        "law_incomplete", {"why": render(failure) if isinstance(failure, Reason) else str(failure).rstrip(".")}
    )


def without_moment(
    piece: BendingPiece,
    state: PieceState,
    point_of: Callable[[BendingPiece, PieceState], Point],
    tolerance: float = STRAIGHT,
) -> Point:
    """The piece without moment at the pressure of a state, by Newton's method for the angle from that state.

    point_of: makes a point of a state. tolerance: largest error of the angle to first order, rad. Raises `PieceFailed`.
    """
    for _ in range(MAX_ITERATIONS):
        point = point_of(piece, state)
        correction = -point.moment / point.slopes.moment_by_angle
        if abs(correction) < tolerance:
            return point
        angle = state.angle + float(np.clip(correction, -LARGEST_TURN, LARGEST_TURN))
        state = bent(piece, angle, state, None, point.path_point)
    values: Values = {"piece": piece.name, "pressure_kPa": in_kPa(state.pressure)}
    raise PieceFailed(Reason("no_piece_without_moment", values))


def reached(piece: BendingPiece, pressure: float, angle: float, made_of: Callable[[PieceState], Value]) -> Value:
    """What is made of the state at a pressure in MPa and an angle in rad.

    It is solved from rest, and from half the pressure and the angle where that leads to no stable state. Raises
    `PieceFailed`.
    """
    with suppress(PieceFailed):
        return made_of(inflated(piece, pressure, angle))
    half = inflated(piece, 0.5 * pressure, 0.5 * angle)
    return made_of(piece.solve(pressure, angle, half))


@contextmanager
def stable(piece: BendingPiece, state: PieceState) -> Iterator[None]:
    """An unstable state, or one with a singular tangent, becomes a `PieceFailed` that names it."""
    try:
        if state.negative_pivots:
            raise PieceFailed(_unstable(piece, state), Reason("tangent_indefinite"))
        yield
    except SingularMatrix as failure:
        raise PieceFailed(_unstable(piece, state), Reason("tangent_singular", {"why": str(failure)})) from None


def _unstable(piece: BendingPiece, state: PieceState) -> Reason:
    kappa, pressure = state.angle / piece.body.length, in_kPa(state.pressure)
    return Reason("piece_unstable", {"piece": piece.name, "pressure_kPa": pressure, "kappa_per_mm": kappa})
