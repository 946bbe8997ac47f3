"""The ends of the arm at one pressure, beside cells continued to them, from finite elements."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.cell.axis import circle
from fem.cell.edge import free_edge
from fem.cell.piece import BendingPiece, PieceFailed
from fem.path.predictor import extrapolate
from geometry.arrays import Array
from pipeline.cell.point import PiecePoint, stable, without_moment
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve

#: intervals of the moment of the clamped end, whose departure from the cells changes little with it
CLAMP_INTERVALS = 16
#: part of the way to the last moment of the cell at which the clamped end is solved last
WITHIN = 0.99
#: over the spacing: what is left of the moments of the cell where no further state is solved, and the largest step
NEAREST, FARTHEST = 0.05, 1.3
#: states to either side, and trials for each
MOST_POINTS, MAX_RETRIES = 60, 5
#: turns of the end of the arm at which its support is described; between them its couple is right to 0.4 % of the
#: largest one (`pneunet`)
TURNS = 24
#: from the piece, which is the mirror image of the tip, to the tip
MIRROR = np.array([-1.0, 1.0])
#: change of the moment in difference quotients, over the range of the law
DIFFERENCE = 1e-5


def clamp_curve(piece: BendingPiece, cell: CellCurve, intervals: int = CLAMP_INTERVALS) -> tuple[ClampCurve, list[str]]:
    """The clamped end over the moments of a cell at the same pressure, and why it was not followed further.

    intervals: of the moments of the cell, 0 for the end without moment alone. Raises `PieceFailed` where no state is
    reached.
    """
    angle = float(np.interp(0.0, cell.moment, cell.kappa)) * piece.body.length
    first = without_moment(piece, piece.solve(cell.pressure / 1000.0, angle, piece.rest()), PiecePoint.of)
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
        rotation_by_pressure=np.array([row.rotation_by_pressure for row in rows]),
        offset=np.array([row.offset for row in rows]),
        offset_by_moment=np.array([row.offset_by_moment for row in rows]),
        s=piece.space.points[piece.curve, 0],
        beside=np.array([row.beside for row in rows]),
    )
    return curve, limits


def _clamp_points(
    piece: BendingPiece, cell: CellCurve, first: PiecePoint, spacing: float, limits: list[str]
) -> list[PiecePoint]:
    """States of the clamped end from the one without moment on, up to the last moment of the cell.

    spacing: N mm between them, its sign is that of the direction; infinite for none.
    """
    points = [first]
    limit = float(cell.moment[-1 if spacing > 0.0 else 0])
    while (limit - points[-1].moment) / spacing > NEAREST and len(points) < MOST_POINTS:
        left = (limit - points[-1].moment) / spacing
        try:
            part = 1.0 if left > FARTHEST else WITHIN * left
            point = _clamp_point(piece, points, part * spacing, min(left, FARTHEST) / part)
        except PieceFailed as failure:
            limits.append(str(failure))
            break
        if not 0.0 < (point.moment - points[-1].moment) / spacing <= left:
            limits.append(
                f"the clamped end at {cell.pressure:.4g} kPa was not followed beyond {points[-1].moment:.4g} N mm"
            )
            break
        points.append(point)
    return points[1:]


def _clamp_point(piece: BendingPiece, points: Sequence[PiecePoint], change: float, farthest: float) -> PiecePoint:
    """The clamped end at the last moment and about a change of it, N mm, by its slope there.

    Where walls meet on the way it stiffens, and the step is shortened until the moment changes by no more than farthest
    times that. Raises `PieceFailed`.
    """
    last = points[-1]
    before = points[-2].path_point if len(points) > 1 else None
    step = change / last.slopes.moment_by_angle
    for _ in range(MAX_RETRIES):
        angle = last.state.angle + step
        predicted = extrapolate(before, last.path_point, angle)
        state = piece.solve(last.state.pressure, angle, last.state, predicted)
        reached = (state.moment - last.moment) / change
        if reached <= farthest:
            break
        step *= WITHIN / reached
    return PiecePoint.of(piece, state)


@dataclass(frozen=True, eq=False)  # arrays inside
class _ClampRow:
    rotation: float
    rotation_by_moment: float
    rotation_by_pressure: float
    offset: Array  #: (2,)
    offset_by_moment: Array  #: (2,)
    beside: Array  #: (m, 2)


def _clamp_row(piece: BendingPiece, cell: CellCurve, point: PiecePoint) -> _ClampRow:
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
    # at fixed moment the plane of the piece and that of the cells turn with the pressure
    turned_cells = -float(np.interp(state.moment, cell.moment, cell.moment_by_pressure / cell.rigidity))
    by_pressure = -known.moment_by_pressure / 1000.0 / known.moment_by_angle - turned_cells * piece.body.length
    return _ClampRow(
        rotation,
        (ahead[0] - behind[0]) / width,
        by_pressure,
        offset,
        (ahead[1] - behind[1]) / width,
        beside,
    )


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
    with stable(piece, state):
        edge = free_edge(piece, state)
    kappa, stretch, ripple = cell.at(0.0)
    length = piece.body.length
    s = length - piece.space.points[piece.curve, 0]
    axis, angle = circle(s, stretch, kappa), kappa * s
    origin = edge.curve[-1]  # the node of the curve on the plane, which the axis passes beside it

    def beside(points: Array) -> Array:
        """Of the nodes (m, 2) of the curve, in the piece, beside the axis."""
        return _components((points - origin) * MIRROR + ripple - axis, angle)[::-1]

    def beside_end(point: Array) -> Array:
        """Of one point (2,) beside the end of the axis."""
        return _components(((point - origin) * MIRROR + ripple - axis[0])[None], angle[:1])[0]

    # the plane is turned by the curvature less than the end, and the support turns against both
    turns = np.linspace(-np.pi, np.pi, TURNS, endpoint=False) - kappa * length
    held = [edge.held(turn) for turn in turns]
    lines = [state.lever * np.array([np.cos(turn), np.sin(turn)]) for state, turn in zip(held, turns, strict=True)]
    return TipCurve(
        pressure=cell.pressure,
        s=s[::-1] - length,
        beside=beside(edge.curve),
        edge=beside_end(edge.middle),
        couple=np.array([-state.couple for state in held]),
        acts_at=np.array([beside_end(state.curve[0] + line) for state, line in zip(held, lines, strict=True)]),
        beside_held=np.array([beside(state.curve) for state in held]),
        beside_pinned=beside(edge.pinned()),
    )


def _turned(points: Array, angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def _components(away: Array, angle: Array) -> Array:
    """Components (m, 2) along and normal to directions of the given angles (m,)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([away[:, 0] * cosine + away[:, 1] * sine, away[:, 1] * cosine - away[:, 0] * sine], axis=1)
