"""The arm's own law between two pressures, where the moment has a kink that moves with the pressure."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.arrays import Array
from rod.arm_law.between import join_states, measure_disagreement
from rod.arm_law.curves import CellCurve
from rod.arm_law.section import section_at

SOFT, STIFF = 200.0, 500.0
GROWTH = 2e-4  #: of -kappa_0, 1/(mm kPa)


def moment_of(kappa: Array, pressure: float, onset: float) -> Array:
    """SOFT up to the curvature `onset`, STIFF beyond; zero at -GROWTH p."""
    free = np.minimum(kappa, onset) + GROWTH * pressure
    return np.asarray(SOFT * free + STIFF * np.maximum(kappa - onset, 0.0))


def curve(
    pressure: float, onset: float, onset_by_pressure: float, first: float = -0.03, last: float = 0.02
) -> CellCurve:
    """A cell whose walls begin to touch at `onset`, with states on both sides of the kink next to it."""
    kappa = np.unique(np.concatenate([np.linspace(first, 0.02, 21), onset + np.array([-1e-6, 1e-6])]))
    kappa = kappa[kappa <= last]
    touch = kappa > onset
    ones = np.ones(len(kappa))
    by_pressure = SOFT * GROWTH - np.where(touch, (STIFF - SOFT) * onset_by_pressure, 0.0)
    return CellCurve(
        pressure=pressure,
        moment=moment_of(kappa, pressure, onset),
        kappa=kappa,
        rigidity=np.where(touch, STIFF, SOFT),
        moment_by_pressure=by_pressure,
        stretch=1.0 + 1.5 * kappa + 1e-4 * pressure,
        stretch_by_kappa=1.5 * ones,
        stretch_by_pressure=1e-4 * ones,
        axial_rigidity=60.0 * ones,
        shear_rigidity=10.0 * ones,
        contact=touch,
        min_J=ones,
        s=np.array([0.0, 5.0]),
        ripple=np.zeros((len(kappa), 2, 2)),
    )


def largest_error(first: CellCurve, second: CellCurve, pressure: float, onset: float) -> float:
    """Of the curvature at equal moments, 1/mm."""
    law = section_at((first.placed, second.placed), pressure, pressure)
    kappa = np.linspace(law.kappa[0], law.kappa[-1], 4001)
    exact = np.interp(law.moment, moment_of(kappa, pressure, onset), kappa)
    return float(np.abs(law.kappa - exact).max())


def test_a_kink_that_moves_with_the_pressure_stays_a_kink_between_two_pressures() -> None:
    rate = -1e-3
    first, second = (curve(p, 0.01 + rate * p, rate) for p in (0.0, 20.0))
    for pressure in (5.0, 10.0, 16.0):
        # a 257th of the range of the table beside the kink, but not the 0.01/mm by which it moves
        assert largest_error(first, second, pressure, 0.01 + rate * pressure) < 1e-4


def test_a_kink_at_one_curvature_stays_there_whatever_the_ranges_of_the_curves() -> None:
    first, second = curve(0.0, 0.012, 0.0), curve(20.0, 0.012, 0.0, first=-0.06)
    assert largest_error(first, second, 10.0, 0.012) < 1e-4


@pytest.mark.parametrize(("end", "begin"), [(-0.03, -0.025), (-0.041, -0.03)])
def test_the_state_without_moment_is_known_where_curves_end_far_apart(end: float, begin: float) -> None:
    """The second curve ends at `end`, before the first one is free of moment; the first one may begin beyond it."""
    first, second = curve(100.0, 0.01, 0.0, first=begin), curve(225.0, 0.01, 0.0, first=-0.06, last=end)
    for pressure in (101.0, 130.0, 190.0, 224.0):
        law = section_at((first.placed, second.placed), pressure, pressure)
        assert law.kappa_0 == pytest.approx(-GROWTH * pressure, abs=1e-6)


@pytest.mark.parametrize("rounding", [-1e-10, 1e-10])
def test_curves_that_end_without_a_moment_have_a_state_without_one_between_them(rounding: float) -> None:
    """As those of swollen cells that a moment straightens no further; rounding: of the last curvature, 1/mm."""
    ends = {pressure: -GROWTH * pressure + rounding for pressure in (100.0, 125.0)}
    first, second = (
        replace(cut, kappa=np.append(cut.kappa[:-1], end), moment=np.append(cut.moment[:-1], SOFT * rounding))
        for cut, end in ((curve(p, 0.01, 0.0, first=-0.06, last=end + 3e-3), end) for p, end in ends.items())
    )
    for pressure in (100.0, 110.0, 124.0, 125.0):
        law = section_at((first.placed, second.placed), pressure, pressure)
        assert law.kappa_0 == pytest.approx(-GROWTH * pressure, abs=1e-6)


def test_the_states_between_belong_to_both_curves_and_rise() -> None:
    first, second = curve(0.0, 0.01, 0.0), curve(20.0, -0.01, 0.0)
    pairs = join_states(first.placed, second.placed, 5.0)
    assert np.all(np.diff(pairs.moment) > 0.0)
    assert (pairs.first[0], pairs.second[0]) == pytest.approx((first.moment[0], second.moment[0]))
    assert pairs.stretch == pytest.approx(1.0 + 1.5 * pairs.kappa + 5e-4, abs=1e-12)


def test_predictions_from_both_sides_agree_where_the_law_is_known_and_differ_where_it_is_not() -> None:
    rate = -1e-3
    exact, wrong = (
        measure_disagreement(curve(0.0, 0.01, slope).placed, curve(20.0, 0.01 + 20.0 * rate, slope).placed)[1].max()
        for slope in (rate, 0.0)
    )
    assert exact < 1e-5
    assert wrong > 1e-3


def test_rigidities_between_two_pressures_are_near_those_of_the_curves() -> None:
    """Kinks that nearly meet the end of the curves: lines that belong to other states cross there."""
    first, second = curve(0.0, 0.019, -5e-4), curve(20.0, -0.02, 2e-3)
    for pressure in np.linspace(0.5, 19.5, 39):
        law = section_at((first.placed, second.placed), pressure, pressure)
        rigidity = 1.0 / law.kappa_slope
        assert rigidity.min() > 0.7 * SOFT
        assert rigidity.max() < 1.3 * STIFF
        assert law.stretch_slope / law.kappa_slope == pytest.approx(1.5, rel=0.26)
