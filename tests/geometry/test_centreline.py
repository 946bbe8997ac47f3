"""The material curve, and products of many vectors."""

import numpy as np
import pytest

from geometry import Centreline
from geometry.topology import cross


def test_arc_of_a_circle() -> None:
    s = np.linspace(0, 90, 200)
    line = Centreline(s, 50 * np.sin(s / 50), 50 * (1 - np.cos(s / 50)))
    assert line.length == 90
    assert line.stretch == pytest.approx(1, abs=1e-5)
    assert line.angle == pytest.approx((s[1:] + s[:-1]) / 2 / 50, abs=1e-12)


def test_angle_is_continuous_past_half_a_turn() -> None:
    s = np.linspace(0, 10, 60)
    line = Centreline(s, np.sin(s), 1 - np.cos(s))
    assert line.angle[-1] == pytest.approx((s[-1] + s[-2]) / 2)


def test_arrays_are_read_only_copies() -> None:
    s = np.arange(5.0)
    line = Centreline(s, 2 * s, 0 * s)
    s[0] = -7
    assert line.s[0] == 0
    assert line.stretch == 2
    for array in (line.s, line.x, line.y, line.angle, line.chords):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


@pytest.mark.parametrize("shape", [(3,), (0, 3), (1, 3), (40, 3), (7, 3, 3)])
def test_cross_products_are_those_of_numpy(shape: tuple[int, ...]) -> None:
    a, b = np.random.default_rng(1).normal(size=(2, *shape))
    product = cross(a, b)
    np.testing.assert_array_equal(product, np.cross(a, b))
    assert product.flags.c_contiguous


def test_cross_products_with_one_vector() -> None:
    generator = np.random.default_rng(3)
    a, b = generator.normal(size=(40, 3)), generator.normal(size=3)
    np.testing.assert_array_equal(cross(a, b), np.cross(a, b))


def test_cross_products_of_columns_that_do_not_stand_side_by_side() -> None:
    a, b = np.random.default_rng(2).normal(size=(2, 3, 20))
    np.testing.assert_array_equal(cross(a.T, b.T), np.cross(a.T, b.T))
