"""Self-contact of a short arm: walls touch without intersection, and the result hardly depends on its parameters."""

import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import ipctk
import numpy as np
import pytest

import fem
from fem.discretisation import Discretisation
from fem.effects.barrier import COMPLIANCE, WEIGHT, FacingTerm, carried_gaps, contact_potential
from fem.effects.contact import STIFFNESS, BarrierTerm
from fem.effects.effect import Term, UnilateralTerm
from fem.materials.material import Material
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import LoadControl
from fem.path.follower import PathFollower
from fem.path.newton import NEAR, Converged, Start, Unstable
from fem.path.options import PathEnded
from fem.path.solver import Increment, IncrementSolver
from geometry import Body, Reason
from geometry.arrays import Array
from tests.bodies import bricks, fork, named, on_plane

LAW = fem.StVenantKirchhoff(E=1.2, nu=0.495)
GAP = 2.0


def bend(
    body: Body, contact: list[fem.Effect], pressures: list[float], **options: float
) -> tuple[fem.Experiment, tuple[fem.Step, ...]]:
    experiment = fem.Experiment.of("II", body, 0.0)
    model = experiment.model(LAW, [fem.Pressure("cavity", 1e-3 * pressures[-1]), *contact], "p2p0")
    tight = fem.PathOptions(fem.NewtonOptions(tolerance=1e-9), **options)
    return experiment, fem.follow(model, [pressure / pressures[-1] for pressure in pressures], tight).steps


@pytest.fixture(scope="module")
def touching(short: Body) -> tuple[fem.Experiment, tuple[fem.Step, ...]]:
    """Experiment II at 5 kPa, where nothing touches, and at 37 kPa."""
    return bend(short, [fem.SelfContact("gap", starts_inactive=True)], [5.0, 37.0])


@pytest.fixture(scope="module")
def without(short: Body) -> fem.Step:
    """The same at 37 kPa, with walls that pass through each other."""
    return bend(short, [], [37.0])[1][0]


def crossings(step: fem.Step) -> bool:
    """Whether any two triangles through the nodes of the gap's faces cross, by exact tests."""
    surface = step.space.surface("gap")
    nodes = surface.unique_nodes
    faces = np.asfortranarray(np.searchsorted(nodes, surface.triangles).astype(np.int32))
    mesh = ipctk.CollisionMesh(np.asfortranarray(step.points[nodes]), ipctk.edges(faces), faces)
    return bool(ipctk.has_intersections(mesh, np.asfortranarray(step.positions[nodes])))


def distance(step: fem.Step, other: fem.Step) -> float:
    return float(np.abs(step.displacement - other.displacement).max())


def test_pairs_far_from_contact_have_no_place_in_the_matrix_and_results_do_not_depend_on_it(
    short: Body, touching: tuple[fem.Experiment, tuple[fem.Step, ...]]
) -> None:
    _, steps = touching
    _, with_all = bend(short, [fem.SelfContact("gap", starts_inactive=True, near=np.inf)], [5.0, 37.0])
    _, with_few = bend(short, [fem.SelfContact("gap", starts_inactive=True, near=0.05)], [5.0, 37.0])
    assert len(steps[0].added_pairs) == 0, "nothing touches at 5 kPa"
    assert 0 < len(with_few[1].added_pairs) < len(steps[1].added_pairs) < 0.6 * len(with_all[1].added_pairs)
    for other in (with_all, with_few):
        assert distance(other[1], steps[1]) < 1e-8
        assert other[1].factorizations == steps[1].factorizations


def test_walls_touch_and_do_not_cross(touching: tuple[fem.Experiment, tuple[fem.Step, ...]], without: fem.Step) -> None:
    step = touching[1][-1]
    assert 0 < step.min_gap < 0.1 * GAP
    assert not crossings(step)
    assert "self_contact" in step.effects
    assert crossings(without)  # the same test sees what contact prevents


def test_contact_pushes_the_chambers_distance(
    touching: tuple[fem.Experiment, tuple[fem.Step, ...]], without: fem.Step
) -> None:
    experiment, steps = touching
    assert experiment.end(steps[-1])[1] < experiment.end(without)[1] - 0.5


def test_contact_that_starts_inactive_ends_where_contact_from_the_start_does(short: Body, touching) -> None:
    _, always = bend(short, [fem.SelfContact("gap")], [5.0, 37.0])
    for later, present in zip(touching[1], always, strict=True):
        assert distance(later, present) < 1e-6 * short.length
    assert touching[1][0].effects == ("pressure",)
    assert always[0].effects == ("pressure", "self_contact")


