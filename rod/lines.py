"""Two straight lines through what an estimate of curvature has seen: the regression behind `identify`.

Unknown for a given break d: compliances a_i and offsets b_i of the lines Delta = a_i M - b_i, and two amplitudes of a
wiggle, Delta times (1 + w_c cos + w_s sin)(2 pi s/p), that a cell may add to its answer. Averaging over whole cells
removes the wiggle except where d cuts through a cell, and there it would pass for a slope.

Within one or two soft cells M changes little, so that slope and offset of the first line can be told apart only by
good data. Where they cannot, weak prior knowledge decides: an offset b_i of zero, within twice the largest Delta (a
secant of a curve through the origin), wiggles of zero within 0.1. Data that can tell outweigh it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import lsq_linear

from .curve import Curvature, Moment, fine_grid
from .law import RodError

Array = NDArray[np.float64]

#: prior standard deviation of an offset, over the largest Delta
OFFSET = 2.0
#: prior standard deviation of each amplitude of the wiggle within a cell
WIGGLE = 0.1
#: the stiffest line that is looked for, over the rigidity of one line for the whole rod
STIFFEST = 50.0


@dataclass(frozen=True)
class Seen:
    """Seen Delta, its error, and what the estimate sees of any piecewise law."""

    s: Array  #: (n,) mm
    delta: Array  #: (n,) 1/mm
    covariance: Array  #: (n, n)
    length: float  #: mm
    pitch: float  #: mm
    running: Array  #: (3, n, GRID_CELLS + 1, 2): integrals over sigma of R (M, -1), alone and times cos and sin

    @staticmethod
    def of(kappa_0: Curvature, kappa: Curvature, moment: Moment) -> Seen:
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
        if np.ptp(kappa.s) < 6.0 * kappa.pitch:
            raise RodError(
                f"Five numbers need seven cells; this curvature covers {np.ptp(kappa.s) / kappa.pitch + 1:.1f}."
            )
        grid = fine_grid(length)
        angle = 2.0 * np.pi * grid / kappa.pitch
        resolution = 0.5 * (kappa.resolution + kappa_0.resolution)
        lines = np.column_stack([CubicSpline(moment.s, moment.value)(grid), -np.ones(len(grid))])
        waves = np.stack([np.ones(len(grid)), np.cos(angle), np.sin(angle)])
        seen = resolution[None, :, :, None] * waves[:, None, :, None] * lines[None, None, :, :]
        running = np.concatenate([np.zeros((3, len(kappa.s), 1, 2)), np.cumsum(seen, axis=2)], axis=2)
        return Seen(
            kappa.s, kappa.kappa - kappa_0.kappa, kappa.covariance + kappa_0.covariance, length, kappa.pitch, running
        )

    def columns(self, d: float) -> Array:
        """(3, n, 4): seen Delta by a_1, b_1, a_2, b_2 for a break at d; alone, times cos, times sin."""
        place = d / self.length * (self.running.shape[2] - 1)
        left = min(int(place), self.running.shape[2] - 2)
        first = self.running[:, :, left] + (place - left) * (self.running[:, :, left + 1] - self.running[:, :, left])
        return np.concatenate([first, self.running[:, :, -1] - first], axis=2)

    @property
    def whole(self) -> Array:
        """(3, n, 2): the same for one line."""
        return self.running[:, :, -1]


@dataclass(frozen=True)
class Weights:
    """What one residual weighs against the prior knowledge."""

    data: float  #: square root of effective observations per point, over the residual's standard deviation
    offset: float  #: 1/mm, prior standard deviation of b_i


@dataclass(frozen=True)
class Fit:
    """Numbers a, b of each line and the two wiggles; all that sampling needs."""

    numbers: Array  #: (2 lines + 2,)
    fitted: Array  #: (n,)
    matrix: Array  #: (n, 2 lines + 2)
    solution: Array  #: (2 lines + 2, n + lines + 2): numbers from weighted data and prior draws
    objective: float  #: weighted squares, prior included


def solve(columns: Array, delta: Array, weights: Weights) -> Fit:
    """Best numbers for the columns (3, n, 2 lines) of `Seen.columns` or `Seen.whole`."""
    lines = columns.shape[2] // 2
    plain_rows = np.vstack([weights.data * columns[0], _prior(lines, weights)[:lines, :-2]])
    plain = np.linalg.lstsq(plain_rows, _right(weights, delta, lines), rcond=1e-13)[0]
    # the wiggle multiplies the lines as they are without it
    matrix = np.column_stack([columns[0], columns[1] @ plain, columns[2] @ plain])
    prior = _prior(lines, weights)
    solution = np.linalg.pinv(np.vstack([weights.data * matrix, prior]), rcond=1e-13)
    numbers = solution @ _right(weights, delta, len(prior))
    fitted = matrix @ numbers
    objective = float(np.sum((weights.data * (delta - fitted)) ** 2) + np.sum((prior @ numbers) ** 2))
    return Fit(numbers, fitted, matrix, solution, objective)


def stiffened(fit: Fit, delta: Array, weights: Weights, stiffest: float) -> Fit:
    """The same fit with compliances of at least 1/stiffest (N mm2), where the free fit goes below."""
    lines = (len(fit.numbers) - 2) // 2
    slopes = np.arange(0, 2 * lines, 2)
    if np.all(fit.numbers[slopes] >= 1.0 / stiffest):
        return fit
    low = np.full(len(fit.numbers), -np.inf)
    low[slopes] = 1.0 / stiffest
    prior = _prior(lines, weights)
    rows = np.vstack([weights.data * fit.matrix, prior])
    found = lsq_linear(rows, _right(weights, delta, len(prior)), bounds=(low, np.inf), method="bvls")
    return Fit(found.x, fit.matrix @ found.x, fit.matrix, fit.solution, 2.0 * float(found.cost))


def _prior(lines: int, weights: Weights) -> Array:
    """(lines + 2, 2 lines + 2): one row for each offset and each wiggle, over its standard deviation."""
    rows = np.zeros((lines + 2, 2 * lines + 2))
    rows[np.arange(lines), 2 * np.arange(lines) + 1] = 1.0 / weights.offset
    rows[[lines, lines + 1], [2 * lines, 2 * lines + 1]] = 1.0 / WIGGLE
    return rows


def _right(weights: Weights, delta: Array, priors: int) -> Array:
    return np.append(weights.data * delta, np.zeros(priors))
