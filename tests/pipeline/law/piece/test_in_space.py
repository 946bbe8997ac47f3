"""Rigidities out of the plane as a part of the arm's own law, against finite elements of a whole arm."""

from dataclasses import replace

import numpy as np
import pytest

import fem
from fem import Experiment, LineForce, Model, follow
from fem.cell.lateral import LateralRigidities
from fem.cell.piece import BendingPiece
from fem.equations.constraints import Constraints
from fem.supports import Fixed
from geometry import GRADINGS, PneuNet, Reason
from pipeline.law.mesh_limit import PLANE, CellMesh, Corrections, MeshLimit, across_on, corrected, numbers_on
from pipeline.law.piece import in_space
from pipeline.law.piece.in_space import cell_in_space
from pipeline.law.piece.measure import CellSweep, sweep_cell
from pipeline.law.piece.measure_clamp import clamp_curve
from pipeline.law.piece.measure_tip import tip_curve
from pipeline.law.piece.reach import Reach
from pipeline.law.table import space_table
from pipeline.results.laws import law_of_record, law_record, record_of, value_of
from pipeline.values.law import LawMeshError
from pipeline.values.richardson import Limit
from rod import RodError
from rod.arm_law.curves import ACROSS, IN_SPACE, CellCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.load import Load
from tests.pieces import end_piece, half_cell, tip_piece

DESIGN = PneuNet(chambers=5)
SIZE, DHAT, PRESSURE = 5.0, 0.04, 20.0
BEND = -0.012  #: 1/mm, about the curvature of the cell without moment
MESH = CellMesh(SIZE, 1, 0.0, 0.0, (), (), ())
SLIGHT = 1e-5  #: N
RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)


@pytest.fixture(scope="module")
def swept() -> tuple[BendingPiece, CellSweep]:
    piece = BendingPiece(half_cell(DESIGN, SIZE), RUBBER, "mirror", dhat=DHAT)
    return piece, sweep_cell(piece, PRESSURE, Reach(DESIGN.length, 0.0, 0.0, BEND))


@pytest.fixture(scope="module")
def cell(swept: tuple[BendingPiece, CellSweep]) -> CellCurve:
    piece, sweep = swept
    curve, limits = cell_in_space(piece, sweep.curve(piece.body.length), [p.state for p in sweep.points])
    assert limits == ()
    return curve


@pytest.fixture(scope="module")
def law(cell: CellCurve) -> ArmLaw:
    clamp = clamp_curve(BendingPiece(end_piece(DESIGN, 1, SIZE), RUBBER, "clamp", dhat=DHAT), cell)
    tip = tip_curve(BendingPiece(tip_piece(DESIGN, 1, SIZE), RUBBER, "free", dhat=DHAT), cell)
    repetition = DESIGN.repetition(SIZE, GRADINGS["off"])
    parts = (cell,), (clamp.curve,), (tip.curve,)
    return ArmLaw(2.0 * repetition.half_pitch, repetition.middle, DESIGN.length, *parts)


def test_an_arm_gives_way_across_its_plane_as_finite_elements_of_the_whole_arm_do(law: ArmLaw) -> None:
    experiment = Experiment.of("II", DESIGN.body(SIZE), None)
    effects = [fem.Pressure("cavity", PRESSURE / 1000.0), fem.SelfContact("gap", DHAT)]
    model = experiment.model(RUBBER, effects, "p2p0")
    step = follow(model, [1.0]).steps[-1]
    across = Model(experiment.body.mesh, RUBBER, [Fixed("sym", "xy"), Fixed("clamp")], effects)
    system = across.system()
    assert system.constraints.size == Constraints.of(across.supports, across.space).size
    state = system.state_at(step.displacement, 1.0)
    tangent = system.linearise(state, system.assemble(state, system.terms), system.terms)
    load = np.zeros_like(state.displacement)
    LineForce(experiment.edge, (0.0, 0.0, -0.5)).bind(across.space, RUBBER).gradient(load, 1.0, load)
    lift = 2.0 * float(np.vdot(load, tangent.solve(-load).displacement))
    rod = law.at(PRESSURE)
    assert _lift(rod) == pytest.approx(lift, rel=1e-2)
    assert rod.stability(rod.solve()).is_stable


def _lift(rod: LawRod) -> float:
    """mm/N, of the end by a small force across the plane."""
    return rod.solve_in_space(Load((0.0, 0.0, SLIGHT))).end[2] / SLIGHT


