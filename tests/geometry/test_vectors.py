"""Products of many vectors are those of numpy, to the last bit."""

import numpy as np
import pytest

from geometry.topology import cross


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