def test_contact_that_is_never_activated_is_bitwise_no_contact(short: Body, touching) -> None:
    _, without = bend(short, [], [5.0])
    _, alone = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [5.0])
    np.testing.assert_array_equal(alone[0].displacement, without[0].displacement)
    np.testing.assert_array_equal(alone[0].stress, without[0].stress)
    assert alone[0].factorizations == without[0].factorizations


def test_contact_that_is_never_activated_does_not_load_ipctk() -> None:
    program = (
        "import sys\n"
        "from fem import Experiment, Pressure, SelfContact, StVenantKirchhoff, follow\n"
        "from geometry import PneuNet\n"
        "body = PneuNet(chambers=2).body(7.0)\n"
        "effects = [Pressure('cavity', 1e-3), SelfContact('gap', starts_inactive=True)]\n"
        "model = Experiment.of('II', body, 0.0).model(StVenantKirchhoff(1.2, 0.495), effects, 'p2p0')\n"
        "step = follow(model, [1.0]).steps[-1]\n"
        "assert 1.0 < step.min_gap < 2.0\n"
        "print('ipctk' in sys.modules)\n"
    )
    root = Path(__file__).resolve().parent.parent.parent
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=root)
    assert done.stdout.strip() == "False"


def test_the_answer_tends_to_a_limit_with_the_activation_distance(short: Body, touching) -> None:
    """Measured at 37 kPa for 0.04 (the default), 0.02, 0.01 mm: end_y -9.148, -9.132, -9.124 mm."""
    experiment, steps = touching
    ends = [experiment.end(steps[-1])[1]]
    for dhat in (0.02, 0.01):
        _, finer = bend(short, [fem.SelfContact("gap", dhat, starts_inactive=True)], [37.0])
        assert finer[0].min_gap < dhat
        ends.append(experiment.end(finer[0])[1])
    first, second = np.abs(np.diff(ends))
    assert first < 0.0006 * short.length
    assert np.log2(first / second) == pytest.approx(1.0, abs=0.05)


def test_half_and_whole_body_touch_alike(short: Body) -> None:
    """Measured: 2e-14. With one of several equally near triangles chosen, the force on the end differed by 2e-4."""
    ends = []
    for body in (short, short.full()):
        experiment = fem.Experiment.of("III", body, 0.0)
        model = experiment.model(
            LAW, [fem.Pressure("cavity", 0.037), fem.SelfContact("gap", starts_inactive=True)], "p2p0"
        )
        step = fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps[0]
        assert step.min_gap < 0.1 * GAP
        ends.append(experiment.end_force(step)[1])
    assert ends[1] == pytest.approx(ends[0], rel=1e-10)


@final
@dataclass(frozen=True)
class BarrierContact(fem.Effect):
    """Self-contact by the barrier of incremental potential contact alone."""

    faces: str
    dhat: float | None = None

    def bind(self, space: Discretisation, material: Material) -> Term:
        term = fem.SelfContact(self.faces, self.dhat).bind(space, material).tightened(space.points)
        assert isinstance(term, BarrierTerm)
        return term


@pytest.mark.slow
def test_barrier_gives_the_same_state(short: Body, touching) -> None:
    """Measured: 0.0035 mm with gaps of 0.0178 and 0.0177 mm; the barrier's whole width lies before the wall."""
    _, exact = bend(short, [BarrierContact("gap", 0.02)], [5.0, 17.0, 37.0])
    assert not crossings(exact[-1])
    assert exact[-1].min_gap == pytest.approx(touching[1][-1].min_gap, rel=0.02)
    assert distance(exact[-1], touching[1][-1]) < 2e-4 * short.length


def squeezed(contact: list[fem.Effect], factors: list[float]) -> tuple[fem.Step, ...]:
    """Two prongs whose outer corners are pressed 0.3 mm each towards the other, over a gap of 0.4 mm."""
    corners = np.array([[6.0, 0.0, 0.0], [6.0, 0.0, 1.0]])
    press = [fem.Prescribed(corners, "y", 0.3), fem.Prescribed(corners + np.array([0.0, 2.4, 0.0]), "y", -0.3)]
    model = fem.Model(fork(0.4), LAW, [fem.Fixed("clamp"), *press], contact, "p2p0")
    return fem.follow(model, factors, fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps


def test_prongs_meet_in_their_middle_and_part_again() -> None:
    closed, opened = squeezed([fem.SelfContact("prongs", starts_inactive=True)], [1.0, 0.1])
    assert 0 < closed.min_gap < 0.04
    free = squeezed([], [0.1])[0]
    assert distance(opened, free) < 1e-8
    assert opened.min_gap > 0.04


def test_a_crossing_that_facing_walls_cannot_prevent_is_solved_with_the_exact_barrier(monkeypatch, short: Body) -> None:
    """Where the pairs of facing walls are blind, exact tests refuse the state and the barrier takes over.

    The gap of the state is then that of the barrier: the plane of a triangle that a wall faced at rest, and has turned
    away from, tells nothing of it.
    """
    _, facing = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [17.0])
    _, barrier = bend(short, [BarrierContact("gap")], [17.0])
    monkeypatch.setattr(FacingTerm, "violation", lambda self, x: Reason("walls_cross"))
    monkeypatch.setattr(FacingTerm, "gap", lambda self, x: -1.0)
    _, steps = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [17.0])
    assert not crossings(steps[0])
    assert steps[0].min_gap == pytest.approx(barrier[0].min_gap, rel=0.02)
    # which of the barrier's collisions are near enough depends a little on the way
    assert 100.0 * distance(steps[0], barrier[0]) < distance(steps[0], facing[0])


