"""The walk along the load path: cut back, restore, give up with a reason, take up again."""

from dataclasses import replace

import numpy as np
import pytest
from bodies import box

import fem.path.newton
from fem import (
    Experiment,
    Fixed,
    Gravity,
    Model,
    NewtonOptions,
    NotConverged,
    PathOptions,
    Prescribed,
    Pressure,
    SelfContact,
    Step,
    StVenantKirchhoff,
    follow,
    step_from_arrays,
    step_to_arrays,
)
from fem.path.newton import StepFailed
from fem.path.predictor import Predictor, Start, predicted
from geometry import Body, PneuNet

LAW = StVenantKirchhoff(E=1.2, nu=0.495)


#: bends the beam by a third of its length
WEIGHT = Gravity(5e-8)


def beam(effects: list) -> Model:
    return Model(box((4, 1, 1), (8.0, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.3), [Fixed("left")], effects)


def test_steps_stand_exactly_at_the_asked_factors_in_their_order() -> None:
    kept: list[Step] = []
    solution = follow(beam([WEIGHT]), [0.3, 1.0, 0.3], keep=kept.append)
    assert [step.factor for step in solution.steps] == [0.3, 1.0, 0.3]
    assert tuple(kept) == solution.steps
    np.testing.assert_allclose(solution.steps[0].displacement, solution.steps[2].displacement, atol=1e-5)
    assert solution.factorizations == sum(step.factorizations for step in solution.steps)
    assert solution.seconds.total > 0


def test_what_newton_does_can_be_watched() -> None:
    seen: list[tuple[float, int, float]] = []
    solution = follow(beam([WEIGHT]), [0.5, 1.0], watch=lambda *now: seen.append(now))
    assert {factor for factor, _, _ in seen} == {0.5, 1.0}
    assert sum(iteration > 0 for _, iteration, _ in seen) + 1 == solution.factorizations  # one for the rate at rest
    assert seen[-1][2] < NewtonOptions().tolerance


def test_failed_attempts_are_cut(monkeypatch) -> None:
    """Attempts over more than a third of the way fail here; the end state must not know of it."""
    plain = follow(beam([WEIGHT]), [1.0])
    real, starts, reached = fem.path.newton.solve, [], [0.0]

    def fails_far_out(system, terms, start, control, *rest):
        starts.append((control.factor, start.displacement.copy()))
        if control.factor - reached[-1] > 0.34:
            raise StepFailed("too far")
        found = real(system, terms, start, control, *rest)
        reached.append(control.factor)
        return found

    monkeypatch.setattr(fem.path.newton, "solve", fails_far_out)
    step = follow(beam([WEIGHT]), [1.0]).steps[0]
    assert step.cutbacks >= 2
    assert reached == sorted(reached)
    assert reached[-1] == 1.0
    # each from a share of the way along the rate at rest that strains a little, under two stresses
    assert [factor for factor, _ in starts[:5]] == [1.0, 1.0, 0.5, 0.5, 0.25]
    sizes = [np.linalg.norm(displacement) for _, displacement in starts[:5]]
    assert sizes[0] == sizes[1] >= sizes[2] == sizes[3] >= sizes[4] > 0
    np.testing.assert_allclose(step.displacement, plain.steps[0].displacement, atol=1e-4)


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "mixed"])
def test_the_rate_of_a_step_is_its_derivative(formulation: str) -> None:
    """Of displacement and pressures by the load factor; the factor at hand is that of the iteration before the end."""
    model = Model(box((4, 1, 1), (8.0, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.49), [Fixed("left")], [WEIGHT], formulation)
    options = PathOptions(NewtonOptions(tolerance=1e-10))
    before, at, after = follow(model, [0.49, 0.5, 0.51], options).steps
    assert at.rate is not None
    by_difference = (after.displacement - before.displacement) / 0.02
    assert np.abs(at.rate.displacement - by_difference).max() < 2e-3 * np.abs(by_difference).max()
    system = model.system()
    pressures = [system.state_at(step.displacement, step.factor).pressure for step in (before, after)]
    by_difference = (pressures[1] - pressures[0]) / 0.02
    assert np.abs(at.rate.pressure - by_difference).max(initial=0.0) <= 5e-3 * np.abs(by_difference).max(initial=0.0)


def test_what_does_not_ramp_is_whole_from_the_first_factor_on() -> None:
    first, last = follow(beam([Gravity(5e-8, ramp=False)]), [0.1, 1.0]).steps
    np.testing.assert_allclose(first.displacement, last.displacement, atol=1e-9)
    alone = follow(beam([WEIGHT]), [1.0]).steps[0]
    np.testing.assert_allclose(last.displacement, alone.displacement, atol=1e-4)


def test_a_pressure_no_body_can_bear_ends_with_a_sentence(short: Body) -> None:
    """1 MPa on 17 kPa's way: what was reached stays, the limit of the law is named. Measured: 150 factorizations."""
    model = Experiment.of("II", short, 0.0).model(
        LAW, [Pressure("cavity", 1.0), SelfContact("gap", starts_inactive=True)], "p2p0"
    )
    kept: list[Step] = []
    with pytest.raises(NotConverged) as caught:
        follow(model, [0.017, 1.0], keep=kept.append)
    reason, partial = caught.value.reason, caught.value.partial
    assert str(caught.value) == reason
    assert reason.startswith("no equilibrium found beyond load factor 0.0")
    assert "on the way to 1: " in reason
    assert "is below 0.577, where StVenantKirchhoff in compression is no longer stable" in reason
    assert [step.factor for step in partial.steps] == [0.017]
    assert partial.steps == tuple(kept)
    assert partial.factorizations < 300
    assert partial.seconds.factorization > 0


def test_a_body_that_is_not_held_is_told_so() -> None:
    model = Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, [Fixed("left", "x")], [Gravity(1e-9)])
    with pytest.raises(NotConverged, match=r"singular.*a part of the body is not held") as caught:
        follow(model, [1.0])
    assert caught.value.partial.steps == ()
    assert caught.value.partial.factorizations < 20


