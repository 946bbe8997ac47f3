"""The ends of the arm at one pressure, beside cells continued to them, from finite elements."""

from dataclasses import dataclass

import numpy as np

from fem.cell.axis import circle
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import Slopes, slopes
from fem.equations.linear import SingularMatrix
from fem.path.predictor import PathPoint, extrapolate
from geometry.arrays import Array
from pipeline.cell.measure import MAX_ITERATIONS, STRAIGHT
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve

#: intervals of the moment of the clamped end, whose departure from the cells changes little with it
CLAMP_INTERVALS = 16
#: part of the way to the last moment of the cell at which the clamped end is solved last
WITHIN = 0.99
#: change of the moment in difference quotients, over the range of the law
DIFFERENCE = 1e-5


def clamp_curve(piece: BendingPiece, cell: CellCurve, intervals: int = CLAMP_INTERVALS) -> tuple[ClampCurve, list[str]]:
    """The clamped end over the moments of a cell at the same pressure, and why it was not followed further.

    intervals: of the moments of the cell, 0 for the end without moment alone. Raises `PieceFailed` where no state is
    reached.
    """
    first = _clamp_without_moment(piece, cell)
    limits: list[str] = []
    spacing = float(np.ptp(cell.moment)) / intervals if intervals else np.inf
    behind, ahead = (_clamp_points(piece, cell, first, way * spacing, limits) for way in (-1, 1))
    points = [*reversed(behind), first, *ahead]
    rows = [_clamp_row(piece, cell, point) for point in points]
    curve = ClampCurve(
        pressure=cell.pressure,
        moment=np.array([point.state.moment for point in points]),
        rotation=np.array([row.rotation for row in rows]),
        rotation_by_moment=np.array([row.rotation_by_moment for row in rows]),
        offset=np.array([row.offset for row in rows]),
        offset_by_moment=np.array([row.offset_by_moment for row in rows]),
        s=piece.space.points[piece.curve, 0],
        beside=np.array([row.beside for row in rows]),
    )
    return curve, limits


@dataclass(frozen=True, eq=False)  # arrays inside
class _EndPoint:
    """One state of a clamped end with its slopes."""

    state: PieceState
    slopes: Slopes

    @property
    def path_point(self) -> PathPoint:
        """The state and its tangent, on the path of the angle."""
        return PathPoint(self.state.angle, 1.0, self.state.state, self.state.touches, self.slopes.angle_rate)


def _clamp_points(
    piece: BendingPiece, cell: CellCurve, first: _EndPoint, spacing: float, limits: list[str]
) -> list[_EndPoint]:
    """States of the clamped end from the one without moment on, at moments of the cell that are not too close.

    spacing: N mm, its sign is that of the direction.
    """
    points = [first]
    direction = 1 if spacing > 0.0 else -1
    rows = np.argsort(np.abs(cell.moment))
    rows = rows[direction * cell.moment[rows] > 0.0]
    for number, row in enumerate(rows):
        last = points[-1]
        is_outermost = number == len(rows) - 1
        if direction * (cell.moment[row] - last.state.moment) < (0.05 if is_outermost else 1.0) * abs(spacing):
            continue
        angle = float(cell.kappa[row]) * piece.body.length + _departure(last.state, cell, piece.body.length)
        before = points[-2].path_point if len(points) > 1 else None
        predicted = extrapolate(before, last.path_point, angle)
        try:
            state = piece.solve(last.state.pressure, angle, last.state, predicted)
            limit = float(cell.moment[-1 if direction > 0 else 0])
            if direction * (state.moment - limit) > 0.0:  # beyond the cell: back by the secant, and a little more
                fraction = WITHIN * (limit - last.state.moment) / (state.moment - last.state.moment)
                angle = last.state.angle + fraction * (state.angle - last.state.angle)
                state = piece.solve(state.pressure, angle, state)
            if not cell.moment[0] <= state.moment <= cell.moment[-1]:
                break
            points.append(_EndPoint(state, slopes(piece, state)))
        except (PieceFailed, SingularMatrix) as failure:
            limits.append(str(failure))
            break
    return points[1:]


