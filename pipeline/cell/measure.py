"""The curves of a cell of the arm, from finite elements of half a cell."""

from dataclasses import dataclass, field
from typing import final

import numpy as np

from fem.cell.axis import Axis, axis_of
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import Slopes, shear_rigidity, slopes
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.path.predictor import PathPoint, extrapolate
from rod.arm_law.curves import CellCurve

#: the moments of a law go beyond zero, and beyond the moment that straightens the arm, by that of a given force on the
#: end at the distance l, but to no more than this many times EI/l
REACH = 3.0
#: intervals of the first sweep to either side, and how often one is halved where its cubic is not good enough
INTERVALS, HALVINGS = 3, 4
#: a sweep ends where the rigidity of the cell falls below this part of that at rest: near the largest moment that
#: the cell bears its curvature depends on the pressure too strongly to be interpolated
SOFTENED = 0.3
#: how often a step is halved that changes the moment by far more than the last slope said
MAX_HALVINGS = 4
#: largest error of the cubic between two states, over the largest curvature of the law
TOLERANCE = 1e-3
#: Newton's method for the angle without moment: largest moment left over EI times an angle of one
STRAIGHT, MAX_ITERATIONS = 1e-8, 12


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class CellPoint:
    """One state of a half cell with its slopes."""

    state: PieceState
    slopes: Slopes
    axis: Axis
    shear: float  #: GA, N

    @property
    def moment(self) -> float:
        """N mm."""
        return self.state.moment

    @property
    def path_point(self) -> PathPoint:
        """The state and its tangent, on the path of the angle."""
        return PathPoint(self.state.angle, 1.0, self.state.state, self.state.touches, self.slopes.angle_rate)


@dataclass
class CellSweep:
    """The states of a half cell at one pressure, and why it was not followed further."""

    pressure: float  #: kPa
    points: list[CellPoint] = field(default_factory=list)  #: by increasing curvature
    #: why the curve ends, a sentence each: at the largest moment (1) and at the smallest (-1), unless it was reached
    ends: dict[int, str] = field(default_factory=dict)
    #: intervals with the error of their cubics where it was measured, rad
    errors: list[tuple[CellPoint, CellPoint, float]] = field(default_factory=list)

    @property
    def limits(self) -> list[str]:
        """The sentences of `ends`."""
        return [self.ends[side] for side in sorted(self.ends)]

    @property
    def error(self) -> float:
        """Largest error of the cubics between the states, over the largest curvature."""
        scale = max(abs(point.state.angle) for point in self.points)
        errors = [error for first, second, error in self.errors if first in self.points and second in self.points]
        return max(errors, default=0.0) / scale

    def curve(self, half_pitch: float) -> CellCurve:
        """The sweep as a curve of the law; raises `rod.RodError` where the moment does not rise."""
        points = self.points
        h = half_pitch
        return CellCurve(
            pressure=self.pressure,
            moment=np.array([p.moment for p in points]),
            kappa=np.array([p.state.angle / h for p in points]),
            rigidity=np.array([p.slopes.moment_by_angle * h for p in points]),
            moment_by_pressure=np.array([p.slopes.moment_by_pressure / 1000.0 for p in points]),
            stretch=np.array([p.axis.stretch for p in points]),
            stretch_by_kappa=np.array([p.axis.stretch_by_angle * h for p in points]),
            stretch_by_pressure=np.array([p.axis.stretch_by_pressure / 1000.0 for p in points]),
            axial_rigidity=np.array([h / p.slopes.distance_by_force for p in points]),
            shear_rigidity=np.array([p.shear for p in points]),
            contact=np.array([p.state.touches for p in points]),
            min_J=np.array([p.state.extremes.min_J for p in points]),
            s=points[0].axis.s,
            ripple=np.array([p.axis.ripple for p in points]),
        )


@dataclass(frozen=True)
class Reach:
    """For what loads a law is made."""

    length: float  #: mm, of the arm
    force: float  #: N, on its end
    next_pressure: float | None = None  #: kPa; the moment that straightens the arm there is within the law, too


