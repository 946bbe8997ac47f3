"""What steps say of the stability of their state, under a given load and under a given volume."""

import numpy as np
import pytest

import fem
from tests.bodies import box, hollow_box


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
