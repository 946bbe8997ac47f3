"""Curvature of a material curve by Gaussian-process regression (paper, section 3 and equation (6)).

X(s) and Y(s), of the curve without its stretch, are draws of one process with three parts: a smooth one with the kernel
c exp(-(s - s')^2 / (2 L^2)), a ripple that repeats with the pitch, and white noise. The estimate is the curvature of
the smooth part. A derivative of a Gaussian process is again one, so the derivatives of the posterior mean and their
covariance are closed forms of the kernel's derivatives, and

    kappa = (X' Y'' - X'' Y') / (X'^2 + Y'^2)^(3/2)

has a standard deviation, to first order in the errors of the derivatives.

Hyperparameters: all curves that are compared (experiments II and III) share one set, estimated by maximum likelihood
from all of them together, and L lies between MIN_LENGTH_SCALE and MAX_LENGTH_SCALE pitches. With L free and without a
part for the ripple the process would follow the ripple in one experiment and not in the other, or take it for noise and
smear the boundary zone at the clamp.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import GRID_CELLS, Curvature, fine_grid, without_stretch
from rod.errors import RodError

#: smallest and largest length scale of the smooth part, over the pitch
MIN_LENGTH_SCALE, MAX_LENGTH_SCALE = 1.5, 3.0
#: correlation length of the ripple's amplitude along the arm, over the pitch
RIPPLE_CORRELATION = 3.0


@dataclass(frozen=True)
class Smoothing:
    """Hyperparameters of the process, shared by all curves that are compared."""

    amplitude: float  #: mm, square root of the kernel's variance
    length_scale: float  #: mm
    noise: float  #: mm, standard deviation of the white noise
    ripple: float  #: mm, square root of the variance of the ripple, which repeats with the pitch
    pitch: float  #: mm
    at_bound: bool  #: the length scale is the smallest or the largest that the rule allows


def shared_smoothing(centrelines: Sequence[Centreline], pitch: float, shortest: float = MIN_LENGTH_SCALE) -> Smoothing:
    """Hyperparameters of maximum likelihood for all coordinates of all curves together.

    The length scale is at least `shortest` pitches (mm). The curves are one material curve in several states. Raises
    `RodError` where they do not have the same points s, for fewer than 8 points, and for a pitch that is not positive.
    """
    # the one door to scikit-learn; inside, because it would delay `import rod` by a second
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, ExpSineSquared, WhiteKernel

    s = _common_s(centrelines)
    if not (np.isfinite(pitch) and pitch > 0.0 and shortest > 0.0):
        raise RodError(
            f"The pitch and the smallest length scale must be positive, not {pitch} mm and {shortest} pitches."
        )
    unstretched = [without_stretch(c) for c in centrelines]
    targets = np.column_stack([_without_chord(s, v) for c in unstretched for v in (c.x, c.y)])
    unit = float(np.sqrt(np.mean(targets**2))) or 1.0
    low, high = shortest * pitch, max(MAX_LENGTH_SCALE, 1.5 * shortest) * pitch
    smooth = ConstantKernel(10.0, (1e-4, 1e8)) * RBF(1.2 * low, (low, high))
    decay, periodic = RBF(RIPPLE_CORRELATION * pitch, "fixed"), ExpSineSquared(1.0, pitch, "fixed", "fixed")
    kernel = smooth + ConstantKernel(1e-5, (1e-12, 1.0)) * decay * periodic + WhiteKernel(1e-7, (1e-10, 1.0))
    process = GaussianProcessRegressor(kernel, alpha=1e-14, n_restarts_optimizer=1, random_state=0)
    with warnings.catch_warnings():
        # a length scale at its bound is expected and reported by `at_bound`; the likelihood is flat there
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit(s[:, None], targets / unit)
    optimum = process.kernel_
    rbf, ripple = optimum.k1.k1.k2.length_scale, optimum.k1.k2.k1.k1.constant_value
    amplitude, noise = optimum.k1.k1.k1.constant_value, optimum.k2.noise_level
    at_bound = bool(rbf < 1.001 * low or rbf > 0.999 * high)
    return Smoothing(
        amplitude=unit * float(np.sqrt(amplitude)),
        length_scale=float(rbf),
        noise=unit * float(np.sqrt(noise)),
        ripple=unit * float(np.sqrt(ripple)),
        pitch=pitch,
        at_bound=at_bound,
    )


def gaussian_process(centreline: Centreline, smoothing: Smoothing) -> Curvature:
    """Curvature at the nodes from half a pitch beyond the clamp to one pitch before the tip, with its full covariance.

    Nearer to the ends half of a cell is missing and the ripple does not average out; the last half cell is bent by the
    support of the tip. theta and kappa are functions of rest arc length, for stretch within the cells would be taken
    for noise.
    """
    s, centreline, pitch = centreline.s - centreline.s[0], without_stretch(centreline), smoothing.pitch
    maps, (c11, c12, c22) = _derivative_posterior(s, smoothing)
    x1, x2 = (_derivative(s, maps[k], centreline.x, k) for k in (1, 2))
    y1, y2 = (_derivative(s, maps[k], centreline.y, k) for k in (1, 2))
    speed = np.hypot(x1, y1)
    kappa = (x1 * y2 - x2 * y1) / speed**3
    x_influence, y_influence = _influence(s, centreline.angle)
    covariance, resolution = np.zeros((len(s), len(s))), np.zeros((len(s), GRID_CELLS))
    # derivatives of kappa by the first and the second derivative of X, then of Y
    for by_first, by_second, influence in (
        (y2 / speed**3 - 3.0 * kappa * x1 / speed**2, -y1 / speed**3, x_influence),
        (-x2 / speed**3 - 3.0 * kappa * y1 / speed**2, x1 / speed**3, y_influence),
    ):
        cross = np.outer(by_first, by_second) * c12
        covariance += np.outer(by_first, by_first) * c11 + np.outer(by_second, by_second) * c22 + cross + cross.T
        resolution += (by_first[:, None] * maps[1] + by_second[:, None] * maps[2]) @ influence
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


def _chord(s: Array, values: Array) -> tuple[float, float]:
    """Value at s = 0 and slope of the chord between the ends."""
    slope = (values[-1] - values[0]) / (s[-1] - s[0])
    return float(values[0] - slope * s[0]), float(slope)


def _without_chord(s: Array, values: Array) -> Array:
    offset, slope = _chord(s, values)
    rest = values - offset - slope * s
    return rest - rest.mean()


def _derivative(s: Array, mean: Array, values: Array, order: int) -> Array:
    """Derivative of the posterior mean, with the chord's slope put back."""
    return mean @ _without_chord(s, values) + (_chord(s, values)[1] if order == 1 else 0.0)


