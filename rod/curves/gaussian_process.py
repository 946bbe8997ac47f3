"""Curvature of a material curve by Gaussian-process regression (paper, section 3 and equation (6)).

X(s) and Y(s), of the curve without its stretch, are draws of one process with three parts: a smooth one with the kernel
c exp(-(s - s')^2 / (2 L^2)), a wiggle that repeats with the pitch, and white noise. The curve that is meant is the
smooth part. Because a derivative of a Gaussian process is one again, the derivatives of the posterior mean and their
covariance are closed forms of the kernel's derivatives, and

    kappa = (X' Y'' - X'' Y') / (X'^2 + Y'^2)^(3/2)

comes with a standard deviation, to first order in the errors of the derivatives.

The rule of the hyperparameters: all curves that are compared (Tests II and III) share one set, found by maximum
likelihood from all of them together, and L lies between SHORTEST and LONGEST pitches. With L free and no part for the
wiggle the process follows it in one test and not in the other, or takes it for noise and smears the soft zone at the
clamp.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import GRID_CELLS, Curvature, fine_grid, without_stretch
from rod.law import RodError

#: the smallest and the largest length scale over the pitch
SHORTEST, LONGEST = 1.5, 3.0
#: over the pitch, the length along which the wiggle within the cells may change
FADING = 3.0


@dataclass(frozen=True)
class Smoothing:
    """Hyperparameters of the process, shared by all curves that are compared."""

    amplitude: float  #: mm, square root of the kernel's variance
    length_scale: float  #: mm
    noise: float  #: mm, standard deviation of the white noise
    wiggle: float  #: mm, square root of the variance of the wiggle that repeats with the pitch
    pitch: float  #: mm
    at_bound: bool  #: the length scale is the smallest or the largest that the rule allows


def shared_smoothing(centrelines: Sequence[Centreline], pitch: float, shortest: float = SHORTEST) -> Smoothing:
    """Hyperparameters of maximum likelihood for all coordinates of all curves together, length scale >= shortest *
    pitch.

    The curves are one material curve in several states: they have the same s. Raises `RodError` where they do not.
    """
    # the one door to scikit-learn; inside, because `import rod` for a single solve must not wait a second for it
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, ExpSineSquared, WhiteKernel

    s = _common_s(centrelines)
    if not (np.isfinite(pitch) and pitch > 0.0 and shortest > 0.0):
        raise RodError(
            f"The pitch and the smallest length scale must be positive, not {pitch} mm and {shortest} pitches."
        )
    still = [without_stretch(c) for c in centrelines]
    targets = np.column_stack([_without_chord(s, v) for c in still for v in (c.x, c.y)])
    unit = float(np.sqrt(np.mean(targets**2))) or 1.0
    low, high = shortest * pitch, max(LONGEST, 1.5 * shortest) * pitch
    smooth = ConstantKernel(10.0, (1e-4, 1e8)) * RBF(1.2 * low, (low, high))
    fading, repeating = RBF(FADING * pitch, "fixed"), ExpSineSquared(1.0, pitch, "fixed", "fixed")
    kernel = smooth + ConstantKernel(1e-5, (1e-12, 1.0)) * fading * repeating + WhiteKernel(1e-7, (1e-10, 1.0))
    process = GaussianProcessRegressor(kernel, alpha=1e-14, n_restarts_optimizer=1, random_state=0)
    with warnings.catch_warnings():
        # a length scale at its bound is the rule at work, reported by `at_bound`; the likelihood is flat beside it
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit(s[:, None], targets / unit)
    found = process.kernel_
    rbf, wiggle = found.k1.k1.k2.length_scale, found.k1.k2.k1.k1.constant_value
    amplitude, noise = found.k1.k1.k1.constant_value, found.k2.noise_level
    at_bound = bool(rbf < 1.001 * low or rbf > 0.999 * high)
    return Smoothing(
        amplitude=unit * float(np.sqrt(amplitude)),
        length_scale=float(rbf),
        noise=unit * float(np.sqrt(noise)),
        wiggle=unit * float(np.sqrt(wiggle)),
        pitch=pitch,
        at_bound=at_bound,
    )


def gaussian_process(centreline: Centreline, smoothing: Smoothing) -> Curvature:
    """Curvature at the nodes from half a pitch behind the clamp to one before the tip, with its full covariance.

    Nearer to the ends half of a cell is missing and the wiggle does not average out; what holds the tip bends its last
    half cell by itself. Stretch within the cells would pass for noise: theta and kappa belong to rest arc length.
    """
    s, centreline, pitch = centreline.s - centreline.s[0], without_stretch(centreline), smoothing.pitch
    maps, (c11, c12, c22) = _posterior(s, smoothing)
    x1, x2 = (_derivative(s, maps[k], centreline.x, k) for k in (1, 2))
    y1, y2 = (_derivative(s, maps[k], centreline.y, k) for k in (1, 2))
    speed = np.hypot(x1, y1)
    kappa = (x1 * y2 - x2 * y1) / speed**3
    x_moves, y_moves = _moves(s, centreline.angle)
    covariance, resolution = np.zeros((len(s), len(s))), np.zeros((len(s), GRID_CELLS))
    # kappa by the first and the second derivative of X, then of Y
    for by_first, by_second, moves in (
        (y2 / speed**3 - 3.0 * kappa * x1 / speed**2, -y1 / speed**3, x_moves),
        (-x2 / speed**3 - 3.0 * kappa * y1 / speed**2, x1 / speed**3, y_moves),
    ):
        cross = np.outer(by_first, by_second) * c12
        covariance += np.outer(by_first, by_first) * c11 + np.outer(by_second, by_second) * c22 + cross + cross.T
        resolution += (by_first[:, None] * maps[1] + by_second[:, None] * maps[2]) @ moves
    inner = (s >= 0.5 * pitch) & (s <= s[-1] - pitch)
    theta = np.unwrap(np.arctan2(y1, x1))
    return Curvature(
        float(s[-1]), pitch, s[inner], kappa[inner], theta[inner], covariance[np.ix_(inner, inner)], resolution[inner]
    )


def _common_s(centrelines: Sequence[Centreline]) -> Array:
    s = centrelines[0].s - centrelines[0].s[0]
    if len(s) < 8:
        raise RodError(f"A Gaussian process needs at least 8 points along the curve; there are {len(s)}.")
    for other in centrelines[1:]:
        if other.s.shape != s.shape or np.max(np.abs(other.s - other.s[0] - s)) > 1e-6 * s[-1]:
            raise RodError(
                "Curves that share their smoothing must have the same points s; these are of different bodies."
            )
    return s


def _line(s: Array, values: Array) -> tuple[float, float]:
    """Value at s = 0 and slope of the chord between the ends."""
    slope = (values[-1] - values[0]) / (s[-1] - s[0])
    return float(values[0] - slope * s[0]), float(slope)


def _without_chord(s: Array, values: Array) -> Array:
    offset, slope = _line(s, values)
    rest = values - offset - slope * s
    return rest - rest.mean()


def _derivative(s: Array, mean: Array, values: Array, order: int) -> Array:
    """Derivative of the posterior mean, with the chord's slope put back."""
    return mean @ _without_chord(s, values) + (_line(s, values)[1] if order == 1 else 0.0)


