"""Five parameters from two curvatures and a moment (paper, section 3).

Delta = kappa - kappa_0 at equal pressure and s, M(s) by equation (7). Two lines

    Delta(s) = a_i M(s) - b_i,    a_i = 1/alpha_i,    b_i = m0_i/alpha_i,    i = 1 for s < d, 2 beyond

are fitted by least squares (`regression`), in Delta, because curvature is what carries the errors. d minimises the
squares over a stated range.

Errors: the covariance of both curvatures, and the misfit. Where the residual is larger than the covariance explains
(the law is not exact), the excess is added as an error that is correlated within a cell. The intervals come from a
parametric bootstrap: refits to draws of that error around the fit. The effective number of observations is that of this
error, at least the number of cells: with white noise the number of points, with misfit alone the number of cells. The
single line for the whole rod has an error of its own (`single_line`).
"""

import math
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.curves.closure import Closure
from rod.curves.curve import Curvature, Moment
from rod.curves.uncertainty import Bootstrap, Interval, effective_observations, interval
from rod.errors import RodError
from rod.identification.observed import HARMONICS, Observed
from rod.identification.regression import MAX_RIGIDITY_RATIO, OFFSET, Fit, Regression, Resample
from rod.identification.single_line import LineFit, single_line
from rod.law import PARAMETER_NAMES, FiveParameters

#: range over the length in which the break d is sought
BREAKS = (0.05, 0.35)
#: lower end of that range over the pitch: nowhere below half a pitch, and on long arms, where BREAKS begins beyond the
#: first cell, 0.6 of it
MIN_BREAK, FIRST_CELL = 0.5, 0.6
#: breaks of the grid on which d is sought first
GRID_POINTS = 65
#: relative error of Delta at which a simpler law is as good as a richer one
NEGLIGIBLE_MISFIT = 0.02
#: difference of the criteria from which on they speak clearly for one of the two ("strong", Kass and Raftery 1995)
CLEAR = 6.0


@dataclass(frozen=True, kw_only=True)
class Identification:
    """The five parameters by regression with their intervals, and whether a single line suffices."""

    law: FiveParameters
    alpha1: Interval  #: N mm2
    alpha2: Interval  #: N mm2
    m01: Interval  #: N mm
    m02: Interval  #: N mm
    d: Interval  #: mm
    r2: float  #: fraction of the variance of Delta that the two lines explain, with the ripple within the cells
    single_line: LineFit
    observations: float  #: effective number of independent observations
    criterion_two_lines: float  #: Bayesian information criterion; the smaller one wins
    criterion_single_line: float
    d_given: bool = False  #: whether d was given and not sought; two lines are then wanted

    @property
    def two_lines(self) -> bool:
        """Whether two lines are worth their additional parameters, or wanted, because their d was given."""
        return self.d_given or self.evidence > 0.0

    @property
    def evidence(self) -> float:
        """For two lines, by the criterion: above zero they are worth their additional parameters."""
        return self.criterion_single_line - self.criterion_two_lines


def is_clear(evidence: float) -> bool:
    """Whether a difference of the criteria speaks clearly for a single line or for two, or the data leave it open."""
    return abs(evidence) >= CLEAR


def identify(
    kappa_0: Curvature,
    kappa: Curvature,
    moment: Moment,
    closure: Closure | None = None,
    *,
    d: float | None = None,
    bootstrap: Bootstrap = Bootstrap(),  # noqa: B008  a frozen value
) -> Identification:
    """The five parameters from the intrinsic and the loaded curvature and the moment of the loaded curve.

    Both curvatures come from the same estimator at the same points. closure: displacement of the end, which the
    parameters have to reproduce. d: mm, given instead of sought; it may be shorter than what the curvatures resolve,
    and the closure then decides on the first line.

    Raises `RodError` when the curvatures do not belong together, when the rod carries no moment, when the arm is too
    short (`observed.FEWEST_PITCHES`), when d leaves the rod, and when curvature falls where the moment grows.
    """
    observed = Observed.of(kappa_0, kappa, moment, closure)
    grid = _break_grid(observed) if d is None else _given(observed, d)
    single = single_line(observed, bootstrap)
    regression = _weighted_regression(observed, grid, MAX_RIGIDITY_RATIO * single.alpha.value)
    profile = [regression.bounded(d) for d in grid]
    best = profile[0] if len(grid) == 1 else regression.bounded(regression.refine(grid, profile))
    a1, b1, a2, b2 = best.parameters[:4]
    law = FiveParameters(1 / a1, 1 / a2, b1 / a1, b2 / a2, best.d or 0.0)
    resample = Resample.of(regression, best, bootstrap.draws, bootstrap.generator())
    sampled = _refit(regression.about(best), _candidates(grid, law.d), resample)
    cells = float(np.ptp(observed.s)) / observed.pitch + 1.0
    observations = max(effective_observations(regression.weights.error), cells)
    return Identification(
        law=law,
        **{n: interval(getattr(law, n), column) for n, column in zip(PARAMETER_NAMES, sampled.T, strict=True)},
        r2=observed.r_squared(best.fitted),
        single_line=single,
        observations=observations,
        criterion_two_lines=_criterion(observed, best, 5 if d is None else 4, observations),
        # the criterion compares two lines with one of the same weights, not with the one that is reported
        criterion_single_line=_criterion(observed, regression.solve(), 2, observations),
        d_given=d is not None,
    )


