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

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
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
        """The effects on all numbers of some parts."""
        return Effects(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Effects)))

    def of(self, chosen: Mask) -> "Effects":
        """The effects on some numbers, chosen (n,)."""
        return Effects(*(getattr(self, one.name)[chosen] for one in fields(self)))

    def model_covariance(self, other: "Effects", spread: Spread) -> Array:
        """(n, m) of the errors of the model in these numbers and in others."""
        apart = (self.pressures[:, None] - other.pressures) / spread.reach_kPa
        return np.asarray(spread.model**2 * np.exp(-0.5 * apart**2) * (self.by_model @ other.by_model.T))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Gaussian:
    """Unknowns before and after numbers were measured, which are linear in them about some changes of theirs."""

    effects: Effects  #: of the unknowns on the numbers, at the changes
    residual: Array  #: (n,) measured less rod, there
    units: tuple[str, ...]  #: (n,) mm, deg or N
    changes: Array  #: (k,) from what was expected
    stds_before: Array  #: (k,) of the changes
    spread: Spread

    @staticmethod
    def of(
        effects: Effects, residual: Array, units: tuple[str, ...], at: Array, stds: Array, usual: Mapping[str, float]
    ) -> "Gaussian":
        """At changes (k,), with the spread that foretells best; usual: scatter by unit that is expected."""
        reach = REACH * float(effects.pressures.max()) or 1.0
        return Gaussian(effects, residual, units, at, stds, Spread(usual, MODEL_ERROR, reach)).with_spread(usual)

    def with_spread(self, usual: Mapping[str, float]) -> "Gaussian":
        """With scatter and error of the model by which rows of each pressure are foretold best from all others.

        usual: scatter by unit that is expected. One pressure says nothing of the error of the model, which stays.
        """
        kinds = sorted(set(self.units))

        def with_sizes(logs: Array) -> "Gaussian":
            sizes = {unit: usual[unit] * float(np.exp(log)) for unit, log in zip(kinds, logs[1:], strict=True)}
            model = MODEL_ERROR * float(np.exp(logs[0]))
            return replace(self, spread=replace(self.spread, scatter=sizes, model=model))

        def badness(logs: Array) -> float:
            before = (logs[0] / MODEL_ERROR_SPREAD) ** 2 + np.sum((logs[1:] / SCATTER_SPREAD) ** 2)
            return float(0.5 * before) - with_sizes(logs).left_out_density

        start = np.vstack([np.zeros(1 + len(kinds)), np.eye(1 + len(kinds))])
        options = {"initial_simplex": start, "xatol": 0.02, "fatol": 0.02}
        return with_sizes(minimize(badness, start[0], method="Nelder-Mead", options=options).x)

    @property
    def left_out_density(self) -> float:
        """Logarithm of the probability density of the rows at each pressure, foretold from those at all others."""
        density = 0.0
        for pressure in np.unique(self.effects.pressures):
            is_out = self.effects.pressures == pressure
            out, known = self._some(is_out), self._some(~is_out)
            covariance = known.error_covariance(out.effects) + self.spread.scatter_of(out.units)
            factor, off = cho_factor(covariance), out._shifted - out.effects.by_unknown @ known.mean
            logarithm = 2.0 * float(np.log(np.diag(factor[0])).sum()) + len(off) * float(np.log(2.0 * np.pi))
            density -= 0.5 * (float(off @ cho_solve(factor, off)) + logarithm)
        return density

    def _some(self, chosen: Mask) -> "Gaussian":
        """With some of the numbers, chosen (n,)."""
        units = tuple(np.array(self.units)[chosen].tolist())
        return replace(self, effects=self.effects.of(chosen), residual=self.residual[chosen], units=units)

    @property
    def _shifted(self) -> Array:
        """(n,) measured less what a rod without changes has, to first order."""
        return np.asarray(self.residual + self.effects.by_unknown @ self.changes)

    @property
    def noise(self) -> Array:
        """(n, n) covariance of what is not explained by the unknowns."""
        return self.effects.model_covariance(self.effects, self.spread) + self.spread.scatter_of(self.units)

    @cached_property
    def gain(self) -> Array:
        """(k, n) by which measured numbers change the mean."""
        total = self.noise + self._by_std @ self.effects.by_unknown.T
        return np.asarray(cho_solve(cho_factor(total), self._by_std)).T

    @property
    def _by_std(self) -> Array:
        return np.asarray(self.effects.by_unknown * self.stds_before**2)  # (n, k)

    @property
    def mean(self) -> Array:
        """(k,) of the changes, after the measurement."""
        return np.asarray(self.gain @ self._shifted)

    @cached_property
    def covariance(self) -> Array:
        """(k, k) of the changes, after the measurement."""
        covariance = np.diag(self.stds_before**2) - self.gain @ self._by_std
        return np.asarray(0.5 * (covariance + covariance.T))

    @property
    def stds(self) -> Array:
        """(k,) of the changes, after the measurement."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def correlation(self) -> Array:
        """(k, k)"""
        return np.asarray(self.covariance / np.outer(self.stds, self.stds))

    @property
    def step(self) -> float:
        """From the changes to the mean, over its deviation (Mahalanobis); 0.1 at most where a fit has ended."""
        step = self.mean - self.changes
        return math.sqrt(step @ np.linalg.pinv(self.covariance, hermitian=True) @ step)

    @property
    def degrees(self) -> int:
        """Degrees of freedom of Student's distribution, one for each pressure: the error of the model is known from as
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
