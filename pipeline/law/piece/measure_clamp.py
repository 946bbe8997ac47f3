"""The clamped end of the arm at one pressure, beside cells continued to it, from finite elements."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import isnan, nan
from typing import final

import numpy as np

from fem.cell.axis import circle, components
from fem.cell.inflation import unloaded
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.path.predictor import extrapolate
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.piece.adaptive import divided
from pipeline.law.piece.in_space import clamp_in_space
from pipeline.law.piece.point import KeptCurve, PiecePoint, reached, reason_of, without_moment
from pipeline.law.piece.rates import clamp_rates
from pipeline.values.pressure import KPA_PER_MPA, in_MPa
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.cubics import cubic

#: a state of the clamped end near that without moment, by the angle of this in rad
Begin = Callable[[float], PieceState]

#: where the clamped end is solved first, as a part of the moments of the cell, and in how many steps it is followed
#: over them: smooth curves of cells whose walls do not touch (three steps: rotations right to 1e-4 rad and the material
#: curve to 2.5e-4 of the length on 33 arms drawn at random), and of others, from the side on which no walls touch
SMOOTH, TOUCHING = (1 / 3, 3), (0.15, 7)
#: smallest step where there is no equilibrium ahead, over the moments of the cell
SMALLEST_STEP = 1 / 56
#: part of the way to the last moment of the cell at which the clamped end is solved last
WITHIN = 0.99
#: over a step: what is left of the moments of the cell where no further state is solved, and the largest change
NEAREST, FARTHEST = 0.1, 1.3
#: largest error of the cubic between two states, rad of the rotation by which the end departs from the cells: the free
#: end of the arm moves by that part of the length; and how often an interval is divided
TOLERANCE, DIVISIONS = 1e-3, 4
#: smallest part into which an interval is divided
CLOSEST = 0.2
#: rad, error of the angle of a clamped end that counts as one without moment; what depends on its square is left
NEARLY_STRAIGHT = 3e-3
#: of an angle at which it is solved first, in rad
DIGITS = 6
#: change of the moment in difference quotients, over the range of the law
DIFFERENCE = 1e-5


def clamp_curve(piece: BendingPiece, cell: CellCurve, begin: Begin | None = None) -> KeptCurve[ClampCurve]:
    """The clamped end over the moments of a cell at the same pressure.

    begin: as in `straight_point`. The clamped end is followed from moments without contact on; an interval is then
    divided where the cubic through its ends may miss by more than TOLERANCE. Raises `PieceFailed` where no state is
    reached.
    """
    lowest, last = float(cell.moment[0]), float(cell.moment[-1])
    steps = _steps(cell)[1]
    first = _first(piece, cell, begin)
    limits: list[PieceFailed] = []
    behind, ahead = (_followed(piece, cell, first, moment, steps, limits) for moment in (lowest, last))
    points = [*reversed(behind), first, *ahead]
    if len(points) < 2:
        raise limits[0] if limits else PieceFailed(Reason("clamp_once", {"pressure_kPa": cell.pressure}))
    error = _refine(piece, cell, points)
    why, rates = tuple(map(reason_of, limits)), clamp_rates(piece, points)
    curve, unstable = clamp_in_space(piece, cell, _curve(piece, cell, points), points)
    return KeptCurve(curve, (*why, *unstable), error, rates=rates)


def _first(piece: BendingPiece, cell: CellCurve, begin: Begin | None) -> "_ClampPoint":
    """From that without moment where walls touch or that is near a known one, else or where that fails from rest."""
    part, (lowest, last) = _steps(cell)[0], cell.moment[[0, -1]]
    part = 1.0 - part if cell.contact[0] and not cell.contact[-1] else part
    angle = cell.at(float(lowest + part * (last - lowest)))[0] * piece.body.length
    with suppress(PieceFailed):
        if begin or cell.contact.any():
            near = straight_point(piece, cell, begin)
            predicted = extrapolate(None, near.path_point, angle)
            return _ClampPoint.on(piece, cell, piece.solve(near.state.pressure, angle, near.state, predicted))
    return reached(piece, in_MPa(cell.pressure), angle, partial(_ClampPoint.on, piece, cell))


def _steps(cell: CellCurve) -> tuple[float, int]:
    """Where the clamped end is solved first, as a part of the moments, and the number of steps over them."""
    return TOUCHING if cell.contact.any() else SMOOTH


def clamp_without_moment(piece: BendingPiece, cell: CellCurve, begin: Begin | None = None) -> ClampCurve:
    """The clamped end without moment alone; as `straight_point`."""
    return _curve(piece, cell, [_ClampPoint.at(piece, cell, straight_point(piece, cell, begin))])


def near_clamp(piece: BendingPiece, cell: CellCurve, begin: Begin | None) -> KeptCurve[ClampCurve]:
    """The clamped end from its state without moment alone, whose derivatives hold for all moments."""
    curve = straight_clamp(clamp_without_moment(piece, cell, begin), cell.moment)
    rates = clamp_rates(piece, [straight_point(piece, cell, begin)])
    alike = {name: {key: len(cell.moment) * rows for key, rows in row.items()} for name, row in rates.items()}
    return KeptCurve(curve, rates=alike)


def straight_clamp(clamp: ClampCurve, moments: Array) -> ClampCurve:
    """A clamped end of which one state is known, to first order at moments (k,) in N mm."""
    change = moments - clamp.moment[0]
    rotation, offset = clamp.rotation_by_moment * change, clamp.offset_by_moment * change[:, None]
    alike = ("rotation_by_moment", "rotation_by_pressure", "offset_by_moment", "beside", "volume")
    rows = {name: getattr(clamp, name).repeat(len(moments), axis=0) for name in alike}
    return replace(clamp, moment=moments, rotation=clamp.rotation + rotation, offset=clamp.offset + offset, **rows)


def straight_point(piece: BendingPiece, cell: CellCurve, begin: Begin | None = None) -> PiecePoint:
    """The state without moment, or with so little that first order leads to none; kept by the piece.

    begin: gives one near it; None: from rest. Raises `PieceFailed` where none is reached.
    """
    pressure, angle = in_MPa(cell.pressure), round(cell.at(0.0)[0] * piece.body.length, DIGITS)

    def solve() -> PiecePoint:
        start = begin(angle) if begin else unloaded(piece, pressure, angle)
        return without_moment(piece, start, PiecePoint.of, NEARLY_STRAIGHT)

    return piece.kept(("without moment", pressure, angle), solve)


def _curve(piece: BendingPiece, cell: CellCurve, points: Sequence["_ClampPoint"]) -> ClampCurve:
    by_other = np.array([point.rotation_by_other for point in points])
    return ClampCurve(
        pressure=cell.pressure,
        moment=np.array([point.moment for point in points]),
        rotation=np.array([point.rotation for point in points]),
        rotation_by_moment=np.array([point.rotation_by_moment for point in points]),
        rotation_by_pressure=np.array([point.rotation_by_pressure for point in points]),
        offset=np.array([point.offset for point in points]),
        offset_by_moment=np.array([point.offset_by_moment for point in points]),
        s=piece.space.points[piece.curve, 0],
        beside=np.array([point.beside for point in points]),
        rotation_by_other=np.empty(0) if isnan(by_other[0]) else by_other,
        volume=np.array([point.volumes for point in points]),
    )


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class _ClampPoint(PiecePoint):
    """A state, and how its plane departs from cells continued to the clamp, with the slopes by the moment."""

    rotation: float  #: rad
    rotation_by_moment: float
    rotation_by_pressure: float
    offset: Array  #: (2,) mm
    offset_by_moment: Array  #: (2,)
    beside: Array  #: (m, 2) mm
    rotation_by_other: float  #: rad/kPa, NaN where it is not known

    @classmethod
    def on(cls, piece: BendingPiece, cell: CellCurve, state: PieceState) -> "_ClampPoint":
        """One factorization. Raises `PieceFailed` where the piece is not stable."""
        return cls.at(piece, cell, PiecePoint.of(piece, state))

    @classmethod
    def at(cls, piece: BendingPiece, cell: CellCurve, point: PiecePoint) -> "_ClampPoint":
        """Raises `PieceFailed` where the moment falls with the angle."""
        state, known = point.state, point.slopes
        if known.moment_by_angle <= 0.0:
            values = {"pressure_kPa": cell.pressure, "moment_N_mm": state.moment}
            raise PieceFailed(Reason("clamp_moment_falls", values))
        x = (piece.space.points + state.state.displacement)[piece.curve, :2]
        turned = known.by_angle[piece.curve, :2]
        step = DIFFERENCE * float(np.ptp(cell.moment)) / known.moment_by_angle
        rotation, offset, beside = _placed(piece, cell, state.moment, state.angle, x)
        ahead, behind = (
            _placed(piece, cell, state.moment + k * known.moment_by_angle, state.angle + k, x + k * turned)
            for k in (step, -step)
        )
        width = 2.0 * step * known.moment_by_angle

        def turned_by(moment_by: float, cells_by: Array) -> float:
            """At fixed moment the plane of the piece and that of the cells turn with a pressure, rad/kPa."""
            turned_cells = -float(np.interp(state.moment, cell.moment, cells_by / cell.rigidity))
            return -moment_by / KPA_PER_MPA / known.moment_by_angle - turned_cells * piece.body.length

        has_other = len(cell.moment_by_other) > 0
        return _ClampPoint(
            state,
            known,
            point.volumes,
            rotation,
            (ahead[0] - behind[0]) / width,
            turned_by(known.moment_by_pressure, cell.moment_by_pressure),
            offset,
            (ahead[1] - behind[1]) / width,
            beside,
            turned_by(known.moment_by_other, cell.moment_by_other) if has_other else nan,
        )


def _followed(
    piece: BendingPiece, cell: CellCurve, first: _ClampPoint, limit: float, steps: int, limits: list[PieceFailed]
) -> list[_ClampPoint]:
    """States of the clamped end from the first one on, without it, up to a moment in N mm; steps: over all moments."""
    points = [first]
    spacing = float(np.copysign(np.ptp(cell.moment) / steps, limit - first.moment))
    change = spacing
    while (limit - points[-1].moment) / spacing > NEAREST:
        left = limit - points[-1].moment
        change = WITHIN * left if left / change < FARTHEST else change
        try:
            points.append(_next_point(piece, cell, points, change, left))
        except PieceFailed as failure:
            change /= 2.0
            if change / spacing < SMALLEST_STEP * steps:
                limits.append(failure)
                break
    return points[1:]


def _next_point(
    piece: BendingPiece, cell: CellCurve, points: Sequence[_ClampPoint], change: float, left: float
) -> _ClampPoint:
    """The clamped end about a change of the moment, N mm, beyond the last of its states.

    It turns with the cells continued to the clamp, and departs from them at the last slope. left: N mm, the moments of
    the cell that remain. Raises `PieceFailed` without an equilibrium near, and where the moment changes otherwise.
    """
    last = points[-1]
    before = points[-2].path_point if len(points) > 1 else None
    turned = (cell.at(last.moment + change)[0] - cell.at(last.moment)[0]) * piece.body.length
    angle = last.state.angle + turned + change * last.rotation_by_moment
    predicted = extrapolate(before, last.path_point, angle)
    state = piece.solve_near(last.state.pressure, angle, predicted or last.state.state, last.state)
    reached = state.moment - last.moment
    if not 0.0 < reached / change <= min(FARTHEST, left / change):
        values = {"pressure_kPa": cell.pressure, "moment_N_mm": last.moment}
        raise PieceFailed(Reason("clamp_not_followed", values))
    return _ClampPoint.on(piece, cell, state)


def _refine(piece: BendingPiece, cell: CellCurve, points: list[_ClampPoint]) -> float:
    """Divide the intervals of the moment until their cubics are right to TOLERANCE; the largest error, rad."""

    def missed(first: _ClampPoint, second: _ClampPoint, middle: _ClampPoint) -> float:
        return abs(_rotation_between(first, second, middle.moment) - middle.rotation)

    curve = divided(_largest_miss, partial(_point_between, piece, cell), missed, TOLERANCE, DIVISIONS)
    return max((one.error or 0.0 for one in curve.refine(points)), default=0.0)


def _largest_miss(first: _ClampPoint, second: _ClampPoint) -> float:
    """How far the cubic of the rotation misses at most, rad, if it is a kink between straight lines that lies between
    two states: an eighth of the interval times the change of the slope, for a kink in the middle.

    A quarter of what the mean slope leaves of the change, where that is more, which no such kink makes it: then the
    states do not lie on one path.
    """
    step = second.moment - first.moment
    bent = (second.rotation_by_moment - first.rotation_by_moment) * step
    left = second.rotation - first.rotation - 0.5 * (first.rotation_by_moment + second.rotation_by_moment) * step
    return max(abs(bent) / 8.0, abs(left) / 4.0)


def _point_between(piece: BendingPiece, cell: CellCurve, first: _ClampPoint, second: _ClampPoint) -> _ClampPoint | None:
    """The clamped end between two states, where the tangents of the rotation in both meet: at a kink if there is one.

    None where there is no state.
    """
    step = second.moment - first.moment
    change = first.rotation_by_moment - second.rotation_by_moment
    met = second.rotation - first.rotation - second.rotation_by_moment * step
    part = met / (change * step) if change else 0.0
    moment = first.moment + (float(np.clip(part, CLOSEST, 1.0 - CLOSEST)) if 0.0 < part < 1.0 else 0.5) * step
    angle = _rotation_between(first, second, moment) + cell.at(moment)[0] * piece.body.length
    predicted = extrapolate(first.path_point, second.path_point, angle)
    with suppress(PieceFailed):
        state = piece.solve_near(first.state.pressure, angle, predicted or first.state.state, second.state)
        if first.moment < state.moment < second.moment:
            return _ClampPoint.on(piece, cell, state)
    return None


def _rotation_between(first: _ClampPoint, second: _ClampPoint, moment: float) -> float:
    """The rotation at a moment between two states, rad, by the cubic through them."""
    rows = [(point.moment, point.rotation, point.rotation_by_moment) for point in (first, second)]
    moments, rotations, slopes = np.array(rows).T
    return float(cubic(moments, rotations, slopes, moment))


def _placed(piece: BendingPiece, cell: CellCurve, moment: float, angle: float, x: Array) -> tuple[float, Array, Array]:
    """Rotation, offset (2,) and curve nodes (m, 2) beside the axis; the axis passes the plane as the cell's does."""
    kappa, stretch, ripple = cell.at(moment)
    rotation = angle - kappa * piece.body.length
    along = np.array([np.cos(angle), np.sin(angle)])
    normal = np.array([-along[1], along[0]])
    plane = x[-1] - ripple[0] * along - ripple[1] * normal  # the axis there
    s = piece.space.points[piece.curve, 0]
    axis = _turned(circle(s, stretch, kappa), rotation)
    height = np.array([0.0, piece.body.curve_y])
    offset = plane - axis[-1] - height
    return rotation, offset, components(x - axis - offset - height, rotation + kappa * s)


def _turned(points: Array, angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])
