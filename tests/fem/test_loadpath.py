"""The load path: targets, increments that are cut, reasons for its end, resumption, counts."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

import fem
from fem.elements import ELEMENTS
from fem.path import newton
from fem.path.control import LoadControl
from fem.path.newton import Converged, Start, StepFailed
from fem.path.predictor import PathPoint, extrapolate
from fem.path.solver import Increment, IncrementSolver
from geometry import Body, PneuNet, Reason
from tests.bodies import box, hollow_box
from tests.laws import LAWS
from tests.loads import Traction

LAW = fem.StVenantKirchhoff(E=1.2, nu=0.495)


#: bends the beam by a third of its length
WEIGHT = fem.Gravity(5e-8)


def beam(effects: list) -> fem.Model:
    return fem.Model(box((4, 1, 1), (8.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 0.3), [fem.Fixed("left")], effects)


@pytest.mark.parametrize(("part", "is_taken"), [(0.01, True), (0.2, False)])
def test_an_equilibrium_with_the_contact_of_its_load_alone_is_no_jump(
    part: float, is_taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It differs from that on the way by a part that does not depend on the last increment, here 0.8 % of the load; the
    path ended there. One that is far away is another equilibrium."""

    def settled(self: IncrementSolver, converged: Converged, increment: Increment) -> Converged:
        if increment.control.value < 1.0:
            return converged
        state, grown = converged.state, 1.0 + part
        state = replace(state, displacement=grown * state.displacement, strain=grown * state.strain)
        return replace(converged, state=state)

    plain = fem.follow(beam([WEIGHT]), [0.992, 1.0]).steps[-1]
    monkeypatch.setattr(IncrementSolver, "settled", settled)
    step = fem.follow(beam([WEIGHT]), [0.992, 1.0]).steps[-1]
    assert step.factor == 1.0
    expected = (1.0 + part if is_taken else 1.0) * plain.displacement
    np.testing.assert_allclose(step.displacement, expected, atol=1e-9)


def test_steps_are_at_the_targets_in_their_order() -> None:
    steps: list[fem.Step] = []
    solution = fem.follow(beam([WEIGHT]), [0.3, 1.0, 0.3], observer=fem.PathObserver(step_done=steps.append))
    assert [step.factor for step in solution.steps] == [0.3, 1.0, 0.3]
    assert tuple(steps) == solution.steps
    np.testing.assert_allclose(solution.steps[0].displacement, solution.steps[2].displacement, atol=1e-5)
    assert solution.factorizations == sum(step.factorizations for step in solution.steps)
    assert solution.seconds.total > 0


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("formulation", ELEMENTS)
def test_a_bent_beam_returns_to_a_millionth_of_its_load_and_to_none(formulation: str, law: str) -> None:
    """Without load the rounding of the stress is all that is left; with little load the tolerance is the same."""
    weight = fem.Gravity(6e-8 if ELEMENTS[formulation].quadratic else 6e-7)  # linear elements lock
    model = fem.Model(box((4, 1, 1), (8.0, 1.0, 1.0)), LAWS[law], [fem.Fixed("left")], [weight], formulation)
    bent, nearly_unloaded, unloaded = fem.follow(model, [1.0, 1e-6, 0.0]).steps
    assert np.abs(bent.displacement).max() > 2.0
    assert np.abs(unloaded.displacement).max() < 1e-14
    assert (nearly_unloaded.cutbacks, unloaded.cutbacks) == (0, 0)
    assert nearly_unloaded.factorizations + unloaded.factorizations <= 8
    system = model.system()
    state = system.state_at(nearly_unloaded.displacement, nearly_unloaded.factor)
    assembly = system.assemble(state, system.terms)
    residual = np.linalg.norm(system.constraints.reduce(assembly.gradient))
    assert residual < fem.NewtonOptions().tolerance * assembly.scale


def test_newton_iterations_can_be_observed_and_are_counted() -> None:
    observed: list[tuple[float, int, float]] = []
    observer = fem.PathObserver(lambda *arguments: observed.append(arguments))
    solution = fem.follow(beam([WEIGHT]), [0.5, 1.0], observer=observer)
    assert {target for target, _, _ in observed} == {0.5, 1.0}
    assert observed[-1][2] < fem.NewtonOptions().tolerance
    first, second = solution.steps
    for step in solution.steps:
        assert step.cutbacks == 0
        iterations = [iteration for target, iteration, _ in observed if target == step.factor]
        assert step.newton_iterations == sum(iteration > 0 for iteration in iterations)
    assert first.factorizations == first.newton_iterations + 1  # of the tangent at rest
    assert second.factorizations == second.newton_iterations


