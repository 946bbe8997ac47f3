"""Products of many vectors."""

import numpy as np

from geometry.arrays import Array


def cross(a: Array, b: Array) -> Array:
    """Cross products of vectors (..., 3) with others of the same shape or one alone (3,).

    The numbers are those of `numpy.cross`, which takes three to five times as long for a hundred vectors or fewer.
    """
    a1, a2, a3 = a[..., 0], a[..., 1], a[..., 2]
    b1, b2, b3 = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty(a.shape)
    product[..., 0] = a2 * b3 - a3 * b2
    product[..., 1] = a3 * b1 - a1 * b3
    product[..., 2] = a1 * b2 - a2 * b1
    return product