def test_walls_that_pass_through_a_soft_contact_are_separated_by_a_stiffer_one(monkeypatch, short: Body) -> None:
    """A 25th of the stiffness lets walls cross, four times that still does, sixteen times that does not."""
    monkeypatch.setattr("fem.effects.contact.STIFFNESS", 0.04 * STIFFNESS)
    tightened, gaps, stiffness = FacingTerm.tightened, [], []

    def recorded(self: FacingTerm, x: Array) -> UnilateralTerm:
        gaps.append(self.gap(x))
        stiffness.append(self.stiffness)
        return tightened(self, x)

    monkeypatch.setattr(FacingTerm, "tightened", recorded)
    stability: list[tuple[Term, ...]] = []
    monkeypatch.setattr("fem.path.follower.instability", lambda system, converged, terms: stability.append(terms) or ())
    _, steps = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [37.0])
    assert len(gaps) == 2
    assert gaps[0] < gaps[1] < 0 < steps[0].min_gap
    stiffest = stability[-1][-1]  # the stability of the state is that with the contact that keeps its walls apart
    assert stiffest.stiffness == pytest.approx(16 * stiffness[0])
    assert not crossings(steps[0])


def test_contact_is_activated_before_there_is_equilibrium_without_it(short: Body) -> None:
    """A state that is nearly in equilibrium shows which walls meet; the iterations to the end of that are saved."""
    model = fem.Experiment.of("II", short, 0.0).model(
        LAW, [fem.Pressure("cavity", 0.037), fem.SelfContact("gap", starts_inactive=True)], "p2p0"
    )
    residuals: list[tuple[int, float]] = []
    observer = fem.PathObserver(lambda target, iteration, residual: residuals.append((iteration, residual)))
    step = fem.follow(model, [1.0], observer=observer).steps[0]
    assert step.active[-1]
    begins = [number for number, (iteration, _) in enumerate(residuals) if iteration == 0]
    last_without = [residuals[number - 1][1] for number in begins[1:]]
    assert all(fem.NewtonOptions().tolerance < residual < NEAR for residual in last_without)
    assert len(begins) == 2


def test_gaps_ahead_are_those_of_their_present_rates() -> None:
    mesh = fork(0.4)
    space = Discretisation.of(mesh, "p2p0")
    term = fem.SelfContact("prongs", starts_inactive=True).bind(space, LAW)
    down = np.where(space.points[:, 1:2] > 1.2, [[0.0, -0.5, 0.0]], 0.0)
    assert term.gap(space.points) == pytest.approx(0.4)
    assert term.gap_ahead(space.points, down) == pytest.approx(-0.1, abs=1e-9)
    turned = np.cross([0.0, 0.0, 1.0], space.points)  # the rate of a rotation changes no gap, the whole motion would
    assert term.gap_ahead(space.points, turned) == pytest.approx(0.4, abs=1e-2)
    assert term.gap(space.points + turned) > 0.5


def test_contact_that_is_foreseen_saves_factorizations_and_changes_nothing(monkeypatch, short: Body, touching) -> None:
    _, steps = touching
    assert steps[1].active[-1]
    monkeypatch.setattr(ActiveSet, "approached", lambda self, x, dx: self)
    _, unforeseen = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [5.0, 37.0])
    assert distance(steps[1], unforeseen[1]) < 1e-7
    assert steps[1].factorizations < unforeseen[1].factorizations


