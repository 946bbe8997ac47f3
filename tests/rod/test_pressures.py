"""Parameters over pressure and over length: paper, section 4.1, equations (9) and (10)."""

import dataclasses

import numpy as np
import pytest

from rod import FiveParameters
from rod.pressures import Quantity, linear_range, straightness
from rod.pressurised_rod import PressurisedRod

S = np.linspace(0.0, 112.0, 57)
ROD = PressurisedRod(
    112.0,
    np.array([17.0, 37.0]),
    (FiveParameters(80.0, 290.0, -1.0, 0.1, 12.0), FiveParameters(60.0, 430.0, -3.0, 0.2, 14.0)),
    S,
    np.outer([0.012, 0.03], 1.0 + 0.1 * np.cos(S)),
    np.array([0.0, 0.02]),
)


def test_a_line_through_rigidities():
    p = [10.0, 17.0, 24.0, 31.0]
    line = straightness(p, [200.0 + 3.0 * q for q in p], [1.0] * 4)
    assert (line.slope, line.intercept) == pytest.approx((3.0, 200.0))
    assert line.straight
    assert line.tested
    bent = straightness(p, [200.0 + 0.3 * q**2 for q in p], [1.0] * 4)
    assert not bent.straight
    assert not straightness(p[:2], [1.0, 2.0], [0.1, 0.1]).tested


def test_slope_error_follows_the_errors_of_the_values():
    p = np.array([5.0, 17.0, 31.0, 45.0])
    random = np.random.default_rng(0)
    slopes = [straightness(p, 200.0 + p + 4.0 * random.standard_normal(4), [4.0] * 4) for _ in range(400)]
    assert np.std([s.slope for s in slopes]) == pytest.approx(slopes[0].slope_std, rel=0.15)


def test_the_rod_between_two_pressures():
    rod = ROD.at(27.0)
    assert dataclasses.astuple(rod.law) == pytest.approx((70.0, 360.0, -2.0, 0.15, 13.0))  # two values: a line
    # both are zero at 0 kPa: the parabola through three values
    parabolas = [np.polyval(np.polyfit([0.0, 17.0, 37.0], [0.0, *v], 2), 27.0) for v in ([0.012, 0.03], [0.0, 0.02])]
    assert rod.solve().kappa[0] == pytest.approx(parabolas[0] * 1.1)
    assert rod.theta0 == pytest.approx(parabolas[1])
    for pressure, law, kappa_0, theta0 in zip(ROD.pressures, ROD.laws, ROD.kappa_0, ROD.theta0, strict=True):
        at = ROD.at(float(pressure))
        assert at.law == law
        assert at.theta0 == theta0
        np.testing.assert_array_equal(np.asarray(at.kappa_0)[:, 1], kappa_0)


def test_what_curves_over_the_pressure_is_met_better_than_by_straight_lines():
    """A rest curvature of the form p/(1 + p/40 kPa) and rigidities that rise with p^2, from four pressures."""
    p = np.array([5.0, 17.0, 31.0, 45.0])

    def kappa_0(pressure):
        return -0.001 * pressure / (1.0 + pressure / 40.0)

    def alpha(pressure):
        return 200.0 + 0.1 * pressure**2

    rod = PressurisedRod(
        112.0,
        p,
        tuple(FiveParameters(alpha(q), 2 * alpha(q), -0.1 * q, 0.0, 12.0) for q in p),
        S,
        np.array([np.full(len(S), kappa_0(q)) for q in p]),
        np.zeros(4),
    )
    for between in (11.0, 24.0, 38.0):
        at = rod.at(between)
        for value, exact in ((np.asarray(at.kappa_0)[0, 1], kappa_0), (at.five.alpha1, alpha)):
            by_line = float(np.interp(between, p, exact(p)))
            assert abs(value - exact(between)) < 0.5 * abs(by_line - exact(between))


def test_the_mean_of_an_interpolated_profile_is_the_interpolated_mean():
    """A small rest curvature below a ripple that is ten times larger and has another dependence on the pressure."""
    p = np.array([5.0, 20.0, 37.0])
    ripple = np.cos(2.0 * np.pi * S / S[-1])[:-1]
    ripple = np.append(ripple - ripple.mean(), 0.0)
    profiles = np.array([-1e-6 * q**2 + 2e-2 * np.sqrt(q) * ripple for q in p])
    laws = (FiveParameters(200.0, 400.0, 0.0, 0.0, 12.0),) * 3
    at = PressurisedRod(112.0, p, laws, S, profiles, np.zeros(3)).at(28.5)
    assert np.asarray(at.kappa_0)[:, 1].mean() == pytest.approx(-1e-6 * 28.5**2, rel=0.02)


def test_an_arm_that_is_bent_without_pressure_does_not_go_to_a_straight_one():
    """An arm that carries its weight has equal states at all pressures, and between them."""
    p = np.array([2.0, 4.0])
    laws = (FiveParameters(200.0, 400.0, 0.0, 0.0, 12.0),) * 2
    same = np.full((2, len(S)), -0.01)
    bent = PressurisedRod(112.0, p, laws, S, same, np.full(2, 0.1), straight_without_pressure=False)
    for pressure in (2.0, 3.0, 4.0):
        rod = bent.at(pressure)
        assert np.asarray(rod.kappa_0)[:, 1] == pytest.approx(-0.01, abs=1e-12)
        assert rod.theta0 == pytest.approx(0.1, abs=1e-12)
    straight = dataclasses.replace(bent, straight_without_pressure=True)
    assert np.asarray(straight.at(3.0).kappa_0)[0, 1] == pytest.approx(-0.01125)


def test_one_pressure_is_a_rod_at_that_pressure():
    single = dataclasses.replace(
        ROD, pressures=ROD.pressures[:1], laws=ROD.laws[:1], kappa_0=ROD.kappa_0[:1], theta0=ROD.theta0[:1]
    )
    assert single.at(17.0).law == ROD.laws[0]


def bent(p: list[float]) -> dict[str, Quantity]:
    """A straight quantity, and one that is straight from 17 kPa on."""
    return {
        "straight": Quantity([100.0 + q for q in p], [0.1] * len(p)),
        "bent": Quantity([200.0 + 10.0 * max(q, 17.0) for q in p], [0.1] * len(p)),
    }


def test_the_range_ends_where_one_quantity_bends() -> None:
    p = [5.0, 10.0, 17.0, 24.0, 31.0, 37.0]
    linear = linear_range(p, bent(p))
    assert (linear.low, linear.high) == (17.0, 37.0)
    assert linear.tested
    assert linear.lines["bent"].slope == pytest.approx(10.0)
    full = linear_range(p, {"straight": bent(p)["straight"]})
    assert (full.low, full.high) == (5.0, 37.0)


def test_two_pressures_are_a_range_that_was_not_tested() -> None:
    linear = linear_range([17.0, 37.0], bent([17.0, 37.0]))
    assert not linear.tested
    assert linear_range([17.0], bent([17.0])) is None
    zigzag = [10.0, 20.0, 30.0, 40.0]
    assert linear_range(zigzag, {"zigzag": Quantity([1.0, 2.0, 1.0, 2.0], [0.01] * 4)}) is None
