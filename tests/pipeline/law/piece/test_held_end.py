"""The arm's own law where x of the end is prescribed, against finite elements of the whole arm."""

from dataclasses import replace

import numpy as np
import pytest

import fem
from fem.cell.piece import BendingPiece
from geometry import GRADINGS, BisectedCircle
from geometry.arrays import Array
from pipeline.law.piece.measure import sweep_cell
from pipeline.law.piece.measure_clamp import clamp_curve
from pipeline.law.piece.measure_tip import axis_by_pull, tip_curve
from pipeline.law.piece.reach import Reach
from rod import Load, RodSolution
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from tests.pieces import end_piece, half_cell
from tests.quotients import SOLVED, quotient

#: its flat divider, which carries the edge that is held, gives way along the arm
DESIGN = BisectedCircle(length=60.0)
SIZE, PRESSURE, ENDS = 4.0, 20.0, 3
RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)


@pytest.fixture(scope="module")
def cell() -> CellCurve:
    piece = BendingPiece(half_cell(DESIGN, SIZE), RUBBER, "mirror")
    return sweep_cell(piece, PRESSURE, Reach(DESIGN.length, 0.3, 0.0, 0.01)).curve(piece.body.length)


@pytest.fixture(scope="module")
def law(cell: CellCurve) -> ArmLaw:
    clamp, tip = (BendingPiece(end_piece(DESIGN, ENDS, SIZE), RUBBER, start) for start in ("clamp", "free"))
    middle = DESIGN.repetition(SIZE, GRADINGS["off"]).middle
    return ArmLaw(
        DESIGN.pitch,
        middle,
        DESIGN.length,
        (cell,),
        (clamp_curve(clamp, cell).curve,),
        (tip_curve(tip, cell).curve,),
    )


@pytest.mark.parametrize("end_y", [0.0, None])
def test_the_force_that_holds_x_of_the_end(law: ArmLaw, end_y: float | None) -> None:
    experiment = fem.Experiment.of("III", DESIGN.body(SIZE), end_y, end_x=0.0)
    step = fem.follow(experiment.model(RUBBER, [fem.Pressure("cavity", PRESSURE / 1000.0)], "p2p0"), [1.0]).steps[-1]
    force = experiment.end_force(step)[0]
    assert force < -0.2

    def by_law(arm: ArmLaw) -> float:
        solution = arm.at(PRESSURE).under(Load(), end_y, DESIGN.length)
        assert solution.positions(np.array([DESIGN.length]))[0, 0] == pytest.approx(DESIGN.length, abs=1e-6)
        return float(solution.force[0])

    assert by_law(law) == pytest.approx(force, rel=0.01)
    rigid = replace(law, tips=tuple(replace(tip, pinned_by_pull=0.0 * tip.pinned_by_pull) for tip in law.tips))
    assert by_law(rigid) < 1.15 * force  # without the compliance of the edge


def test_the_displacement_of_the_axis_by_a_pull_is_that_of_the_rod(cell: CellCurve) -> None:
    """Difference quotients of the rod of cells alone, whose start does not turn."""
    length, beside, pull = 40.0, np.array([0.3, -1.1]), 1e-4
    s = np.array([10.0, 25.0, length])
    for bent in (0.0, 0.01):  # 1/mm, on top of the curvature without moment
        curve = replace(cell, kappa=cell.kappa + bent)
        clamp, tip = _rigid_ends(cell, beside)
        rod = ArmLaw(DESIGN.pitch, 0.5 * DESIGN.pitch, length, (curve,), (clamp,), (tip,)).at(PRESSURE)
        plus, minus = (rod.solve((force, 0.0)) for force in (pull, -pull))
        moved = quotient(_axis(plus, s), _axis(minus, s), 2.0 * pull, SOLVED)
        assert axis_by_pull(curve, s, beside) == moved.within(rel=2e-3, abs=1e-3 * float(np.abs(moved.value).max()))


def _axis(solution: RodSolution, s: Array) -> Array:
    return np.stack([np.interp(s, solution.s, values) for values in (solution.x, solution.y)], axis=1)


def _rigid_ends(cell: CellCurve, acts_at: Array) -> tuple[ClampCurve, TipCurve]:
    """Ends that are cells too; a force acts beside the end of the axis."""
    points, none = len(cell.moment), np.zeros((2, 2))
    clamp = ClampCurve(
        PRESSURE,
        cell.moment,
        *np.zeros((3, points)),
        *np.zeros((2, points, 2)),
        np.array([0.0, 1.0]),
        np.zeros((points, 2, 2)),
    )
    tip = TipCurve(
        PRESSURE, np.array([-1.0, 0.0]), none, acts_at, np.zeros(4), np.zeros((4, 2)), np.zeros((4, 2, 2)), none, none
    )
    return clamp, tip
