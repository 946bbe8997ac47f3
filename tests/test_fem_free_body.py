"""Experiment I from a state of experiment II: the clamp is released."""

from dataclasses import replace

import numpy as np
import pytest

from fem import Experiment, Model, NewtonOptions, PathOptions, Pressure, SelfContact, StVenantKirchhoff, follow
from fem.free_body import FreeBody
from fem.path.follower import PathFollower
from fem.supports import nodes_at
from geometry import Body

TIGHT = PathOptions(NewtonOptions(tolerance=1e-8))


def model(experiment: Experiment, formulation: str = "p2p0", pressure: float = 0.015) -> Model:
    effects = [Pressure("cavity", pressure), SelfContact("gap", starts_inactive=True)]
    return experiment.model(StVenantKirchhoff(1.2, 0.495), effects, formulation)


def experiments(body: Body) -> tuple[Experiment, Experiment]:
    """I and II."""
    return Experiment.of("I", body, None), Experiment.of("II", body, None)


@pytest.mark.parametrize(("whole", "pressure"), [(False, 0.015), (True, 0.015), (False, 0.037)])
def test_the_released_body_is_in_the_state_of_the_path_from_rest(
    whole: bool, pressure: float, short: Body, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With walls in contact at 37 kPa too, and in fewer factorizations."""
    free, clamped = experiments(short.full() if whole else short)
    (near,) = follow(model(clamped, pressure=pressure), [1.0], TIGHT).steps
    of_free = model(free, pressure=pressure)
    (direct,) = follow(of_free, [1.0], TIGHT).steps
    with monkeypatch.context() as without_the_path:
        without_the_path.setattr(PathFollower, "advance", None)
        (released,) = follow(of_free, [1.0], TIGHT, begin=lambda number: free.released(near)).steps
    assert near.active == direct.active == released.active
    np.testing.assert_allclose(released.displacement, direct.displacement, atol=1e-5)
    assert np.abs(released.gradient[:, :2]).max() < 1e-6
    assert released.factorizations < direct.factorizations


def test_a_path_goes_on_from_the_released_body(short: Body) -> None:
    """To a load for which there is no state of the clamped one, as one that is resumed there."""
    free, clamped = experiments(short)
    (near,) = follow(model(clamped), [0.8]).steps
    begin = [free.released(near), None].__getitem__
    first, last = follow(model(free), [0.8, 1.0], TIGHT, begin=begin).steps
    (direct,) = follow(model(free), [1.0], TIGHT).steps
    np.testing.assert_allclose(last.displacement, direct.displacement, atol=1e-5)
    resumed = follow(model(free), [0.8, 1.0], TIGHT, resume=[first], begin=begin).steps[-1]
    np.testing.assert_array_equal(last.displacement, resumed.displacement)


@pytest.mark.parametrize("turn", [0.3, 2.0, np.pi, -2.9])
@pytest.mark.parametrize("whole", [False, True])
def test_any_rigid_motion_is_taken_back(turn: float, whole: bool, short: Body) -> None:
    """In the plane for half a body; with a roll of 0.2 and a yaw of 0.1 rad for a whole one."""
    free, clamped = experiments(short.full() if whole else short)
    space = model(clamped).space
    rotation = _about(2, turn) @ (_about(1, 0.1) @ _about(0, 0.2) if whole else np.eye(3))
    moved = space.points @ rotation.T + (3.0, -2.0, 1.0 if whole else 0.0)
    (rest,) = follow(model(clamped), [1e-6]).steps
    placed = free.released(replace(rest, displacement=moved - space.points))
    np.testing.assert_allclose(placed.displacement, 0.0, atol=1e-9)


def test_a_body_that_is_bent_and_stretched_meets_the_constraints(short: Body) -> None:
    """Each of the constrained components of the displacement vanishes, and distances are those of the state."""
    whole = short.full()
    free, clamped = experiments(whole)
    space = model(clamped).space
    x, y, z = space.points.T
    bent = np.column_stack([1.1 * x - 0.02 * x * y, 0.02 * x**2 + y, z + 0.003 * x**2 + 0.01 * x * y])
    (rest,) = follow(model(clamped), [1e-6]).steps
    placed = free.released(replace(rest, displacement=bent - space.points))
    assert isinstance(FreeBody.of(whole, free.curve.vertices).top, np.ndarray)
    for support in free.supports:
        nodes = nodes_at(support.where, space)
        for letter in support.components:
            np.testing.assert_allclose(placed.displacement[nodes, "xyz".index(letter)], 0.0, atol=1e-9)
    for first, second in ((0, -1), (5, 100)):
        distances = [np.linalg.norm(p[first] - p[second]) for p in (bent, placed.positions)]
        assert distances[0] == pytest.approx(distances[1])


def _about(axis: int, angle: float) -> np.ndarray:
    rotation = np.eye(3)
    a, b = [k for k in range(3) if k != axis]
    rotation[[a, b], [a, b]] = np.cos(angle)
    rotation[a, b], rotation[b, a] = -np.sin(angle), np.sin(angle)
    return rotation
