"""A rigid rotation causes no stress: C. Truesdell, W. Noll, "The non-linear field theories of mechanics", Handbuch der
Physik III/3, Springer 1965, section 29 (elastic materials are indifferent to the frame).

One end of a bar is rotated about a skew axis and moved, and the solver must find the rotated bar without stress,
although the iterates are strained. `test_uniaxial` tests the same for the law at a given displacement.
"""

import numpy as np
import pytest

from fem import Model, NewtonOptions, PathOptions, Prescribed, follow
from fem.discretisation import Discretisation
from fem.elements import ELEMENTS
from geometry.arrays import Array
from tests.bodies import box
from tests.laws import LAWS

AXIS = np.array([1.0, 2.0, -1.0]) / np.sqrt(6)
ANGLE = 1.0
SHIFT = np.array([0.3, -0.2, 0.1])


def rotation() -> Array:
    """Rodrigues' formula."""
    cross = np.array([[0, -AXIS[2], AXIS[1]], [AXIS[2], 0, -AXIS[0]], [-AXIS[1], AXIS[0], 0]])
    return np.eye(3) + np.sin(ANGLE) * cross + (1 - np.cos(ANGLE)) * cross @ cross


@pytest.mark.parametrize("formulation", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_a_turned_end_turns_the_bar(law: str, formulation: str) -> None:
    mesh = box((2, 1, 1), (2.0, 1.0, 1.0))
    points = Discretisation.of(mesh, formulation).points
    motion = points @ rotation().T + SHIFT - points
    held = np.flatnonzero(points[:, 0] == 0.0)
    supports = [Prescribed(points[node], "xyz"[axis], motion[node, axis]) for node in held for axis in range(3)]
    model = Model(mesh, LAWS[law], supports, [], formulation)
    step = follow(model, [1.0], PathOptions(NewtonOptions(tolerance=1e-9))).steps[0]
    np.testing.assert_allclose(step.displacement, motion, atol=1e-12)
    assert np.abs(step.stress).max() < 1e-12
    assert np.abs(step.gradient).max() < 1e-12
    assert step.min_J == pytest.approx(1.0, abs=1e-12)
