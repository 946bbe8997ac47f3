"""Cubics of `rod.cubics` against those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

from rod.cubics import cubic, cubic_slope, monotone_slopes, parabola_slopes, periodic_slopes

RANDOM = np.random.default_rng(5)
X = np.cumsum(RANDOM.uniform(0.5, 2.0, 12))
POINTS = np.concatenate([X, np.linspace(X[0] - 0.4, X[-1] + 0.4, 101)])


@pytest.mark.parametrize("shape", [(), (3,), (4, 2)])
def test_cubics_have_the_given_values_and_slopes(shape: tuple[int, ...]) -> None:
    y, slopes = RANDOM.normal(size=(2, 12, *shape))
    spline = CubicHermiteSpline(X, y, slopes)
    assert cubic(X, y, slopes, POINTS) == pytest.approx(spline(POINTS), rel=1e-12, abs=1e-12)
    assert cubic(X, y, slopes, 5.3) == pytest.approx(spline(5.3), rel=1e-12, abs=1e-12)
    assert np.shape(cubic(X, y, slopes, 5.3)) == shape
    assert cubic_slope(X, y, slopes, POINTS) == pytest.approx(spline(POINTS, 1), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    "y",
    [
        np.cumsum(RANDOM.uniform(0.0, 3.0, 12) ** 3),
        RANDOM.normal(size=12),
        np.array([0.0, 0.0, 1.0, 1.0, 1.0, -2.0, -3.0, -3.0, 5.0, 5.1, 5.1, 0.0]),
        RANDOM.normal(size=(12, 5)),
    ],
)
def test_monotone_slopes_are_those_of_pchip(y: np.ndarray) -> None:
    ours = cubic(X, y, monotone_slopes(X, y), POINTS)
    assert ours == pytest.approx(PchipInterpolator(X, y)(POINTS), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("count", [2, 3, 12])
def test_the_slopes_of_parabolas_are_exact(count: int) -> None:
    constants = RANDOM.normal(size=(3, 4, 2))
    constants[2] *= count > 2  # through two points there is a straight line
    x = X[:count, None, None]
    y = constants[0] + x * (constants[1] + x * constants[2])
    assert parabola_slopes(X[:count], y) == pytest.approx(constants[1] + 2.0 * x * constants[2], rel=1e-10, abs=1e-10)


@pytest.mark.parametrize(("count", "shape"), [(1, ()), (2, (2,)), (3, ()), (24, (4, 2))])
def test_periodic_slopes_are_those_of_the_periodic_spline(count: int, shape: tuple[int, ...]) -> None:
    y = RANDOM.normal(size=(count, *shape))
    y = np.concatenate([y, y[:1]])
    x = np.linspace(-1.0, 2.0, count + 1)
    expected = CubicSpline(x, y, bc_type="periodic")(x, 1)
    assert periodic_slopes(y, 3.0 / count) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_two_points_are_joined_by_a_straight_line() -> None:
    x, y = np.array([17.0, 37.0]), np.array([60.0, 55.0])
    assert cubic(x, y, monotone_slopes(x, y), 27.0) == pytest.approx(57.5)
