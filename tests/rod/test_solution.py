"""What a rod in equilibrium puts out: its material curve, the end of it, and the angle of its end."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from geometry import Centreline
from rod import FiveParameters, Rod, RodSolution
from tests.rod.arm_law.test_arm_law import LENGTH, law_of, straight_law

FIVE = Rod(LENGTH, -0.01, FiveParameters(400.0, 400.0, 0.0, 0.0, 20.0), start=(0.0, 1.0))
#: mm, the end of the material curve beside the axis, along and normal to it
BESIDE = (0.5, 3.0)


def beside_the_axis() -> RodSolution:
    """The arm's own law of a straight arm whose material curve leaves the axis over the last 10 mm."""
    cell, clamp, tip = straight_law(0.0, -0.01)
    tip = replace(tip, beside=np.array([(0.0, 0.0), BESIDE]))
    return Rod(LENGTH, law=law_of((cell, clamp, tip)).at(0.0)).solve()


def test_with_five_parameters_the_material_curve_is_the_axis() -> None:
    shape = FIVE.solve(force=(0.0, 0.02))
    np.testing.assert_array_equal(shape.curve, np.column_stack([shape.x, shape.y]))
    np.testing.assert_allclose(shape.curve, shape.positions(shape.s), atol=1e-12)
    assert shape.end == (shape.x[-1], shape.y[-1])
    assert shape.end_angle == pytest.approx(float(np.interp(0.99 * LENGTH, shape.s, shape.theta)), abs=1e-4)
    with pytest.raises(ValueError, match="read-only"):
        shape.curve[0, 0] = 1.0


def test_with_the_arms_own_law_curve_and_end_are_those_beside_the_axis() -> None:
    shape = beside_the_axis()
    turn = float(shape.theta[-1])
    along, normal = BESIDE
    assert shape.end[0] - shape.x[-1] == pytest.approx(along * np.cos(turn) - normal * np.sin(turn))
    assert shape.end[1] - shape.y[-1] == pytest.approx(along * np.sin(turn) + normal * np.cos(turn))
    np.testing.assert_allclose(shape.curve, shape.positions(shape.s), atol=1e-12)
    assert shape.end_angle - turn == pytest.approx(np.arctan2(0.3, 1.05), abs=0.02)  # 3 and 0.5 mm on 10 mm


def test_the_end_angle_is_the_same_of_rods_and_of_curves_of_nodes() -> None:
    nodes = np.linspace(0.0, LENGTH, 401)
    for shape in (FIVE.solve(force=(0.0, 0.02)), beside_the_axis()):
        assert Centreline(nodes, *shape.positions(nodes).T).end_angle == pytest.approx(shape.end_angle, abs=1e-6)


def test_the_end_angle_counts_full_turns() -> None:
    shape = replace(FIVE, kappa_0=-0.1).solve()
    assert shape.end_angle == pytest.approx(-0.1 * 0.99 * LENGTH, abs=1e-4)  # cubics between the s
    nodes = np.linspace(0.0, LENGTH, 401)
    assert Centreline(nodes, *shape.positions(nodes).T).end_angle == pytest.approx(shape.end_angle, abs=1e-4)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_arm_bends_by_the_rotation_of_its_end_section(side: float) -> None:
    """Positive to the side to which it bends without load, with full turns; where it is held the tip may be at rest."""
    rod = replace(FIVE, kappa_0=side * 0.01, law=FiveParameters(400.0, 400.0, 0.0, 0.0, 20.0))
    assert rod.solve().bending_deg == pytest.approx(np.degrees(0.01 * LENGTH), abs=1e-6)
    assert replace(rod, kappa_0=side * 0.1).solve().bending_deg == pytest.approx(np.degrees(0.1 * LENGTH), abs=1e-5)
    against = rod.solve(moment=-side * 6.0)
    assert against.bending_deg == pytest.approx(np.degrees((0.01 - 6.0 / 400.0) * LENGTH), abs=1e-6)
    held = rod.solve(end_y=1.0)  # the chord does not turn
    assert held.end[1] == pytest.approx(1.0, abs=1e-6)
    assert held.bending_deg == pytest.approx(side * np.degrees(held.theta[-1]), abs=1e-6)
    assert held.bending_deg > 0.2 * np.degrees(0.01 * LENGTH)


def test_the_end_of_the_material_curve_may_turn_otherwise_than_the_section() -> None:
    shape = beside_the_axis()
    assert shape.bending_deg == pytest.approx(abs(np.degrees(shape.theta[-1])), abs=1e-6)
    assert abs(shape.bending_deg - abs(np.degrees(shape.end_angle))) > 10.0


def test_solutions_can_be_pickled_and_copied() -> None:
    for shape in (FIVE.solve(force=(0.0, 0.02)), beside_the_axis()):
        for again in (pickle.loads(pickle.dumps(shape)), copy.deepcopy(shape)):
            np.testing.assert_array_equal(again.curve, shape.curve)
            assert again.end_angle == shape.end_angle
