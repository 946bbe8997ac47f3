"""The arm's own law from a half cell and two ends, against finite elements of the whole arm; walls that meet."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest

import fem
from fem import Discretisation
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.effects.contact import crossings
from geometry import GRADINGS, PneuNet, Reason
from pipeline.config.load import load_config
from pipeline.law.piece.measure import TOLERANCE, CellPoint, cell_without_moment, sweep_cell
from pipeline.law.piece.measure_clamp import NEAREST, TOUCHING, clamp_curve, clamp_without_moment
from pipeline.law.piece.measure_clamp import TOLERANCE as CLAMP_TOLERANCE
from pipeline.law.piece.measure_tip import tip_curve
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.point import PiecePoint
from pipeline.law.piece.reach import Reach
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.values.pressure import KPA_PER_MPA, in_MPa
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from tests.pieces import end_piece, half_cell
from tests.solved import alone

DESIGN = PneuNet(chambers=5)
SIZE, DHAT, PRESSURE = 5.0, 0.04, 20.0
#: 1/mm, curvature of the cell without moment at PRESSURE
BEND = -0.012
RUBBER = fem.StVenantKirchhoff(E=1.2, nu=0.495)


@dataclass(frozen=True)
class KeptCurve:
    """A cell and two ends at one pressure."""

    force: float  #: N, for which the law is made
    pressure: float = PRESSURE  #: kPa

    @cached_property
    def cell(self) -> CellCurve:
        piece = BendingPiece(half_cell(DESIGN, SIZE), RUBBER, "mirror", dhat=DHAT)
        sweep = sweep_cell(piece, self.pressure, Reach(DESIGN.length, self.force, 0.0, BEND))
        assert sweep.limits == ()
        assert sweep.error < TOLERANCE
        return sweep.curve(piece.body.length)

    @cached_property
    def clamp(self) -> ClampCurve:
        clamp = clamp_curve(self._end("clamp"), self.cell)
        assert clamp.limits == ()
        assert clamp.error <= CLAMP_TOLERANCE
        return clamp.curve

    @cached_property
    def clamp_without_moment(self) -> ClampCurve:
        return clamp_without_moment(self._end("clamp"), self.cell)

    @cached_property
    def law(self) -> ArmLaw:
        tip = tip_curve(self._end("free"), self.cell).curve
        middle = DESIGN.repetition(SIZE, GRADINGS["off"]).middle
        return ArmLaw(DESIGN.pitch, middle, DESIGN.length, (self.cell,), (self.clamp,), (tip,))

    def _end(self, start: str) -> BendingPiece:
        return BendingPiece(end_piece(DESIGN, 1, SIZE), RUBBER, start, dhat=DHAT)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def measured() -> KeptCurve:
    return KeptCurve(0.1)


@pytest.mark.parametrize(("name", "end_y", "force"), [("II", 0.0, 0.0), ("III", 0.0, 0.0), ("dead", 0.0, -0.08)])
def test_the_rod_agrees_with_finite_elements_of_the_whole_arm(
    measured: KeptCurve, name: str, end_y: float, force: float
) -> None:
    experiment = fem.Experiment.of(name, DESIGN.body(SIZE), end_y, (0.0, force))
    effects = [fem.Pressure("cavity", PRESSURE / 1000.0), fem.SelfContact("gap", DHAT, starts_inactive=False)]
    step = fem.follow(experiment.model(RUBBER, effects, "p2p0"), [1.0]).steps[-1]
    curve = experiment.centreline(step)
    rod = measured.law.at(PRESSURE)
    solution = rod.solve(end_y=end_y) if name == "III" else rod.solve((0.0, force))
    distance = solution.positions(curve.s) + np.array([0.0, DESIGN.curve_y]) - np.stack([curve.x, curve.y], axis=1)
    assert np.linalg.norm(distance, axis=1).max() < 3e-3 * DESIGN.length
    (air,), volume = rod.volumes(solution), experiment.symmetry_factor * step.cavity_volume("cavity")
    assert air == pytest.approx(volume, rel=5e-4)
    assert volume > 1.2 * DESIGN.cavity_volume
    if name == "III":
        assert solution.force[1] == pytest.approx(experiment.end_force(step)[1], rel=5e-3)


def test_slopes_of_the_clamped_end_are_those_of_its_curve(measured: KeptCurve) -> None:
    """Between two states the mean of the slopes is the difference quotient, but for the curvature of the curve."""
    clamp = measured.clamp
    steps = np.diff(clamp.moment)
    for name in ("rotation", "offset"):
        values = getattr(clamp, name).reshape(len(clamp.moment), -1)
        slopes = getattr(clamp, f"{name}_by_moment").reshape(len(clamp.moment), -1)
        quotient = np.diff(values, axis=0) / steps[:, None]
        mean = (slopes[1:] + slopes[:-1]) / 2.0
        bound = 0.75 * np.abs(np.diff(slopes, axis=0)) + 0.02 * np.abs(slopes).max(axis=0)
        assert np.mean(np.abs(quotient - mean) <= bound) > 0.9


def test_the_slope_of_the_clamped_end_by_the_pressure(measured: KeptCurve) -> None:
    """Against the central difference of two pressures, without moment."""
    higher, lower = (KeptCurve(0.05, PRESSURE + change) for change in (0.2, -0.2))
    without = [curves.clamp_without_moment.rotation[0] for curves in (lower, higher)]
    expected = (without[1] - without[0]) / 0.4
    assert measured.clamp_without_moment.rotation_by_pressure[0] == pytest.approx(expected, rel=2e-2)


def test_the_clamped_end_is_followed_over_the_moments_of_the_cell() -> None:
    """Where walls of the cell touch it is many times as stiff as without moment."""
    measured = KeptCurve(0.15, 5.0)
    cell, clamp = measured.cell, measured.clamp
    assert cell.rigidity[-1] > 3.0 * np.interp(0.0, cell.moment, cell.rigidity)
    spacing = np.ptp(cell.moment) / TOUCHING[1]
    for k in (0, -1):
        assert abs(clamp.moment[k] - cell.moment[k]) < NEAREST * spacing
        assert cell.moment[0] < clamp.moment[k] < cell.moment[-1]
    assert np.diff(clamp.moment).max() < 1.4 * spacing


def test_between_its_states_the_clamped_end_departs_as_the_cubics_say(measured: KeptCurve) -> None:
    """In the middle of the longest intervals with contact and without, against a state that is solved there."""
    cell, clamp, piece = measured.cell, measured.clamp, measured._end("clamp")
    steps = np.diff(clamp.moment)
    assert len(steps) > TOUCHING[1]  # where walls meet, intervals are divided
    for row in np.argsort(steps)[-3:]:
        moment = clamp.moment[row] + 0.5 * steps[row]
        angle = clamp.at(moment)[0] + cell.at(moment)[0] * piece.body.length
        state = inflated(piece, PRESSURE / 1000.0, angle)
        rotation = angle - cell.at(state.moment)[0] * piece.body.length
        assert abs(rotation - clamp.at(state.moment)[0]) < 2.0 * CLAMP_TOLERANCE
    rows = zip(clamp.moment, clamp.rotation, clamp.offset, strict=True)
    for moment, rotation, offset in rows:
        assert clamp.at(moment)[0] == pytest.approx(rotation, abs=1e-12)
        assert clamp.at(moment)[1] == pytest.approx(offset, abs=1e-12)


def test_a_clamped_end_that_bears_no_larger_moment_is_named(
    measured: KeptCurve, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was reached before is kept, and the attempts beyond it are few."""
    piece = measured._end("clamp")
    largest = float(measured.cell.moment[-1]) / 2.0
    solved, angles = BendingPiece.solve_near, []

    def limited(self: BendingPiece, pressure: float, angle: float, *others: object, **options: bool) -> PieceState:
        angles.append(angle)
        state = solved(self, pressure, angle, *others, **options)  # type: ignore[arg-type]
        if state.moment > largest:
            raise PieceFailed(Reason("tangent_indefinite"))
        return state

    monkeypatch.setattr(BendingPiece, "solve_near", limited)
    clamp = clamp_curve(piece, measured.cell)
    assert clamp.limits == (Reason("piece_fails", {"why": "the tangent is indefinite"}),)
    assert 0.6 * largest < clamp.curve.moment[-1] <= largest
    assert len(angles) < 30