def sweep_cell(piece: BendingPiece, pressure_kPa: float, reach: Reach, start: PieceState | None = None) -> CellSweep:
    """Follow a half cell at one pressure over the moments that an arm meets.

    start: a state at another pressure. Raises `PieceFailed` where the unloaded cell is not reached.
    """
    h = piece.body.length
    middle = cell_without_moment(piece, pressure_kPa / 1000.0, start)
    sweep = CellSweep(pressure_kPa, [middle])
    rigidity = middle.slopes.moment_by_angle * h
    beyond = min(REACH * rigidity / reach.length, reach.force * reach.length)
    straight = -middle.state.angle / h * rigidity
    if reach.next_pressure is not None:
        straight += middle.slopes.moment_by_pressure / 1000.0 * (reach.next_pressure - pressure_kPa)
    softest = SOFTENED * slopes(piece, piece.rest()).moment_by_angle
    _sweep_to(piece, sweep, max(straight, 0.0) + beyond, softest)
    _sweep_to(piece, sweep, min(straight, 0.0) - beyond, softest)
    _refine(piece, sweep)
    _keep_rising(sweep, middle, h)
    return sweep


def cell_without_moment(piece: BendingPiece, pressure: float, start: PieceState | None = None) -> CellPoint:
    """The cell without moment at a pressure in MPa, by Newton's method for the angle.

    start: a state to begin with, the cell at rest unless it is given. Raises `PieceFailed`.
    """
    start = piece.rest() if start is None else start
    state = start if start.pressure == pressure else piece.solve(pressure, start.angle, start)
    for _ in range(MAX_ITERATIONS):
        point = _point(piece, state)
        correction = -point.moment / point.slopes.moment_by_angle
        if abs(correction) < STRAIGHT:
            return point
        angle = state.angle + float(np.clip(correction, -0.2, 0.2))
        state = piece.solve(pressure, angle, state, _predicted(None, point, angle))
    raise PieceFailed(f"the half cell at {1000.0 * pressure:.4g} kPa has no state without moment near the last one")


def _point(piece: BendingPiece, state: PieceState) -> CellPoint:
    try:
        known = slopes(piece, state)
        shear = shear_rigidity(piece, state, known)
    except SingularMatrix as failure:
        curvature = 1000.0 * state.angle / piece.body.length
        raise PieceFailed(
            f"the half cell is not stable at {1000.0 * state.pressure:.4g} kPa and {curvature:.4g} 1/m: {failure}"
        ) from None
    return CellPoint(state, known, axis_of(piece, state, known), shear)


def _predicted(before: CellPoint | None, last: CellPoint, angle: float) -> State | None:
    """Where Newton's method starts at an angle on the path through one or two points."""
    return extrapolate(None if before is None else before.path_point, last.path_point, angle)


def _sweep_to(piece: BendingPiece, sweep: CellSweep, moment: float, softest: float) -> None:
    """States until the moment is passed, or until there is none; each step changes the moment by a part of it.

    softest: N mm, slope of the moment by the angle below which the sweep ends.
    """
    outward = 1 if moment > 0 else -1
    interval, halvings = abs(moment) / INTERVALS, 0
    while True:
        last = sweep.points[-1 if outward > 0 else 0]
        if outward * (last.moment - moment) >= 0.0:
            return
        before = None
        if len(sweep.points) > 1:
            before = sweep.points[-2 if outward > 0 else 1]
        angle = last.state.angle + outward * interval / last.slopes.moment_by_angle / 2**halvings
        try:
            point = _point(piece, piece.solve(last.state.pressure, angle, last.state, _predicted(before, last, angle)))
        except PieceFailed as failure:
            sweep.ends[outward] = str(failure)
            return
        change = outward * (point.moment - last.moment)
        if change <= 0.0:
            curvature = 1000.0 * last.state.angle / piece.body.length
            sweep.ends[outward] = (
                f"the moment of the cell falls at {sweep.pressure:g} kPa beyond a curvature of {curvature:.4g} 1/m"
            )
            return
        if change > 2.0 * interval and halvings < MAX_HALVINGS:  # walls met on the way
            halvings += 1
            continue
        sweep.points.insert(len(sweep.points) if outward > 0 else 0, point)
        if point.slopes.moment_by_angle < softest:
            curvature = 1000.0 * point.state.angle / piece.body.length
            sweep.ends[outward] = (
                f"the cell at {sweep.pressure:g} kPa has less than {SOFTENED:g} of its rigidity at rest beyond a "
                f"curvature of {curvature:.4g} 1/m, and the law ends there"
            )
            return


