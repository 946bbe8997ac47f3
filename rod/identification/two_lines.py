"""Five numbers from two curvatures and a moment (paper, section 3; design notes, "The five numbers").

Delta = kappa - kappa_0 at equal pressure and s, M(s) by equation (7). Two lines

    Delta(s) = a_i M(s) - b_i,    a_i = 1/alpha_i,    b_i = m0_i/alpha_i,    i = 1 for s < d, 2 beyond

are fitted in the least-squares sense, in Delta, because curvature is what carries the errors. What is compared with the
estimated Delta is not the line itself but what the estimate would have seen of it (`curve.Curvature.resolution`,
`lines`). d minimises the squares over a stated range; the profile over d is kept.

Errors: the covariance of both curvatures, and the misfit. Where the residual is larger than the covariance explains
(the law is not the whole truth), the excess is added as an error that neighbouring points within a cell share. The
intervals come from fits to draws of that error. The effective number of observations is that of this error, at least
the number of cells: with white noise the number of points, with misfit alone the number of cells. One line for the
whole rod has an error of its own (`single_line`).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from geometry.arrays import Array
from rod.curves.closure import Closure
from rod.curves.curve import Curvature, Moment
from rod.curves.uncertainty import Interval, effective_observations, interval, sample_errors
from rod.identification.regression import (
    HARMONICS,
    OFFSET,
    STIFFEST,
    Fit,
    Seen,
    Weights,
    explained,
    solve,
    stiffened,
    weighed,
)
from rod.identification.single_line import LineFit, single_line
from rod.law import FiveParameters, RodError

#: range of d over the length in which the break is looked for
BREAKS = (0.05, 0.35)
#: the same over the pitch: never nearer to the clamp than half a pitch, and on long arms, where a share of the length
#: is more than the first cell, from 0.6 of it
NEAREST, FIRST_CELL = 0.5, 0.6
PROFILE_POINTS = 65
DRAWS = 400
#: relative error of Delta with which a simpler law is as good as a richer one
GOOD_ENOUGH = 0.02


@dataclass(frozen=True)
class Identification:
    """The five numbers of one pressure, their errors, and whether one line would have done."""

    law: FiveParameters
    alpha1: Interval  #: N mm2
    alpha2: Interval  #: N mm2
    m01: Interval  #: N mm
    m02: Interval  #: N mm
    d: Interval  #: mm
    r2: float  #: of the two lines
    single_line: LineFit
    observations: float  #: effective number of independent observations
    criterion_two: float  #: Bayesian information criterion of two lines
    criterion_one: float  #: and of one; the smaller wins
    profile: Array  #: (n, 2) columns d (mm) and root-mean-square residual of Delta (1/mm)
    points: Array  #: (m, 4) columns s (mm), Delta (1/mm), fitted Delta (1/mm), M (N mm) as the estimate sees it

    @property
    def two_lines(self) -> bool:
        """Two lines are worth their three more numbers."""
        return self.criterion_two < self.criterion_one


def identify(
    kappa_0: Curvature,
    kappa: Curvature,
    moment: Moment,
    closing: Closure | None = None,
    *,
    breaks: tuple[float, float] | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> Identification:
    """The five numbers from the intrinsic and the loaded curvature and the moment of the loaded curve.

    Both curvatures come from the same estimator at the same points. closing: how far the end has moved, which the
    numbers have to add up to. breaks: range of d over the length, by default `default_breaks`.

    Raises `RodError` when the curvatures do not belong together, when the rod carries no moment, when there are fewer
    cells than numbers, when breaks leaves the rod, and when curvature falls where the moment grows.
    """
    seen = Seen.of(kappa_0, kappa, moment, closing)
    grid = _grid(seen, breaks)
    one = single_line(seen, draws, seed)
    stiffest = STIFFEST * one.alpha.value
    weights, error = _weights(seen, grid)
    profile = [stiffened(solve(seen.columns(d), seen.delta, weights), seen.delta, weights, stiffest) for d in grid]
    d = _refined(seen, weights, grid, np.array([fit.objective for fit in profile]))
    two = stiffened(solve(seen.columns(d), seen.delta, weights), seen.delta, weights, stiffest)
    law = FiveParameters(
        1 / two.numbers[0], 1 / two.numbers[2], two.numbers[1] / two.numbers[0], two.numbers[3] / two.numbers[2], d
    )
    random = np.random.default_rng(seed)
    sampled = _draws_two(seen, weights, grid, d, two, sample_errors(error, draws, random), random, stiffest)
    best = (law.alpha1, law.alpha2, law.m01, law.m02, law.d)
    alpha1, alpha2, m01, m02, place = (interval(v, c) for v, c in zip(best, sampled.T, strict=True))
    observations = max(effective_observations(error), float(np.ptp(seen.s)) / seen.pitch + 1.0)
    return Identification(
        law=law,
        alpha1=alpha1,
        alpha2=alpha2,
        m01=m01,
        m02=m02,
        d=place,
        r2=explained(seen, two),
        single_line=one,
        observations=observations,
        criterion_two=_criterion(seen, two, 5, observations),
        # two lines are held against one with their own weights, not against the one that is reported
        criterion_one=_criterion(seen, solve(seen.whole, seen.delta, weights), 2, observations),
        profile=np.column_stack([grid, [_rms(seen, fit) for fit in profile]]),
        points=np.column_stack([seen.s, seen.delta, two.fitted, seen.whole.seen[0, :, 0]]),
    )


def shortest_break(length: float, pitch: float) -> float:
    """Where the range of d begins where none is given, mm: a d found there means "at most that"."""
    return max(min(BREAKS[0] * length, FIRST_CELL * pitch), NEAREST * pitch)


def default_breaks(length: float, pitch: float) -> tuple[float, float]:
    """The range of d over the length for an arm with cells of `pitch`; the soft zone is a matter of the first cells."""
    return shortest_break(length, pitch) / length, BREAKS[1]


def _grid(seen: Seen, breaks: tuple[float, float] | None) -> Array:
    low, high = breaks or default_breaks(seen.length, seen.pitch)
    if not 0.0 < low < high < 1.0:
        raise RodError(
            f"The range of d over the length must rise and lie between 0 and 1; {low:g} ... {high:g} does not."
        )
    low = max(low, NEAREST * seen.pitch / seen.length)
    if low >= high:
        raise RodError(
            f"No d below {high:g} of the length can be told apart from the clamp with cells of {seen.pitch:g} mm."
        )
    return np.linspace(low, high, PROFILE_POINTS) * seen.length


def _rms(seen: Seen, fit: Fit) -> float:
    return float(np.sqrt(np.mean((seen.delta - fit.fitted) ** 2)))


def _weights(seen: Seen, grid: Array) -> tuple[Weights, Array]:
    """Weights of the data and covariance of their errors for two lines with the break where it fits best."""

    def best(eager: Weights) -> Fit:
        objective = np.array([solve(seen.columns(d), seen.delta, eager).objective for d in grid])
        return solve(seen.columns(_refined(seen, eager, grid, objective)), seen.delta, eager)

    return weighed(seen, seen.covariance, OFFSET, seen.closing, best)


def _refined(seen: Seen, weights: Weights, grid: Array, objective: Array) -> float:
    """d between the neighbours of the best grid point."""
    best = int(np.argmin(objective))
    bounds = (grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)])
    found = minimize_scalar(
        lambda d: solve(seen.columns(d), seen.delta, weights).objective,
        bounds=bounds,
        method="bounded",
        options={"xatol": 1e-7 * seen.length},
    )
    return float(found.x) if found.fun < objective[best] else float(grid[best])


def _rows(weights: Weights, drawn: Array, fit: Fit, random: np.random.Generator) -> Array:
    """Right-hand sides: weighted data above, draws of what is known around what the fit has of it below."""
    closed = np.zeros((len(fit.known), 1))
    closed[-1] = fit.known[-1] @ fit.numbers
    return np.vstack([weights.data * drawn, closed + random.standard_normal((len(closed), drawn.shape[1]))])


def _draws_two(
    seen: Seen,
    weights: Weights,
    grid: Array,
    place: float,
    best_fit: Fit,
    error: Array,
    random: np.random.Generator,
    stiffest: float,
) -> Array:
    """(draws, 5): alpha1, alpha2, m01, m02, d of fits to the fitted Delta plus drawn errors."""
    fitted = best_fit.fitted
    drawn = fitted[:, None] + error
    right = _rows(weights, drawn, best_fit, random)
    count = drawn.shape[1]
    best, numbers, places = np.full(count, np.inf), np.zeros((4 + 2 * HARMONICS, count)), np.zeros(count)
    step = grid[1] - grid[0]
    near = np.clip(place + step * np.linspace(-2.0, 2.0, 41), grid[0], grid[-1])
    for d in np.union1d(near, grid):
        fit = solve(seen.columns(d), fitted, weights)
        solved = fit.solution @ right
        known = fit.known @ solved - right[len(drawn) :]
        squares = np.sum((weights.data * (drawn - fit.matrix @ solved)) ** 2, axis=0) + np.sum(known**2, axis=0)
        better = squares < best
        best[better], numbers[:, better], places[better] = squares[better], solved[:, better], d
    a1, a2 = (np.maximum(numbers[i], 1.0 / stiffest) for i in (0, 2))
    return np.column_stack([1.0 / a1, 1.0 / a2, numbers[1] / a1, numbers[3] / a2, places])


def _criterion(seen: Seen, fit: Fit, numbers: int, observations: float) -> float:
    """Bayesian information criterion; the variance of the error is one more number.

    The residual cannot be known better than the covariance of the curvatures, and a law need not be better than
    GOOD_ENOUGH: rigidities that spread by some per cent along the arm are one rigidity.
    """
    floor = float(np.trace(seen.covariance)) / len(seen.s) + GOOD_ENOUGH**2 * float(np.mean(seen.delta**2))
    variance = max(_rms(seen, fit) ** 2, floor)
    return observations * math.log(variance) + (numbers + 1) * math.log(observations)