def _clamp_without_moment(piece: BendingPiece, cell: CellCurve) -> _EndPoint:
    """The clamped end without moment, by Newton's method for the angle."""
    angle = float(np.interp(0.0, cell.moment, cell.kappa)) * piece.body.length
    state = piece.solve(cell.pressure / 1000.0, angle, piece.rest())
    for _ in range(MAX_ITERATIONS):
        point = _EndPoint(state, slopes(piece, state))
        correction = -state.moment / point.slopes.moment_by_angle
        if abs(correction) < STRAIGHT:
            return point
        angle = state.angle + float(np.clip(correction, -0.2, 0.2))
        state = piece.solve(state.pressure, angle, state, extrapolate(None, point.path_point, angle))
    raise PieceFailed(f"the clamped end at {cell.pressure:.4g} kPa has no state without moment near that of the cell")


def _departure(state: PieceState, cell: CellCurve, length: float) -> float:
    """rad, of the plane from that of cells continued to the clamp."""
    return state.angle - float(np.interp(state.moment, cell.moment, cell.kappa)) * length


@dataclass(frozen=True, eq=False)  # arrays inside
class _ClampRow:
    rotation: float
    rotation_by_moment: float
    offset: Array  #: (2,)
    offset_by_moment: Array  #: (2,)
    beside: Array  #: (m, 2)


def _clamp_row(piece: BendingPiece, cell: CellCurve, point: _EndPoint) -> _ClampRow:
    """How the plane at the end departs from cells continued to the clamp, with the slopes by the moment."""
    state, known = point.state, point.slopes
    x = (piece.space.points + state.state.displacement)[piece.curve, :2]
    turned = known.by_angle[piece.curve, :2]
    step = DIFFERENCE * float(np.ptp(cell.moment)) / known.moment_by_angle
    rotation, offset, beside = _placed(piece, cell, state.moment, state.angle, x)
    ahead, behind = (
        _placed(piece, cell, state.moment + k * known.moment_by_angle, state.angle + k, x + k * turned)
        for k in (step, -step)
    )
    width = 2.0 * step * known.moment_by_angle
    return _ClampRow(rotation, (ahead[0] - behind[0]) / width, offset, (ahead[1] - behind[1]) / width, beside)


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
    return rotation, offset, _components(x - axis - offset - height, rotation + kappa * s)


def tip_curve(piece: BendingPiece, cell: CellCurve) -> TipCurve:
    """The end of the arm without moment; raises `PieceFailed`.

    The piece is the mirror image of the tip: its face `clamp` is the end of the arm, its face `tip` the plane.
    """
    state = piece.solve(cell.pressure / 1000.0, 0.0, piece.rest())
    kappa, stretch, ripple = cell.at(0.0)
    nodes = piece.curve
    x = (piece.space.points + state.state.displacement)[nodes, :2]
    image = (x - x[-1]) * [-1.0, 1.0]  # from the plane on towards the end
    s = piece.body.length - piece.space.points[nodes, 0]
    order = np.argsort(s)
    image, s = image[order] + ripple, s[order]  # the axis passes the plane beside the curve
    away = image - circle(s, stretch, kappa)
    rotation = _end_rotation(image) - kappa * piece.body.length
    couple = state.moment
    return TipCurve(cell.pressure, rotation, couple, s - piece.body.length, _components(away, kappa * s))


def _end_rotation(points: Array) -> float:
    """Angle of the last chord of a curve (m, 2), rad."""
    x, y = points[-1] - points[-2]
    return float(np.arctan2(y, x))


def _turned(points: Array, angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def _components(away: Array, angle: Array) -> Array:
    """Components (m, 2) along and normal to directions of the given angles (m,)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([away[:, 0] * cosine + away[:, 1] * sine, away[:, 1] * cosine - away[:, 0] * sine], axis=1)