def _derivative_posterior(s: Array, smoothing: Smoothing) -> tuple[dict[int, Array], tuple[Array, Array, Array]]:
    """Linear maps from node values to the first two derivatives of the mean, and the covariances 11, 12, 22 of both."""
    length, variance = smoothing.length_scale, smoothing.amplitude**2
    u = (s[:, None] - s[None, :]) / length
    k = variance * np.exp(-0.5 * u**2)
    # derivatives of the kernel by its first argument, and by both, from Hermite polynomials
    d1, d2 = -u * k / length, (u**2 - 1.0) * k / length**2
    d11, d22 = (1.0 - u**2) * k / length**2, (u**4 - 6.0 * u**2 + 3.0) * k / length**4
    d12 = (3.0 * u - u**3) * k / length**3
    apart, pitch = s[:, None] - s[None, :], smoothing.pitch
    ripple = np.exp(-0.5 * (apart / (RIPPLE_CORRELATION * pitch)) ** 2 - 2.0 * np.sin(np.pi * apart / pitch) ** 2)
    factor = cho_factor(k + smoothing.ripple**2 * ripple + (smoothing.noise**2 + 1e-14 * variance) * np.eye(len(s)))
    maps = {1: cho_solve(factor, d1.T).T, 2: cho_solve(factor, d2.T).T}
    return maps, (d11 - maps[1] @ d1.T, d12 - maps[1] @ d2.T, d22 - maps[2] @ d2.T)


def _influence(s: Array, angle: Array) -> tuple[Array, Array]:
    """(n, GRID_CELLS) each: derivatives of x and y of the nodes by the curvature on the grid, the clamp being fixed.

    angle (n - 1,): chord angles between the nodes. A change of curvature rotates everything beyond it.
    """
    grid = fine_grid(float(s[-1]))
    h = grid[1] - grid[0]
    tangent = np.interp(grid, 0.5 * (s[:-1] + s[1:]), angle)
    turns = np.tril(np.full((GRID_CELLS, GRID_CELLS), h), -1) + 0.5 * h * np.eye(GRID_CELLS)
    reach = np.clip(s[:, None] - (grid[None, :] - 0.5 * h), 0.0, h)
    return reach @ (-np.sin(tangent)[:, None] * turns), reach @ (np.cos(tangent)[:, None] * turns)