def test_the_law_in_the_plane_stays_as_it_is(swept: tuple[BendingPiece, CellSweep], cell: CellCurve) -> None:
    piece, sweep = swept
    planar, record = record_of(sweep.curve(piece.body.length)), record_of(cell)
    assert {key: record[key] for key in planar} == planar
    assert len(record) == len(planar) + len(IN_SPACE)
    assert not value_of(CellCurve, planar).is_in_space


def test_the_rigidities_stand_in_the_file_and_follow_the_moduli(law: ArmLaw) -> None:
    read = law_of_record(law_record(law))
    np.testing.assert_array_equal(read.cells[0].twist_axis, law.cells[0].twist_axis)
    np.testing.assert_array_equal(read.clamps[0].lateral_compliance, law.clamps[0].lateral_compliance)
    rod, soft = law.at(PRESSURE), law.scaled(0.5).at(0.5 * PRESSURE)
    assert _lift(soft) == pytest.approx(2.0 * _lift(rod), rel=1e-6)


def test_a_law_of_the_plane_alone_says_nothing_of_space(law: ArmLaw) -> None:
    nothing = dict.fromkeys(IN_SPACE, np.empty(0))
    planar = replace(law, cells=(replace(law.cells[0], **nothing),))
    assert not space_table(planar, LawMeshError())
    rod = planar.at(PRESSURE)
    with pytest.raises(RodError, match="law_in_space"):
        rod.solve_in_space(Load())


def test_in_the_limit_of_the_mesh_rigidities_without_moment_are_those_of_the_limit(law: ArmLaw) -> None:
    (cell,), own = law.cells, across_on(law.cells[0])
    lateral, torsional = (own[name] for name in ACROSS)
    across = {"lateral_rigidity": Limit(0.9 * lateral, 3.0), "torsional_rigidity": Limit(1.2 * torsional, 4.0)}
    numbers = numbers_on(cell, law.length, dict.fromkeys(PLANE, Limit(1.0, 0.0)))
    limits = {PRESSURE: {name: Limit(value, 0.0) for name, value in numbers.items()} | across}
    limit = MeshLimit(0.01, 0.001, limits, ())
    moved = corrected(law, Corrections.of(law.cells, {PRESSURE: numbers}, limit, law.length))
    assert across_on(moved.cells[0]) == pytest.approx({name: one.value for name, one in across.items()})
    # turns about x by a torque and about y by a moment, of a clamped end as much stiffer as the cells
    mean = np.sqrt(1.2 * 0.9)
    softer = law.clamps[0].lateral_compliance / np.array([[1.2, mean], [mean, 0.9]])
    assert moved.clamps[0].lateral_compliance == pytest.approx(softer)
    of_mesh = replace(limit, meshes=(MESH,)).error_of(law.cells, law.length, SIZE)
    assert of_mesh.lateral_rigidity_N_mm2_std == pytest.approx([np.hypot(0.1 * lateral, 3.0)])
    assert of_mesh.torsional_rigidity_N_mm2 == pytest.approx([torsional])


def test_an_unstable_direction_is_a_reason_with_its_place(
    swept: tuple[BendingPiece, CellSweep], monkeypatch: pytest.MonkeyPatch
) -> None:
    piece, sweep = swept
    monkeypatch.setattr(in_space, "lateral_rigidities", lambda *_: LateralRigidities(-1.0, 1.0, 1.0, 0.0, 0.0, 0))
    curve, limits = cell_in_space(piece, sweep.curve(piece.body.length), [p.state for p in sweep.points])
    assert np.all(curve.lateral_rigidity == -1.0)
    place = {"piece": "half cell", "pressure_kPa": PRESSURE, "kappa_per_mm": curve.kappa[0]}
    assert limits == (Reason("unstable_sideways", place),)


def test_the_table_has_the_rigidities_without_moment(law: ArmLaw) -> None:
    table = space_table(law, LawMeshError())
    ((pressure, bending, _, torsion, *_),) = table.rows
    assert float(pressure) == PRESSURE
    cell = law.cells[0]
    assert cell.lateral_rigidity.min() * 0.999 <= float(bending) <= cell.lateral_rigidity.max() * 1.001
    assert cell.torsional_rigidity.min() * 0.999 <= float(torsion) <= cell.torsional_rigidity.max() * 1.001
