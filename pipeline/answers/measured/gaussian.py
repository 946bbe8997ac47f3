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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import final

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize
from scipy.stats import t

from geometry.arrays import Array, Mask

#: distance of two pressures at which errors of the model differ, over the highest pressure
REACH = 0.5
#: error of the model and its scatter in logarithms before anything is known, and that of the scatter
MODEL_ERROR, MODEL_ERROR_SPREAD, SCATTER_SPREAD = 0.06, 0.8, 0.7
#: part of all measurements within an interval
WITHIN = 0.90


@final
@dataclass(frozen=True)
class Spread:
    """How far measured numbers lie from those of a rod."""

    scatter: Mapping[str, float]  #: standard deviation by unit: mm, deg, N
    model: float  #: standard deviation of a and b
    reach_kPa: float  #: distance of two pressures at which these differ

    def scatter_of(self, units: Sequence[str]) -> Array:
        """(n, n) covariance of the scatter of numbers with units (n,); nothing for a unit that was not measured."""
        return np.diag([self.scatter.get(unit, 0.0) ** 2 for unit in units])


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Effects:
    """How numbers (n,) change at some state of an arm."""

    by_unknown: Array  #: (n, k)
    by_model: Array  #: (n, 2) by ln(modulus), and by ln(stiffness) times `fit.OF_STIFFNESS`
    pressures: Array  #: (n,) kPa

    @staticmethod
    def joined(parts: Sequence["Effects"]) -> "Effects":
        """Those of all numbers of some parts."""
        return Effects(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Effects)))

    def of(self, chosen: Mask) -> "Effects":
        """Those of some numbers, chosen (n,)."""
        return Effects(*(getattr(self, one.name)[chosen] for one in fields(self)))

    def model_covariance(self, other: "Effects", spread: Spread) -> Array:
        """(n, m) of the errors of the model in these numbers and in others."""
        apart = (self.pressures[:, None] - other.pressures) / spread.reach_kPa
        return np.asarray(spread.model**2 * np.exp(-0.5 * apart**2) * (self.by_model @ other.by_model.T))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Observed:
    """Measured numbers beside those of a rod, at some changes of what is unknown."""

    effects: Effects
    residual: Array  #: (n,) measured less rod
    units: tuple[str, ...]  #: (n,) mm, deg or N
    changes: Array  #: (k,) from what was expected
    stds: Array  #: (k,) of the changes, before the measurement

    def of(self, chosen: Mask) -> "Observed":
        """Some of the numbers, chosen (n,)."""
        units = tuple(np.array(self.units)[chosen].tolist())
        return replace(self, effects=self.effects.of(chosen), residual=self.residual[chosen], units=units)

    @property
    def shifted(self) -> Array:
        """(n,) measured less what a rod without changes has, to first order."""
        return np.asarray(self.residual + self.effects.by_unknown @ self.changes)

    def noise(self, spread: Spread) -> Array:
        """(n, n) covariance of what is not explained by the unknowns."""
        return self.effects.model_covariance(self.effects, spread) + spread.scatter_of(self.units)


def choose_spread(observed: Observed, usual: Mapping[str, float]) -> Spread:
    """Scatter and error of the model by which rows of each pressure are foretold best from those of the others.

    usual: scatter by unit that is expected. One pressure says nothing of the error of the model, which stays as it is.
    """
    kinds, reach = sorted(set(observed.units)), REACH * float(observed.effects.pressures.max()) or 1.0

    def spread_of(logs: Array) -> Spread:
        sizes = {unit: usual[unit] * float(np.exp(log)) for unit, log in zip(kinds, logs[1:], strict=True)}
        return Spread(sizes, MODEL_ERROR * float(np.exp(logs[0])), reach)

    def badness(logs: Array) -> float:
        before = (logs[0] / MODEL_ERROR_SPREAD) ** 2 + np.sum((logs[1:] / SCATTER_SPREAD) ** 2)
        return float(0.5 * before) - left_out_density(observed, spread_of(logs))

    start = np.vstack([np.zeros(1 + len(kinds)), np.eye(1 + len(kinds))])
    options = {"initial_simplex": start, "xatol": 0.02, "fatol": 0.02}
    found = minimize(badness, start[0], method="Nelder-Mead", options=options)
    return spread_of(found.x)


def left_out_density(observed: Observed, spread: Spread) -> float:
    """Logarithm of the probability density of the rows at each pressure, foretold from those at all others."""
    density = 0.0
    for pressure in np.unique(observed.effects.pressures):
        is_out = observed.effects.pressures == pressure
        out, known = observed.of(is_out), Posterior.of(observed.of(~is_out), spread)
        covariance = known.error_covariance(out.effects) + spread.scatter_of(out.units)
        factor, off = cho_factor(covariance), out.shifted - out.effects.by_unknown @ known.changes
        logarithm = 2.0 * float(np.log(np.diag(factor[0])).sum()) + len(off) * float(np.log(2.0 * np.pi))
        density -= 0.5 * (float(off @ cho_solve(factor, off)) + logarithm)
    return density


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Posterior:
    """What is known of the unknowns after a measurement."""

    changes: Array  #: (k,) mean
    covariance: Array  #: (k, k)
    gain: Array  #: (k, n) by which measured numbers change the mean
    effects: Effects  #: of the numbers that were measured
    spread: Spread

    @staticmethod
    def of(observed: Observed, spread: Spread) -> "Posterior":
        """To first order about the changes of the numbers."""
        by_unknown = observed.effects.by_unknown * observed.stds**2  # (n, k)
        total = observed.noise(spread) + by_unknown @ observed.effects.by_unknown.T
        gain = np.asarray(cho_solve(cho_factor(total), by_unknown)).T
        covariance = np.diag(observed.stds**2) - gain @ by_unknown
        return Posterior(gain @ observed.shifted, 0.5 * (covariance + covariance.T), gain, observed.effects, spread)

    @property
    def stds(self) -> Array:
        """(k,)"""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def correlation(self) -> Array:
        """(k, k)"""
        return np.asarray(self.covariance / np.outer(self.stds, self.stds))

    @property
    def degrees(self) -> int:
        """Of freedom of Student's distribution, a degree for each pressure: the error of the model is known from as
        many errors."""
        return max(1, len(np.unique(self.effects.pressures)))

    @property
    def quantile(self) -> float:
        """Half the width of an interval that holds `WITHIN`, over the deviation."""
        return float(t.ppf(0.5 + 0.5 * WITHIN, self.degrees))

    def error_covariance(self, effects: Effects) -> Array:
        """(m, m) of numbers of the arm less those of its rod with the mean of the unknowns, without scatter."""
        of_model = effects.model_covariance(effects, self.spread)
        across = effects.by_unknown @ self.gain @ self.effects.model_covariance(effects, self.spread)
        return np.asarray(effects.by_unknown @ self.covariance @ effects.by_unknown.T - across - across.T + of_model)

    def deviations(self, effects: Effects, units: Sequence[str] = ()) -> Array:
        """(m,) standard deviations of the same; with the scatter of a reading where units (m,) are given."""
        variance = np.diag(self.error_covariance(effects) + (self.spread.scatter_of(units) if units else 0.0))
        return np.sqrt(np.maximum(variance, 0.0))