def test_contact_that_is_foreseen_and_does_not_come_is_left_out(monkeypatch, short: Body, touching) -> None:
    _, alone = bend(short, [], [2.0, 5.0])
    monkeypatch.setattr(FacingTerm, "gap_ahead", lambda self, x, dx: -1.0)
    _, steps = bend(short, [fem.SelfContact("gap", starts_inactive=True)], [2.0, 5.0])
    assert not steps[1].active[-1]
    assert steps[1].effects == ("pressure",)
    assert distance(steps[1], alone[1]) < 1e-7


def test_contact_of_an_increment_that_fails_is_as_it_was_before(monkeypatch, short: Body) -> None:
    """A smaller increment may not need what a larger one has activated or made stiffer."""
    contact = fem.SelfContact("gap", starts_inactive=True)
    model = fem.Experiment.of("II", short, 0.0).model(LAW, [fem.Pressure("cavity", 0.037), contact], "p2p0")
    system = model.system()
    follower = PathFollower(LoadControl.of(system), fem.PathOptions(min_increment=1.0), fem.PathObserver())
    tried: list[bool] = []

    def failing(solver: IncrementSolver, increment: Increment) -> Converged:
        x = system.space.points
        solver.active_set = replace(solver.active_set, is_active=(True, True)).tightened(x)
        tried.append(solver.active_set.stiffened != system.terms)
        raise Unstable(Reason("tangent_indefinite"))

    monkeypatch.setattr(FacingTerm, "violation", lambda self, x: Reason("walls_cross"))
    monkeypatch.setattr(FacingTerm, "gap", lambda self, x: -1.0)
    monkeypatch.setattr(IncrementSolver, "_from_predictor", failing)
    with pytest.raises(PathEnded):
        follower.advance(1.0)
    assert tried == [True]
    assert follower.solver.active_set.is_active == (True, False)
    assert follower.solver.active_set.stiffened == system.terms


def test_what_overlaps_is_named_where_stiffer_contact_fails(monkeypatch, short: Body) -> None:
    solved = IncrementSolver._solve

    def failing(solver: IncrementSolver, start: Start, increment: Increment) -> Converged:
        if solver.active_set.stiffened != solver.active_set.model:
            raise Unstable(Reason("tangent_indefinite"))
        return solved(solver, start, increment)

    monkeypatch.setattr(IncrementSolver, "_solve", failing)
    monkeypatch.setattr("fem.effects.contact.STIFFNESS", 0.04 * STIFFNESS)
    with pytest.raises(fem.NotConverged) as caught:
        bend(short, [fem.SelfContact("gap", starts_inactive=True)], [37.0], min_increment=0.25)
    reasons = caught.value.end.reasons
    assert [reason.code for reason in reasons[:3]] == ["walls_cross", "stiffer_contact_fails", "tangent_indefinite"]
    assert reasons[0].where is not None


