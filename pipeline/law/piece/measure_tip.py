"""The free end of the arm at one pressure, beside cells continued to it, from finite elements."""

from functools import partial

import numpy as np
from scipy.integrate import cumulative_trapezoid

from fem.cell.air import air_volumes
from fem.cell.axis import circle, components
from fem.cell.edge import FreeEdge, free_edge
from fem.cell.piece import BendingPiece, PieceState
from geometry.arrays import Array
from pipeline.law.piece.measure_clamp import Begin
from pipeline.law.piece.point import KeptCurve, reached, stable
from pipeline.values.pressure import in_MPa
from rod.arm_law.curves import CellCurve, TipCurve

#: turns of the end of the arm at which its support is described; between them its couple is right to 0.4 % of the
#: largest one (`pneunet`)
TURNS = 24
#: from the piece, which is the mirror image of the tip, to the tip
MIRROR = np.array([-1.0, 1.0])
#: points of the axis of the tip at which its displacement by a force on the end is integrated
PULL_POINTS = 201


def tip_curve(piece: BendingPiece, cell: CellCurve, begin: Begin | None = None) -> KeptCurve[TipCurve]:
    """The end of the arm without moment, from a state that the piece keeps; raises `PieceFailed`.

    begin: gives the state without moment; None: from rest.

    The piece is the mirror image of the tip: its face `clamp` is the end of the arm, its face `tip` the plane.
    """

    state, edge = tip_state(piece, cell.pressure, begin)
    kappa, stretch, ripple = cell.at(0.0)
    length = piece.body.length
    s = length - piece.space.points[piece.curve, 0]
    axis, angle = circle(s, stretch, kappa), kappa * s
    origin = edge.curve[-1]  # the node of the curve on the plane, which the axis passes beside it

    def beside(points: Array) -> Array:
        """Places of the nodes (m, 2) of the curve, in the piece, beside the axis."""
        return components((points - origin) * MIRROR + ripple - axis, angle)[::-1]

    def beside_end(point: Array) -> Array:
        """Place of one point (2,) beside the end of the axis."""
        return components(((point - origin) * MIRROR + ripple - axis[0])[None], angle[:1])[0]

    # the plane is turned by the curvature less than the end, and the support turns against both
    turns = np.linspace(-np.pi, np.pi, TURNS, endpoint=False) - kappa * length
    held = [edge.held(turn) for turn in turns]
    pinned, by_force = edge.pinned()
    # the piece is pulled against its x; what the cells give way is in the law already
    by_pull = -by_force * MIRROR - axis_by_pull(cell, s, beside(pinned)[-1])
    lines = [state.lever * np.array([np.cos(turn), np.sin(turn)]) for state, turn in zip(held, turns, strict=True)]
    curve = TipCurve(
        pressure=cell.pressure,
        s=s[::-1] - length,
        beside=beside(edge.curve),
        edge=beside_end(edge.middle),
        couple=np.array([-state.couple for state in held]),
        acts_at=np.array([beside_end(state.curve[0] + line) for state, line in zip(held, lines, strict=True)]),
        beside_held=np.array([beside(state.curve) for state in held]),
        beside_pinned=beside(pinned),
        pinned_by_pull=components(by_pull, angle)[::-1],
        volume=air_volumes(piece.body, piece.space, state.state.displacement),
    )
    return KeptCurve(curve)


def tip_state(piece: BendingPiece, pressure_kPa: float, begin: Begin | None = None) -> tuple[PieceState, FreeEdge]:
    """The state of `tip_curve`, which the piece keeps, and its free edge; raises `PieceFailed`."""

    def solve() -> tuple[PieceState, FreeEdge]:
        if begin:
            return _with_edge(piece, begin(0.0))
        return reached(piece, in_MPa(pressure_kPa), 0.0, partial(_with_edge, piece))

    return piece.kept(("edge", pressure_kPa), solve)


def _with_edge(piece: BendingPiece, state: PieceState) -> tuple[PieceState, FreeEdge]:
    with stable(piece, state):
        return state, free_edge(piece, state)


def axis_by_pull(cell: CellCurve, s: Array, beside_end: Array) -> Array:
    """Displacement (m, 2) per force, mm/N, of the axis at s (m,) mm behind a plane that does not turn, as the law of
    the cells has it to first order without moment. The force acts beside the end of the axis, at max(s), along the
    normal of the plane; beside_end (2,) mm, along and normal to the axis.
    """
    kappa, stretch, _ = cell.at(0.0)
    rigidity, coupling, EA, GA = (
        float(np.interp(0.0, cell.moment, getattr(cell, name)))
        for name in ("rigidity", "stretch_by_kappa", "axial_rigidity", "shear_rigidity")
    )
    fine = np.linspace(0.0, float(s.max()), PULL_POINTS)
    axis, angle = circle(fine, stretch, kappa), kappa * fine
    along, normal = (
        np.stack(pair, axis=1) for pair in ((np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle)))
    )
    acts_at = axis[-1] + beside_end[0] * along[-1] + beside_end[1] * normal[-1]
    bent = (axis[:, 1] - acts_at[1] + coupling * along[:, 0]) / rigidity
    turned = cumulative_trapezoid(bent, fine, initial=0.0)
    rate = (stretch * turned + normal[:, 0] / GA)[:, None] * normal
    rate += (coupling * bent + along[:, 0] / EA)[:, None] * along
    moved = cumulative_trapezoid(rate, fine, axis=0, initial=0.0)
    return np.stack([np.interp(s, fine, moved[:, k]) for k in range(2)], axis=1)
