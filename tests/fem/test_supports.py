"""Supports of a body, and the messages for supports that are not possible."""

import numpy as np
import pytest

from fem import Fixed, Model, Prescribed, Pressure, StVenantKirchhoff, follow
from fem.discretisation import Discretisation
from fem.equations.constraints import Constraints
from fem.supports import SupportError, nodes_at
from tests.bodies import box

SPACE = Discretisation.of(box((2, 1, 1), (2.0, 1.0, 1.0)), "p2p0")
LAW = StVenantKirchhoff(E=1.0, nu=0.3)


def test_a_face_is_all_its_nodes() -> None:
    np.testing.assert_array_equal(nodes_at("left", SPACE), np.flatnonzero(SPACE.points[:, 0] == 0.0))
    assert nodes_at("left", SPACE).size == 9


def test_a_pair_of_faces_is_their_common_edge() -> None:
    x, y, _ = SPACE.points.T
    np.testing.assert_array_equal(nodes_at(("left", "top"), SPACE), np.flatnonzero((x == 0.0) & (y == 1.0)))
    assert nodes_at(("top", "left"), SPACE).size == 3


def test_positions_are_the_nodes_that_stand_there() -> None:
    where = SPACE.points[[7, 3, 20]]
    np.testing.assert_array_equal(nodes_at(where, SPACE), [7, 3, 20])
    np.testing.assert_array_equal(nodes_at(where[0], SPACE), [7])


def test_components_and_values() -> None:
    supports = [
        Fixed("left"),
        Fixed("bottom", "y"),
        Prescribed("right", "x", 0.3),
        Prescribed(("right", "top"), "z", -0.2, ramp=False),
    ]
    constraints = Constraints.of(supports, SPACE)
    left, bottom, right = (nodes_at(name, SPACE) for name in ("left", "bottom", "right"))
    edge = nodes_at(("right", "top"), SPACE)
    assert constraints.constrained.sum() == 3 * 9 + (bottom.size - np.intersect1d(bottom, left).size) + 9 + 3
    np.testing.assert_array_equal(np.unique(np.nonzero(constraints.ramped)[0]), right)
    assert set(constraints.ramped[right, 0]) == {0.3}
    np.testing.assert_array_equal(np.unique(np.nonzero(constraints.constant)[0]), edge)
    assert set(constraints.constant[edge, 2]) == {-0.2}


def test_a_component_may_be_prescribed_twice_with_one_value_but_not_with_two() -> None:
    twice = Constraints.of([Prescribed("right", "x", 0.3), Prescribed(("right", "top"), "x", 0.3)], SPACE)
    assert twice.constrained.sum() == nodes_at("right", SPACE).size
    with pytest.raises(SupportError, match=r"^Fixed at 'right' contradicts Prescribed at .right.: .* displacements x "):
        Constraints.of([Prescribed("right", "x", 0.3), Fixed("right", "x")], SPACE)


def stretched(ramp: bool, factors: list[float]) -> list[float]:
    supports = [Fixed("left", "x"), Fixed("bottom", "y"), Fixed("back", "z"), Prescribed("right", "x", 0.1, ramp)]
    model = Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, supports, [Pressure("top", 1e-9)])
    steps = follow(model, factors).steps
    return [float(step.displacement[nodes_at("right", step.space), 0].mean()) for step in steps]


def test_a_prescribed_value_grows_with_the_load_or_is_constant() -> None:
    assert stretched(True, [0.25, 1.0]) == pytest.approx([0.025, 0.1], rel=1e-14)
    assert stretched(False, [0.25, 1.0]) == pytest.approx([0.1, 0.1], rel=1e-14)


def test_reactions_balance() -> None:
    supports = [Fixed("left"), Prescribed("right", "x", 0.1)]
    step = follow(Model(box((2, 1, 1), (2.0, 1.0, 1.0)), LAW, supports, []), [1.0]).steps[-1]
    pull = step.reaction("right")
    assert pull[0] > 0.04
    np.testing.assert_allclose(step.reaction("left"), -pull, atol=1e-7)
    assert step.reaction(step.points[nodes_at("right", step.space)])[0] == pytest.approx(pull[0], rel=1e-14)
