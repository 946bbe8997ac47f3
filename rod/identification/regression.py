"""Two straight lines through what an estimate of curvature has seen: the regression behind `identify`.

Unknown for a given break d: compliances a_i and offsets b_i of the lines Delta = a_i M - b_i, and two amplitudes of a
wiggle, Delta times (1 + w_c cos + w_s sin)(2 pi s/p), that a cell may add to its answer. Averaging over whole cells
removes the wiggle except where d cuts through a cell, and there it would pass for a slope.

Within one soft cell M changes little, so that slope and offset of the first line can hardly be told apart. A free
offset follows the errors there: measured on design (a), it brings alpha_1 to 40-50 N mm2, fits the curve it is fitted
to, and errs by up to 28 % in the force of the next load. What is known beforehand is that a section without moment
does not bend: offsets are secants of a curve through the origin. Hence the prior knowledge: offsets b_i of zero within
0.15 of the largest Delta, wiggles of zero within 0.7. Data that can tell outweigh it.

One more row closes the curve (`closing`): what the lines add up to at the end must be how far the end has moved. It is
about the lines alone, as a rod without wiggles has them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import lsq_linear

from geometry.arrays import Array
from rod.curves.closure import Closure
from rod.curves.curve import Curvature, Moment, fine_grid
from rod.curves.uncertainty import effective_observations, misfit_correlation, total_covariance, white_noise
from rod.law import RodError

#: prior standard deviation of an offset, over the largest Delta
OFFSET = 0.15
#: prior standard deviation of each amplitude of the wiggle within a cell: gaps bend, chambers hardly do
RIPPLE = 0.7
#: harmonics of the pitch that the wiggle has
HARMONICS = 2
#: relative error of Delta below which nothing is believed
RESOLUTION_OF_DELTA = 1e-5
#: the stiffest line that is looked for, over the rigidity of one line for the whole rod
STIFFEST = 50.0


def harmonics(s: Array, pitch: float) -> list[Array]:
    """cos and sin of every harmonic of the pitch at s, 2 HARMONICS arrays of the shape of s."""
    angles = [2.0 * np.pi * (k + 1) * s / pitch for k in range(HARMONICS)]
    return [f(angle) for angle in angles for f in (np.cos, np.sin)]


#: share of the moment's range that may be run through backwards
REVERSAL = 0.05


@dataclass(frozen=True)
class Seen:
    """Seen Delta, its error, and what the estimate sees of any piecewise law."""

    s: Array  #: (n,) mm
    delta: Array  #: (n,) 1/mm
    covariance: Array  #: (n, n) of Delta, as if both curvatures had their errors each for itself
    noise: Array  #: (n, n) where nodes make it, from Delta alone: what is rough in both curves alike is no error of it
    length: float  #: mm
    pitch: float  #: mm
    running: Array  #: (1 + 2 HARMONICS, n, GRID_CELLS + 1, 2): integrals over sigma of R (M, -1), alone and times waves
    closing: float  #: how far the end has moved, over the error of that; 0 where it is not known
    closing_running: (
        Array  #: (GRID_CELLS + 1, 2): integrals over sigma of the closing's weights times (M, -1), likewise
    )

    @staticmethod
    def of(kappa_0: Curvature, kappa: Curvature, moment: Moment, closing: Closure | None) -> "Seen":
        """What belongs together, checked. Of both resolutions the mean is right to second order in Delta."""
        if kappa_0.s.shape != kappa.s.shape or np.max(np.abs(kappa_0.s - kappa.s)) > 1e-6 * kappa.length:
            raise RodError("The intrinsic and the loaded curvature must be given at the same points of the same curve.")
        length = kappa.length
        if abs(moment.s[-1] - length) > 1e-6 * length:
            raise RodError(
                f"The moment is that of a curve of {moment.s[-1]:g} mm, the curvature of one of {length:g} mm."
            )
        if np.ptp(moment.value) == 0.0:
            raise RodError("The rod carries no moment, or the same everywhere; a rigidity cannot be read from it.")
        _check_monotone(moment)
        if np.ptp(kappa.s) < 5.0 * kappa.pitch:
            raise RodError(
                f"Five numbers need six cells; this curvature covers {np.ptp(kappa.s) / kappa.pitch + 1:.1f}."
            )
        grid, delta = fine_grid(length), kappa.kappa - kappa_0.kappa
        resolution = 0.5 * (kappa.resolution + kappa_0.resolution)
        lines = np.column_stack([CubicSpline(moment.s, moment.value)(grid), -np.ones(len(grid))])
        inside = np.stack([np.ones(len(grid)), *harmonics(grid, kappa.pitch)])
        seen = resolution[None, :, :, None] * inside[:, None, :, None] * lines[None, None, :, :]
        closes = np.zeros_like(lines) if closing is None else closing.weights[:, None] * lines / closing.error
        covariance = kappa.covariance + kappa_0.covariance
        return Seen(
            kappa.s,
            delta,
            covariance,
            covariance if kappa.response is None else white_noise(kappa.response, delta),
            length,
            kappa.pitch,
            _running(seen, 2),
            0.0 if closing is None else closing.value / closing.error,
            _running(closes, 0),
        )

    def columns(self, d: float) -> "Columns":
        """What a_1, b_1, a_2, b_2 bring for a break at d."""
        return Columns(_parted(self.running, 2, d / self.length), _parted(self.closing_running, 0, d / self.length))

    @property
    def whole(self) -> "Columns":
        """The same for one line."""
        return Columns(self.running[:, :, -1], self.closing_running[-1])


@dataclass(frozen=True)
class Columns:
    """What the numbers of one or two lines bring."""

    seen: Array  #: (1 + 2 HARMONICS, n, 2 lines): seen Delta by every number, alone and times every wave
    closing: Array  #: (2 lines,): movement of the end by every number, over its error


def _running(parts: Array, axis: int) -> Array:
    """Sums from the clamp on along the grid on `axis`, from zero."""
    return np.concatenate([np.zeros_like(parts.take([0], axis)), np.cumsum(parts, axis)], axis)


def _parted(running: Array, axis: int, share: float) -> Array:
    """Columns before and beyond a place (over the length) side by side."""
    place = share * (running.shape[axis] - 1)
    left = min(int(place), running.shape[axis] - 2)
    before, behind = running.take(left, axis), running.take(left + 1, axis)
    first = before + (place - left) * (behind - before)
    return np.concatenate([first, running.take(-1, axis) - first], -1)


def _check_monotone(moment: Moment) -> None:
    """Refuse a moment that rises and falls along the curve: then soft and stiff places cannot be told by their load."""
    steps = np.diff(moment.value) * np.sign(moment.value[-1] - moment.value[0])
    back = np.minimum(steps, 0.0)
    if -back.sum() > REVERSAL * np.ptp(moment.value):
        where = moment.s[:-1][back < 0.0]
        raise RodError(
            f"The moment does not fall steadily from one end to the other: it turns back between s = {where[0]:.3g} "
            f"and {where[-1]:.3g} mm; take a load that bends the whole arm one way."
        )


@dataclass(frozen=True)
class Weights:
    """What one residual weighs against the prior knowledge."""

    data: float  #: square root of effective observations per point, over the residual's standard deviation
    offset: float  #: 1/mm, prior standard deviation of b_i
    closing: float  #: how far the end has moved, over the error of that; 0 where it is not known


def weighed(
    seen: Seen, covariance: Array, offset: float, closing: float, best: Callable[[Weights], "Fit"]
) -> tuple[Weights, Array]:
    """Weights of the data and covariance of their errors for a law, from its best fit with next to no prior knowledge.

    covariance (n, n): of the noise; offset: over the largest Delta; closing: as in `Weights`. What the law cannot
    explain counts as an error.
    """
    offset *= float(np.abs(seen.delta).max())
    least = RESOLUTION_OF_DELTA * math.sqrt(float(np.mean(seen.delta**2)))
    fit = best(Weights(1.0 / least, offset, closing))
    error = total_covariance(
        seen.delta - fit.fitted, fit.matrix, covariance, misfit_correlation(seen.pitch, seen.s), least
    )
    deviation = math.sqrt(float(np.trace(error)) / len(seen.s))
    return Weights(math.sqrt(effective_observations(error) / len(seen.s)) / deviation, offset, closing), error


@dataclass(frozen=True)
class Fit:
    """Numbers a, b of each line and the wiggles; all that sampling needs."""

    numbers: Array  #: (2 lines + 2 HARMONICS,)
    fitted: Array  #: (n,)
    matrix: Array  #: (n, 2 lines + 2 HARMONICS)
    known: Array  #: (k, 2 lines + 2 HARMONICS): rows of offsets, wiggles and the closing, each over its deviation
    solution: Array  #: (2 lines + 2 HARMONICS, n + k): numbers from weighted data and what is known
    objective: float  #: weighted squares, what is known included


def solve(columns: Columns, delta: Array, weights: Weights) -> Fit:
    """Best numbers for the columns of `Seen.columns` or `Seen.whole`."""
    seen = columns.seen
    count = seen.shape[2]
    known = _known(columns, weights)
    bare = np.delete(known, slice(count // 2, -1), axis=0)[:, :count]
    plain_rows = np.vstack([weights.data * seen[0], bare])
    plain = np.linalg.lstsq(plain_rows, _right(weights, delta, len(bare)), rcond=1e-13)[0]
    # the wiggle multiplies the lines as they are without it
    matrix = np.column_stack([seen[0], *(seen[1:] @ plain)])
    solution = np.linalg.pinv(np.vstack([weights.data * matrix, known]), rcond=1e-13)
    right = _right(weights, delta, len(known))
    numbers = solution @ right
    fitted = matrix @ numbers
    objective = np.sum((weights.data * (delta - fitted)) ** 2) + np.sum((known @ numbers - right[len(delta) :]) ** 2)
    return Fit(numbers, fitted, matrix, known, solution, float(objective))


def stiffened(fit: Fit, delta: Array, weights: Weights, stiffest: float) -> Fit:
    """The same fit with compliances of at least 1/stiffest (N mm2), where the free fit goes below."""
    lines = (len(fit.numbers) - 2 * HARMONICS) // 2
    slopes = np.arange(0, 2 * lines, 2)
    if np.all(fit.numbers[slopes] >= 1.0 / stiffest):
        return fit
    low = np.full(len(fit.numbers), -np.inf)
    low[slopes] = 1.0 / stiffest
    rows = np.vstack([weights.data * fit.matrix, fit.known])
    found = lsq_linear(rows, _right(weights, delta, len(fit.known)), bounds=(low, np.inf), method="bvls")
    return replace(fit, numbers=found.x, fitted=fit.matrix @ found.x, objective=2.0 * float(found.cost))


def explained(seen: Seen, fit: Fit) -> float:
    """Share of the variance of Delta that a fit explains."""
    return 1.0 - float(np.sum((seen.delta - fit.fitted) ** 2) / np.sum((seen.delta - seen.delta.mean()) ** 2))


def _known(columns: Columns, weights: Weights) -> Array:
    """(lines + 2 HARMONICS + 1, 2 lines + 2 HARMONICS): a row for each offset, each wiggle and the closing."""
    count = len(columns.closing)
    lines = count // 2
    rows = np.zeros((lines + 2 * HARMONICS + 1, count + 2 * HARMONICS))
    rows[np.arange(lines), 2 * np.arange(lines) + 1] = 1.0 / weights.offset
    rows[lines:-1, count:] = np.eye(2 * HARMONICS) / RIPPLE
    rows[-1, :count] = columns.closing
    return rows


def _right(weights: Weights, delta: Array, known: int) -> Array:
    """Weighted data, then what is known: offsets and wiggles of zero, and the closing."""
    return np.concatenate([weights.data * delta, np.zeros(known - 1), [weights.closing]])
