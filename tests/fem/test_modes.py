"""The elastic stiffness that a load leaves: all of it at rest, none at the load under which a column buckles."""

import numpy as np
import pytest

from fem import Fixed, Model, PathObserver, PathOptions, StVenantKirchhoff
from fem.equations.linear import SingularMatrix
from fem.path import diagnosis
from fem.path.control import LoadControl
from fem.path.diagnosis import near_limit_point
from fem.path.follower import PathFollower
from fem.path.modes import stiffness_ratio_mode
from fem.path.predictor import PathPoint
from fem.reasons import Reasons
from tests.bodies import box
from tests.loads import Traction

LENGTH = 16.0
#: Euler's load of a clamped column whose other end is free, E = 1 MPa, over its section of 1 mm2
EULER_LOAD = np.pi**2 / 12 / (4 * LENGTH**2)


def codes(reasons: Reasons) -> list[str]:
    return [reason.code for reason in reasons]


@pytest.fixture(scope="module")
def column() -> PathFollower:
    compression = Traction("right", lambda x: np.broadcast_to([-EULER_LOAD, 0.0, 0.0], x.shape))
    mesh = box((16, 1, 1), (LENGTH, 1.0, 1.0))
    model = Model(mesh, StVenantKirchhoff(1.0, 0.0), [Fixed("left")], [compression], "p2")
    return PathFollower(LoadControl.of(model.system()), PathOptions(), PathObserver())


def test_at_rest_all_of_the_elastic_stiffness_is_left(column: PathFollower) -> None:
    mode = stiffness_ratio_mode(column.system, column.system.rest_state(), ())
    assert mode.stiffness == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("load", [0.4, 0.8])
def test_a_column_loses_its_stiffness_as_euler_says(column: PathFollower, load: float) -> None:
    """1 - P / P_E, at the free end. Measured: 0.5 % of P_E, which shear and the ends cost."""
    column.advance(load)
    mode = stiffness_ratio_mode(column.system, column.points[-1].state, column.solver.active_set.active)
    assert mode.stiffness == pytest.approx(1.0 - load, abs=0.02)
    assert mode.position[0] == pytest.approx(LENGTH)


def test_a_singular_tangent_is_a_limit_point_unless_the_body_is_at_rest(column: PathFollower, monkeypatch) -> None:
    """An exactly singular matrix is not met by rounded numbers, so the solver is made to report one."""
    column.advance(0.5)
    assert near_limit_point(column.system, column.points[-1], law_is_named=True) == ()
    assert codes(near_limit_point(column.system, column.points[-1])) == ["unexplained"]

    def singular(values: np.ndarray) -> None:
        raise SingularMatrix("a pivot is zero")

    monkeypatch.setattr(column.system.solver, "factorize", singular)
    rest = PathPoint(0.0, 0.0, column.system.rest_state())
    assert codes(near_limit_point(column.system, rest)) == ["body_not_held"]
    last = column.points[-1]
    assert codes(near_limit_point(column.system, last)) == ["singular_limit_point", "volume_leads_on"]
    of_law = near_limit_point(column.system, last, law_is_named=True)
    assert codes(of_law) == ["singular_limit_point", "law_exceeded"]
    monkeypatch.setattr(diagnosis, "EARLY", (column.system.space.element.name,))
    assert codes(near_limit_point(column.system, last))[-1] == "early_limit"