def test_increments_that_fail_are_halved_and_leave_no_trace_in_the_result() -> None:
    """Two iterations do not suffice for the full weight, but for parts of it."""
    direct = fem.follow(beam([WEIGHT]), [1.0]).steps[0]
    observed: list[int] = []
    observer = fem.PathObserver(lambda target, iteration, residual: observed.append(iteration))
    solution = fem.follow(beam([WEIGHT]), [1.0], fem.PathOptions(fem.NewtonOptions(iterations=2)), observer)
    step = solution.steps[0]
    assert direct.newton_iterations > 2
    assert step.cutbacks >= 2
    assert [step.factor for step in solution.steps] == [1.0]
    np.testing.assert_allclose(step.displacement, direct.displacement, atol=1e-4)
    # failed attempts were factorized, but are no iterations that led to the result
    assert step.factorizations == sum(iteration > 0 for iteration in observed) + 1
    assert step.newton_iterations < step.factorizations - 2 * step.cutbacks
    assert step.newton_iterations > direct.newton_iterations


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "mixed"])
def test_the_rate_of_a_step_is_its_derivative(formulation: str) -> None:
    """Of displacement and pressures by the load factor; the tangent matrix is that of the last iteration."""
    model = fem.Model(
        box((4, 1, 1), (8.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 0.49), [fem.Fixed("left")], [WEIGHT], formulation
    )
    options = fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))
    before, at, after = fem.follow(model, [0.49, 0.5, 0.51], options).steps
    by_difference = (after.displacement - before.displacement) / 0.02
    assert np.abs(at.rate.displacement - by_difference).max() < 2e-3 * np.abs(by_difference).max()
    system = model.system()
    pressures = [system.state_at(step.displacement, step.factor).pressure for step in (before, after)]
    by_difference = (pressures[1] - pressures[0]) / 0.02
    assert np.abs(at.rate.pressure - by_difference).max(initial=0.0) <= 5e-3 * np.abs(by_difference).max(initial=0.0)


def test_constant_loads_are_applied_in_full_from_the_first_target_on() -> None:
    first, last = fem.follow(beam([fem.Gravity(5e-8, ramp=False)]), [0.1, 1.0]).steps
    np.testing.assert_allclose(first.displacement, last.displacement, atol=1e-9)
    alone = fem.follow(beam([WEIGHT]), [1.0]).steps[0]
    np.testing.assert_allclose(last.displacement, alone.displacement, atol=1e-4)


def codes(failure: fem.NotConverged) -> list[str]:
    return [reason.code for reason in failure.end.reasons]


def test_a_pressure_that_no_body_can_bear_ends_with_a_reason(short: Body) -> None:
    """1 MPa after 17 kPa: the step that was reached is returned, the limit of the law is named."""
    model = fem.Experiment.of("II", short, 0.0).model(
        LAW, [fem.Pressure("cavity", 1.0), fem.SelfContact("gap", starts_inactive=True)], "p2p0"
    )
    steps: list[fem.Step] = []
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow(model, [0.017, 1.0], observer=fem.PathObserver(step_done=steps.append))
    reason, partial = caught.value.reason, caught.value.partial
    assert str(caught.value) == reason
    assert reason.startswith("no equilibrium found beyond load factor 0.0")
    assert "on the way to 1: " in reason
    assert "stretch_too_small" in codes(caught.value)
    assert [step.factor for step in partial.steps] == [0.017]
    assert partial.steps == tuple(steps)
    assert partial.factorizations < 300
    assert partial.seconds.factorization > 0


def test_a_body_that_is_not_held_is_reported() -> None:
    model = fem.Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, [fem.Fixed("left", "x")], [fem.Gravity(1e-9)])
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow(model, [1.0])
    assert codes(caught.value)[-1] == "body_not_held"
    assert caught.value.partial.steps == ()
    assert caught.value.partial.factorizations < 20


def test_a_load_that_is_not_a_number_has_no_equilibrium() -> None:
    pulled = Traction("right", lambda x: np.full_like(x, np.nan))
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow(beam([pulled]), [1.0])
    assert caught.value.end.reasons[0] == Reason("residual_unbounded", {"iterations": 0})


