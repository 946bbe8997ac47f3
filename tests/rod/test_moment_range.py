"""The warning for a load whose moments are outside the range of the identification."""

import numpy as np
import pytest

from rod import FiveParameters, Moment, MomentRange, Rod

ARM = Rod(112.0, -0.03, FiveParameters(190.0, 400.0, 0.0, -0.4, 6.5))
III = ARM.solve(end_y=0.0)
SAMPLED = MomentRange.of(Moment(III.s, III.moment))


def test_the_range_is_that_of_the_loaded_curve_without_its_tail() -> None:
    assert SAMPLED.high == pytest.approx(III.moment.max())
    inside = np.interp(0.95 * 112.0, III.s, III.moment)
    assert SAMPLED.low == pytest.approx(inside, rel=0.1)
    assert 0.0 < SAMPLED.low < 0.1 * SAMPLED.high


def test_the_load_of_the_fit_and_loads_near_it_say_nothing() -> None:
    assert SAMPLED.warning(III) == ""
    assert SAMPLED.warning(ARM.solve(end_y=-20.0)) == ""
    assert SAMPLED.warning(ARM.solve()) == ""


def test_a_curled_arm_under_a_dead_force_is_warned_of_with_its_size() -> None:
    shape = ARM.solve(force=(0.0, 0.05))
    moments = np.interp(np.linspace(0.0, 112.0, 401), shape.s, shape.moment)
    outside = (moments < SAMPLED.low) | (moments > SAMPLED.high)
    warning = SAMPLED.warning(shape)
    assert warning.startswith(f"The moment leaves the {SAMPLED.low:.3g} to {SAMPLED.high:.3g} N mm")
    assert f"on {100 * outside.mean():.0f} % of the rod" in warning
    assert f"up to {moments.min():.3g} N mm" in warning


def test_arms_that_bend_the_other_way_are_the_same() -> None:
    mirrored = Rod(112.0, 0.03, FiveParameters(190.0, 400.0, 0.0, 0.4, 6.5))
    held = mirrored.solve(end_y=0.0)
    sampled = MomentRange.of(Moment(held.s, held.moment))
    assert (sampled.low, sampled.high) == pytest.approx((-SAMPLED.high, -SAMPLED.low), rel=1e-6)
    assert sampled.warning(held) == ""
    assert sampled.warning(mirrored.solve(end_y=-60.0)) != ""


def test_between_two_pressures_the_range_is_between() -> None:
    between = MomentRange(1.0, 10.0).between(MomentRange(2.0, 20.0), 0.25)
    assert between == MomentRange(1.25, 12.5)