def test_where_the_moment_of_the_clamped_end_does_not_grow_its_law_ends(
    measured: KeptCurve, monkeypatch: pytest.MonkeyPatch
) -> None:
    piece = measured._end("clamp")
    largest = float(measured.cell.moment[-1]) / 2.0
    known = PiecePoint.of

    def falling(piece: BendingPiece, state: PieceState) -> PiecePoint:
        point = known(piece, state)
        slope = -1.0 if state.moment > largest else point.slopes.moment_by_angle
        return replace(point, slopes=replace(point.slopes, moment_by_angle=slope))

    monkeypatch.setattr(PiecePoint, "of", falling)
    (limit,) = clamp_curve(piece, measured.cell).limits
    assert str(limit.values["why"]).startswith("at 20 kPa the clamped end is not described from a moment of ")


def test_the_curves_of_a_cell_rise_and_name_their_contact(measured: KeptCurve) -> None:
    cell = measured.cell
    assert np.all(np.diff(cell.moment) > 0.0)
    assert np.all(np.diff(cell.kappa) > 0.0)
    assert cell.contact.any()
    assert not cell.contact.all()


def test_the_air_of_a_cell_has_the_slopes_of_its_potential(measured: KeptCurve) -> None:
    """At fixed curvature dM/dp = -dV/dkappa, by trapezoids between states; mm3 per mm and N mm per kPa.

    In most intervals within 1e-3 of the largest change; more walls that meet in one make a kink there.
    """
    cell = measured.cell
    changes = np.diff(cell.volume[:, 0])
    slopes = -KPA_PER_MPA * cell.moment_by_pressure
    by_moment = 0.5 * (slopes[1:] + slopes[:-1]) * np.diff(cell.kappa)
    misses = np.abs(changes - by_moment) / np.ptp(cell.volume)
    assert np.median(misses) < 1e-3
    assert misses[cell.contact[1:] == cell.contact[:-1]].max() < 5e-3


