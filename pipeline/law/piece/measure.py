"""The curves of a cell of the arm, from finite elements of half a cell."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import isnan
from typing import final

import numpy as np

from fem.cell.axis import Axis, axis_of
from fem.cell.inflation import bent, unloaded
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import shear_rigidity, slopes
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.piece.adaptive import divided
from pipeline.law.piece.point import PiecePoint, reason_of, stable, without_moment
from pipeline.law.piece.reach import Range, Reach
from pipeline.values.pressure import KPA_PER_MPA, in_MPa
from rod.arm_law.curves import CellCurve
from rod.cubics import cubic, cubic_slope

#: intervals of the first sweep to either side, and how often one is divided where its cubic is not good enough
INTERVALS, DIVISIONS = 2, 6
#: smallest part into which an interval is divided
NEAREST = 0.15
#: the last step goes this many times as far as the law needs; smallest part of a step
LAST, SHORTEST = 1.05, 0.25
#: largest change of ln V in a step of a swollen cell
SWELLING = 0.3
#: a sweep ends where the rigidity of the cell falls below this part of that at rest: near the largest moment that
#: the cell bears its curvature depends on the pressure too strongly to be interpolated
SOFTENED = 0.3
#: change of the moment over what the last slope said beyond which a step is shortened, and how often
FARTHEST, MAX_RETRIES = 1.5, 4
#: largest error of the cubic between two states, over the largest curvature of the law: a dead force that lifts the arm
#: makes ten times that of its shape
TOLERANCE = 1e-3


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class CellPoint(PiecePoint):
    """One state of a half cell with its slopes and its axis."""

    axis: Axis

    @classmethod
    def of(cls, piece: BendingPiece, state: PieceState) -> "CellPoint":
        """One factorization. Raises `PieceFailed` where the cell is not stable."""
        point = PiecePoint.of(piece, state)
        return CellPoint(state, point.slopes, point.volumes, axis_of(piece, state, point.slopes))

    def turned(self, angle: float) -> "CellPoint":
        """The state turned by an angle in rad, to first order, without its volumes."""
        state = replace(
            self.state, angle=self.state.angle + angle, moment=self.moment + self.slopes.moment_by_angle * angle
        )
        axis = replace(self.axis, stretch=self.axis.stretch + self.axis.stretch_by_angle * angle)
        return replace(self, state=state, volumes=np.empty(0), axis=axis)


@dataclass
class CellSweep:
    """The states of a half cell at one pressure, and why it was not followed further."""

    pressure: float  #: kPa
    points: list[CellPoint] = field(default_factory=list)  #: by increasing curvature
    #: why the curve ends at the largest moment (1) and at the smallest (-1), unless it was reached
    ends: dict[int, Reason] = field(default_factory=dict)
    shear: list[tuple[float, float]] = field(default_factory=list)  #: moments in N mm with GA in N, in any order
    #: intervals with the error of their cubics where it was measured, rad
    errors: list[tuple[CellPoint, CellPoint, float]] = field(default_factory=list)

    def outermost(self, side: int) -> CellPoint:
        """The point of the largest moment (side = 1) or of the smallest (-1)."""
        return self.points[-1 if side > 0 else 0]

    @property
    def limits(self) -> tuple[Reason, ...]:
        """Why it was not followed further."""
        return tuple(self.ends[side] for side in sorted(self.ends))

    @property
    def error(self) -> float:
        """Largest error of the cubics between the states, over the largest curvature."""
        scale = max(abs(point.state.angle) for point in self.points)
        errors = [error for first, second, error in self.errors if first in self.points and second in self.points]
        return max(errors, default=0.0) / scale

    def curve(self, half_pitch: float) -> CellCurve:
        """The sweep as a curve of the law; raises `rod.RodError` where the moment does not rise."""
        points, h = self.points, half_pitch
        other = {}
        if not isnan(points[0].slopes.moment_by_other):
            other["moment_by_other"] = np.array([p.slopes.moment_by_other / KPA_PER_MPA for p in points])
            other["stretch_by_other"] = np.array([p.axis.stretch_by_other / KPA_PER_MPA for p in points])
        return CellCurve(
            pressure=self.pressure,
            moment=np.array([p.moment for p in points]),
            kappa=np.array([p.state.angle / h for p in points]),
            rigidity=np.array([p.slopes.moment_by_angle * h for p in points]),
            moment_by_pressure=np.array([p.slopes.moment_by_pressure / KPA_PER_MPA for p in points]),
            stretch=np.array([p.axis.stretch for p in points]),
            stretch_by_kappa=np.array([p.axis.stretch_by_angle * h for p in points]),
            stretch_by_pressure=np.array([p.axis.stretch_by_pressure / KPA_PER_MPA for p in points]),
            axial_rigidity=np.array([h / p.slopes.distance_by_force for p in points]),
            shear_rigidity=np.interp([p.moment for p in points], *np.array(sorted(self.shear)).T),
            contact=np.array([p.state.touches for p in points]),
            min_J=np.array([p.state.extremes.min_J for p in points]),
            s=points[0].axis.s,
            ripple=np.array([p.axis.ripple for p in points]),
            volume=np.array([p.volumes / h for p in points]),
            **other,
        )


def sweep_cell(piece: BendingPiece, pressure_kPa: float, reach: Reach) -> CellSweep:
    """Follow a half cell at one pressure over the moments and curvatures that an arm meets.

    Raises `PieceFailed` where the unloaded cell is not reached.
    """
    h = piece.body.length
    middle = cell_without_moment(piece, in_MPa(pressure_kPa))
    sweep = CellSweep(pressure_kPa, [middle], shear=[(middle.moment, shear_at(piece, middle))])
    softest = SOFTENED * slopes(piece, piece.rest()).moment_by_angle
    kappa, rigidity = middle.state.angle / h, middle.slopes.moment_by_angle * h
    for outward in (1, -1):
        _sweep_to(piece, sweep, reach.range_from(kappa, rigidity, outward), softest)
    _refine(piece, sweep)
    _keep_rising(sweep, middle, h)
    return sweep


def straight_curve(piece: BendingPiece, pressure_kPa: float, turn: float) -> CellCurve:
    """A half cell at one pressure to first order about its state without moment, by `turn` rad to either side.

    Raises `PieceFailed`, for a swollen cell too.
    """
    point = cell_without_moment(piece, in_MPa(pressure_kPa))
    if piece.is_swollen(piece.volume(point.state.state)):
        raise PieceFailed(Reason("cell_swells"))
    sweep = CellSweep(pressure_kPa, [point.turned(-turn), point.turned(turn)], shear=[(0.0, shear_at(piece, point))])
    return sweep.curve(piece.body.length)


def cell_without_moment(piece: BendingPiece, pressure: float, start: PieceState | None = None) -> CellPoint:
    """The cell without moment at a pressure in MPa, by Newton's method for the angle.

    start: a state to begin with, the cell at rest unless it is given. Raises `PieceFailed`.
    """
    if start is None:

        def from_rest() -> CellPoint:
            return without_moment(piece, unloaded(piece, pressure, 0.0), CellPoint.of)

        return piece.kept(("without moment", pressure), from_rest)
    state = start if start.pressure == pressure else piece.solve(pressure, start.angle, start)
    return without_moment(piece, state, CellPoint.of)


def cell_near(piece: BendingPiece, pressure_kPa: float, bend: float) -> CellSweep:
    """The state without moment at a pressure, and those bent by `bend` (1/mm) more and less.

    Raises `PieceFailed`.
    """
    middle = cell_without_moment(piece, in_MPa(pressure_kPa))

    def side(sign: float) -> CellPoint:
        angle = middle.state.angle + sign * bend * piece.body.length
        return point_at(piece, None, middle, angle)

    points = [side(-1.0), middle, side(1.0)]
    return CellSweep(pressure_kPa, points, shear=[(middle.moment, shear_at(piece, middle))])


def point_at(piece: BendingPiece, before: CellPoint | None, last: CellPoint, angle: float) -> CellPoint:
    """The cell at another angle, in rad, on the path through one or two points. Raises `PieceFailed`."""
    return CellPoint.of(piece, bent(piece, angle, last.state, before and before.path_point, last.path_point))


def _sweep_to(piece: BendingPiece, sweep: CellSweep, until: Range, softest: float) -> None:
    """States to one side until the law needs no more, or until there is none; each step changes the moment by a part of
    the way, and by less where a cell bears no step of that size.

    softest: N mm, slope of the moment by the angle below which the sweep ends.
    """
    outward, change = until.outward, until.first_moment / INTERVALS
    followed, shortest = [sweep.outermost(outward)], abs(change) / 2**MAX_RETRIES
    while (left := until.left(*_changes(followed, piece.body.length))) > 0.0:
        last = followed[-1]
        part = float(np.clip(LAST * left / abs(change), SHORTEST, 1.0))
        try:
            point = _next_point(piece, sweep, part * change)
            if outward * (point.moment - last.moment) <= 0.0:
                raise PieceFailed(Reason("cell_moment_falls", {"pressure_kPa": sweep.pressure}))
            sweep.shear.append((point.moment, shear_at(piece, point)))
        except PieceFailed as failure:
            if len(followed) == 1 and abs(change) > shortest:
                change /= 2.0
                continue
            sweep.ends[outward] = reason_of(failure)
            return
        followed.append(point)
        sweep.points.insert(len(sweep.points) if outward > 0 else 0, point)
        if point.slopes.moment_by_angle < softest:
            sweep.ends[outward] = Reason("cell_softens", _place(sweep, point, piece.body.length))
            return


def _changes(points: Sequence[CellPoint], half_pitch: float) -> tuple[Array, Array]:
    """Changes of the moment (n,) in N mm and of the curvature (n,) in 1/mm since the first of n states."""
    rows = np.array([(point.moment, point.state.angle / half_pitch) for point in points])
    moments, turns = (rows - rows[0]).T
    return moments, turns


def _next_point(piece: BendingPiece, sweep: CellSweep, change: float) -> CellPoint:
    """The state beside the outermost one whose moment differs by `change` or not much more. Raises `PieceFailed`."""
    outward = 1 if change > 0.0 else -1
    last, before = sweep.outermost(outward), None
    if len(sweep.points) > 1:
        before = sweep.points[-2 if outward > 0 else 1]
    angle = last.state.angle + change / last.slopes.moment_by_angle
    if piece.is_swollen(piece.volume(last.state.state)):
        most = SWELLING * piece.volume(last.state.state) / abs(last.slopes.moment_by_pressure)
        angle = float(np.clip(angle, last.state.angle - most, last.state.angle + most))
    for _ in range(MAX_RETRIES):
        point = point_at(piece, before, last, angle)
        if abs(point.moment - last.moment) <= FARTHEST * abs(change) or outward * (point.moment - last.moment) <= 0.0:
            break
        # walls met on the way: along the tangent of the last state to where it meets that of this one, and on
        turn = last.state.angle + _division(last, point) * (angle - last.state.angle)
        rest = change - (turn - last.state.angle) * last.slopes.moment_by_angle
        angle = turn + max(outward * rest, 0.0) * outward / point.slopes.moment_by_angle
    return point


def shear_at(piece: BendingPiece, point: CellPoint) -> float:
    """GA in N. Raises `PieceFailed`."""
    with stable(piece, point.state):
        return shear_rigidity(piece, point.state, point.slopes)


def _place(sweep: CellSweep, point: CellPoint, half_pitch: float) -> dict[str, float]:
    return {"pressure_kPa": sweep.pressure, "kappa_per_mm": point.state.angle / half_pitch}


def _refine(piece: BendingPiece, sweep: CellSweep) -> None:
    """Divide the intervals of the angle until their cubics are right to TOLERANCE where they are divided."""
    tolerance = TOLERANCE * max(abs(point.state.angle) for point in sweep.points)

    def between(first: CellPoint, second: CellPoint) -> CellPoint | None:
        angle = first.state.angle + _division(first, second) * (second.state.angle - first.state.angle)
        try:
            return CellPoint.of(piece, bent(piece, angle, first.state, first.path_point, second.path_point))
        except PieceFailed as failure:  # keep the states on that side of the interval where there is no moment
            position, keeps_first = sweep.points.index(second), first.moment + second.moment > 0.0
            sweep.ends[1 if keeps_first else -1] = reason_of(failure)
            sweep.points[:] = sweep.points[:position] if keeps_first else sweep.points[position:]
            return None

    curve = divided(_largest_error, between, _cubic_error, tolerance, DIVISIONS)
    sweep.errors.extend((one.first, one.second, one.error or 0.0) for one in curve.refine(sweep.points))


def _division(first: CellPoint, second: CellPoint) -> float:
    """Part of the way from one point to another at which the tangents of both meet: at a kink between straight lines,
    in the middle of a parabola. The middle where they do not meet in between."""
    length = second.state.angle - first.state.angle
    change = first.slopes.moment_by_angle - second.slopes.moment_by_angle
    across = second.moment - first.moment - second.slopes.moment_by_angle * length
    part = across / (change * length) if abs(change) > 1e-6 * abs(second.slopes.moment_by_angle) else 0.5
    return float(np.clip(part, NEAREST, 1.0 - NEAREST)) if 0.0 < part < 1.0 else 0.5


def _keep_rising(sweep: CellSweep, middle: CellPoint, half_pitch: float) -> None:
    """Leave the states around that without moment between which the moment rises with the curvature."""
    at = next(row for row, point in enumerate(sweep.points) if point is middle)
    rises = np.diff([point.moment for point in sweep.points]) > 0.0
    last = at + (int(np.argmin(rises[at:])) if not rises[at:].all() else len(rises) - at)
    first = at - (int(np.argmin(rises[:at][::-1])) if not rises[:at].all() else at)
    for side, row in ((-1, first), (1, last)):
        if row not in (0, len(rises)):
            sweep.ends[side] = Reason("cell_falls", _place(sweep, sweep.points[row], half_pitch))
    sweep.points[:] = sweep.points[first : last + 1]


def _largest_error(first: CellPoint, second: CellPoint) -> float:
    """How far the cubic between two points misses at most if a kink between straight lines lies between them, rad: in
    the middle, by an eighth of the interval times the change of the slope.

    A quarter of that where no walls touch, or of what the mean slope leaves of the angle: no kink is there.
    """
    step, slopes = second.moment - first.moment, [1.0 / p.slopes.moment_by_angle for p in (first, second)]
    kink = abs(step * (slopes[1] - slopes[0])) / 8.0
    if first.state.touches or second.state.touches:
        return kink
    return max(kink, abs(second.state.angle - first.state.angle - 0.5 * step * sum(slopes))) / 4.0


def _cubic_error(first: CellPoint, second: CellPoint, middle: CellPoint) -> float:
    """How far the cubic between two points misses a third between them, rad.

    Its slope counts as well, times an eighth of the interval: a kink beside the third point shows in the slope alone.
    """
    rows = [(p.moment, p.state.angle, 1.0 / p.slopes.moment_by_angle) for p in (first, second)]
    moments, angles, by_moment = np.array(rows).T
    value, slope = (float(f(moments, angles, by_moment, middle.moment)) for f in (cubic, cubic_slope))
    step = second.moment - first.moment
    return max(abs(value - middle.state.angle), abs(step * (slope - 1.0 / middle.slopes.moment_by_angle)) / 8.0)