def shortest_break(length: float, pitch: float) -> float:
    """Lower end of the default range of d, mm: a d found there means "at most that"."""
    return max(min(BREAKS[0] * length, FIRST_CELL * pitch), MIN_BREAK * pitch)


def longest_break(length: float) -> float:
    """Upper end of the default range of d, mm: a d found there means "at least that"."""
    return BREAKS[1] * length


def _break_grid(observed: Observed) -> Array:
    """(GRID_POINTS,) breaks, mm."""
    low = shortest_break(observed.length, observed.pitch) / observed.length
    return np.linspace(low, BREAKS[1], GRID_POINTS) * observed.length


def _given(observed: Observed, d: float) -> Array:
    """(1,) the given break, mm."""
    if not 0.0 < d < observed.length:
        raise RodError(f"The break d = {d:g} mm lies off the rod of {observed.length:g} mm.")
    return np.array([float(d)])


def _weighted_regression(observed: Observed, grid: Array, max_rigidity: float) -> Regression:
    """Two lines with the weights that follow from the break where they fit best."""

    def best(trial: Regression) -> Fit:
        fits = [trial.solve(d) for d in grid]
        return fits[0] if len(fits) == 1 else trial.solve(trial.refine(grid, fits))

    regression = Regression.weighted(observed, observed.covariance, OFFSET, best)
    return Regression(observed, regression.weights, max_rigidity)


def _candidates(grid: Array, d: float) -> Array:
    """Breaks among which a refit chooses, mm: the grid, and finer ones near d; a given one alone."""
    if len(grid) == 1:
        return grid
    step = grid[1] - grid[0]
    near = np.clip(d + step * np.linspace(-2.0, 2.0, 41), grid[0], grid[-1])
    return np.union1d(near, grid)


def _refit(regression: Regression, candidates: Array, resample: Resample) -> Array:
    """(draws, 5): alpha1, alpha2, m01, m02, d of the best fit to every draw, with d among the candidates (m,)."""
    weight, count = regression.weights.data, resample.data.shape[1]
    right = np.vstack([weight * resample.data, resample.prior])
    least, best, d = np.full(count, np.inf), np.zeros((4 + 2 * HARMONICS, count)), np.zeros(count)
    for candidate in candidates:
        fit = regression.solve(candidate)
        parameters = fit.inverse @ right
        misfit = np.sum((weight * (resample.data - fit.matrix @ parameters)) ** 2, axis=0)
        squares = misfit + np.sum((fit.prior @ parameters - resample.prior) ** 2, axis=0)
        better = squares < least
        least[better], best[:, better], d[better] = squares[better], parameters[:, better], candidate
    a1, a2 = (np.maximum(best[i], 1.0 / regression.max_rigidity) for i in (0, 2))
    return np.column_stack([1.0 / a1, 1.0 / a2, best[1] / a1, best[3] / a2, d])


def _criterion(observed: Observed, fit: Fit, parameters: int, observations: float) -> float:
    """Bayesian information criterion; the variance of the error is one more parameter.

    The residual cannot be known better than the covariance of the curvatures, and a law need not be better than
    NEGLIGIBLE_MISFIT: rigidities that scatter by a few per cent along the arm are one rigidity.
    """
    noise = float(np.trace(observed.covariance)) / len(observed.s)
    floor = noise + NEGLIGIBLE_MISFIT**2 * float(np.mean(observed.delta**2))
    variance = max(observed.rms(fit.fitted) ** 2, floor)
    return observations * math.log(variance) + (parameters + 1) * math.log(observations)