@pytest.mark.parametrize("is_exact", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_with_stiffer_contact_an_increment_starts_along_the_rate_of_the_last(monkeypatch, short, is_exact) -> None:
    """But not with exact distances, because walls could cross in such a start."""
    starts: list[float] = []
    last = np.zeros(())
    solved = newton.solve

    def tightened(active_set: ActiveSet) -> ActiveSet:  # instead of restored: as after a crossing on the way
        *others, contact = active_set.model
        stiffer = contact.exact(contact.stiffness) if is_exact else replace(contact, stiffness=4 * contact.stiffness)
        return replace(active_set, stiffened=(*others, stiffer))

    def watched(start: Start, *others: object) -> Converged:
        starts.append(float(np.abs(start.state.displacement - last).max()))
        return solved(start, *others)

    monkeypatch.setattr(ActiveSet, "restored", tightened)
    contact = fem.SelfContact("gap", starts_inactive=True)
    model = fem.Experiment.of("II", short, 0.0).model(LAW, [fem.Pressure("cavity", 0.037), contact], "p2p0")
    follower = PathFollower(LoadControl.of(model.system()), fem.PathOptions(), fem.PathObserver())
    last = follower.advance(0.9).displacement
    monkeypatch.setattr(newton, "solve", watched)
    follower.advance(1.0)
    assert (starts[0] == 0.0) == is_exact


def test_contact_of_one_pair_of_walls_activates_that_of_the_next() -> None:
    """Pressed onto its neighbour, the lowest of three prongs pushes that one onto the third."""
    gap = 0.4
    heights = np.array([0.0, 1.0, 1.0 + gap, 2.0 + gap, 2.0 + 2 * gap, 3.0 + 2 * gap])
    filled = np.ones((4, 5, 1), dtype=bool)
    filled[1:, [1, 3]] = False
    mesh = bricks(filled, [np.array([0.0, 1.0, 2.5, 4.0, 6.0]), heights, np.array([0.0, 1.0])])
    middle = mesh.points[mesh.boundary][..., 1].mean(axis=1)
    root = on_plane(mesh, 0, 1.0)
    sides = [on_plane(mesh, 1, height) for height in heights]
    mesh = named(
        mesh,
        clamp=on_plane(mesh, 0, 0.0),
        lower=sides[1] | sides[2] | (root & (middle < 1.5 + gap)),
        upper=sides[3] | sides[4] | (root & (middle > 1.5 + gap)),
    )
    corners = np.array([[6.0, 0.0, 0.0], [6.0, 0.0, 1.0]])
    steps = []
    for inactive in (True, False):
        contact = [fem.SelfContact(name, starts_inactive=inactive) for name in ("lower", "upper")]
        model = fem.Model(
            mesh, fem.StVenantKirchhoff(1.2, 0.3), [fem.Fixed("clamp"), fem.Prescribed(corners, "y", 1.0)], contact
        )
        steps.append(fem.follow(model, [1.0], fem.PathOptions(fem.NewtonOptions(tolerance=1e-9))).steps[0])
    assert steps[0].active == (True, True)
    assert 0 < steps[0].min_gap < 0.02
    assert distance(*steps) < 1e-7


def test_a_carried_gap_is_where_the_pressure_of_the_barrier_has_moved_the_body() -> None:
    dhat, compliance = 0.04, COMPLIANCE / contact_potential(np.array([-1.0]), 0.04)[2][0]
    gap, pressure = (grid.ravel() for grid in np.meshgrid([-0.5, -0.02, 0.0, 0.03, 0.05, 1.0], [0.0, 1e-3, 0.1, 4.0]))
    carried = carried_gaps(gap, pressure, dhat)
    _, slope, _ = contact_potential(carried, dhat)
    np.testing.assert_allclose(carried - gap, compliance * (-slope - pressure), atol=1e-8)
    is_open = (gap > dhat) & (pressure == 0.0)
    assert is_open.any()
    np.testing.assert_array_equal(carried[is_open], gap[is_open])
    # the pressure of the step counts more than its gap
    np.testing.assert_allclose(-slope[(pressure == 4.0) & (gap < 1.0)], 4.0, rtol=0.15)


def test_the_force_of_a_carried_gap_is_linear_and_that_of_the_gap_where_both_are_equal() -> None:
    space = Discretisation.of(fork(0.4), "p2p0")
    term = replace(fem.SelfContact("prongs", dhat=0.3).bind(space, LAW), dhat=0.5)  # beyond the gap at rest
    x, dx = space.points, 1e-3 * np.random.default_rng(1).standard_normal(space.points.shape)

    def force(term: FacingTerm, x: Array) -> Array:
        out = np.zeros_like(x)
        term.gradient(x, 1.0, out)
        return out

    assert np.abs(force(term, x)).max() > 0
    carrying = term.advanced(x, dx)
    assert carrying.carried is not None
    assert np.abs(force(carrying.settled(), x) - force(term, x)).max() == 0.0
    # between two positions the force of a pair along its normal changes by its curvature at e times the change of gap
    local = term.pairs.local(x)
    for e in (-0.3, 0.0, 0.2, 0.4):
        there = replace(term, carried=np.full(local.gap.shape, e))
        _, slope, curvature = contact_potential(np.array([e]), term.dhat, term.overlap)
        expected = np.zeros_like(x)
        per_pair = WEIGHT * term.stiffness * term.pairs.area * (slope + curvature * (local.gap - e))
        np.add.at(expected, local.nodes, per_pair[:, None, None] * local.first)
        np.testing.assert_allclose(force(there, x), expected, atol=1e-14)
    # a step after which the linear law and the barrier agree leaves the gap that they agree on
    still = term.advanced(x, np.zeros_like(x))
    assert still.carried is not None
    np.testing.assert_allclose(still.carried, term.pairs.gaps(x), atol=1e-10)


def test_carried_gaps_make_a_narrow_barrier_cheap_and_change_nothing(monkeypatch, short: Body, touching) -> None:
    """A narrow barrier is steep: the gap after a step, in which rotations make errors, says little about its force."""
    narrow: list[fem.Effect] = [fem.SelfContact("gap", dhat=0.005, starts_inactive=True)]
    _, carried = bend(short, narrow, [5.0, 37.0])
    assert carried[1].factorizations <= touching[1][1].factorizations + 4
    monkeypatch.setattr(FacingTerm, "advanced", lambda self, x, dx: self)
    _, uncarried = bend(short, narrow, [5.0, 37.0])
    assert distance(carried[1], uncarried[1]) < 1e-7
    assert carried[1].factorizations < uncarried[1].factorizations
