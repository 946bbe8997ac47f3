"""A path behind a state for which contact had to become stiffer, and got pairs in creases."""

from dataclasses import replace

import numpy as np
import pytest

import fem
from fem import Hencky, Model, Pressure, SelfContact, Step, follow
from fem.discretisation import Discretisation
from fem.effects.barrier import FacingTerm
from fem.effects.contact import BarrierTerm
from fem.effects.effect import UnilateralTerm
from fem.effects.tightening import Tightening
from fem.solution import step_from_arrays, step_to_arrays
from geometry import GRADINGS, PneuNet
from tests.fem.test_creases import bracket, contact, folded

#: of 8.05 kPa of vacuum; walls of the chambers fold on the way to the second one
FRACTIONS = (0.5, 1.0, 1.05)


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
    return model, follow(model, FRACTIONS).steps


def test_the_path_goes_on_with_the_contact_of_the_last_state(path: tuple[Model, tuple[Step, ...]]) -> None:
    """With softer contact, and without the pairs in creases, that state is no equilibrium."""
    model, steps = path
    assert [step.factor for step in steps] == list(FRACTIONS)
    stiffer = [contact for contact in steps[1].contacts if contact]
    assert len(stiffer) == 2
    assert stiffer[1].pairs.nodes.size > 0
    assert not any(step.negative_pivots for step in steps)
    forgotten = [steps[0], replace(steps[1], contacts=(None, None, None))]
    with pytest.raises(fem.NotConverged) as ended:
        follow(model, FRACTIONS, resume=forgotten)
    assert ended.value.end.reached == FRACTIONS[1]


def test_a_resumed_path_has_the_same_contact_bit_for_bit(path: tuple[Model, tuple[Step, ...]]) -> None:
    model, steps = path
    done = [step_from_arrays(step.space, step_to_arrays(step)) for step in steps[:2]]
    resumed = follow(model, FRACTIONS, resume=done).steps
    for step, other in zip(steps, resumed, strict=True):
        np.testing.assert_array_equal(step.displacement, other.displacement)


def forces(space: Discretisation, term: UnilateralTerm) -> np.ndarray:
    out = np.zeros_like(space.points)
    term.gradient(folded(space, 0.01), 1.0, out)
    return out


def stored(term: UnilateralTerm, model: FacingTerm) -> UnilateralTerm:
    """As it stands again after its state was stored."""
    tightening = term.tightening(model)
    assert tightening is not None
    again = Tightening.from_arrays("contact_3", tightening.arrays("contact_3"))
    assert again is not None
    return model.with_tightening(again)


def test_contact_stands_again_with_its_stiffness_and_its_pairs() -> None:
    space = bracket()
    model, x = contact(space), folded(space, 0.01)
    crease = model.tightened(x)
    assert isinstance(crease, FacingTerm)
    stiffer = crease.tightened(x)
    for term in (crease, stiffer):
        again = stored(term, model)
        assert isinstance(term, FacingTerm)
        assert isinstance(again, FacingTerm)
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
