"""A force of constant direction on the end, its balance with the clamp, and how far an end section has turned."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fem import Experiment, LineForce, Step, StVenantKirchhoff, follow
from fem.discretisation import Discretisation
from fem.supports import nodes_at
from geometry import Body, PneuNet
from geometry.arrays import Array

FORCE = (0.01, 0.05)


@pytest.fixture(scope="module")
def short() -> Body:
    return PneuNet(chambers=2).body(5.0)


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_a_line_force_is_spread_as_a_constant_line_load(short, formulation: str) -> None:
    experiment = Experiment.of("dead", short, 0.0, FORCE)
    edge, line = experiment.edge, LineForce(experiment.edge, (0.0, 1.0, 0.0))
    space = Discretisation.of(short.mesh, formulation)
    assert edge.nodal_weights(space).sum() == pytest.approx(1.0)
    assert edge.nodal_weights(space) @ edge.positions(space)[:, 2] == pytest.approx(np.mean(edge.vertices[[0, -1], 2]))
    term = line.bind(space, StVenantKirchhoff(1.2, 0.4))
    assert term.effect == "line_force"
    lifted = space.points + np.array([0.0, 3.0, 0.0])
    assert term.energy(lifted, 0.5) - term.energy(space.points, 0.5) == pytest.approx(-1.5)
    out = np.zeros_like(space.points)
    term.gradient(space.points, 1.0, out)
    assert out.sum(axis=0) == pytest.approx([0.0, -1.0, 0.0])


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_the_clamp_carries_the_dead_force(short, formulation: str) -> None:
    experiment = Experiment.of("dead", short, 0.0, FORCE)
    step = follow(experiment.model(StVenantKirchhoff(1.2, 0.4), [], formulation), [0.5, 1.0]).steps[-1]
    assert experiment.end_force(step) == pytest.approx(FORCE)
    assert experiment.clamp_force(step) == pytest.approx([-FORCE[0], -FORCE[1]], rel=1e-6)
    start, end = experiment.curve.vertices[0], experiment.end(step)
    moment = (end[0] - start[0]) * FORCE[1] - (end[1] - start[1]) * FORCE[0]
    assert experiment.clamp_moment(step) == pytest.approx(-moment - experiment.end_couple(step), rel=1e-6)
    assert end[1] > experiment.curve.vertices[-1, 1] + {"p2p0": 0.1, "p1": 0.03}[formulation]


def test_without_a_force_the_fourth_experiment_is_the_second(short) -> None:
    assert Experiment.of("dead", short, 0.0).force == (0.0, 0.0)
    assert Experiment.of("II", short, 0.0, FORCE).force == (0.0, 0.0)
    with pytest.raises(ValueError, match="allowed are"):
        Experiment.of("IV", short, 0.0)


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
def test_the_end_is_held_along_one_axis_and_loaded_along_the_other(short, formulation: str) -> None:
    experiment = Experiment.of("III", short, 0.4, (FORCE[0], 0.0))
    step = follow(experiment.model(StVenantKirchhoff(1.2, 0.4), [], formulation), [0.5, 1.0]).steps[-1]
    force, end = experiment.end_force(step), experiment.end(step)
    assert force[0] == pytest.approx(FORCE[0], rel=1e-6)
    assert end[1] - experiment.curve.vertices[-1, 1] == pytest.approx(0.4)
    assert experiment.clamp_force(step) == pytest.approx(-force, rel=1e-6)
    start = experiment.curve.vertices[0]
    moment = (end[0] - start[0]) * force[1] - (end[1] - start[1]) * force[0]
    assert experiment.clamp_moment(step) == pytest.approx(-moment - experiment.end_couple(step), rel=1e-6)


def test_the_end_held_where_a_force_put_it_needs_that_force(short) -> None:
    """But for the edge, which stays straight where it is held and bends under the force: 0.001 N along the arm."""
    material, force = StVenantKirchhoff(1.2, 0.4), (0.3, 0.05)
    dead = Experiment.of("dead", short, 0.0, force)
    loaded = follow(dead.model(material, [], "p2p0"), [1.0]).steps[-1]
    edge = loaded.displacement[nodes_at(dead.edge, loaded.space)][:, :2]
    x, y = dead.edge.nodal_weights(loaded.space) @ edge  # on which the force does its work
    held = Experiment.of("III", short, y, end_x=x)
    step = follow(held.model(material, [], "p2p0"), [1.0]).steps[-1]
    assert held.end_force(step) == pytest.approx(force, rel=5e-3)
    assert held.clamp_force(step) == pytest.approx(-held.end_force(step), rel=1e-6)


def bent(points: Array, angle: float, length: float) -> Array:
    """(n, 3): sections stay plane and turn by angle (rad) over the length (mm), downwards."""
    turned = angle * points[:, 0] / length
    radius = length / angle + points[:, 1]
    return np.column_stack([radius * np.sin(turned), radius * np.cos(turned) - length / angle, points[:, 2]])


def turned(body: Body, formulation: str, angle: float, lift: float = 0.0) -> tuple[float, float]:
    """Degrees, of the end section and of the end of the material curve.

    lift: mm along y of the end face before the body is bent, which fades over the last tenth of the length.
    """
    space = Discretisation.of(body.mesh, formulation)
    moved = space.points + np.outer((space.points[:, 0] / body.length) ** 40, (0.0, lift, 0.0))
    step = SimpleNamespace(space=space, positions=bent(moved, np.radians(angle), body.length))
    experiment, bends = Experiment.of("II", body, 0.0), cast("Step", step)
    return float(np.degrees(experiment.end_rotation(bends))), float(np.degrees(experiment.centreline(bends).end_angle))


@pytest.mark.parametrize("formulation", ["p2p0", "p1"])
@pytest.mark.parametrize("angle", [1.0, 90.0, 200.0, 400.0])
def test_an_arc_turns_its_end_by_its_angle(short: Body, formulation: str, angle: float) -> None:
    assert turned(short, formulation, angle)[0] == pytest.approx(-angle, abs=1e-9)


def test_an_end_that_is_lifted_turns_its_curve_and_not_its_section(short: Body) -> None:
    section, curve = turned(short, "p2p0", 20.0, 0.3)
    assert section == pytest.approx(-20.0, abs=1e-9)
    assert curve > -15.0
