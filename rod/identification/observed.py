"""The data of the regression: observed Delta with its errors, and what any piecewise law contributes to it.

A law is not compared with the estimated Delta directly but with what the estimate resolves of the law
(`Curvature.resolution`). For two lines Delta = a_i M - b_i that is linear in the compliances a_i and the offsets b_i,
with coefficients that are integrals along the arm up to the break and beyond it. Cumulative integrals on the fine grid
give the design matrix for every break d by differences.
"""

from dataclasses import dataclass, replace
from math import floor

import numpy as np
from scipy.interpolate import CubicSpline

from geometry.arrays import Array
from rod.curves.closure import Closure
from rod.curves.curve import Curvature, Moment, fine_grid
from rod.curves.uncertainty import white_noise
from rod.errors import RodError

#: harmonics of the pitch in the ripple of Delta within the cells
HARMONICS = 2
#: fraction of the moment's range that may be run through backwards
REVERSAL = 0.05
#: length over the pitch that five parameters need: six averages over different cells, the first of which ends one pitch
#: from the clamp, and the last half a pitch before the end
FEWEST_PITCHES = 6.5


def harmonics(s: Array, pitch: float) -> list[Array]:
    """cos and sin of every harmonic of the pitch (mm) at s (mm): 2 HARMONICS arrays of the shape of s."""
    angles = [2.0 * np.pi * (k + 1) * s / pitch for k in range(HARMONICS)]
    return [f(angle) for angle in angles for f in (np.cos, np.sin)]


@dataclass(frozen=True)
class DesignMatrix:
    """What the parameters a, b of one or two lines contribute, one column per parameter (a_1, b_1, a_2, b_2)."""

    data: Array  #: (1 + 2 HARMONICS, n, 2 lines): observed Delta by every parameter, alone and times every harmonic
    closure: Array  #: (2 lines,): displacement of the end by every parameter, over its standard deviation


@dataclass(frozen=True)
class Observed:
    """Observed Delta = kappa - kappa_0, its errors, and the integrals from which design matrices follow."""

    s: Array  #: (n,) mm
    delta: Array  #: (n,) 1/mm
    covariance: Array  #: (n, n) 1/mm2, of Delta, as if both curvatures had independent errors
    #: (n, n) 1/mm2, of Delta from white noise of the nodes, estimated from the roughness of Delta itself, so that mesh
    #: noise common to both curvatures cancels; where nodes make no error, as `covariance`
    noise: Array
    length: float  #: mm
    pitch: float  #: mm
    #: (1 + 2 HARMONICS, n, GRID_CELLS + 1, 2): along the grid, cumulative integrals of the resolution times (M, -1),
    #: alone and times every harmonic
    cumulative: Array
    closure: float  #: displacement of the end over its standard deviation; 0 where it is not observed
    cumulative_closure: Array  #: (GRID_CELLS + 1, 2): cumulative integrals of the closure's weights times (M, -1)

    @staticmethod
    def of(kappa_0: Curvature, kappa: Curvature, moment: Moment, closure: Closure | None) -> "Observed":
        """From the intrinsic and the loaded curvature, the moment and the closure of one curve at one pressure.

        Of both resolutions the mean is right to second order in Delta. Raises `RodError` where they do not belong
        together, where there is no moment or it is not monotone, and for arms of fewer than FEWEST_PITCHES pitches.
        """
        _check_consistent(kappa_0, kappa, moment)
        grid, delta = fine_grid(kappa.length), kappa.kappa - kappa_0.kappa
        resolution = 0.5 * (kappa.resolution + kappa_0.resolution)
        lines = np.column_stack([CubicSpline(moment.s, moment.value)(grid), -np.ones(len(grid))])
        factors = np.stack([np.ones(len(grid)), *harmonics(grid, kappa.pitch)])
        resolved = resolution[None, :, :, None] * factors[:, None, :, None] * lines[None, None, :, :]
        closing = np.zeros_like(lines) if closure is None else closure.weights[:, None] * lines / closure.error
        covariance = kappa.covariance + kappa_0.covariance
        return Observed(
            kappa.s,
            delta,
            covariance,
            covariance if kappa.response is None else white_noise(kappa.response, delta),
            kappa.length,
            kappa.pitch,
            _cumulative(resolved, 2),
            0.0 if closure is None else closure.value / closure.error,
            _cumulative(closing, 0),
        )

    def two_lines(self, d: float) -> DesignMatrix:
        """For two lines with the break at d, mm."""
        fraction = d / self.length
        return DesignMatrix(_split_at(self.cumulative, 2, fraction), _split_at(self.cumulative_closure, 0, fraction))

    @property
    def single_line(self) -> DesignMatrix:
        """For one line all along the arm."""
        return DesignMatrix(self.cumulative[:, :, -1], self.cumulative_closure[-1])

    def weighing_closure(self, weight: float) -> "Observed":
        """The data with a closure that weighs so many times more."""
        return replace(self, closure=weight * self.closure, cumulative_closure=weight * self.cumulative_closure)

    def rms(self, fitted: Array) -> float:
        """Root mean square of Delta - fitted, 1/mm."""
        return float(np.sqrt(np.mean((self.delta - fitted) ** 2)))

    def r_squared(self, fitted: Array) -> float:
        """Fraction of the variance of Delta that fitted (n,) explains, 0 where its mean explains as much.

        A line that passes the origin and closes the curve may be further from Delta than the mean of Delta is.
        """
        unexplained = np.sum((self.delta - fitted) ** 2) / np.sum((self.delta - self.delta.mean()) ** 2)
        return max(0.0, 1.0 - float(unexplained))


