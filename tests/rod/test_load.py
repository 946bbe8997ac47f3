"""Loads of an arm besides its pressure: end force, end couple, dead weight."""

import numpy as np
import pytest

from geometry import Centreline
from rod import FiveParameters, Load, Rod, RodError, moment_from_load

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
