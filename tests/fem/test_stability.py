"""What steps say of the stability of their state, and the elastic stiffness that a load leaves."""

import numpy as np
import pytest

import fem
from fem import Fixed, Model, PathObserver, PathOptions, StVenantKirchhoff
from fem.equations.linear import SingularMatrix
from fem.path import diagnosis
from fem.path.control import LoadControl
from fem.path.diagnosis import near_limit_point
from fem.path.follower import PathFollower
from fem.path.modes import stiffness_ratio_mode
from fem.path.predictor import PathPoint
from fem.reasons import Reasons
from tests.bodies import box, hollow_box
from tests.loads import Traction


def codes(step: fem.Step) -> list[str]:
    return [reason.code for reason in step.instability]


def pressed_column() -> fem.Model:
    """A clamped column that is shortened by a tenth, twice as much as it bears without buckling."""
    supports = [fem.Fixed("left"), fem.Fixed("right", "yz"), fem.Prescribed("right", "x", -0.8)]
    return fem.Model(box((8, 1, 1), (8.0, 1.0, 1.0)), fem.StVenantKirchhoff(1.0, 1e-5), supports, [], "p2")


def balloon() -> fem.Model:
    """Its largest load factor is 0.52, at nine times the volume at rest, 0.5 mm3."""
    supports = [fem.Fixed("clamp"), fem.Fixed("sym", "z")]
    return fem.Model(hollow_box(half=True), fem.NeoHooke(0.4, 20.0), supports, [fem.Pressure("cavity", 1.0)])


@pytest.fixture(scope="module")
def column_steps() -> tuple[fem.Step, ...]:
    return fem.follow(pressed_column(), [1.0, 1.0, 1.0, 0.25]).steps


def test_an_unstable_state_that_is_a_target_again_stays_unstable(column_steps: tuple[fem.Step, ...]) -> None:
    first, second, third, relieved = column_steps
    assert [step.negative_pivots for step in column_steps] == [4, 4, 4, 0]
    assert codes(first) == ["unstable", "not_followed"]
    for step in (second, third):
        np.testing.assert_allclose(step.displacement, first.displacement, atol=1e-8)
        assert codes(step) == ["unstable", "not_followed_earlier"]
        assert step.instability[0].values["directions"] == 4
    assert relieved.instability == ()


def test_a_resumed_path_tells_the_same_of_its_stability(column_steps: tuple[fem.Step, ...]) -> None:
    for count in (1, 2):
        again = fem.follow(pressed_column(), [1.0, 1.0, 1.0], resume=column_steps[:count]).steps
        assert [step.instability for step in again] == [step.instability for step in column_steps[:3]]


def test_a_path_under_a_volume_goes_through_a_limit_of_the_load_and_is_followed() -> None:
    (step,) = fem.follow_volume(balloon(), "cavity", [5.5]).steps
    assert step.negative_pivots == 1
    assert codes(step) == ["unstable"]


@pytest.mark.parametrize("before", [[], [4.0]])
def test_the_end_of_a_path_under_a_volume_does_not_advise_a_volume(before: list[float]) -> None:
    """It ends shortly behind the largest load, with 4 % of the elastic stiffness left."""
    with pytest.raises(fem.NotConverged) as caught:
        fem.follow_volume(balloon(), "cavity", [*before, 25.0])
    failed, explained = caught.value.end.reasons
    assert (failed.code, failed.values["iterations"]) == ("not_converged", 12)
    assert explained.code == "unexplained_under_volume"


LENGTH = 16.0
#: Euler's load of a clamped column whose other end is free, E = 1 MPa, over its section of 1 mm2
EULER_LOAD = np.pi**2 / 12 / (4 * LENGTH**2)


def codes_of(reasons: Reasons) -> list[str]:
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
    assert codes_of(near_limit_point(column.system, column.points[-1])) == ["unexplained"]

    def singular(values: np.ndarray) -> None:
        raise SingularMatrix("a pivot is zero")

    monkeypatch.setattr(column.system.solver, "factorize", singular)
    rest = PathPoint(0.0, 0.0, column.system.rest_state())
    assert codes_of(near_limit_point(column.system, rest)) == ["body_not_held"]
    last = column.points[-1]
    assert codes_of(near_limit_point(column.system, last)) == ["singular_limit_point", "volume_leads_on"]
    of_law = near_limit_point(column.system, last, law_is_named=True)
    assert codes_of(of_law) == ["singular_limit_point", "law_exceeded"]
    monkeypatch.setattr(diagnosis, "EARLY", (column.system.space.element.name,))
    assert codes_of(near_limit_point(column.system, last))[-1] == "early_limit"