def too_few_pitches(length: float, pitch: float) -> str:
    """Why an arm (mm) with cells of `pitch` (mm) is too short for five parameters; empty where it is not."""
    if length >= (FEWEST_PITCHES - 1e-9) * pitch:
        return ""
    return (
        f"Five parameters need a length of at least {FEWEST_PITCHES:g} pitches; this arm of {length:.4g} mm has "
        f"{floor(100 * length / pitch) / 100:g} of {pitch:.4g} mm."  # never rounded up to as many as are needed
    )


def _check_consistent(kappa_0: Curvature, kappa: Curvature, moment: Moment) -> None:
    """Refuse curvatures and moments that do not belong together or cannot give five parameters."""
    length = kappa.length
    if kappa_0.s.shape != kappa.s.shape or np.max(np.abs(kappa_0.s - kappa.s)) > 1e-6 * length:
        raise RodError("The intrinsic and the loaded curvature must be given at the same points of the same curve.")
    if abs(moment.s[-1] - length) > 1e-6 * length:
        raise RodError(f"The moment is that of a curve of {moment.s[-1]:g} mm, the curvature of one of {length:g} mm.")
    if np.ptp(moment.value) == 0.0:
        raise RodError("The rod carries no moment, or the same everywhere; a rigidity cannot be read from it.")
    steps = np.diff(moment.value) * np.sign(moment.value[-1] - moment.value[0])
    back = np.minimum(steps, 0.0)
    if -back.sum() > REVERSAL * np.ptp(moment.value):  # soft and stiff sections could not be told by their load
        reversed_at = moment.s[:-1][back < 0.0]
        raise RodError(
            f"The moment does not fall steadily from one end to the other: it turns back between "
            f"s = {reversed_at[0]:.3g} and {reversed_at[-1]:.3g} mm; take a load that bends the whole arm one way."
        )
    if sentence := too_few_pitches(length, kappa.pitch):
        raise RodError(sentence)


def _cumulative(parts: Array, axis: int) -> Array:
    """Cumulative sums along the grid on `axis`, starting with zero at the clamp."""
    return np.concatenate([np.zeros_like(parts.take([0], axis)), np.cumsum(parts, axis)], axis)


def _split_at(cumulative: Array, axis: int, fraction: float) -> Array:
    """Integrals before and beyond a point at this fraction of the length, side by side on the last axis."""
    position = fraction * (cumulative.shape[axis] - 1)
    left = min(int(position), cumulative.shape[axis] - 2)
    before, after = cumulative.take(left, axis), cumulative.take(left + 1, axis)
    first = before + (position - left) * (after - before)
    return np.concatenate([first, cumulative.take(-1, axis) - first], -1)
