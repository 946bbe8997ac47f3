"""The path near a limit point: announcement, jumps, increments, how long one is tried, and from which start."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fem import Fixed, Model, Pressure, StVenantKirchhoff, follow
from fem.equations.state import State
from fem.kernels.element import internal_force
from fem.path.control import LoadControl
from fem.path.effort import ITERATIONS_NEAR_LIMIT, MAX_UNSTABLE, MAX_UNSTABLE_RETRY, RETRY_ITERATIONS, Effort, effort_of
from fem.path.increments import LIMIT_ACCURACY, MAX_CUTBACKS, MAX_INCREMENTS, Increments
from fem.path.limit import announced_limit, way_between
from fem.path.predictor import MAX_PREDICTOR_STRAIN, PathPoint, Predictor, extrapolate
from tests.bodies import box, hollow_box
from tests.loads import Traction

LIMIT = 3.0


def state(value: float) -> State:
    """A state of one node and one stress point that are both as large as the value."""
    return State(0.0, np.full((1, 3), value), np.zeros(0), np.full((1, 1, 6), value), np.zeros((1, 1, 6)))


def fold(at: float, regular: float = 0.0) -> PathPoint:
    """A point of the path u = regular * p - sqrt(LIMIT - p), which ends at the limit."""
    root = np.sqrt(LIMIT - at)
    return PathPoint(at, 1.0, state(regular * at - root), rate=state(regular + 0.5 / root))


def line(at: float, offset: float = 0.0) -> PathPoint:
    return PathPoint(at, 1.0, state(at + offset), rate=state(1.0))


def test_a_fold_is_announced_where_it_is() -> None:
    for regular in (0.0, 0.5, 2.0):
        announced = [announced_limit(fold(a, regular), fold(b, regular)) for a, b in ((1.0, 2.5), (2.9, 2.99))]
        assert announced == pytest.approx([LIMIT, LIMIT])
    assert announced_limit(line(1.0), line(2.0)) is None


def test_no_limit_is_announced_where_the_rates_grow_but_not_towards_a_fold() -> None:
    """The mean rate lies half way between both on a parabola, and nearer to the second one on u = p^1.5."""
    for power in (2.0, 1.5):
        points = [PathPoint(at, 1.0, state(at**power), rate=state(power * at ** (power - 1.0))) for at in (1.0, 2.0)]
        assert announced_limit(*points) is None


def test_a_fold_is_extrapolated_exactly() -> None:
    for regular in (0.0, 0.5):
        ahead = extrapolate(fold(1.0, regular), fold(2.0, regular), 2.9, LIMIT)
        assert ahead.displacement == pytest.approx(fold(2.9, regular).state.displacement)
        beyond = extrapolate(fold(1.0, regular), fold(2.0, regular), 3.1, LIMIT)
        assert np.isfinite(beyond.displacement).all()


def test_a_way_longer_than_its_rates_is_a_jump() -> None:
    for before, last in ((line(1.0), line(2.0)), (fold(1.0), fold(2.9))):
        way = way_between(before, last)
        assert not way.is_jump
    jump = way_between(line(1.0), line(2.0, offset=0.5))
    assert jump.is_jump
    assert jump.length == pytest.approx(1.5)
    straight = way_between(line(1.0), line(2.0))
    assert straight.is_straight
    assert way_between(replace(line(1.0), rate=None), line(2.0)) is None


def searched(limit: float, target: float, solvable: float) -> tuple[Increments, list[float]]:
    """The increments towards a target of which the loads up to `solvable` have an equilibrium, and what was tried."""
    increments, tried = Increments(0.0, target, 1 / 256), []
    before = fold(0.0)
    while True:
        fraction = increments.next
        value = fraction * target
        tried.append(value)
        if value < solvable:
            last = fold(value) if value < limit else line(value)
            increments.accepted(fraction, announced_limit(before, last))
            before = last
            if fraction == 1.0:
                return increments, tried
        else:
            increments.failed(fraction, unstable=True)
        if increments.is_confirmed_or_exhausted or (value >= solvable and increments.ended):
            return increments, tried


@pytest.mark.parametrize("target", [3.1, 4.0, 10.0, 30.0, 300.0])
def test_few_increments_find_a_limit_from_any_target(target: float) -> None:
    increments, tried = searched(LIMIT, target, LIMIT)
    assert increments.limit == pytest.approx(LIMIT)
    assert increments.limit_is_confirmed
    assert LIMIT * (1 - LIMIT_ACCURACY) < increments.reached * target < LIMIT
    assert len(tried) <= 22


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_load_without_an_equilibrium_is_not_before_the_limit_that_is_named(direction: float) -> None:
    """The limit is announced a little behind the load that failed, on a way up as on a way down."""
    way = Increments(0.0, 10.0 * direction, 1 / 256)
    for fraction in (0.2995, 0.2998):
        way.accepted(fraction, 3.02 * direction)
        assert way.confirmed_limit is None
    way.failed(0.3005, unstable=True)
    assert way.confirmed_limit == pytest.approx(3.005 * direction)
    way.limit = 3.003 * direction
    assert way.confirmed_limit == 3.003 * direction


def test_a_limit_that_is_announced_and_passed_does_not_end_the_path() -> None:
    """The rates grow as if the path ended at the limit, but it goes on."""
    increments, tried = searched(LIMIT, 10.0, 11.0)
    assert increments.reached == 1.0
    assert len(tried) < 12


def test_a_load_that_failed_from_far_away_is_tried_again_from_near() -> None:
    """No limit is named where one increment failed, however close to the announced limit the loads are."""
    close = Increments(60.0, 60.5, 1 / 256)
    close.limit = 60.3
    close.failed(1.0, unstable=True)
    assert not close.limit_is_confirmed
    assert close.next < 1.0


def test_the_search_ends_whatever_happens() -> None:
    slow = Increments(0.0, 1.0, 1e-9)
    count = 0
    while not slow.is_confirmed_or_exhausted:
        fraction = slow.next
        if count % 2:
            slow.accepted(fraction, None)
        else:
            slow.failed(fraction, unstable=False)
        count += 1
    assert slow.cutbacks <= MAX_CUTBACKS
    assert count <= MAX_INCREMENTS


def test_a_target_far_beyond_the_load_does_not_end_the_search() -> None:
    """Increments of 2 kPa fail and those of 0.5 kPa converge, on the way from 20 to 2000 kPa as from 20 to 40 kPa."""
    for target in (40.0, 2000.0):
        way = Increments(20.0, target, 1 / 256)
        way.accepted(1.0 / (target - 20.0), None)
        while way.next * (target - 20.0) > 1.5 and not way.ended:
            way.failed(way.next, unstable=False)
        assert not way.ended
    hopeless = Increments(0.0, 2000.0, 1 / 256)
    while not hopeless.ended:
        hopeless.failed(hopeless.next, unstable=False)
    assert hopeless.cutbacks == 9  # from rest nothing but the way gives a measure


def test_a_bifurcation_is_passed_where_the_path_goes_straight_on() -> None:
    """A column under 1.5 times Euler's load stays straight, unstable in two directions, in one increment."""
    length = 16.0
    euler = np.pi**2 / 12 / (4 * length**2)
    compression = Traction("right", lambda x: np.broadcast_to([-euler, 0.0, 0.0], x.shape))
    model = Model(
        box((16, 1, 1), (length, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.0), [Fixed("left")], [compression], "p2"
    )
    stable, unstable = follow(model, [0.5, 1.5]).steps
    assert stable.negative_pivots == 0
    assert unstable.negative_pivots == 2
    assert unstable.cutbacks == 0
    assert unstable.instability[0].values["directions"] == 2


AT_REST = SimpleNamespace(value=0.0, touching=False)


def effort(
    *,
    cutbacks: int = 0,
    small: bool = False,
    nears: bool = False,
    stable: bool = True,
    load: bool = True,
    from_rest: bool = False,
    **last: Any,
) -> Effort:
    """Of the increment to 1 from the last point, by default at 0.5."""
    increments: Any = SimpleNamespace(cutbacks=cutbacks, is_small=small, nears_limit=nears, passes_limit=False)
    points: Any = [AT_REST]
    if not from_rest:
        points.append(SimpleNamespace(**{"value": 0.5, "touching": False, **last}))
    control: Any = SimpleNamespace(value=1.0, gives_load=load)
    return effort_of(control, increments, points, stable)


def test_the_first_increment_to_a_target_may_take_long() -> None:
    assert effort() == Effort(None, MAX_UNSTABLE)
    assert effort(load=False) == effort(stable=False) == Effort(None)


def test_an_increment_much_longer_than_the_last_one_is_given_up_early() -> None:
    assert effort(value=0.1) == Effort(None, MAX_UNSTABLE_RETRY, True)


@pytest.mark.parametrize("touching", [False, True])
def test_a_smaller_increment_may_begin_with_an_indefinite_tangent(touching: bool) -> None:
    """As that of an arm that turns far under its weight; contact is not needed for it."""
    assert effort(cutbacks=1, touching=touching) == Effort(RETRY_ITERATIONS, MAX_UNSTABLE_RETRY, True)
    assert effort(cutbacks=1, from_rest=True) == Effort(RETRY_ITERATIONS, 0, True)
    assert effort(cutbacks=1, small=True) == Effort(RETRY_ITERATIONS, MAX_UNSTABLE)


def test_near_a_limit_only_contact_excuses_an_indefinite_tangent() -> None:
    for touching, unstable in ((False, 0), (True, MAX_UNSTABLE_RETRY)):
        near = effort(cutbacks=1, nears=True, touching=touching)
        assert near == Effort(ITERATIONS_NEAR_LIMIT, unstable, True, True)
    assert effort(cutbacks=1, nears=True, stable=False).unstable is None


def whole_state(value: float) -> State:
    return State(value, *(np.full(3, value) for _ in range(4)))


def point(at: float, function: np.polynomial.Polynomial, rate: bool) -> PathPoint:
    return PathPoint(at, 1.0, whole_state(function(at)), rate=whole_state(function.deriv()(at)) if rate else None)


CUBIC = np.polynomial.Polynomial([0.3, -1.2, 0.7, 0.4])


@pytest.mark.parametrize(
    ("degree", "rates"), [(1, (False, False)), (1, (True, False)), (2, (False, True)), (3, (True, True))]
)
def test_polynomials_are_extrapolated_exactly(degree: int, rates: tuple[bool, bool]) -> None:
    function = np.polynomial.Polynomial(CUBIC.coef[: degree + 1])
    extrapolated = extrapolate(point(1.0, function, rates[0]), point(3.0, function, rates[1]), 6.5)
    for values in (
        extrapolated.factor,
        extrapolated.displacement,
        extrapolated.pressure,
        extrapolated.strain,
        extrapolated.stress,
    ):
        np.testing.assert_allclose(values, function(6.5), rtol=1e-12)


def test_a_single_point_is_extrapolated_along_its_rate() -> None:
    function = np.polynomial.Polynomial([2.0, 3.0])
    extrapolated = extrapolate(None, point(1.0, function, True), 1.5)
    np.testing.assert_allclose(extrapolated.displacement, function(1.5))
    assert extrapolate(None, point(1.0, function, False), 1.5) is None


@pytest.mark.parametrize("formulation", ["p2p0", "mixed"])
def test_the_first_start_strains_little_under_a_stress_that_balances_the_whole_load(formulation: str) -> None:
    law, supports = StVenantKirchhoff(1.2, 0.49), [Fixed("clamp"), Fixed("sym", "z")]
    model = Model(hollow_box(half=True, parts=2), law, supports, [Pressure("cavity", 1.0)], formulation)
    system = model.system()
    rest = PathPoint(0.0, 0.0, system.rest_state(), terms=system.terms)
    control = LoadControl.of(system)
    balanced, last = Predictor(rest, control).starts([rest], control.target(1.0, 1.0), system.terms)
    assert balanced.trial
    assert not last.trial
    start = balanced.state
    np.testing.assert_array_equal(last.state.displacement, start.displacement)
    assert last.state.factor < start.factor == 1.0
    assert np.abs(start.strain).max() == pytest.approx(MAX_PREDICTOR_STRAIN)
    assert np.abs(start.stress).max() > 2 * np.abs(law.shear_modulus * start.strain).max()
    loads = system.loads(np.zeros_like(start.displacement), 1.0, system.terms)
    forces, space = np.zeros_like(loads), system.space
    internal_force(space.arrays, np.zeros_like(loads), start.stress, forces)
    assert np.linalg.norm(system.constraints.reduce(forces + loads)) < 1e-9 * np.linalg.norm(
        system.constraints.reduce(loads)
    )