def _posterior(s: Array, smoothing: Smoothing) -> tuple[dict[int, Array], tuple[Array, Array, Array]]:
    """Linear maps from node values to the first two derivatives of the mean, and the covariances 11, 12, 22 of both."""
    length, variance = smoothing.length_scale, smoothing.amplitude**2
    u = (s[:, None] - s[None, :]) / length
    k = variance * np.exp(-0.5 * u**2)
    # derivatives of the kernel by its first argument, and by both, from Hermite polynomials
    d1, d2 = -u * k / length, (u**2 - 1.0) * k / length**2
    d11, d22 = (1.0 - u**2) * k / length**2, (u**4 - 6.0 * u**2 + 3.0) * k / length**4
    d12 = (3.0 * u - u**3) * k / length**3
    apart = s[:, None] - s[None, :]
    wiggle = np.exp(
        -0.5 * (apart / (FADING * smoothing.pitch)) ** 2 - 2.0 * np.sin(np.pi * apart / smoothing.pitch) ** 2
    )
    factor = cho_factor(k + smoothing.wiggle**2 * wiggle + (smoothing.noise**2 + 1e-14 * variance) * np.eye(len(s)))
    maps = {1: cho_solve(factor, d1.T).T, 2: cho_solve(factor, d2.T).T}
    return maps, (d11 - maps[1] @ d1.T, d12 - maps[1] @ d2.T, d22 - maps[2] @ d2.T)


def _moves(s: Array, angle: Array) -> tuple[Array, Array]:
    """(n, GRID_CELLS) each: how x and y of the nodes move with the curvature on the grid, the clamp being fixed.

    angle (n - 1,): chord angles between the nodes. A change of curvature turns all that lies beyond it.
    """
    grid = fine_grid(float(s[-1]))
    h = grid[1] - grid[0]
    tangent = np.interp(grid, 0.5 * (s[:-1] + s[1:]), angle)
    turns = np.tril(np.full((GRID_CELLS, GRID_CELLS), h), -1) + 0.5 * h * np.eye(GRID_CELLS)
    reach = np.clip(s[:, None] - (grid[None, :] - 0.5 * h), 0.0, h)
    return reach @ (-np.sin(tangent)[:, None] * turns), reach @ (np.cos(tangent)[:, None] * turns)
