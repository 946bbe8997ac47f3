"""How far the end section has turned: bodies that are bent into an arc, and one whose end is lifted besides."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fem import Experiment, Step
from fem.discretisation import Discretisation
from geometry import Body, PneuNet
from geometry.arrays import Array


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


@pytest.fixture(scope="module")
def short() -> Body:
    return PneuNet(chambers=2).body(5.0)
