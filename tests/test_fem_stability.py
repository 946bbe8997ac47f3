"""What is left of the elastic stiffness: all of it at rest, none at the load under which a column buckles."""

import numpy as np
import pytest
from bodies import box
from loads import Traction

from fem import Fixed, Model, PathOptions, StVenantKirchhoff
from fem.path.course import LoadCourse
from fem.path.loadpath import Path
from fem.path.modes import most_softened

LENGTH = 16.0
#: Euler's load of a clamped column whose other end is free, E = 1 MPa, over its section of 1 mm2
BUCKLES = np.pi**2 / 12 / (4 * LENGTH**2)


@pytest.fixture(scope="module")
def column() -> Path:
    squeeze = Traction("right", lambda x: np.broadcast_to([-BUCKLES, 0.0, 0.0], x.shape))
    model = Model(box((16, 1, 1), (LENGTH, 1.0, 1.0)), StVenantKirchhoff(1.0, 0.0), [Fixed("left")], [squeeze], "p2")
    return Path(model.system(), LoadCourse(), PathOptions(), lambda value, iteration, residual: None)


def test_all_of_it_at_rest(column: Path) -> None:
    found = most_softened(column.system, column.system.rest_state(), ())
    assert found.stiffness == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("load", [0.4, 0.8])
def test_a_column_loses_it_as_euler_says(column: Path, load: float) -> None:
    """1 - P / P_E, at the free end. Measured: 0.5 % of P_E, which shear and the ends cost."""
    column.advance(load)
    found = most_softened(column.system, column.places[-1].state, column.active_set.active)
    assert found.stiffness == pytest.approx(1.0 - load, abs=0.02)
    assert found.at[0] == pytest.approx(LENGTH)
