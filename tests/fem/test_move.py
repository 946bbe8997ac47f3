"""The way from one equilibrium to another load factor, another displacement of the supports and more loads."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import fem
from fem.effects.effect import at_constant_fraction
from fem.equations.state import State
from fem.path import newton
from fem.path.follower import PathFollower
from fem.path.move import MoveControl
from fem.path.newton import Converged, Start
from fem.supports import Line
from geometry import Body, Reason
from tests.bodies import box, hollow_box

LAW = fem.StVenantKirchhoff(1.0, 0.49)
#: on the side opposite to the clamp
EDGE = np.array([[3.0, 3.0, 0.0], [3.0, 3.0, 0.5], [3.0, 3.0, 1.5]])


def held(height: float, formulation: str = "p2p0") -> fem.Model:
    """A box under pressure; the height in mm of an edge is prescribed."""
    supports = [fem.Fixed("clamp"), fem.Fixed("sym", "z"), fem.Prescribed(EDGE, "y", height, ramp=False)]
    return fem.Model(hollow_box(half=True), LAW, supports, [fem.Pressure("cavity", 0.05)], formulation)


def pulled(force: float, formulation: str = "p2p0", density: float = 1e-6) -> fem.Model:
    """The box under pressure and its weight; a force in N pulls the edge, if it is not zero."""
    effects: list[fem.Effect] = [fem.Pressure("cavity", 0.05), fem.Gravity(density, ramp=False)]
    effects += [fem.LineForce(Line(EDGE), (0.0, force, 0.0), ramp=False)] if force else []
    return fem.Model(hollow_box(half=True), LAW, [fem.Fixed("clamp"), fem.Fixed("sym", "z")], effects, formulation)


@pytest.mark.parametrize("formulation", ["p2", "p2p0", "mixed"])
@pytest.mark.parametrize(("first", "last"), [(0.5, 0.5), (0.5, 1.0), (1.0, 0.5)])
@pytest.mark.parametrize("build", [held, pulled])
def test_the_way_from_another_equilibrium_ends_in_that_from_rest(
    build: Callable[[float, str], fem.Model],
    formulation: str,
    first: float,
    last: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The end is moved further, or a force pulls it that was not there."""
    near = fem.follow(build(0.1 if build is held else 0.0, formulation), [first]).steps[0]
    model = build(0.3 if build is held else 0.02, formulation)
    (direct,) = fem.follow(model, [last]).steps
    with monkeypatch.context() as without_the_usual_path:
        without_the_usual_path.setattr(PathFollower, "advance", None)
        (moved,) = fem.follow(model, [last], begin=[near]).steps
    assert moved.factor == last
    np.testing.assert_allclose(moved.displacement, direct.displacement, atol=1e-6)
    np.testing.assert_allclose(moved.gradient, direct.gradient, atol=1e-5 * np.abs(direct.gradient).max())
    assert moved.cutbacks == 0


def test_the_way_passes_through_states_between_and_its_rate_is_their_derivative() -> None:
    """Prescribed displacements and load factor lie on straight lines, on which the path from rest has its states."""
    tight = fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))
    near = fem.follow(held(0.1), [0.5], tight).steps[0]
    system = held(0.3).system()
    state = system.state_at(near.displacement, near.factor)
    control = MoveControl.of(system, near, 1.0)

    def at(part: float, start: Converged | None) -> Converged:
        begin = Start(state if start is None else start.state, system.terms)
        return newton.solve(begin, control.target(part, 1.0), tight.newton, lambda iteration, residual: None)

    quarter, other = at(0.25, None), at(0.251, None)
    direct = fem.follow(held(0.15), [0.625], tight).steps[0]
    assert quarter.state.factor == pytest.approx(0.625)
    np.testing.assert_allclose(quarter.state.displacement, direct.displacement, atol=1e-8)
    assert other.linearised is not None
    rate = control.target(0.251, 1.0).rate(other.state, other.assembly, other.linearised, system.terms)
    difference = (other.state.displacement - quarter.state.displacement) / 0.001
    assert rate.factor == 0.5
    np.testing.assert_allclose(rate.displacement, difference, atol=0.01 * np.abs(difference).max())
    begin = control.rate_at_begin(state, system.terms)
    difference = (at(0.001, None).state.displacement - state.displacement) / 0.001
    np.testing.assert_allclose(begin.displacement, difference, atol=0.01 * np.abs(difference).max())


def test_a_load_that_the_equilibrium_lacks_grows_from_zero_on_the_way() -> None:
    tight = fem.PathOptions(fem.NewtonOptions(tolerance=1e-10))
    near = fem.follow(pulled(0.0, density=0.0), [0.5], tight).steps[0]
    system = pulled(0.02, density=0.0).system()
    state, control = system.state_at(near.displacement, near.factor), MoveControl.of(system, near, 1.0)

    def at(part: float) -> State:
        begin = Start(state, at_constant_fraction(system.terms, part))
        return newton.solve(begin, control.target(part, 1.0), tight.newton, lambda iteration, residual: None).state

    direct = fem.follow(pulled(0.005, density=0.0), [0.625], tight).steps[0]
    np.testing.assert_allclose(at(0.25).displacement, direct.displacement, atol=1e-8)
    begin = control.rate_at_begin(state, at_constant_fraction(system.terms, 1.0))
    difference = (at(0.001).displacement - state.displacement) / 0.001
    np.testing.assert_allclose(begin.displacement, difference, atol=0.01 * np.abs(difference).max())
    assert np.abs(difference).max() > 0.01


