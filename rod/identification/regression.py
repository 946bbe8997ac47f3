"""The regression behind `identify`: one or two straight lines through observed Delta, with a prior.

Parameters for a given break d: compliances a_i and offsets b_i of the lines Delta = a_i M - b_i, and the amplitudes of
a ripple, Delta times (1 + sum of c_k harmonic_k(s)), by which the response of a cell may vary within it. Averaging over
whole cells removes the ripple except where d cuts through a cell; there it would be taken for a slope.

Prior: within one soft cell M changes little, so that slope and offset of the first line can hardly be told apart, and a
free offset follows the errors there (it then fits the curve and fails on the next load by up to 28 % of the force). A
section without moment does not bend: offsets belong to secants of a curve through the origin. Hence offsets b_i of zero
within OFFSET of the largest Delta and ripple amplitudes of zero within RIPPLE, as standard deviations. Informative data
outweigh them.

Closure condition: one more row demands that the lines add up to the observed displacement of the end (`rod.curves.
closure`). It involves the lines alone, for a rod has no ripple.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear, minimize_scalar

from geometry.arrays import Array
from rod.curves.uncertainty import effective_observations, sample_errors, total_covariance
from rod.identification.observed import HARMONICS, DesignMatrix, Observed

#: prior standard deviation of an offset, over the largest Delta
OFFSET = 0.15
#: prior standard deviation of each amplitude of the ripple within a cell: gaps bend, chambers hardly do
RIPPLE = 0.7
#: relative standard deviation of Delta below which no misfit is resolved
RESOLUTION_OF_DELTA = 1e-5
#: largest rigidity of a line, over that of a single line for the whole rod
MAX_RIGIDITY_RATIO = 50.0


@dataclass(frozen=True)
class Weights:
    """What the data weigh against the prior, and the errors from which that follows."""

    data: float  #: mm, square root of the effective observations per point, over the standard deviation of the error
    offset: float  #: 1/mm, prior standard deviation of b_i
    error: Array  #: (n, n) 1/mm2, covariance of the error of Delta: noise, and misfit that it does not explain


@dataclass(frozen=True)
class Fit:
    """Parameters a, b of each line and the ripple amplitudes, p = 2 lines + 2 HARMONICS; and how they follow."""

    d: float | None  #: mm, break; None for a single line
    parameters: Array  #: (p,)
    fitted: Array  #: (n,) 1/mm, Delta
    matrix: Array  #: (n, p), fitted by parameters
    prior: Array  #: (k, p): rows of offsets, ripple amplitudes and the closure, each over its standard deviation
    inverse: Array  #: (p, n + k): parameters from weighted data and prior
    objective: float  #: weighted sum of squares, prior included


@dataclass(frozen=True)
class Regression:
    """Least squares for one or two lines through observed data with given weights."""

    observed: Observed
    weights: Weights
    max_rigidity: float = math.inf  #: N mm2, of `bounded`

    @staticmethod
    def weighted(
        observed: Observed, noise: Array, offset: float, trial_fit: Callable[["Regression"], Fit]
    ) -> "Regression":
        """The regression whose weights follow from the residual of a trial fit that hardly feels the prior.

        noise (n, n): covariance of the noise of Delta; offset: prior standard deviation over the largest Delta;
        trial_fit: the best fit of the law by a regression. What the law cannot explain counts as an error.
        """
        offset *= float(np.abs(observed.delta).max())
        least = RESOLUTION_OF_DELTA * math.sqrt(float(np.mean(observed.delta**2)))
        fit = trial_fit(Regression(observed, Weights(1.0 / least, offset, noise)))
        # of a misfit: high within a cell, none beyond a few
        correlation = np.exp(-2.0 * ((observed.s[:, None] - observed.s[None, :]) / observed.pitch) ** 2)
        error = total_covariance(observed.delta - fit.fitted, fit.matrix, noise, correlation, least)
        deviation = math.sqrt(float(np.trace(error)) / len(observed.s))
        data = math.sqrt(effective_observations(error) / len(observed.s)) / deviation
        return Regression(observed, Weights(data, offset, error))

    def solve(self, d: float | None = None) -> Fit:
        """The best two lines with the break at d (mm); the best single line without d."""
        delta, weight = self.observed.delta, self.weights.data
        design = self.observed.single_line if d is None else self.observed.two_lines(d)
        prior = self._prior(design)
        count = len(design.closure)
        prior_of_lines = np.delete(prior, slice(count // 2, -1), axis=0)[:, :count]
        rows = np.vstack([weight * design.data[0], prior_of_lines])
        lines = np.linalg.lstsq(rows, self._right(len(prior_of_lines)), rcond=1e-13)[0]
        # the ripple multiplies the lines as they are without it
        matrix = np.column_stack([design.data[0], *(design.data[1:] @ lines)])
        inverse = np.linalg.pinv(np.vstack([weight * matrix, prior]), rcond=1e-13)
        right = self._right(len(prior))
        parameters = inverse @ right
        fitted = matrix @ parameters
        squares = np.sum((weight * (delta - fitted)) ** 2) + np.sum((prior @ parameters - right[len(delta) :]) ** 2)
        return Fit(d, parameters, fitted, matrix, prior, inverse, float(squares))

    def bounded(self, d: float) -> Fit:
        """The fit of `solve` for two lines, with rigidities of at most `max_rigidity` where the free fit exceeds it."""
        fit, slopes, least = self.solve(d), [0, 2], 1.0 / self.max_rigidity
        if np.all(fit.parameters[slopes] >= least):
            return fit
        low = np.full(len(fit.parameters), -np.inf)
        low[slopes] = least
        rows = np.vstack([self.weights.data * fit.matrix, fit.prior])
        bounded = lsq_linear(rows, self._right(len(fit.prior)), bounds=(low, np.inf), method="bvls")
        return replace(fit, parameters=bounded.x, fitted=fit.matrix @ bounded.x, objective=2.0 * float(bounded.cost))

    def refine(self, grid: Array, profile: Sequence[Fit]) -> float:
        """The best break (mm) between the neighbours of the best of the fits on the grid (m,) of breaks."""
        objective = [fit.objective for fit in profile]
        best = int(np.argmin(objective))
        bounds = (grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)])
        refined = minimize_scalar(
            lambda d: self.solve(d).objective,
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-7 * self.observed.length},
        )
        return float(refined.x) if refined.fun < objective[best] else float(grid[best])

    def about(self, fit: Fit) -> "Regression":
        """The regression with the fitted Delta for its data: what a parametric bootstrap draws around."""
        return replace(self, observed=replace(self.observed, delta=fit.fitted))

    def _prior(self, design: DesignMatrix) -> Array:
        """(lines + 2 HARMONICS + 1, 2 lines + 2 HARMONICS): rows of the offsets, the ripple and the closure."""
        count = len(design.closure)
        lines = count // 2
        rows = np.zeros((lines + 2 * HARMONICS + 1, count + 2 * HARMONICS))
        rows[np.arange(lines), 2 * np.arange(lines) + 1] = 1.0 / self.weights.offset
        rows[lines:-1, count:] = np.eye(2 * HARMONICS) / RIPPLE
        rows[-1, :count] = design.closure
        return rows

    def _right(self, prior_rows: int) -> Array:
        """(n + prior_rows,) right-hand side: weighted data, then offsets and ripple of zero, then the closure."""
        return np.concatenate(
            [self.weights.data * self.observed.delta, np.zeros(prior_rows - 1), [self.observed.closure]]
        )


@dataclass(frozen=True)
class Resample:
    """Right-hand sides of a parametric bootstrap, one column per draw."""

    data: Array  #: (n, draws) 1/mm: fitted Delta plus drawn errors
    prior: Array  #: (k, draws): rows of the prior, drawn around zero; the closure around its fitted value

    @staticmethod
    def of(regression: Regression, fit: Fit, draws: int, random: np.random.Generator) -> "Resample":
        """Draws of the errors of the data, then of the prior."""
        data = fit.fitted[:, None] + sample_errors(regression.weights.error, draws, random)
        mean = np.zeros((len(fit.prior), 1))
        mean[-1] = fit.prior[-1] @ fit.parameters
        return Resample(data, mean + random.standard_normal((len(mean), draws)))