def test_an_element_turned_inside_out_is_named() -> None:
    """The right end is pushed past the left one."""
    supports = [fem.Fixed("left"), fem.Prescribed("right", "x", -2.2), fem.Fixed("right", "yz")]
    model = fem.Model(box((2, 1, 1), (2.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 0.3), supports, [])
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow(model, [0.05, 1.0])
    reason = caught.value.end.reasons[0]
    assert reason.code == "element_inverted"
    assert reason.values["min_J"] < 0.0
    assert reason.where is not None
    assert len(caught.value.partial.steps) == 1


def test_too_few_iterations_are_reported() -> None:
    options = fem.PathOptions(fem.NewtonOptions(iterations=1), min_increment=0.3)
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow(beam([WEIGHT]), [1.0], options)
    assert codes(caught.value) == ["not_converged", "unexplained"]


@pytest.mark.parametrize("through_arrays", [False, True])
def test_a_resumed_path_continues_as_if_it_had_not_been_interrupted(short: Body, through_arrays: bool) -> None:
    effects = [fem.Pressure("cavity", 0.037), fem.SelfContact("gap", starts_inactive=True)]
    model = fem.Experiment.of("II", short, 0.0).model(LAW, effects, "p2p0")
    factors = [5 / 37, 25 / 37, 1.0]
    whole = fem.follow(model, factors).steps
    assert "self_contact" in whole[1].effects
    for count in (1, 2):
        done = whole[:count]
        if through_arrays:
            done = tuple(fem.step_from_arrays(step.space, fem.step_to_arrays(step)) for step in done)
        again = fem.follow(model, factors, resume=done).steps
        assert [step.factor for step in again] == factors
        for step, first in zip(again, whole, strict=True):
            np.testing.assert_array_equal(step.displacement, first.displacement)
            np.testing.assert_array_equal(step.added_pairs, first.added_pairs)
            assert step.factorizations == first.factorizations
            assert step.newton_iterations == first.newton_iterations
            assert step.effects == first.effects


@pytest.mark.parametrize(("formulation", "limit"), [("p2p0", 0.5198), ("mixed", 0.4779)])
@pytest.mark.parametrize("fractions", [(0.7, 0.99), (0.3, 0.6, 0.9)])
def test_a_path_towards_a_limit_that_is_resumed_is_the_same_bit_for_bit(
    fractions: tuple[float, ...], formulation: str, limit: float
) -> None:
    """The last two points and the rate at rest announce the limit, on which increments and starts depend."""
    supports = [fem.Fixed("clamp"), fem.Fixed("sym", "z")]
    model = fem.Model(hollow_box(True), fem.NeoHooke(0.4, 20.0), supports, [fem.Pressure("cavity", 1.0)], formulation)
    factors = [fraction * limit for fraction in fractions]
    whole = fem.follow(model, factors).steps
    for count in range(1, len(factors)):
        again = fem.follow(model, factors, resume=whole[:count]).steps
        for step, first in zip(again, whole, strict=True):
            np.testing.assert_array_equal(step.displacement, first.displacement)
            assert step.factorizations == first.factorizations


def test_a_finished_path_that_is_resumed_solves_nothing() -> None:
    model = beam([WEIGHT])
    steps = fem.follow(model, [0.5, 1.0]).steps
    again = fem.follow(model, [0.5, 1.0], resume=steps)
    assert again.steps == steps
    assert again.factorizations == again.analyses == 0


def test_two_loads_of_one_kind_add_up() -> None:
    both = fem.follow(beam([fem.Gravity(2e-8), fem.Gravity(3e-8)]), [1.0]).steps[0]
    single = fem.follow(beam([WEIGHT]), [1.0]).steps[0]
    np.testing.assert_allclose(both.displacement, single.displacement, atol=1e-12)


def far_from_the_path() -> tuple[LoadControl, Start]:
    """The full pressure, and a start 30 times beyond what the rate at rest is good for."""
    body = PneuNet(chambers=2).body(7.0)
    model = fem.Experiment.of("II", body, 0.0).model(
        fem.StVenantKirchhoff(1.2, 0.495), [fem.Pressure("cavity", 5e-3)], "p2p0"
    )
    system = model.system()
    control = LoadControl.of(system)
    rest = PathPoint(0.0, 0.0, system.rest_state(), rate=control.rate_at_rest(system.terms, 1.0))
    far = extrapolate(None, rest, 30.0)
    assert far is not None
    return control.target(1.0, 1.0), Start(far, system.terms)


def test_a_trial_start_is_given_up_as_soon_as_the_strain_is_limited() -> None:
    """Far beyond what the rate at rest is good for: a trial costs one factorization, another start is iterated on."""
    control, start = far_from_the_path()
    times = control.system.solver.times
    spent = times.factorizations
    with pytest.raises(StepFailed) as failed:
        newton.solve(replace(start, trial=True), control, fem.NewtonOptions(), lambda *arguments: None)
    assert failed.value.reasons[0].code == "tangent_stays_indefinite"
    assert times.factorizations == spent + 1
    iterations: list[int] = []
    with suppress(StepFailed):
        newton.solve(start, control, fem.NewtonOptions(), lambda iteration, residual: iterations.append(iteration))
    assert iterations[-1] > 1


def test_a_start_has_an_iteration_limit_of_its_own() -> None:
    system = beam([WEIGHT]).system()
    start = Start(system.rest_state(), system.terms, max_iterations=1)
    with pytest.raises(StepFailed, match="no equilibrium after 1 iterations"):
        newton.solve(start, LoadControl.of(system).target(1.0, 1.0), fem.NewtonOptions(), lambda *arguments: None)
    assert system.solver.times.factorizations == 1


def test_an_extrapolated_equilibrium_is_iterated_once_because_its_stability_is_not_known() -> None:
    """Under twice Euler's load a straight column is in equilibrium before any iteration, and unstable."""
    length = 16.0
    euler = np.pi**2 / 12 / (4 * length**2)
    compression = Traction("right", lambda x: np.broadcast_to([-euler, 0.0, 0.0], x.shape))
    column = box((16, 1, 1), (length, 1.0, 1.0))
    model = fem.Model(column, fem.StVenantKirchhoff(1.0, 0.0), [fem.Fixed("left")], [compression], "p2")
    system, known = model.system(), fem.follow(model, [2.0]).steps[0]
    state = system.state_at(known.displacement, known.factor)
    control = LoadControl.of(system).target(2.0, 1.0)
    start = Start(state, system.terms)
    unchecked = newton.solve(start, control, fem.NewtonOptions(), lambda *arguments: None)
    checked = newton.solve(replace(start, iterates=True), control, fem.NewtonOptions(), lambda *arguments: None)
    assert (unchecked.iterations, checked.iterations) == (0, 1)
    assert checked.negative_pivots == known.negative_pivots == 2
    np.testing.assert_allclose(checked.state.displacement, known.displacement, atol=1e-6)


def test_a_path_that_loses_its_stability_on_the_way_says_that_it_was_not_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A straight bar pressed with three times its Euler load stays straight; half of that is too much already."""
    euler = np.pi**2 / 12.0 / (4.0 * 8.0**2)

    def pressed(x: np.ndarray) -> np.ndarray:
        return np.stack([np.full(x.shape[:-1], -3.0 * euler), 0.0 * x[..., 1], 0.0 * x[..., 2]], axis=-1)

    ends = [fem.Fixed("left")]
    bar = fem.Model(
        box((8, 1, 1), (8.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 1e-5), ends, [Traction("right", pressed)], "p2"
    )
    (at_once,) = fem.follow(bar, [1.0]).steps
    solve, tried = IncrementSolver.solve, []

    def fails_at_first(self: IncrementSolver, increment: Increment) -> Converged:
        tried.append(increment)
        if len(tried) == 1:
            raise StepFailed(Reason("nothing_tried"))
        return solve(self, increment)

    monkeypatch.setattr(IncrementSolver, "solve", fails_at_first)
    (halved,) = fem.follow(bar, [1.0]).steps
    np.testing.assert_allclose(halved.displacement, at_once.displacement, atol=1e-6)
    assert (at_once.negative_pivots, halved.negative_pivots) == (2, 2)
    assert [reason.code for reason in at_once.instability] == ["unstable"]
    unstable, left = halved.instability
    assert (unstable.code, unstable.values["directions"]) == ("unstable", 2)
    assert (left.code, left.values) == ("not_followed", {"stable": 0.0, "unstable": 0.5})
