"""Contact by pairs of walls beside exact distances, and a path behind a state that needed stiffer contact."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import fem
from fem import Experiment, Hencky, Model, Pressure, SelfContact, Step, StVenantKirchhoff, follow
from fem.discretisation import Discretisation
from fem.effects import barrier
from fem.effects.barrier import FacingTerm
from fem.effects.contact import BarrierTerm, crossings
from fem.effects.effect import UnilateralTerm
from fem.effects.tightening import Tightening
from fem.path import exact_contact
from fem.solution import step_from_arrays, step_to_arrays
from geometry import GRADINGS, PneuNet
from pipeline.simulate.records import contact_error
from tests.bodies import fork
from tests.collapse import collapsing
from tests.fem.test_creases import bracket, contact, folded

GAP, LENGTH = 0.4, 30.0
#: of 34 kPa
FRACTIONS = (0.4676, 0.8, 1.0)


@pytest.mark.parametrize(("slide", "is_compared"), [(0.0, False), (0.05, False), (2.5, True)])
def test_contact_is_compared_where_nodes_press_beside_their_triangles(slide: float, is_compared: bool) -> None:
    space, law = Discretisation.of(fork(GAP, layers=6), "p2"), StVenantKirchhoff(E=1.0, nu=0.4)
    term = SelfContact("prongs", dhat=0.5 * GAP, overlap=0.0).bind(space, law)
    x, upper = space.points.copy(), space.points[:, 1] > 1.0 + GAP / 2
    x[upper] += [slide, -0.7 * GAP, 0.0]
    exact = term.with_exact_distances(x)
    assert isinstance(exact, BarrierTerm) is is_compared
    assert (exact is term) is not is_compared
    shifted = SelfContact("prongs", dhat=0.5 * GAP).bind(space, law)
    assert shifted.with_exact_distances(x) is shifted
    x[upper, 1] += GAP  # walls that do not touch
    assert term.with_exact_distances(x) is term


@pytest.fixture(scope="module")
def collapse() -> tuple[Experiment, Model, tuple[Step, ...]]:
    experiment, model = collapsing(LENGTH)
    return experiment, model, follow(model, FRACTIONS).steps


def end(step: Step, displacement: np.ndarray) -> np.ndarray:
    return np.asarray(displacement[step.points[:, 0] > LENGTH - 1e-6].mean(axis=0))


def test_a_collapsed_divider_has_a_state_with_exact_distances(
    collapse: tuple[Experiment, Model, tuple[Step, ...]],
) -> None:
    """Measured: 0.088 mm; with elements of 5 mm it is 0.083 mm, and 0.087 mm where the whole path has them."""
    _, _, (apart, _, step) = collapse
    assert apart.exact is None
    assert apart.inexact == step.inexact == ()
    motion = end(step, step.exact.displacement) - end(step, step.displacement)
    assert 0.05 < np.linalg.norm(motion) < 0.2
    positions = step.points + step.exact.displacement
    assert len(crossings(positions, step.space.surface("cavity_lower").triangles)[0]) == 0
    assert not step.exact.gradient[step.gradient == 0.0].any()
    borne = (step.exact.gradient - step.gradient).sum(axis=0)[:2]  # by the clamp; along z the plane of symmetry bears
    assert np.abs(borne).max() < 1e-3 * np.abs(step.gradient).sum()


def test_the_path_does_not_depend_on_the_state_with_exact_distances(
    monkeypatch: pytest.MonkeyPatch, collapse: tuple[Experiment, Model, tuple[Step, ...]]
) -> None:
    _, model, steps = collapse
    monkeypatch.setattr(barrier, "PART_BESIDE", 2.0)
    without = follow(model, FRACTIONS).steps
    assert any(step.exact for step in steps[:-1]), "the last step comes after a comparison"
    assert not any(step.exact for step in without)
    for step, other in zip(steps, without, strict=True):
        assert np.abs(step.displacement - other.displacement).max() < 1e-6 * LENGTH
        assert step.factorizations >= other.factorizations


def test_a_path_that_is_resumed_behind_a_comparison_is_the_same_bit_for_bit(
    collapse: tuple[Experiment, Model, tuple[Step, ...]],
) -> None:
    _, model, steps = collapse
    done = [step_from_arrays(step.space, step_to_arrays(step)) for step in steps[:2]]
    resumed = follow(model, FRACTIONS, resume=done).steps
    np.testing.assert_array_equal(resumed[-1].displacement, steps[-1].displacement)
    for step, other in zip(resumed, steps, strict=True):
        same(step, other)


def same(step: Step, other: Step) -> None:
    """Both have no state with exact distances, or both the same one."""
    assert (step.exact is None) is (other.exact is None)
    if step.exact and other.exact:
        np.testing.assert_allclose(step.exact.displacement, other.exact.displacement, rtol=0.0, atol=1e-9 * LENGTH)
        np.testing.assert_allclose(step.exact.gradient, other.exact.gradient, rtol=0.0, atol=1e-9)


def test_where_there_is_no_such_state_it_is_said_why(
    monkeypatch: pytest.MonkeyPatch, collapse: tuple[Experiment, Model, tuple[Step, ...]]
) -> None:
    experiment, model, steps = collapse
    monkeypatch.setattr(exact_contact, "MAX_ITERATIONS", 2)
    alone = follow(model, FRACTIONS, resume=steps[:2]).steps[-1]
    assert alone.exact is None
    assert [(reason.code, reason.values["iterations"]) for reason in alone.inexact] == [("not_converged", 2)]
    assert step_from_arrays(alone.space, step_to_arrays(alone)).inexact == alone.inexact
    np.testing.assert_array_equal(alone.displacement, steps[-1].displacement)
    assert np.isnan(contact_error(experiment, alone)).all()


def test_the_error_of_contact_is_that_of_end_and_force(collapse: tuple[Experiment, Model, Sequence[Step]]) -> None:
    experiment, _, (apart, _, step) = collapse
    assert np.isnan(contact_error(experiment, apart)).all()
    end_mm, end_N = contact_error(experiment, step)
    assert 0.05 < end_mm < 0.2
    assert end_N == pytest.approx(0.0, abs=1e-6)  # the end of II is free


#: of 8.05 kPa of vacuum; walls of the chambers fold on the way to the second one
PARTS = (0.5, 1.0, 1.05)


def evacuated() -> Model:
    """Two chambers, which vacuum presses together and flat."""
    design = PneuNet(
        chambers=2,
        width=23.5,
        chamber_length=16.4,
        gap=4.08,
        chamber_height=19.7,
        strip=5.74,
        base=4.06,
        wall=3.11,
        side_wall=2.71,
        roof=3.66,
        channel=3.44,
    )
    effects = [
        Pressure("cavity", -0.00805),
        SelfContact("gap", starts_inactive=True),
        SelfContact("cavity", starts_inactive=True, overlap=0.0),
    ]
    experiment = fem.Experiment.of("II", design.body(9.05, GRADINGS["walls"]), 0.0)
    return experiment.model(Hencky(E=0.111, nu=0.4692), effects, "mixed")


@pytest.fixture(scope="module")
def path() -> tuple[Model, tuple[Step, ...]]:
    model = evacuated()
    return model, follow(model, PARTS).steps


def test_the_path_goes_on_with_the_contact_of_the_last_state(path: tuple[Model, tuple[Step, ...]]) -> None:
    """With softer contact, and without the pairs in creases, that state is no equilibrium."""
    model, steps = path
    assert [step.factor for step in steps] == list(PARTS)
    stiffer = [contact for contact in steps[1].contacts if contact]
    assert len(stiffer) == 2
    assert stiffer[1].pairs.nodes.size > 0
    assert not any(step.negative_pivots for step in steps)
    forgotten = [steps[0], replace(steps[1], contacts=(None, None, None))]
    with pytest.raises(fem.NotConverged) as ended:
        follow(model, PARTS, resume=forgotten)
    assert ended.value.end.reached == PARTS[1]


def test_a_resumed_path_has_the_same_contact_bit_for_bit(path: tuple[Model, tuple[Step, ...]]) -> None:
    model, steps = path
    done = [step_from_arrays(step.space, step_to_arrays(step)) for step in steps[:2]]
    resumed = follow(model, PARTS, resume=done).steps
    for step, other in zip(steps, resumed, strict=True):
        np.testing.assert_array_equal(step.displacement, other.displacement)


def forces(space: Discretisation, term: UnilateralTerm) -> np.ndarray:
    out = np.zeros_like(space.points)
    term.gradient(folded(space, 0.01), 1.0, out)
    return out


def stored(term: UnilateralTerm, model: FacingTerm) -> UnilateralTerm:
    """As it stands again after its state was stored."""
    tightening = term.tightening(model)
    again = Tightening.from_arrays("contact_3", tightening.arrays("contact_3"))
    assert again is not None
    return model.with_tightening(again)


def test_contact_stands_again_with_its_stiffness_and_its_pairs() -> None:
    space = bracket()
    model, x = contact(space), folded(space, 0.01)
    crease = model.tightened(x)
    stiffer = crease.tightened(x)
    for term in (crease, stiffer):
        again = stored(term, model)
        assert again.stiffenings == term.stiffenings
        np.testing.assert_array_equal(forces(space, again), forces(space, term))
        assert forces(space, term).any()
    assert model.tightening(model) is None
    assert Tightening.from_arrays("contact_3", {}) is None


def test_contact_stands_again_with_exact_distances() -> None:
    space = bracket()
    model = contact(space)
    assert model.exact is not None
    exact = model.exact(model.stiffness)
    again = stored(exact, model)
    assert isinstance(again, BarrierTerm)
    assert again.dhat == exact.dhat  # type: ignore[attr-defined]
