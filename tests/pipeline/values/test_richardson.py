"""Richardson's extrapolation of values with a known limit."""

import math

import numpy as np
import pytest

from pipeline.values.richardson import extrapolate


def test_two_sizes_with_a_known_order_give_the_limit() -> None:
    sizes = (2.5, 4.0)
    estimate = extrapolate(sizes, [3.0 + 0.2 * h**2 for h in sizes], orders=(2.0, 2.0))
    assert estimate.limit == pytest.approx(3.0, abs=1e-12)
    assert (estimate.value - estimate.limit) == pytest.approx(0.2 * 2.5**2, abs=1e-12)
    assert 0.0 < estimate.limit_std < 0.3 * (estimate.value - estimate.limit)  # the scatter that is to be expected


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0])
def test_two_sizes_with_a_range_of_orders_hold_the_truth(order: float) -> None:
    sizes = (4.0, 2.5)
    estimate = extrapolate(sizes, [3.0 - 0.2 * h**order for h in sizes])
    assert abs(estimate.limit - 3.0) < 2.3 * estimate.limit_std  # an end of the range, of a skewed distribution
    assert abs(estimate.value - 3.0) < 1.96 * estimate.error_std
    # and the uncertainty is that of the order, not a blanket
    assert estimate.limit_std < abs(estimate.value - estimate.limit)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.0])
def test_three_sizes_find_the_order(order: float) -> None:
    sizes = np.array([5.0, 3.2, 2.0])
    estimate = extrapolate(sizes, 10.0 + 0.1 * sizes**order)
    assert abs(estimate.order - order) < 0.4  # with a scatter of five hundredths three meshes say no more
    assert abs(estimate.limit - 10.0) < 2.0 * estimate.limit_std


def test_scatter_is_covered() -> None:
    """Meshes that are not nested scatter: of 150 draws the limit lies within 1.96 deviations in nearly all."""
    random, sizes = np.random.default_rng(0), np.array([5.0, 4.0, 3.2, 2.5])
    hits = 0
    for _ in range(150):
        order = random.uniform(1.0, 3.0)
        smooth = (sizes / 5.0) ** order
        estimate = extrapolate(sizes, 1.0 + smooth + 0.05 * random.standard_normal(4))
        hits += abs(estimate.limit - 1.0) < 1.96 * estimate.limit_std
    assert 0.9 <= hits / 150 <= 1.0


def test_values_that_do_not_converge_say_so() -> None:
    steady = extrapolate([4.0, 3.0, 2.0], [1.16, 1.09, 1.04])
    jumping = extrapolate([4.0, 3.0, 2.0], [1.16, 0.95, 1.04])
    assert jumping.limit_std > 2.5 * steady.limit_std


def test_equal_values_have_no_error() -> None:
    estimate = extrapolate([4.0, 2.0, 1.0], [5.0, 5.0, 5.0])
    assert (estimate.limit, estimate.error_std) == (pytest.approx(5.0), pytest.approx(0.0, abs=1e-12))
    assert math.isfinite(estimate.order)