def test_walls_in_contact_stay_in_contact_on_the_way(short: Body) -> None:
    def model(height: float) -> fem.Model:
        effects = [fem.Pressure("cavity", 0.04), fem.SelfContact("gap", starts_inactive=True)]
        return fem.Experiment.of("III", short, height).model(fem.StVenantKirchhoff(1.2, 0.495), effects, "p2p0")

    near = fem.follow(model(0.0), [1.0]).steps[0]
    (moved,) = fem.follow(model(1.5), [1.0], begin=[near]).steps
    (direct,) = fem.follow(model(1.5), [1.0]).steps
    assert near.active == moved.active == direct.active == (True, True)
    np.testing.assert_allclose(moved.displacement, direct.displacement, atol=1e-5)
    assert moved.factorizations < direct.factorizations


def test_a_way_that_fails_leads_to_the_path_from_rest() -> None:
    """Two iterations suffice for small increments only; the way from another state is one increment."""
    near, model, few = (
        fem.follow(held(-0.5), [1.0]).steps[0],
        held(0.3),
        fem.PathOptions(fem.NewtonOptions(iterations=2)),
    )
    solution, observed = observed_path(model, [0.5], few, [near])
    direct, alone = observed_path(model, [0.5], few, [])
    step = solution.steps[0]
    np.testing.assert_array_equal(step.displacement, direct.steps[0].displacement)
    assert set(observed) == {0.5}  # the load factor, on the way from there too
    assert len(observed) > len(alone)
    assert step.factorizations == solution.factorizations > direct.factorizations


def test_no_way_begins_at_a_state_that_is_not_stable() -> None:
    near, model = fem.follow(held(0.1), [0.5]).steps[0], held(0.3)
    direct = fem.follow(model, [0.5])
    for unstable in (replace(near, negative_pivots=1), replace(near, instability=(Reason("not_followed_earlier"),))):
        refused = fem.follow(model, [0.5], begin=[unstable])
        assert refused.factorizations == direct.factorizations
        np.testing.assert_array_equal(refused.steps[0].displacement, direct.steps[0].displacement)


def test_a_way_that_ends_at_an_unstable_state_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    near, model, tried = fem.follow(held(0.1), [0.5]).steps[0], held(0.3), []
    advance = PathFollower.advance

    def observed(path: PathFollower, target: float) -> fem.Step:
        tried.append(target)
        monkeypatch.undo()
        return advance(path, target)

    monkeypatch.setattr(PathFollower, "advance", observed)
    fem.follow(model, [0.5], begin=[near])
    assert tried == []
    monkeypatch.setattr(Converged, "negative_pivots", 1)
    fem.follow(model, [0.5], begin=[near])
    assert tried == [0.5]


def test_states_of_several_ways_are_the_same_when_they_are_resumed() -> None:
    near = [fem.follow(held(0.1), [factor]).steps[0] for factor in (0.5, 1.0)]
    model, factors, begin = held(0.3), [0.5, 1.0, 1.1], [*near, None]
    whole = fem.follow(model, factors, begin=begin).steps
    for count in (1, 2):
        kept = [through_arrays(model, step) for step in whole[:count]]
        resumed = fem.follow(model, factors, resume=kept, begin=begin).steps
        for state, other in zip(whole, resumed, strict=True):
            np.testing.assert_array_equal(state.displacement, other.displacement)


def test_a_path_may_begin_nowhere_but_at_rest() -> None:
    """None for each factor is the path without `begin`; a shorter list too."""
    model = held(0.3)
    usual = fem.follow(model, [0.5, 1.0]).steps
    for begin in ([None, None], [None], []):
        for state, other in zip(usual, fem.follow(model, [0.5, 1.0], begin=begin).steps, strict=True):
            np.testing.assert_array_equal(state.displacement, other.displacement)


def test_a_load_that_no_way_leads_to_ends_with_the_reason_of_the_path_from_rest() -> None:
    block = fem.Model(
        box((2, 1, 1), (1.0, 1.0, 1.0)), LAW, [fem.Fixed("left"), fem.Prescribed("right", "x", -0.1, ramp=False)], []
    )
    near = fem.follow(block, [1.0]).steps[0]
    crushed = replace(block, supports=[fem.Fixed("left"), fem.Prescribed("right", "x", -1.2, ramp=False)])
    with pytest.raises(fem.NotConverged) as direct:
        fem.follow(crushed, [1.0])
    with pytest.raises(fem.NotConverged) as moved:
        fem.follow(crushed, [1.0], begin=[near])
    assert moved.value.end.reached == direct.value.end.reached
    assert str(moved.value) == str(direct.value)


def test_a_slender_bar_is_followed_beyond_its_buckling() -> None:
    """It buckles after 0.8 % of the way; the smallest increment is then a part of what is reached."""
    ends = [fem.Fixed("left"), fem.Prescribed("right", "x", -7.9, ramp=False)]
    (step,) = fem.follow(fem.Model(box((4, 1, 1), (8.0, 1.0, 1.0)), LAW, ends, []), [1.0]).steps
    assert step.negative_pivots == 0
    assert np.abs(step.displacement[:, 1:]).max() > 1.0


def observed_path(
    model: fem.Model, factors: list[float], options: fem.PathOptions, begin: list[fem.Step | None]
) -> tuple[fem.Solution, list[float]]:
    """The solution, and the target of every iteration."""
    targets: list[float] = []
    observer = fem.PathObserver(lambda target, iteration, residual: targets.append(target))
    return fem.follow(model, factors, options, observer, begin=begin), targets


def through_arrays(model: fem.Model, step: fem.Step) -> fem.Step:
    return fem.step_from_arrays(model.space, fem.step_to_arrays(step))
