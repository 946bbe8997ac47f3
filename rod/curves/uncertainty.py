"""Errors of fitted parameters: noise, misfit, and intervals from a parametric bootstrap."""

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array


@dataclass(frozen=True)
class Bootstrap:
    """A parametric bootstrap: refits to data drawn around the fit with the errors that the fit suggests."""

    draws: int = 400
    seed: int = 0

    def generator(self) -> np.random.Generator:
        """A generator that begins with the seed."""
        return np.random.default_rng(self.seed)


@final
@dataclass(frozen=True)
class Interval:
    """A value with its error, from bootstrap draws."""

    value: float
    std: float  #: half the distance of the 16 % and 84 % quantiles of the draws
    low: float  #: 2.5 % of the draws lie below
    high: float  #: 2.5 % of the draws lie above

    def widened(self, std: float) -> "Interval":
        """The value with a further, independent error of this standard deviation."""
        further = 1.96 * std
        low, high = (math.hypot(self.value - end, further) for end in (self.low, self.high))
        return Interval(self.value, math.hypot(self.std, std), self.value - low, self.value + high)


def interval(value: float, drawn: Array) -> Interval:
    """A value and bootstrap draws of it, (draws,), as value, standard deviation and 95 % interval."""
    low, below, above, high = np.quantile(drawn, [0.025, 0.1587, 0.8413, 0.975])
    # a value at a bound of its range may lie beyond all its draws
    return Interval(float(value), float(0.5 * (above - below)), float(min(low, value)), float(max(high, value)))


def white_noise(response: Array, kappa: Array) -> Array:
    """Covariance of kappa from white sideways noise of the nodes; response (m, n) is kappa by node displacements.

    The variance of the noise is that which explains the third differences of kappa along the curve, to which a smooth
    curvature contributes next to nothing.
    """
    rough, expected = _roughness(response, kappa)
    variance = float(np.sum(rough)) / float(np.sum(expected))
    return variance * response @ response.T


def local_deviation(response: Array, kappa: Array, s: Array, pitch: float) -> Array:
    """(n,) standard deviation of kappa at s (n,) mm from noise as in `white_noise` that differs along the curve: at
    each point that which explains the third differences within half a pitch."""
    rough, expected = _roughness(response, kappa)
    middle = 0.5 * (s[1:-2] + s[2:-1])
    distance = np.abs(s[:, None] - middle[None, :])
    reach = np.maximum(0.5 * pitch, distance.min(axis=1))  # beyond the outermost differences the nearest one
    near = distance <= reach[:, None]
    variance = (near @ rough) / (near @ expected)
    return np.sqrt(variance * np.sum(response**2, axis=1))


def _roughness(response: Array, kappa: Array) -> tuple[Array, Array]:
    """(n - 3,) squares of the third differences of kappa, and what they are in the mean for noise of variance one."""
    differences = np.diff(np.eye(len(kappa)), 3, axis=0)
    return (differences @ kappa) ** 2, np.sum((differences @ response) ** 2, axis=1)


def total_covariance(residual: Array, matrix: Array, noise: Array, correlation: Array, least: float) -> Array:
    """(n, n) covariance of the noise plus that of the misfit, which the noise does not explain.

    residual (n,): of a least-squares fit with the matrix (n, k); noise (n, n): covariance; correlation (n, n): of the
    misfit; least: its smallest standard deviation. A residual that noise alone exceeds in one case of twenty is not
    counted as misfit.
    """
    q, _ = np.linalg.qr(matrix)

    def of_residual(covariance: Array) -> Array:  # after a fit with this matrix, of data with the covariance
        half = covariance - q @ (q.T @ covariance)
        return half - (half @ q) @ q.T

    rest = of_residual(noise)
    chance = float(np.trace(rest)) + 1.64 * float(np.sqrt(2.0 * np.sum(rest * rest)))
    excess = max(least**2, (float(residual @ residual) - chance) / float(np.trace(of_residual(correlation))))
    return noise + excess * correlation


def effective_observations(error: Array) -> float:
    """Number of independent observations with the same information on a mean: the number of points for white noise."""
    return float(np.trace(error) ** 2 / np.sum(error**2))


def sample_errors(error: Array, draws: int, random: np.random.Generator) -> Array:
    """(n, draws) normal errors with the covariance `error` (n, n)."""
    size, vectors = np.linalg.eigh(error)
    return vectors @ (np.sqrt(np.maximum(size, 0.0))[:, None] * random.standard_normal((len(error), draws)))
