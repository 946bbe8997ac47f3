"""Errors of fitted numbers: what noise explains, what misfit adds, and intervals from draws."""

import math
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array


@dataclass(frozen=True)
class Interval:
    """A number with its error."""

    value: float
    std: float  #: half the distance of the 16 % and 84 % quantiles of the draws
    low: float  #: 2.5 % of the draws lie below
    high: float  #: 2.5 % of the draws lie above

    def widened(self, std: float) -> "Interval":
        """With a further error, independent of the one it has."""
        further = 1.96 * std
        low, high = (math.hypot(self.value - end, further) for end in (self.low, self.high))
        return Interval(self.value, math.hypot(self.std, std), self.value - low, self.value + high)


def interval(value: float, drawn: Array) -> Interval:
    """A number and its draws as value, standard deviation and 95 % interval."""
    low, below, above, high = np.quantile(drawn, [0.025, 0.1587, 0.8413, 0.975])
    # a number at a bound of its range may lie beyond all its draws
    return Interval(float(value), float(0.5 * (above - below)), float(min(low, value)), float(max(high, value)))


def white_noise(response: Array, kappa: Array) -> Array:
    """Covariance of kappa from white sideways noise of the nodes; response (m, n) is kappa by node displacements.

    The variance of the noise is what explains the third differences of kappa along the curve, where a smooth curvature
    leaves next to nothing.
    """
    rough = np.diff(np.eye(len(kappa)), 3, axis=0)
    seen = rough @ kappa
    variance = float(seen @ seen) / float(np.sum((rough @ response) ** 2))
    return variance * response @ response.T


def misfit_correlation(pitch: float, s: Array) -> Array:
    """(n, n) correlation of a misfit at the points s (n,) mm: shared within a cell, independent beyond a few."""
    return np.exp(-2.0 * ((s[:, None] - s[None, :]) / pitch) ** 2)


def total_covariance(residual: Array, matrix: Array, noise: Array, shared: Array, least: float) -> Array:
    """(n, n) covariance of noise, plus the misfit that it does not explain, with the correlation `shared`.

    residual (n,) is what a least-squares fit with the columns of matrix (n, k) has left; least: the standard deviation
    of the misfit that is assumed at the very least. What noise alone leaves in one case of twenty is no misfit.
    """
    q, _ = np.linalg.qr(matrix)

    def behind(covariance: Array) -> Array:  # covariance of what is left behind a fit of these columns
        half = covariance - q @ (q.T @ covariance)
        return half - (half @ q) @ q.T

    rest = behind(noise)
    chance = float(np.trace(rest)) + 1.64 * float(np.sqrt(2.0 * np.sum(rest * rest)))
    excess = max(least**2, (float(residual @ residual) - chance) / float(np.trace(behind(shared))))
    return noise + excess * shared


def effective_observations(error: Array) -> float:
    """Number of independent observations with the same information on a mean: the number of points for white noise."""
    return float(np.trace(error) ** 2 / np.sum(error**2))


def sample_errors(error: Array, draws: int, random: np.random.Generator) -> Array:
    """(n, draws) errors with the covariance `error`."""
    size, vectors = np.linalg.eigh(error)
    return vectors @ (np.sqrt(np.maximum(size, 0.0))[:, None] * random.standard_normal((len(error), draws)))