def _refine(piece: BendingPiece, sweep: CellSweep) -> None:
    """Halve the intervals of the angle until their cubics are right to TOLERANCE in the middle."""
    scale = max(abs(point.state.angle) for point in sweep.points)
    pending = [(a, b, HALVINGS) for a, b in zip(sweep.points[:-1], sweep.points[1:], strict=True)]
    while pending:
        first, second, halvings = pending.pop()
        angle = 0.5 * (first.state.angle + second.state.angle)
        try:
            predicted = _predicted(first, second, angle)
            middle = _point(piece, piece.solve(first.state.pressure, angle, first.state, predicted))
        except PieceFailed as failure:
            _cut(sweep, first, second, str(failure))
            pending = [interval for interval in pending if interval[0] in sweep.points and interval[1] in sweep.points]
            continue
        error = _cubic_error(first, second, middle)
        sweep.points.insert(sweep.points.index(second), middle)
        if error > TOLERANCE * scale and halvings:
            pending += [(first, middle, halvings - 1), (middle, second, halvings - 1)]
        else:  # the error of the whole interval: walls that meet in a half make a kink there
            sweep.errors.append((first, second, error))


def _keep_rising(sweep: CellSweep, middle: CellPoint, half_pitch: float) -> None:
    """Leave the states around that without moment between which the moment rises with the curvature."""
    at = next(row for row, point in enumerate(sweep.points) if point is middle)
    rises = np.diff([point.moment for point in sweep.points]) > 0.0
    last = at + (int(np.argmin(rises[at:])) if not rises[at:].all() else len(rises) - at)
    first = at - (int(np.argmin(rises[:at][::-1])) if not rises[:at].all() else at)
    for side, row in ((-1, first), (1, last)):
        if row not in (0, len(rises)):
            curvature = 1000.0 * sweep.points[row].state.angle / half_pitch
            sweep.ends[side] = (
                f"the moment of the cell does not rise at {sweep.pressure:g} kPa beyond a curvature of "
                f"{curvature:.4g} 1/m"
            )
    sweep.points[:] = sweep.points[first : last + 1]


def _cut(sweep: CellSweep, first: CellPoint, second: CellPoint, reason: str) -> None:
    """Keep the states on that side of an interval where there is no moment; reason: a sentence."""
    position = sweep.points.index(second)
    keeps_first = first.moment + second.moment > 0.0
    sweep.ends[1 if keeps_first else -1] = reason
    sweep.points[:] = sweep.points[:position] if keeps_first else sweep.points[position:]


def _cubic_error(first: CellPoint, second: CellPoint, middle: CellPoint) -> float:
    """How far the cubic between two points misses a third between them, rad.

    Its slope counts as well, times an eighth of the interval: a kink beside the third point shows in the slope alone.
    """
    step = second.moment - first.moment
    t = (middle.moment - first.moment) / step
    a, b = first.state.angle, second.state.angle
    da, db = step / first.slopes.moment_by_angle, step / second.slopes.moment_by_angle
    value = (1 + 2 * t) * (1 - t) ** 2 * a + t * (1 - t) ** 2 * da + t * t * (3 - 2 * t) * b + t * t * (t - 1) * db
    slope = 6 * t * (1 - t) * (b - a) + (3 * t * t - 4 * t + 1) * da + (3 * t * t - 2 * t) * db
    return max(abs(value - middle.state.angle), abs(slope - step / middle.slopes.moment_by_angle) / 8.0)
