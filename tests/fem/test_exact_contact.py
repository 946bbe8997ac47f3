"""The comparison of contact by pairs of walls with exact distances between them."""

from collections.abc import Sequence

import numpy as np
import pytest

from fem import Experiment, Model, SelfContact, Step, StVenantKirchhoff, follow
from fem.discretisation import Discretisation
from fem.effects import barrier
from fem.effects.contact import BarrierTerm, crossings
from fem.path import exact_contact
from fem.solution import step_from_arrays, step_to_arrays
from pipeline.simulate.records import contact_error
from tests.bodies import fork
from tests.collapse import collapsing

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
    assert step.exact is not None
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
