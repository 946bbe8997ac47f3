"""From results on two or more meshes to the result of an infinitely fine one, and what the finest mesh has wrong
(Richardson's extrapolation).

A number v that is read from a mesh of size h errs by C h^q when h is small:

    v(h) = v_0 + C h^q

Two sizes give v_0 and C for an order q that must be assumed; from three on the data say something about q themselves.
Either way q is not known well: smooth solutions of quadratic elements converge faster than those with re-entrant
corners and contact. So q is a range, every order in it is tried, and what differs between them is an uncertainty:

    v_0 = mean of v_0(q),   its variance = variance of v_0(q) + mean of the variance of the fit at q

With equal weight for every q from two sizes; from three sizes on each q has the weight of its likelihood. Values of
meshes that are not nested scatter: by SCATTER of their range as far as one knows beforehand, and by what is left behind
the fit, so values that do not converge steadily say so by a large deviation. For the usual form with one order and a
factor of safety see W. L. Oberkampf and C. J. Roy, Verification and Validation in Scientific Computing, Cambridge 2010,
chapter 8.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.law import RodError

#: orders that are assumed where two sizes say nothing about them
ASSUMED = (1.0, 2.0)
#: orders among which three or more sizes choose
FITTED = (0.5, 4.0)
#: standard deviation of the scatter that is expected, over the range of the values, and how many observations this
#: expectation is worth
SCATTER, EXPECTED = 0.05, 3
_ORDERS = 351


@dataclass(frozen=True)
class Extrapolated:
    """A number at mesh size zero, and the error of the finest mesh."""

    value: float  #: on the finest mesh
    limit: float  #: at size zero
    limit_std: float  #: standard deviation of limit
    order: float  #: mean of the orders, by their weights
    order_std: float

    @property
    def error(self) -> float:
        """What the value on the finest mesh is too large by."""
        return self.value - self.limit

    @property
    def error_std(self) -> float:
        """What the mesh adds to the standard deviation of the value on the finest mesh, taken as it is: the error that
        is expected and the uncertainty of that, as a root mean square."""
        return math.hypot(self.error, self.limit_std)


def extrapolated(
    sizes: Sequence[float], values: Sequence[float], orders: tuple[float, float] | None = None
) -> Extrapolated:
    """The limit of values on meshes of different sizes (any unit, in any sequence).

    orders: the range of q, by default `ASSUMED` from two sizes and `FITTED` from more; equal numbers fix q.

    Raises `RodError` for fewer than two different sizes, sizes that are not positive, values that are not finite, and
    a range of orders that is none.
    """
    h, v = np.asarray(sizes, float), np.asarray(values, float)
    if h.ndim != 1 or h.shape != v.shape or len(np.unique(h)) < max(2, len(h)):
        raise RodError("An extrapolation needs one value each on meshes of two or more different sizes.")
    if not (np.all(h > 0.0) and np.all(np.isfinite(h)) and np.all(np.isfinite(v))):
        raise RodError("Mesh sizes must be positive and their values finite numbers.")
    low, high = orders or (ASSUMED if len(h) == 2 else FITTED)
    if not 0.0 < low <= high:
        raise RodError(f"A range of orders rises from above zero; {low:g} ... {high:g} does not.")
    finest = float(v[np.argmin(h)])
    tried = np.linspace(low, high, _ORDERS if low < high else 1)
    if not np.ptp(v) > 0.0:
        return Extrapolated(finest, finest, 0.0, float(tried.mean()), float(tried.std()))
    fits = np.array([_fit(h / h.min(), v, order) for order in tried])
    limits, variances, squares = fits.T
    weights = _weights(squares, len(h))
    limit, order = float(weights @ limits), float(weights @ tried)
    spread = float(weights @ ((limits - limit) ** 2 + variances))
    return Extrapolated(finest, limit, math.sqrt(spread), order, math.sqrt(float(weights @ (tried - order) ** 2)))


def _fit(h: Array, v: Array, order: float) -> tuple[float, float, float]:
    """v_0 at one order, its variance by the scatter, and the squares of the scatter."""
    rows = np.column_stack([np.ones(len(h)), h**order])
    inverse = np.linalg.inv(rows.T @ rows)
    numbers = inverse @ (rows.T @ v)
    squares = float(np.sum((v - rows @ numbers) ** 2)) + EXPECTED * (SCATTER * float(np.ptp(v))) ** 2
    # so few observations follow Student's distribution, whose variance has two degrees of freedom less
    return float(numbers[0]), float(inverse[0, 0]) * squares / (len(h) - 4 + EXPECTED), squares


def _weights(squares: Array, count: int) -> Array:
    """Likelihoods of the orders, summing to one, with the scatter's variance integrated out."""
    if count == 2:
        return np.full(len(squares), 1.0 / len(squares))
    likelihood = (squares / squares.min()) ** (-0.5 * (count - 2 + EXPECTED))
    return np.asarray(likelihood / likelihood.sum())
