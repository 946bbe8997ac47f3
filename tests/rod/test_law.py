"""The five-parameter law, loads besides the pressure, and moments outside the range of the identification."""

import dataclasses

import numpy as np
import pytest

from geometry import Centreline
from rod import FiveParameters, Load, Moment, MomentRange, Rod, RodError, moment_from_load

LAW = FiveParameters(alpha1=55.0, alpha2=400.0, m01=5.0, m02=-0.3, d=14.0)


def test_two_lines_meet_at_d_and_d_belongs_to_the_second():
    s = np.array([0.0, 13.999, 14.0, 100.0])
    assert LAW.rigidity(s).tolist() == [55.0, 55.0, 400.0, 400.0]
    assert LAW.moment(s, 0.01) == pytest.approx([5.55, 5.55, 3.7, 3.7])


def test_deviation_is_the_inverse_of_moment():
    s = np.linspace(0.0, 112.0, 50)
    moment = np.linspace(7.0, 0.0, 50)
    assert LAW.moment(s, LAW.deviation(s, moment)) == pytest.approx(moment, abs=1e-12)


def test_rest_curvature_carries_the_intercepts():
    s, kappa, kappa_0 = np.linspace(0.0, 112.0, 50), np.linspace(-0.01, 0.04, 50), 0.03
    expected = LAW.moment(s, kappa - kappa_0)
    assert LAW.rigidity(s) * (kappa - LAW.kappa_rest(s, kappa_0)) == pytest.approx(expected, abs=1e-12)


def test_the_law_is_a_frozen_value():
    with pytest.raises(dataclasses.FrozenInstanceError):
        LAW.alpha1 = 1.0  # type: ignore[misc]
    assert FiveParameters(55, 400, 5, -0.3, 14) == LAW


LINEAR = FiveParameters(1.0, 1.0, 0.0, 0.0, 0.13)
#: a pressurised arm of 112 mm, soft in its first cell
ARM = Rod(112.0, 0.01, FiveParameters(180.0, 400.0, 0.5, -0.2, 12.0))


@pytest.mark.parametrize("height", [0.0, 6.0, -4.0])
def test_the_moment_of_a_heavy_cantilever_follows_from_its_shape(height: float) -> None:
    """Statics from the deformed shape against the moment that the rod equations carried along."""
    load = Load((0.01, -0.03), couple=0.7, weight=(1e-4, -8e-4), weight_height=height)
    shape = ARM.under(load)
    s = np.linspace(0.0, 112.0, 2001)
    moment = moment_from_load(Centreline(s, *shape.positions(s).T), load)
    assert np.interp(shape.s, s, moment.value) == pytest.approx(shape.moment, abs=1e-4)
    alone = moment_from_load(Centreline(s, *shape.positions(s).T), Load(load.force, load.couple))
    assert np.abs(alone.value - moment.value).max() > 1.0  # the weight matters here


def test_the_moment_of_a_straight_heavy_cantilever_is_that_of_the_handbook() -> None:
    """M = q (l - s)^2 / 2, exact for the trapezoidal rule on a straight curve."""
    s = np.linspace(0.0, 10.0, 11)
    moment = moment_from_load(Centreline(s, s, 0 * s), Load(weight=(0.0, -0.2)))
    assert moment.value == pytest.approx(-0.1 * (10.0 - s) ** 2, abs=1e-13)


def test_a_heavy_column_buckles_under_the_weight_of_greenhill() -> None:
    """q l^3 = 7.8373 alpha (A. G. Greenhill, Proc. Camb. Phil. Soc. 4, 1881): just below it the column stands."""
    column = Rod(1.0, 0.0, LINEAR)
    assert column.under(Load(weight=(-7.83, 0.0))).x[-1] == pytest.approx(1.0)
    with pytest.raises(RodError, match="The rod buckles at"):
        column.under(Load(weight=(-7.85, 0.0)))


def test_a_held_end_takes_the_couple_but_no_force_along_the_axis_on_which_it_is_held() -> None:
    held = ARM.under(Load((0.0, 5.0), couple=0.5), end_y=10.0)
    assert held.y[-1] == pytest.approx(10.0)
    assert held.force == pytest.approx(ARM.solve(end_y=10.0, moment=0.5).force)


def test_the_end_held_where_a_force_put_it_needs_that_force() -> None:
    """With both coordinates held, and with one of them and the force along the other."""
    force = (0.3, 0.7)
    free = ARM.solve(force)
    x, y = float(free.x[-1]), float(free.y[-1])
    for load, end_x, end_y in (
        (Load(), x, y),
        (Load((9.0, 9.0)), x, y),
        (Load((0.3, 0.0)), None, y),
        (Load((0.0, 0.7)), x, None),
    ):
        held = ARM.under(load, end_y=end_y, end_x=end_x)
        assert (held.x[-1], held.y[-1]) == pytest.approx((x, y), abs=1e-6)
        assert held.force == pytest.approx(force, rel=1e-5)


CURLED = Rod(112.0, -0.03, FiveParameters(190.0, 400.0, 0.0, -0.4, 6.5))
III = CURLED.solve(end_y=0.0)
SAMPLED = MomentRange.of(Moment(III.s, III.moment))


def test_the_range_is_that_of_the_loaded_curve_without_its_tail() -> None:
    assert SAMPLED.high == pytest.approx(III.moment.max())
    inside = np.interp(0.95 * 112.0, III.s, III.moment)
    assert SAMPLED.low == pytest.approx(inside, rel=0.1)
    assert 0.0 < SAMPLED.low < 0.1 * SAMPLED.high


def test_the_load_of_the_fit_and_loads_near_it_say_nothing() -> None:
    assert SAMPLED.warning(III) == ""
    assert SAMPLED.warning(CURLED.solve(end_y=-20.0)) == ""
    assert SAMPLED.warning(CURLED.solve()) == ""


def test_a_curled_arm_under_a_dead_force_is_warned_of_with_its_size() -> None:
    shape = CURLED.solve(force=(0.0, 0.05))
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
