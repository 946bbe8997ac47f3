"""The terms of the potential: gradient and second derivative of each against differences of its energy and gradient."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fem import ContactError, Effect, Gravity, Pressure, SelfContact, StrainLimitingLayer, StVenantKirchhoff
from fem.discretisation import Discretisation
from fem.effects import facing_pairs
from fem.effects.barrier import CONTINUATION, FacingTerm, continued_barrier
from fem.effects.contact import BarrierTerm
from fem.effects.effect import Blocks, Term, advanced, at_constant_fraction
from fem.effects.facing_pairs import FacingPairs
from geometry import Mesh
from geometry.arrays import Array
from tests.bodies import box, bricks, difference, fork, hollow_box, named

LAW = StVenantKirchhoff(E=1.2, nu=0.4)
GAP = 0.4


def times(blocks: Blocks, dx: Array) -> Array:
    """The second derivative times dx (n, 3)."""
    out = np.zeros_like(dx)
    assert (blocks.rows <= blocks.columns).all()
    np.add.at(out, blocks.rows, np.einsum("mij,mj->mi", blocks.values, dx[blocks.columns]))
    off = blocks.rows != blocks.columns
    np.add.at(out, blocks.columns[off], np.einsum("mij,mi->mj", blocks.values[off], dx[blocks.rows[off]]))
    return out


def gradient(term: Term, x: Array, factor: float) -> Array:
    out = np.zeros_like(x)
    term.gradient(x, factor, out)
    return out


def shaken(space: Discretisation, size: float, seed: int) -> Array:
    """A random motion (n, 3) that leaves the plane of symmetry where it is."""
    move = np.random.default_rng(seed).normal(scale=size, size=space.points.shape)
    if "sym" in space.surfaces:
        move[space.surface("sym").unique_nodes, 2] = 0.0
    return move


def bound(mesh: Mesh, effect: Effect, formulation: str = "p2p0") -> tuple[Term, Discretisation]:
    space = Discretisation.of(mesh, formulation)
    return effect.bind(space, LAW), space


def facing(formulation: str = "p2p0") -> tuple[FacingTerm, Discretisation]:
    space = Discretisation.of(fork(GAP), formulation)
    return SelfContact("prongs", dhat=0.8 * GAP).bind(space, LAW), space


def barrier(formulation: str = "p2p0") -> tuple[BarrierTerm, Discretisation]:
    term, space = facing(formulation)
    exact = term.tightened(space.points)
    assert isinstance(exact, BarrierTerm)
    return exact, space


CASES: dict[str, Callable[[str], tuple[Term, Discretisation]]] = {
    "pressure": lambda elements: bound(hollow_box(half=True), Pressure("cavity", 0.2), elements),
    "pressure, not ramped": lambda elements: bound(
        hollow_box(half=False), Pressure("cavity", 0.2, ramp=False), elements
    ),
    "gravity": lambda elements: bound(hollow_box(half=True), Gravity(1.13e-9, (1.0, -9810.0, 20.0)), elements),
    "facing walls": facing,
    "barrier": barrier,
}


def pinched(space: Discretisation) -> Array:
    """The fork closed so far that some pairs are beyond the activation distance, some within, some nearly touch."""
    x = space.points.copy()
    upper = x[:, 1] > 1.0 + GAP / 2
    x[upper, 1] -= 0.7 * GAP * np.clip(x[upper, 0] - 1.0, 0.0, None) / 5.0
    return x


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
@pytest.mark.parametrize("name", CASES)
def test_derivatives(name: str, formulation: str) -> None:
    term, space = CASES[name](formulation)
    term = at_constant_fraction((term,), 0.6)[0]
    dx = shaken(space, 1.0, seed=2)
    x = (pinched(space) if name in ("facing walls", "barrier") else space.points) + shaken(space, 0.01, seed=1)
    factor, step = 0.7, 1e-6 if name in ("facing walls", "barrier") else 1e-4
    force = gradient(term, x, factor)
    slope = difference(lambda y: np.float64(term.energy(y, factor)), x, dx, step)
    assert np.abs(force).max() > 0
    assert np.vdot(force, dx) == pytest.approx(slope, rel=1e-7)
    change = difference(lambda y: gradient(term, y, factor), x, dx, step)
    if "sym" in space.surfaces:  # what the plane of symmetry bears is no part of the potential
        change[space.surface("sym").unique_nodes, 2] = 0.0
    product = times(term.blocks(x, factor, convex=False), dx)
    if "sym" in space.surfaces:
        product[space.surface("sym").unique_nodes, 2] = 0.0
    np.testing.assert_allclose(product, change, atol=1e-6 * max(np.abs(change).max(), 1e-9))


@pytest.mark.parametrize("name", ["facing walls", "barrier"])
def test_convex_substitute_is_positive_semi_definite(name: str) -> None:
    term, space = CASES[name]("p2p0")
    x = pinched(space) + shaken(space, 0.01, seed=1)
    blocks = term.blocks(x, 1.0, convex=True)
    size = x.size
    matrix = np.column_stack([times(blocks, column.reshape(x.shape)).ravel() for column in np.eye(size)])
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    values = np.linalg.eigvalsh(matrix)
    assert values.min() > -1e-9 * values.max()
    assert values.max() > 0


def test_ramped_loads_follow_the_load_factor_and_constant_ones_their_own_fraction() -> None:
    for make in (lambda ramp: Pressure("cavity", 0.2, ramp), lambda ramp: Gravity(1e-9, ramp=ramp)):
        ramped, space = bound(hollow_box(half=False), make(True))
        constant, _ = bound(hollow_box(half=False), make(False))
        x = space.points + shaken(space, 0.05, seed=1)
        np.testing.assert_allclose(
            gradient(constant.with_constant_fraction(0.6), x, 0.1), gradient(ramped, x, 0.6), atol=1e-18
        )
        assert ramped.with_constant_fraction(0.6) is ramped
        assert not gradient(constant, x, 1.0).any()


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_gravity_weighs_the_body(formulation: str) -> None:
    term, space = bound(box((2, 2, 2), (1.0, 2.0, 3.0)), Gravity(2e-9, (0.0, -9810.0, 0.0)), formulation)
    pull = -gradient(term, space.points, 1.0)
    np.testing.assert_allclose(pull.sum(axis=0), [0.0, -6.0 * 2e-9 * 9810.0, 0.0], rtol=1e-12)
    turning = np.cross(space.points, pull).sum(axis=0)
    np.testing.assert_allclose(turning, np.cross([0.5, 1.0, 1.5], pull.sum(axis=0)), rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_contact_forces_have_no_resultant(formulation: str) -> None:
    for name in ("facing walls", "barrier"):
        term, space = CASES[name](formulation)
        x = pinched(space) + shaken(space, 0.01, seed=1)
        force = gradient(term, x, 1.0)
        scale = np.abs(force).sum()
        np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12 * scale)
        np.testing.assert_allclose(np.cross(x, force).sum(axis=0), 0.0, atol=1e-11 * scale)


def test_barrier_and_its_quadratic_continuation_meet_smoothly() -> None:
    dhat = 0.3
    gap = np.linspace(-0.2, 0.4, 100_001)
    value, slope, bend = continued_barrier(gap, dhat)
    np.testing.assert_allclose(np.gradient(value, gap)[1:-1], slope[1:-1], atol=1e-4 * np.abs(slope).max())
    np.testing.assert_allclose(np.gradient(slope, gap)[1:-1], bend[1:-1], atol=1e-3 * np.abs(bend).max())
    assert (slope <= 0).all()
    assert (bend >= 0).all()
    assert not value[gap >= dhat].any()
    exact = gap[(gap > CONTINUATION * dhat) & (gap < dhat)]
    r = (exact / dhat) ** 2
    np.testing.assert_allclose(continued_barrier(exact, dhat)[0], -dhat * (1 - r) ** 2 * np.log(r), rtol=1e-12)


@pytest.mark.parametrize(("formulation", "least"), [("p2p0", 20), ("p1", 8)])
def test_pairs_look_across_the_gap_and_turn_negative_when_walls_cross(formulation: str, least: int) -> None:
    term, space = facing(formulation)
    pairs = term.pairs
    assert pairs.nodes.size > least
    np.testing.assert_allclose(pairs.gaps(space.points), GAP, rtol=1e-12)
    heights = space.points[pairs.nodes, 1]
    assert set(np.round(heights, 9)) == {1.0, 1.0 + GAP}
    np.testing.assert_allclose(space.points[pairs.triangles][..., 1].mean(axis=1), 2.0 + GAP - heights)
    x = space.points.copy()
    x[x[:, 1] > 1.0 + GAP / 2, 1] -= 1.5 * GAP
    np.testing.assert_allclose(pairs.gaps(x), -0.5 * GAP, rtol=1e-12)
    assert term.violation(x).code == "walls_cross"


def test_the_barrier_of_crossing_walls_is_stiffened_twice_and_then_exact() -> None:
    term, space = facing()
    crossed = space.points.copy()
    crossed[space.points[:, 1] > 1.0 + GAP / 2, 1] -= 1.5 * GAP
    push = np.linalg.norm(gradient(term, crossed, 1.0))
    for _ in range(2):
        stiffer = term.tightened(crossed)
        assert isinstance(stiffer, FacingTerm)
        term = stiffer
        assert np.linalg.norm(gradient(term, crossed, 1.0)) == pytest.approx(4.0 * push)
        push *= 4.0
    assert isinstance(term.tightened(crossed), BarrierTerm)
    assert isinstance(term.tightened(space.points), BarrierTerm)


def test_contact_far_away_is_nothing() -> None:
    space = Discretisation.of(fork(GAP), "p2p0")
    term = SelfContact("prongs").bind(space, LAW)
    x = space.points
    assert term.energy(x, 1.0) == 0.0
    assert not gradient(term, x, 1.0).any()
    assert not term.blocks(x, 1.0, convex=False).values.any()
    assert term.violation(x) is None
    assert term.gap(x) == pytest.approx(GAP)
    exact = term.tightened(x)
    assert isinstance(exact, BarrierTerm)
    assert exact.energy(x, 1.0) == 0.0
    assert not gradient(exact, x, 1.0).any()
    assert exact.blocks(x, 1.0, convex=False).rows.size == 0
    assert exact.gap(x) == np.inf


@pytest.mark.slow
def test_barrier_stops_a_step_before_walls_touch() -> None:
    term, space = barrier()
    closing = np.zeros_like(space.points)
    closing[space.points[:, 1] > 1.0 + GAP / 2, 1] = -2.0 * GAP
    fraction = term.step_limit(space.points, closing)
    assert 0.2 < fraction < 0.5
    assert term.violation(space.points + fraction * closing) is None
    assert term.violation(pinched(space) + 0.2 * closing).code == "walls_cross"
    assert term.step_limit(space.points, -closing) == 1.0


@pytest.mark.parametrize(("gap", "code"), [(GAP, "walls_cross"), (20.0, "far_walls_cross")])
def test_walls_that_meet_from_far_are_told_with_their_distance_at_rest(gap: float, code: str) -> None:
    space = Discretisation.of(fork(gap), "p2p0")
    surface = space.surface("prongs")
    x = space.points.copy()
    upper = x[:, 1] > 1.0 + gap / 2
    x[upper, 1] -= 1.2 * gap * (x[upper, 0] - 1.0) / 5.0
    violation = BarrierTerm(surface, space.points, 0.1, 1.0).violation(x)
    assert violation.code == code
    assert 19.0 <= violation.values.get("apart_mm", gap) < 30.0 or code == "walls_cross"
    assert violation.where is not None


@pytest.mark.parametrize("starts_inactive", [False, True])
def test_an_activation_distance_that_walls_are_within_at_rest_is_refused(starts_inactive: bool) -> None:
    sentence = r"self-contact on 'prongs': dhat, 0.45 mm, must be below the smallest gap at rest, 0.4 mm"
    with pytest.raises(ContactError, match=sentence):
        bound(fork(GAP), SelfContact("prongs", 0.45, starts_inactive))
    bound(fork(GAP), SelfContact("prongs", 0.39, starts_inactive))


def test_a_face_that_faces_nothing_has_no_pairs() -> None:
    space = Discretisation.of(fork(GAP), "p2p0")
    assert FacingPairs.of(space.surface("above"), space.points).nodes.size == 0


def test_without_an_exact_barrier_the_gaps_alone_judge_and_nothing_is_stiffer_in_the_end() -> None:
    term, space = facing()
    term = replace(term, exact=None)
    assert term.violation(pinched(space)) is None
    crossed = space.points.copy()
    crossed[space.points[:, 1] > 1.0 + GAP / 2, 1] -= 1.5 * GAP
    assert term.violation(crossed).code == "walls_cross"
    stiffest = replace(term, stiffenings=0)
    assert stiffest.tightened(crossed) is stiffest


def test_walls_of_a_cavity_see_each_other_across_it() -> None:
    """Far apart compared to the mesh, where the nearest triangles are those of the same wall."""
    filled = np.ones((10, 10, 3), dtype=bool)
    filled[1:-1, 1:-1, 1] = False
    lines = [np.linspace(0.0, 10.0, 11), np.linspace(0.0, 10.0, 11), np.array([0.0, 1.0, 7.0, 8.0])]
    mesh = bricks(filled, lines)
    middle = mesh.points[mesh.boundary].mean(axis=1)
    inside = (np.abs(middle - [5.0, 5.0, 4.0]) < [4.01, 4.01, 3.01]).all(axis=1)
    space = Discretisation.of(named(mesh, cavity=inside), "p2")
    pairs = FacingPairs.of(space.surface("cavity"), space.points)
    flat = np.isclose(space.points[space.surface("cavity").unique_nodes, 2] % 6.0, 1.0)
    assert np.unique(pairs.nodes).size > 0.9 * flat.sum()
    assert set(np.round(pairs.gaps(space.points), 9)) == {6.0, 8.0}


def test_contact_that_starts_inactive_on_faces_that_face_nothing_is_never_activated() -> None:
    space = Discretisation.of(fork(GAP), "p2p0")
    term = SelfContact("above", starts_inactive=True).bind(space, LAW)
    assert not term.must_activate(space.points)
    assert term.gap(space.points) == np.inf


@pytest.mark.parametrize("name", ["pressure", "layer"])
def test_terms_give_the_same_node_pairs_on_each_call(name: str) -> None:
    """The same arrays, so that their position in the matrix is looked up once."""
    if name == "layer":
        mesh = box((2, 2, 2), (1.0, 1.0, 1.0))
        term, space = bound(mesh, StrainLimitingLayer(mesh.plane(1, 0.5), 0.1, 100.0, 0.3))
    else:
        term, space = CASES[name]("p2p0")
    x = space.points + shaken(space, 0.01, seed=1)
    first = term.blocks(space.points, 1.0, convex=False)
    later = advanced((term,), space.points, x - space.points)[0].blocks(x, 0.5, convex=True)
    assert first.rows is later.rows
    assert first.columns is later.columns


def test_pairs_of_one_surface_are_searched_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(facing_pairs, "_kept", {})
    space = Discretisation.of(fork(GAP), "p2p0")
    wider = Discretisation.of(fork(2 * GAP), "p2p0")
    first = FacingPairs.of(space.surface("prongs"), space.points)
    again = Discretisation.of(fork(GAP), "p2p0")
    assert FacingPairs.of(again.surface("prongs"), again.points) is first
    other = FacingPairs.of(wider.surface("prongs"), wider.points)
    assert other.gaps(wider.points).min() > 1.5 * first.gaps(space.points).min()
    for count in range(facing_pairs.KEPT):
        moved = space.points + 0.1 * (1 + count)
        FacingPairs.of(space.surface("prongs"), moved)
    assert len(facing_pairs._kept) == facing_pairs.KEPT
    np.testing.assert_array_equal(FacingPairs.of(space.surface("prongs"), space.points).nodes, first.nodes)
