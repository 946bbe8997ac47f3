"""Cubics through points with given slopes, and the slopes of a monotone, of a smooth and of a periodic curve.

scipy.interpolate has them. They are written out here because its import takes longer than all other work of
`pneurod rod` together; `tests/rod/test_cubics.py` compares them with scipy.
"""

import numpy as np

from geometry.arrays import Array


def cubic(x: Array, y: Array, slopes: Array, at: Array | float) -> Array:
    """Values at `at` (k,) of the cubics through y (n, ...) over rising x (n,) with the slopes dy/dx (n, ...).

    Outside x the first and the last cubic are continued. A number `at` gives the shape of one y.
    """
    inside, (c0, c1, c2, c3) = _coefficients(x, y, slopes, at)
    return c0 + inside * (c1 + inside * (c2 + inside * c3))


def cubic_slope(x: Array, y: Array, slopes: Array, at: Array | float) -> Array:
    """Derivatives at `at` of the curve of `cubic`."""
    inside, (_, c1, c2, c3) = _coefficients(x, y, slopes, at)
    return c1 + inside * (2.0 * c2 + inside * (3.0 * c3))


def _coefficients(x: Array, y: Array, slopes: Array, at: Array | float) -> tuple[Array, tuple[Array, ...]]:
    """Distance of every point from the beginning of its interval, and the four coefficients of its cubic."""
    x, y, slopes, point = (np.asarray(values, float) for values in (x, y, slopes, at))
    i = np.searchsorted(x[1:-1], point, side="right")
    first, slope, ahead = y[i], slopes[i], i + 1
    step, inside = x[ahead] - x[i], point - x[i]
    if y.ndim > 1:
        across = (*np.shape(i), *(1,) * (y.ndim - 1))
        step, inside = np.reshape(step, across), np.reshape(inside, across)
    secant = (y[ahead] - first) / step
    third = (slope + slopes[ahead] - 2.0 * secant) / step
    return inside, (first, slope, (secant - slope) / step - third, third / step)


def cubic_coefficients(x: Array, y: Array, slopes: Array) -> Array:
    """(4, n - 1, ...): the coefficients of the cubics of `cubic`, by powers of the distance from where each begins."""
    return np.stack(_coefficients(x, y, slopes, x[:-1])[1])


def monotone_cubic(x: Array, y: Array, at: Array | float) -> Array:
    """Values at `at` (k,) of the monotone cubics through y (n, ...) over rising x (n,); the ends outside."""
    return cubic(x, y, monotone_slopes(x, y), np.clip(at, x[0], x[-1]))


def hermite(t: Array | float, a: Array, b: Array, da: Array, db: Array) -> Array:
    """The cubic at t between a (t = 0) and b (t = 1) with the slopes da and db per unit of t."""
    h00, h10 = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2
    h01, h11 = t**2 * (3 - 2 * t), t**2 * (t - 1)
    return np.asarray(h00 * a + h10 * da + h01 * b + h11 * db)


def monotone_slopes(x: Array, y: Array) -> Array:
    """(n, ...) slopes of the monotone cubics (PCHIP) through y (n, ...) over rising x (n,), at least two points.

    Inside, the weighted harmonic mean of the two neighbouring secants, zero where these have different signs; at the
    ends a one-sided parabola, limited so that the curve stays monotone. F. N. Fritsch, J. Butland, SIAM J. Sci. Stat.
    Comput. 5 (1984).
    """
    y = np.asarray(y, float)
    steps = np.diff(np.asarray(x, float)).reshape(-1, *(1,) * (y.ndim - 1))
    secants = np.diff(y, axis=0) / steps
    if len(secants) == 1:
        return np.concatenate([secants, secants])
    before, after = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    same = secants[:-1] * secants[1:] > 0.0
    safe = np.where(same, secants[:-1], 1.0), np.where(same, secants[1:], 1.0)
    inner = np.where(same, (before + after) / (before / safe[0] + after / safe[1]), 0.0)
    first = _end_slope(steps[:2], secants[:2])
    last = _end_slope(steps[:-3:-1], secants[:-3:-1])
    return np.concatenate([first[None], inner, last[None]])


def parabola_slopes(x: Array, y: Array) -> Array:
    """(n, ...) slopes of smooth cubics through y (n, ...) over rising x (n,), at least two points.

    Each is that of the parabola through a point and its two neighbours, at the ends through the last three points; of
    two points that of the straight line.
    """
    return np.asarray(np.gradient(y, x, axis=0, edge_order=2 if len(x) > 2 else 1))


def periodic_slopes(y: Array, step: float) -> Array:
    """(n + 1, ...) slopes at equally spaced points of the periodic cubic spline through y (n + 1, ...).

    Its second derivative is continuous; the last point is the first one again, one period later.
    """
    n = len(y) - 1
    turned = np.arange(n)
    matrix = 4.0 * np.eye(n)
    for neighbour in (-1, 1):
        np.add.at(matrix, (turned, (turned + neighbour) % n), 1.0)
    right = 3.0 / step * (np.roll(y[:-1], -1, axis=0) - np.roll(y[:-1], 1, axis=0))
    slopes = np.linalg.solve(matrix, right.reshape(n, -1)).reshape(right.shape)
    return np.concatenate([slopes, slopes[:1]])


def _end_slope(steps: Array, secants: Array) -> Array:
    """The slope at an end from the two steps and secants (2, ...) beside it, nearest first."""
    slope = ((2.0 * steps[0] + steps[1]) * secants[0] - steps[0] * secants[1]) / (steps[0] + steps[1])
    turned = (np.sign(secants[0]) != np.sign(secants[1])) & (np.abs(slope) > 3.0 * np.abs(secants[0]))
    slope = np.where(turned, 3.0 * secants[0], slope)
    return np.where(np.sign(slope) != np.sign(secants[0]), 0.0, slope)