def test_an_element_turned_inside_out_is_named() -> None:
    """The right end is pushed past the left one."""
    supports = [Fixed("left"), Prescribed("right", "x", -2.2), Fixed("right", "yz")]
    model = Model(box((2, 1, 1), (2.0, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.3), supports, [])
    with pytest.raises(NotConverged, match=r"inside out at \(.*\) mm \(J = -") as caught:
        follow(model, [0.05, 1.0])
    assert len(caught.value.partial.steps) == 1


def test_iterations_that_do_not_suffice_are_said() -> None:
    options = PathOptions(NewtonOptions(iterations=1), smallest=0.3)
    with pytest.raises(NotConverged, match=r"no equilibrium after 1 iterations \(relative residual \d"):
        follow(beam([WEIGHT]), [1.0], options)


@pytest.mark.parametrize("through_arrays", [False, True])
def test_a_path_taken_up_again_goes_on_as_if_never_left(short: Body, through_arrays: bool) -> None:
    effects = [Pressure("cavity", 0.037), SelfContact("gap", starts_inactive=True)]
    model = Experiment.of("II", short, 0.0).model(LAW, effects, "p2p0")
    factors = [5 / 37, 25 / 37, 1.0]
    whole = follow(model, factors).steps
    assert "self_contact" in whole[1].effects
    for count in (1, 2):
        done = whole[:count]
        if through_arrays:
            done = tuple(step_from_arrays(step.space, step_to_arrays(step)) for step in done)
        again = follow(model, factors, resume=done).steps
        assert [step.factor for step in again] == factors
        for step, first in zip(again, whole, strict=True):
            np.testing.assert_allclose(step.displacement, first.displacement, rtol=0, atol=1e-10)
            assert step.factorizations == first.factorizations
            assert step.effects == first.effects


def test_a_finished_path_taken_up_again_does_nothing() -> None:
    model = beam([WEIGHT])
    steps = follow(model, [0.5, 1.0]).steps
    again = follow(model, [0.5, 1.0], resume=steps)
    assert again.steps == steps
    assert again.factorizations == 0


def test_two_loads_of_one_kind_add_up() -> None:
    both = follow(beam([Gravity(2e-8), Gravity(3e-8)]), [1.0]).steps[0]
    one = follow(beam([WEIGHT]), [1.0]).steps[0]
    np.testing.assert_allclose(both.displacement, one.displacement, atol=1e-12)


def test_a_predicted_start_whose_strain_is_limited_is_given_up(monkeypatch) -> None:
    """A guess far beyond what the rate at rest is good for costs one factorization, not all that a guess is worth."""
    body = PneuNet(chambers=2).body(7.0)
    model = Experiment.of("II", body, 0.0).model(StVenantKirchhoff(1.2, 0.495), [Pressure("cavity", 5e-3)], "p2p0")
    starts, guesses = Predictor.starts, []

    def plain(self: Predictor, places, aim, terms):
        yield list(starts(self, places, aim, terms))[-1]

    def misled(self: Predictor, places, aim, terms):
        *_, last = starts(self, places, aim, terms)
        far = predicted(None, replace(places[-1], rate=self._rate), 30.0 * aim.value)
        guesses.append(far)
        yield Start(far, terms, iterations=8, trial=True)
        yield last

    monkeypatch.setattr(Predictor, "starts", plain)
    direct = follow(model, [1.0])
    monkeypatch.setattr(Predictor, "starts", misled)
    led = follow(model, [1.0])
    assert len(guesses) == 1
    assert led.factorizations == direct.factorizations + 1
    np.testing.assert_allclose(led.steps[0].displacement, direct.steps[0].displacement, atol=1e-6)