def test_a_pressure_that_the_cell_does_not_bear_is_named() -> None:
    piece = BendingPiece(half_cell(DESIGN, SIZE), RUBBER, "mirror", dhat=DHAT)
    with pytest.raises(PieceFailed, match=r"half cell at .* kPa"):
        sweep_cell(piece, 2000.0, Reach(DESIGN.length, 0.1, 0.0, BEND))


def test_an_unstable_equilibrium_of_a_cell_is_no_state_of_the_law() -> None:
    """Newton's method finds equilibria of the cell at 65 and 66 kPa; the whole arm has its limit at 64.77 kPa."""
    config = load_config(
        Path(__file__).resolve().parent.parent.parent.parent.parent / "configs" / "pneunet_coarse.yaml"
    )
    cell = ArmPieces.of(Scene.meshed(config)).cell
    below = cell_without_moment(cell, 0.064)
    assert below.state.negative_pivots == 0
    for pressure in (0.065, 0.066):
        with pytest.raises(PieceFailed, match=r"is not stable at 6[56] kPa .* the tangent is indefinite"):
            cell_without_moment(cell, pressure)


#: design 33 of `make unseen SEED=59 N=60`, on a coarser mesh
BISECTED = """
name: bisected
geometry: {family: bisected_circle, length: 70.4 mm, radius: 6.55 mm, end_wall: 2.31 mm, wall: 1.19 mm,
           divider: 1.28 mm}
material: {law: mooney_rivlin, c10: 18.2 kPa, c01: 4.54 kPa, nu: 0.4984}
pressures: [4.95 kPa, 9.9 kPa]
mesh: {size: 3.5 mm}
"""


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bisected") / "bisected.yaml"
    path.write_text(BISECTED, encoding="utf-8")
    return path


def measure(design: Path, pressure_kPa: float, contact: str) -> tuple[CellPoint, bool]:
    """The cell without moment, and whether walls of the lower cavity pass through each other, by exact tests."""
    cell = ArmPieces(load_config(design, [f"effects.self_contact={contact}"]), None).cell
    point = cell_without_moment(cell, in_MPa(pressure_kPa))
    x = cell.space.points + point.state.state.displacement
    edges, _ = crossings(x, cell.space.surface("cavity_lower").triangles)
    return point, len(edges) > 0


def test_the_divider_stops_at_the_round_wall(design: Path) -> None:
    touching, crosses = measure(design, 9.9, "auto")
    assert touching.state.touches
    assert touching.state.gap > 0.0
    assert not crosses
    free, crosses = measure(design, 9.9, "off")
    assert crosses
    assert abs(touching.slopes.moment_by_angle / free.slopes.moment_by_angle - 1.0) > 0.03


def test_contact_does_nothing_before_walls_meet(design: Path) -> None:
    (apart, _), (free, _) = (measure(design, 4.95, contact) for contact in ("auto", "off"))
    assert not apart.state.touches
    assert apart.state.angle == pytest.approx(free.state.angle, rel=1e-9)


@pytest.mark.slow
def test_the_arm_is_as_wide_as_the_touching_cell(design: Path, tmp_path: Path) -> None:
    """Half the width of the plane in the middle of the arm, whose finite elements have contact too, in mm; without
    contact the cell is 3 % wider."""
    config = load_config(design)
    scene, pieces = Scene.meshed(config), ArmPieces(config, None)
    with alone(tmp_path, config) as context:
        outcomes = simulate(scene, context, ("II",))
    rest = Discretisation.of(scene.body.mesh, config.mesh.formulation).points
    planes = pieces.repetition.middle + 2.0 * pieces.repetition.half_pitch * np.arange(20)
    plane = planes[np.argmin(np.abs(planes - config.design.length / 2.0))]
    arm = (rest + outcomes["II"].records[-1].displacement)[np.abs(rest[:, 0] - plane) < 1e-6, 2].max()
    (touching, _), (free, _) = (measure(design, 9.9, contact) for contact in ("auto", "off"))
    cell = pieces.cell.space
    width, too_wide = (
        (cell.points + point.state.state.displacement)[cell.surface("clamp").unique_nodes, 2].max()
        for point in (touching, free)
    )
    assert width == pytest.approx(arm, rel=2e-3)
    assert too_wide > 1.02 * arm
