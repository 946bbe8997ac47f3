"""Numbers that are linear in what is unknown, with scatter and an error of the model that is smooth in the pressure.

With y the measured numbers, f the rod, theta what is unknown and e the scatter,

    y = f(theta) + a(p) df/dln(modulus) + 2 b(p) df/dln(stiffness) + e.

a and b are the errors of the model: the rubber of the arm follows another law than that of the rod, so that the modulus
that fits best changes with the pressure, and so does the stiffness against loads on the end. Both are Gaussian
processes over the pressure with one standard deviation, so that rows at near pressures err alike (M. C. Kennedy,
A. O'Hagan, J. R. Stat. Soc. B 63 (2001) 425; an error inside the model as in K. Sargsyan et al., Int. J. Uncertain.
Quantif. 9 (2019) 365). How large they are, and the scatter, is what best foretells the rows of each pressure from
those of all others.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from geometry.arrays import Array

#: distance of two pressures at which errors of the model differ, over the highest pressure
REACH = 0.5
#: error of the model and its scatter in logarithms before anything is known, and that of the scatter
MODEL_ERROR, MODEL_ERROR_SPREAD, SCATTER_SPREAD = 0.06, 0.8, 0.7


@final
@dataclass(frozen=True)
class Spread:
    """How far measured numbers lie from those of a rod."""

    scatter: Mapping[str, float]  #: standard deviation by unit: mm, deg, N
    model: float  #: standard deviation of a and b


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Effects:
    """How numbers (n,) change at some state of an arm."""

    by_unknown: Array  #: (n, k)
    by_model: Array  #: (n, 2) by ln(modulus), and by ln(stiffness) times `fit.OF_STIFFNESS`
    pressures: Array  #: (n,) kPa

    def model_covariance(self, other: "Effects", model: float, reach_kPa: float) -> Array:
        """(n, m) of the errors of the model in these numbers and in others."""
        apart = (self.pressures[:, None] - other.pressures) / reach_kPa
        return np.asarray(model**2 * np.exp(-0.5 * apart**2) * (self.by_model @ other.by_model.T))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Observed:
    """Measured numbers beside those of a rod, at some changes of what is unknown."""

    effects: Effects
    residual: Array  #: (n,) measured less rod
    units: tuple[str, ...]  #: (n,) mm, deg or N
    changes: Array  #: (k,) from what was expected
    stds: Array  #: (k,) of the changes, before the measurement

    @property
    def reach_kPa(self) -> float:
        """Distance of two pressures at which errors of the model differ."""
        return REACH * float(self.effects.pressures.max()) or 1.0

    @property
    def shifted(self) -> Array:
        """(n,) measured less what a rod without changes has, to first order."""
        return np.asarray(self.residual + self.effects.by_unknown @ self.changes)

    def noise(self, spread: Spread) -> Array:
        """(n, n) covariance of what is not explained by the unknowns."""
        scatter = np.diag([spread.scatter[unit] ** 2 for unit in self.units])
        return self.effects.model_covariance(self.effects, spread.model, self.reach_kPa) + scatter

    def prior(self, other: Effects) -> Array:
        """(n, m) covariance of the numbers and others because of the unknowns."""
        return np.asarray(self.effects.by_unknown * self.stds**2 @ other.by_unknown.T)


def choose_spread(observed: Observed, usual: Mapping[str, float]) -> Spread:
    """Scatter and error of the model by which rows of each pressure are foretold best from those of the others.

    usual: scatter by unit that is expected. One pressure says nothing of the error of the model, which stays as it is.
    """
    kinds = sorted(set(observed.units))

    def spread_of(logs: Array) -> Spread:
        sizes = {unit: usual[unit] * float(np.exp(log)) for unit, log in zip(kinds, logs[1:], strict=True)}
        return Spread(sizes, MODEL_ERROR * float(np.exp(logs[0])))

    def badness(logs: Array) -> float:
        before = (logs[0] / MODEL_ERROR_SPREAD) ** 2 + np.sum((logs[1:] / SCATTER_SPREAD) ** 2)
        return float(0.5 * before) - left_out_density(observed, spread_of(logs))

    start = np.vstack([np.zeros(1 + len(kinds)), np.eye(1 + len(kinds))])
    options = {"initial_simplex": start, "xatol": 0.02, "fatol": 0.02}
    found = minimize(badness, start[0], method="Nelder-Mead", options=options)
    return spread_of(found.x)


def left_out_density(observed: Observed, spread: Spread) -> float:
    """Logarithm of the probability density of the rows at each pressure, foretold from those at all others."""
    noise, prior = observed.noise(spread), observed.prior(observed.effects)
    total, z, density = noise + prior, observed.shifted, 0.0
    for pressure in np.unique(observed.effects.pressures):
        out = observed.effects.pressures == pressure
        rest = ~out
        foretold, covariance = np.zeros(int(out.sum())), total[np.ix_(out, out)]
        if rest.any():
            gain = _solved(total[np.ix_(rest, rest)], prior[np.ix_(rest, out)]).T
            foretold = gain @ z[rest]
            across = gain @ total[np.ix_(rest, out)]
            covariance = covariance - across - across.T + gain @ total[np.ix_(rest, rest)] @ gain.T
        density += _log_density(z[out] - foretold, covariance)
    return density


def _log_density(error: Array, covariance: Array) -> float:
    factor = cho_factor(covariance)
    logarithm = 2.0 * float(np.log(np.diag(factor[0])).sum())
    return -0.5 * (float(error @ cho_solve(factor, error)) + logarithm + len(error) * float(np.log(2.0 * np.pi)))


def _solved(matrix: Array, right: Array) -> Array:
    return np.asarray(cho_solve(cho_factor(matrix), right))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Posterior:
    """What is known of the unknowns after a measurement."""

    changes: Array  #: (k,) mean
    covariance: Array  #: (k, k)
    gain: Array  #: (k, n) by which measured numbers change the mean
    effects: Effects  #: of the numbers that were measured
    spread: Spread
    reach_kPa: float

    @staticmethod
    def of(observed: Observed, spread: Spread) -> "Posterior":
        """To first order about the changes of the numbers."""
        total = observed.noise(spread) + observed.prior(observed.effects)
        by_unknown = observed.effects.by_unknown * observed.stds**2  # (n, k)
        gain = _solved(total, by_unknown).T
        covariance = np.diag(observed.stds**2) - gain @ by_unknown
        covariance = 0.5 * (covariance + covariance.T)
        return Posterior(gain @ observed.shifted, covariance, gain, observed.effects, spread, observed.reach_kPa)

    @property
    def stds(self) -> Array:
        """(k,)"""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def correlation(self) -> Array:
        """(k, k)"""
        return np.asarray(self.covariance / np.outer(self.stds, self.stds))

    def error_covariance(self, effects: Effects) -> Array:
        """(m, m) of numbers of the arm less those of its rod with the mean of the unknowns, without scatter."""
        of_model = effects.model_covariance(effects, self.spread.model, self.reach_kPa)
        together = self.effects.model_covariance(effects, self.spread.model, self.reach_kPa)  # (n, m)
        across = effects.by_unknown @ self.gain @ together
        return np.asarray(effects.by_unknown @ self.covariance @ effects.by_unknown.T - across - across.T + of_model)
