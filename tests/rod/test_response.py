"""Derivatives of a rod in equilibrium, against difference quotients of the equilibrium."""

from dataclasses import replace

import numpy as np
import pytest

from geometry import Centreline
from rod import Extension, FiveParameters, Load, LoadedShape, Rod, RodError
from rod.identification.shape_fit import BREAK, _ShapeFit, rest_curvature
from rod.mechanics.response import Changes, response
from tests.synthetic_arm import SyntheticArm

TRUE = FiveParameters(190.0, 400.0, -0.1, 0.5, 7.3)
NEAR = FiveParameters(200.0, 380.0, -0.2, 0.3, 8.1)
RIPPLE = [0.1, -0.05, 0.2, 0.1]

LIGHT, HEAVY = (0.0, 0.0), (4e-4, -1.5e-3)
#: axes along which the end is held, and weight; held along x alone the heavy arm has no equilibrium
cases = pytest.mark.parametrize(
    ("held", "weight"),
    [
        *(((x, y), LIGHT) for x in (False, True) for y in (False, True)),
        *(((x, y), HEAVY) for x, y in ((False, False), (False, True), (True, True))),
    ],
    ids=str,
)


def task_of(held, weight):
    """A fit of a rod to an arm, and unknowns near its minimum."""
    arm = SyntheticArm(TRUE, ripple=0.2, noise=0.001)
    free, loaded, load = arm.curves(1)
    load = Load(load.force, 0.5, weight, 6.0 if any(weight) else 0.0)
    task = _ShapeFit.of(LoadedShape(free, loaded, load, arm.pitch, held), None, [TRUE])
    z = task.unknowns(NEAR)
    z[BREAK + 1 :] = RIPPLE
    return task, z


def far_off(found, expected):
    """Largest difference over the largest value."""
    return np.abs(found - expected).max() / np.abs(expected).max()


@cases
def test_derivatives_by_the_law_and_its_ripple(held, weight):
    task, z = task_of(held, weight)
    matrix = task.jacobian(z)
    for k in set(range(len(z))) - {BREAK}:
        step = 1e-5 * np.eye(len(z))[k]
        assert far_off(matrix[:, k], (task.residual(z + step) - task.residual(z - step)) / 2e-5) < 1e-6, k
    step = 1e-4 * np.eye(len(z))[BREAK]  # 0.01 mm, between two nodes
    assert far_off(matrix[:, BREAK], (task.residual(z + step) - task.residual(z - step)) / 2e-4) < 1e-4


def test_the_derivative_by_the_break_at_a_node_is_that_beyond_it():
    task, z = task_of((False, True), LIGHT)
    z[BREAK] = 8.0 / task.shape.length
    step = 1e-5 * np.eye(len(z))[BREAK]
    here = task.residual(z)
    beyond, before = ((task.residual(z + sign * step) - here) / (sign * 1e-5) for sign in (1.0, -1.0))
    kink = far_off(before, beyond)
    assert kink > 0.1
    assert far_off(task.jacobian(z)[:, BREAK], beyond) < 0.2 * kink


def test_a_side_of_the_break_without_a_rod_gives_no_derivative(monkeypatch):
    task, z = task_of((False, True), LIGHT)
    expected, solved = task.jacobian(z), _ShapeFit.solved

    def refuse(where):
        def solve(self, at):
            if where(at[BREAK]):
                raise RodError("no rod")
            return solved(self, at)

        monkeypatch.setattr(_ShapeFit, "solved", solve)

    refuse(lambda d: d > z[BREAK])
    assert far_off(task.jacobian(z)[:, BREAK], expected[:, BREAK]) < 1e-4  # that before the break
    refuse(lambda d: d != z[BREAK])
    assert np.array_equal(task.jacobian(z), np.where(np.arange(len(z)) == BREAK, 0.0, expected))


def test_where_there_is_no_rod_all_derivatives_are_zero(monkeypatch):
    task, z = task_of((False, True), LIGHT)

    def refused(self, at):
        raise RodError("no rod")

    monkeypatch.setattr(_ShapeFit, "_equilibrium", refused)
    assert not task.jacobian(z).any()


@cases
def test_changes_by_errors_of_the_nodes(held, weight):
    """Those of the unloaded shape change kappa_0, and with it the moment that the weight has there."""
    task, z = task_of(held, weight)
    errors = 1e-5 * np.random.default_rng(0).standard_normal((2, 4, len(task.shape.s)))

    def residual(error):
        curves = (task.shape.free, error[:2]), (task.shape.loaded, error[2:])
        free, loaded = (Centreline(c.s, c.x + x, c.y + y) for c, (x, y) in curves)
        theta0, kappa_0 = rest_curvature(free)
        shape = replace(task.shape, free=free, loaded=loaded)
        return replace(task, shape=shape, theta0=theta0, kappa_0=kappa_0).residual(z)

    moved = task._moved(z, errors)
    for k, error in enumerate(errors):
        assert far_off(moved[:, k], 0.5 * (residual(error) - residual(-error))) < 1e-6


@pytest.mark.parametrize("others", [{"fade": 0.1}, {"extension": Extension(np.array([0.0, 112.0]), np.ones(2), 1.0)}])
def test_rods_that_it_does_not_know_are_refused(others):
    at = Rod(112.0, 0.02, TRUE, **others).equilibrium_under(Load((0.0, 0.01)))
    with pytest.raises(RodError, match="inextensible rod whose intercepts do not fade"):
        response(at, turned_clamp(at))


def test_a_rod_without_load_is_refused():
    """The smallest load would add the intercepts of its law."""
    at = Rod(112.0, 0.02, TRUE).equilibrium_under(Load())
    with pytest.raises(RodError, match="without load has no derivatives"):
        response(at, turned_clamp(at))


def test_a_clamp_that_turns():
    """A longer and stiffer arm under a large force, for which the steps are finer; the force keeps its direction."""
    law, length, turn = FiveParameters(4e4, 7e4, -20.0, 10.0, 60.0), 400.0, 1e-5
    at = Rod(length, 0.004, law, 0.3).equilibrium_under(Load((9.0, 4.0)))
    assert len(at.problem.steps.s) > 60
    shape = response(at, turned_clamp(at)).shape[:, :, 0]

    def positions(angle):
        return Rod(length, 0.004, law, 0.3 + angle).equilibrium_under(Load((9.0, 4.0))).solution.curve

    assert far_off(shape, (positions(turn) - positions(-turn)) / (2 * turn)) < 1e-6


def turned_clamp(at):
    """A change of the angle at the clamp alone."""
    n = len(at.problem.steps.first)
    return Changes(np.zeros((n, 6, 1)), np.zeros((n, 1)), np.zeros((n, 1)), np.ones(1))
