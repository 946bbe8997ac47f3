"""The arm without a load from single states of its pieces: the first numbers of a run."""

from collections.abc import Sequence
from contextlib import suppress

from fem.cell.piece import PieceFailed
from pipeline.law.ends import HALF_CELLS
from pipeline.law.piece.measure import straight_curve
from pipeline.law.piece.measure_clamp import clamp_without_moment, straight_clamp
from pipeline.law.piece.measure_tip import tip_curve
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.reach import LARGEST
from pipeline.law.piece.tasks import ArmTasks, PieceCurves
from pipeline.results.unloaded import unloaded_state
from pipeline.values.law import Unloaded
from rod.arm_law.curves import CellCurve
from rod.errors import RodError


def first_states(tasks: ArmTasks, pressures_kPa: Sequence[float]) -> tuple[Unloaded, ...]:
    """The arm without a load from single states of its pieces, at those of the pressures that these bear."""
    states: list[Unloaded] = []
    for pending in [tasks.submit(first_state, pressure) for pressure in pressures_kPa]:
        with suppress(PieceFailed, RodError):
            states.append(pending.result())
    return tuple(states)


def first_state(curves: PieceCurves, pressure: float) -> Unloaded:
    """The arm without a load at a pressure in kPa, from one state of each of its pieces; a task.

    The cell is known to first order about that state, which a weight needs. Raises `PieceFailed`, for a swollen cell
    too, whose ends take minutes, and `RodError`.
    """
    return curves.number(Unloaded, "unloaded", pressure, lambda: solve_first(curves.pieces, pressure)[0])


def solve_first(pieces: ArmPieces, pressure: float) -> tuple[Unloaded, CellCurve]:
    """The cell and its `first_state`."""
    turn = LARGEST / pieces.design.length * pieces.cell.body.length
    cell = straight_curve(pieces.cell, pressure, turn)
    clamp = clamp_without_moment(pieces.end(HALF_CELLS, "clamp"), cell)
    tip = tip_curve(pieces.end(HALF_CELLS, "free"), cell)
    law = pieces.law([cell], [straight_clamp(clamp, cell.moment)], [tip.curve])
    return unloaded_state(law, pressure), cell
