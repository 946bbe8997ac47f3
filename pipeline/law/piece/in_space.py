"""Rigidities of a cell and of the clamped end out of their plane, at states of the curves that a law is made of."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from fem.cell.lateral import LateralRigidities, clamped_compliance, lateral_rigidities
from fem.cell.piece import BendingPiece, PieceState
from fem.equations.linear import SingularMatrix
from geometry import Reason, Values
from geometry.arrays import Array
from pipeline.law.piece.point import PiecePoint
from rod.arm_law.curves import IN_SPACE, CellCurve, ClampCurve
from rod.cubics import monotone_cubic
from rod.mechanics.unloaded import arc_compliance

#: states of a curve at which a cell is measured, as a rule; between them cubics over the moment join rigidities
STATES = 7
#: of turns and motions, those out of the plane
TURNS_AND_SHIFT = (0, 1, 5)
#: points of the cells to which the clamped end is compared
POINTS = 41
#: fields of `LateralRigidities` by those of `CellCurve`
FIELDS = dict(zip(IN_SPACE, (field.name for field in fields(LateralRigidities)), strict=False))


def cell_in_space(
    piece: BendingPiece, curve: CellCurve, states: Sequence[PieceState]
) -> tuple[CellCurve, tuple[Reason, ...]]:
    """The curve with rigidities out of the plane, and where the cell is unstable there.

    states: those of the curve. Two factorizations at each that is measured.
    """
    if not piece.body.half:
        return curve, (Reason("no_law_in_space"),)
    measured: list[tuple[float, LateralRigidities]] = []
    unstable: list[PieceState] = []
    rows = np.unique(np.linspace(0, len(states) - 1, min(STATES, len(states))).round().astype(int))
    for state in (states[row] for row in rows):
        try:
            found = lateral_rigidities(piece, state)
        except SingularMatrix:
            unstable.append(state)
            continue
        measured.append((state.moment, found))
        if found.unstable or min(found.bending, found.torsion, found.shear) <= 0.0:
            unstable.append(state)
    reasons = tuple(_unstable(piece, state, curve) for state in unstable[:1])
    if not measured:
        return curve, reasons
    moments = np.array([moment for moment, _ in measured])
    columns: dict[str, Any] = {}
    for name, field in FIELDS.items():
        values = np.array([getattr(found, field) for _, found in measured])
        columns[name] = monotone_cubic(moments, values, curve.moment)
    return replace(curve, **columns), reasons


def clamp_in_space(
    piece: BendingPiece, cell: CellCurve, curve: ClampCurve, points: Sequence[PiecePoint]
) -> tuple[ClampCurve, tuple[Reason, ...]]:
    """The curve with its compliance out of the plane, from the two states around that without moment.

    points: the states of the curve. Two factorizations at each of the two.
    """
    if not (piece.body.half and cell.is_in_space):
        return curve, ()
    nearest = sorted(points, key=lambda point: abs(point.moment))[:2]
    try:
        known = [_compliance(piece, cell, point.state) for point in nearest]
    except SingularMatrix:
        return curve, (_unstable(piece, nearest[0].state, cell),)
    if len(known) == 2:  # to no moment, if it lies between both
        first, second = (point.moment for point in nearest)
        part = float(np.clip(first / (first - second), 0.0, 1.0))
        known[0] = (1.0 - part) * known[0] + part * known[1]
    return replace(curve, lateral_compliance=known[0]), ()


def _compliance(piece: BendingPiece, cell: CellCurve, state: PieceState) -> Array:
    """(2, 2): what the end turns about x and y per moment there, beyond cells continued to it, rad/(N mm)."""
    kappa, stretch, ripple = cell.at(state.moment)
    rigidities = {name: float(np.interp(state.moment, cell.moment, getattr(cell, name))) for name in IN_SPACE}
    cosine, sine = np.cos(state.angle), np.sin(state.angle)
    end = (piece.space.points + state.state.displacement)[piece.curve[-1]]
    height = float(end[1] * cosine - end[0] * sine - ripple[1])
    differs = clamped_compliance(piece, state, height)
    cells = arc_compliance(piece.body.length, kappa, stretch, rigidities, POINTS)
    differs -= cells[np.ix_(TURNS_AND_SHIFT, TURNS_AND_SHIFT)]
    differs[0, 1] -= 0.5 * rigidities["tilt_by_torque"]  # of the plane between two cells beside the mean of all planes
    differs[1, 0] = differs[0, 1]
    frame = np.array([[cosine, -sine], [sine, cosine]])
    return np.asarray(frame @ differs[:2, :2] @ frame.T)


def _unstable(piece: BendingPiece, state: PieceState, curve: CellCurve) -> Reason:
    kappa = state.angle / piece.body.length
    values: Values = {"piece": piece.name, "pressure_kPa": curve.pressure, "kappa_per_mm": kappa}
    return Reason("unstable_sideways", values)
