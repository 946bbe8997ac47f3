"""Richardson extrapolation: from results on two or more meshes to the limit of an infinitely fine one.

A result v on a mesh of size h has an error C h^q when h is small:

    v(h) = v_0 + C h^q

Two sizes give v_0 and C for an assumed order q; from three on the data say something about q themselves. Either way q
is uncertain: smooth solutions of quadratic elements converge faster than those with re-entrant corners and contact. So
q is a range, every order in it is fitted, and the scatter between the orders is part of the uncertainty:

    v_0 = mean of v_0(q),   its variance = variance of v_0(q) + mean of the variance of the fit at q

With equal weight for every q from two sizes; from three sizes on each q is weighted by its likelihood. Values on meshes
that are not nested scatter: by SCATTER of their range as a prior, and by the residual of the fit, so values that do not
converge steadily get a large standard deviation. For the usual form with one order and a factor of safety see
W. L. Oberkampf and C. J. Roy, Verification and Validation in Scientific Computing, Cambridge 2010, chapter 8.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array

#: range of orders assumed for two sizes, which say nothing about the order
ASSUMED_ORDERS = (1.0, 2.0)
#: range of orders from which three or more sizes choose
FITTED_ORDERS = (0.5, 4.0)
#: prior of the scatter: its standard deviation over the range of the values, and how many observations it is worth
SCATTER, PRIOR_OBSERVATIONS = 0.05, 3
_ORDERS = 351


class Limit(NamedTuple):
    """The limit of a number, for an infinitely fine mesh."""

    value: float
    std: float  #: standard deviation of value


@dataclass(frozen=True)
class Extrapolated:
    """A result extrapolated to mesh size zero, and the discretisation error of the finest mesh."""

    value: float  #: on the finest mesh
    limit: float  #: extrapolated to mesh size zero
    limit_std: float  #: standard deviation of limit
    order: float  #: weighted mean of the orders
    order_std: float  #: standard deviation of the order

    @property
    def error_std(self) -> float:
        """Standard deviation of the uncorrected value on the finest mesh due to discretisation: the root sum of squares
        of its estimated error and of the uncertainty of the limit."""
        return math.hypot(self.value - self.limit, self.limit_std)


def extrapolate(
    sizes: Sequence[float], values: Sequence[float], orders: tuple[float, float] | None = None
) -> Extrapolated:
    """The limit of values on meshes of different sizes (any unit, in any order).

    orders: the range of q, by default `ASSUMED_ORDERS` for two sizes and `FITTED_ORDERS` for more; equal ends fix q.

    Raises `ValueError` for fewer than two different sizes, sizes that are not positive, values that are not finite, and
    a range of orders that does not rise from above zero.
    """
    h, v = np.asarray(sizes, float), np.asarray(values, float)
    if h.ndim != 1 or h.shape != v.shape or len(np.unique(h)) < max(2, len(h)):
        raise ValueError("An extrapolation needs one value each on meshes of two or more different sizes.")
    if not (np.all(h > 0.0) and np.all(np.isfinite(h)) and np.all(np.isfinite(v))):
        raise ValueError("Mesh sizes must be positive and their values finite numbers.")
    low, high = orders or (ASSUMED_ORDERS if len(h) == 2 else FITTED_ORDERS)
    if not 0.0 < low <= high:
        raise ValueError(f"A range of orders rises from above zero; {low:g} ... {high:g} does not.")
    finest = float(v[np.argmin(h)])
    candidates = np.linspace(low, high, _ORDERS if low < high else 1)
    if not np.ptp(v) > 0.0:
        return Extrapolated(finest, finest, 0.0, float(candidates.mean()), float(candidates.std()))
    limits, variances, squares = _fits(h / h.min(), v, candidates)
    weights = _weights(squares, len(h))
    limit, order = float(weights @ limits), float(weights @ candidates)
    spread = float(weights @ ((limits - limit) ** 2 + variances))
    order_std = math.sqrt(float(weights @ (candidates - order) ** 2))
    return Extrapolated(finest, limit, math.sqrt(spread), order, order_std)


def extrapolate_all(by_size: Mapping[float, Mapping[str, float]]) -> dict[str, Extrapolated]:
    """The limits of all numbers that two meshes have at least; by_size: numbers by name, by the size of a mesh."""
    names = dict.fromkeys(name for numbers in by_size.values() for name in numbers)
    found = {}
    for name in names:
        known = {size: numbers[name] for size, numbers in by_size.items() if name in numbers}
        if len(known) > 1:
            found[name] = extrapolate(list(known), list(known.values()))
    return found


def _fits(h: Array, v: Array, orders: Array) -> tuple[Array, Array, Array]:
    """v_0 at each order, its variance due to the scatter, and the sum of squares of the scatter, prior included."""
    columns = np.stack([np.ones((len(orders), len(h))), h ** orders[:, None]], axis=1)
    rows = columns.transpose(0, 2, 1)
    inverse = np.linalg.inv(columns @ rows)
    fitted = inverse @ (columns @ v)[..., None]
    squares = np.sum((v - (rows @ fitted)[..., 0]) ** 2, axis=1) + PRIOR_OBSERVATIONS * (SCATTER * np.ptp(v)) ** 2
    # so few observations follow Student's distribution, whose variance has two degrees of freedom less
    return fitted[:, 0, 0], inverse[:, 0, 0] * squares / (len(h) - 4 + PRIOR_OBSERVATIONS), squares


def _weights(squares: Array, count: int) -> Array:
    """Likelihoods of the orders, summing to one, with the scatter's variance integrated out."""
    if count == 2:
        return np.full(len(squares), 1.0 / len(squares))
    likelihood = (squares / squares.min()) ** (-0.5 * (count - 2 + PRIOR_OBSERVATIONS))
    return np.asarray(likelihood / likelihood.sum())
