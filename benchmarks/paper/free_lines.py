"""The estimators that a reader of the paper would use (paper, section 3), for comparison with `identify`.

Both fit two lines to the moment over the change of curvature, each with a free offset,

    M = alpha1 Delta + m01 for s < d,    M = alpha2 Delta + m02 beyond,    Delta = kappa - kappa_0

by least squares in M, and take the d with the largest r2. They have neither a prior, nor a closure condition, nor the
resolution of the estimate, all of which `identify` has. A slope may be negative: it is then no rigidity.

paper_cells takes the curvature as the mean over one pitch. paper_process takes it from a Gaussian process with the
kernel c exp(-(s - s')^2 / (2 L^2)) and white noise, with a length scale L that is given, because the paper states none
and its d depends on L. Between nodes the process smooths over about L, and at the clamp it lacks data on one side:
there the curvature sinks towards zero. `single_rigidity_control` shows what this does to a rod that has one rigidity.
The process has the mean zero, so something is subtracted from the coordinates before, which the paper does not state
either; how the curve ends at the clamp, and with it alpha1, depends on what that is (`Subtracted`).
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import moment_from_load
from rod.errors import RodError
from rod.law import TwoSlopes
from rod.load import Load
from rod.mechanics.equilibrium import Rod

#: what is subtracted from a coordinate before it becomes a process: the chord between the ends, the chord and then the
#: mean of what is left, or the mean alone
Subtracted = Literal["chord", "chord and mean", "mean"]
#: range of d over the length
BREAKS = (0.02, 0.45)
#: points on either side of d that a line needs at least
FEWEST = 3
#: distance of the points of paper_cells, and of its breaks, over the length
CELL_POINTS, CELL_BREAKS = 448, 0.001
#: points of paper_process on the whole curve, and its breaks over the length
PROCESS_POINTS, PROCESS_BREAKS = 225, 0.002
#: range of the variance of the noise over that of the process; below it rounding errors take the place of noise
LEAST_NOISE, MOST_NOISE = 1e-10, 1.0


@dataclass(frozen=True)
class FreeLines:
    """Two lines with free offsets, and a single one through the same data. Arrays are read-only."""

    law: TwoSlopes
    r2: float  #: fraction of the variance of M that the two lines explain
    single_alpha: float  #: N mm2
    single_r2: float
    points: Array  #: (n, 3) columns s (mm), Delta (1/mm), M (N mm)
    length_scale: float | None = None  #: mm, of the process
    noise: tuple[float, float] | None = None  #: mm, standard deviation of its white noise without and with load


@dataclass(frozen=True)
class TestedCurves:
    """The material curve in experiments II and III at one pressure, and the force on its end in III.

    Raises `RodError` where the curves do not have the same points.
    """

    free: Centreline  #: of II
    loaded: Centreline  #: of III
    force: tuple[float, float]  #: N

    __test__ = False  # a value, though its name begins like a test

    def __post_init__(self) -> None:
        free, loaded = self.free.s, self.loaded.s
        if free.shape != loaded.shape or np.max(np.abs(free - loaded)) > 1e-6 * self.free.length:
            raise RodError("The curves with and without load must have the same points s.")

    @property
    def s(self) -> Array:
        """(n,) mm, rest arc length of the nodes from the clamp."""
        return self.free.s - self.free.s[0]

    def moment(self, s: Array) -> Array:
        """(m,) N mm, moment of the end force at s (m,) mm (paper, equation (7))."""
        return np.interp(s, self.s, moment_from_load(self.loaded, Load(self.force)).value)


def paper_cells(curves: TestedCurves, pitch: float, d: float | None = None) -> FreeLines:
    """Two free lines from curvatures that are means over one pitch (mm); d (mm) is sought unless it is given.

    Raises `RodError` for a curve shorter than three cells and a d that leaves too few points on a side.
    """
    length = curves.free.length
    if not length >= 3.0 * pitch > 0.0:
        raise RodError(f"Means over one pitch need three cells; a curve of {length:g} mm has no three of {pitch:g} mm.")
    middle = 0.5 * (curves.s[1:] + curves.s[:-1])
    s = np.linspace(0.0, length, CELL_POINTS + 1)
    s = s[(s >= middle[0] + 0.5 * pitch) & (s <= length - pitch)]  # the last half cell is bent by the support
    kappa = [
        np.diff([np.interp(s + side * pitch, middle, np.unwrap(curve.angle)) for side in (-0.5, 0.5)], axis=0)[0]
        / pitch
        for curve in (curves.free, curves.loaded)
    ]
    return _free_lines(s, kappa[1] - kappa[0], curves.moment(s), (length, CELL_BREAKS), d)


def paper_process(
    curves: TestedCurves, length_scale: float, d: float | None = None, *, subtracted: Subtracted = "chord"
) -> FreeLines:
    """Two free lines from curvatures of a Gaussian process with the given length scale (mm), on the whole curve.

    Each curve has a process of its own, with the amplitude and the noise of maximum likelihood. Raises `RodError` for a
    length scale that is not positive and a d that leaves too few points on a side.
    """
    if not length_scale > 0.0:
        raise RodError(f"A length scale must be positive, not {length_scale} mm.")
    free, loaded = (_Process.fitted(curve, length_scale, subtracted) for curve in (curves.free, curves.loaded))
    return _of_processes(curves, free, loaded, d)


def single_rigidity_control(curves: TestedCurves, length_scale: float, alpha: float, kappa_0: float) -> FreeLines:
    """`paper_process` for a rod that has one rigidity alpha (N mm2) and constant kappa_0 (1/mm) everywhere.

    The rod is tested as in experiments II and III, with the end of III at the height of the curves, and smoothed as
    they are: with the same nodes, length scale, and ratio of noise to amplitude. It has no noise itself. What differs
    from one rigidity is made by the smoothing. Raises `RodError` as `paper_process`, and where the rod has no
    equilibrium.
    """
    start = (float(curves.loaded.x[0]), float(curves.loaded.y[0]))
    rod = Rod(curves.free.length, kappa_0, TwoSlopes(alpha, alpha, 0.0, 0.0, 0.5 * curves.free.length), start=start)
    shapes = rod.solve(), rod.solve(end_y=float(curves.loaded.y[-1]))
    free, loaded = (Centreline(curves.s, *shape.positions(curves.s).T) for shape in shapes)
    force = (float(shapes[1].force[0]), float(shapes[1].force[1]))
    smoothings = [_Process.fitted(curve, length_scale) for curve in (curves.free, curves.loaded)]
    processes = [replace(p, curve=curve) for p, curve in zip(smoothings, (free, loaded), strict=True)]
    return _of_processes(TestedCurves(free, loaded, force), processes[0], processes[1], None)


@dataclass(frozen=True)
class _Process:
    """A Gaussian process of given length scale through the nodes of a curve, with white noise."""

    curve: Centreline
    length_scale: float  #: mm
    noise: float  #: mm
    inverse: Array  #: (n, n), of the correlation with the noise over the amplitude
    subtracted: Subtracted

    @staticmethod
    def fitted(curve: Centreline, length_scale: float, subtracted: Subtracted = "chord") -> "_Process":
        """Amplitude and noise of maximum likelihood: the amplitude in closed form, their ratio by search."""
        s = curve.s
        shapes = np.column_stack([_rest(s, coordinate, subtracted) for coordinate in (curve.x, curve.y)])
        values, vectors = eigh(np.exp(-0.5 * ((s[:, None] - s[None, :]) / length_scale) ** 2))
        values, squares = np.maximum(values, 0.0), (vectors.T @ shapes) ** 2

        def variance(ratio: float) -> float:
            return float(np.mean(squares / (values + ratio)[:, None]))

        def minus_likelihood(log_ratio: float) -> float:
            ratio = np.exp(log_ratio)
            return float(np.mean(np.log(values + ratio)) + np.log(variance(ratio)))

        bounds = (np.log(LEAST_NOISE), np.log(MOST_NOISE))
        ratio = float(np.exp(minimize_scalar(minus_likelihood, bounds=bounds, method="bounded").x))
        inverse = (vectors / (values + ratio)) @ vectors.T
        return _Process(curve, length_scale, float(np.sqrt(ratio * variance(ratio))), inverse, subtracted)

    def curvature(self, at: Array) -> Array:
        """(m,) 1/mm at arc lengths (m,) mm from the clamp: equation (6) with the derivatives of the posterior means."""
        s, coordinates = self.curve.s - self.curve.s[0], (self.curve.x, self.curve.y)
        u = (at[:, None] - s[None, :]) / self.length_scale
        k = np.exp(-0.5 * u**2)
        first, second = -u * k / self.length_scale, (u**2 - 1.0) * k / self.length_scale**2
        weights = [self.inverse @ _rest(s, values, self.subtracted) for values in coordinates]
        slopes = [0.0 if self.subtracted == "mean" else _slope(s, values) for values in coordinates]
        x1, y1 = (first @ w + slope for w, slope in zip(weights, slopes, strict=True))
        x2, y2 = (second @ w for w in weights)
        return np.asarray((x1 * y2 - x2 * y1) / np.hypot(x1, y1) ** 3)


def _of_processes(curves: TestedCurves, free: _Process, loaded: _Process, d: float | None) -> FreeLines:
    length = curves.free.length
    s = np.linspace(0.0, length, PROCESS_POINTS)
    lines = _free_lines(s, loaded.curvature(s) - free.curvature(s), curves.moment(s), (length, PROCESS_BREAKS), d)
    return replace(lines, length_scale=free.length_scale, noise=(free.noise, loaded.noise))


def _slope(s: Array, values: Array) -> float:
    return float((values[-1] - values[0]) / (s[-1] - s[0]))


def _rest(s: Array, values: Array, subtracted: Subtracted) -> Array:
    """(n,) what is left of a coordinate."""
    if subtracted == "mean":
        return np.asarray(values - values.mean())
    rest = values - values[0] - _slope(s, values) * (s - s[0])
    return np.asarray(rest - rest.mean() if subtracted == "chord and mean" else rest)


def _free_lines(s: Array, delta: Array, moment: Array, breaks: tuple[float, float], d: float | None) -> FreeLines:
    """The lines through (delta, moment) (n,) with the break at d (mm), or where r2 is largest.

    breaks: the length in mm, and the distance of the breaks that are tried over the length.
    """
    length, step = breaks
    spread = float(np.sum((moment - moment.mean()) ** 2))
    if not spread > 0.0:
        raise RodError("The loaded rod carries no moment, and no line can be fitted to it.")
    candidates = np.arange(BREAKS[0], BREAKS[1] + 0.5 * step, step) * length if d is None else np.array([d])
    counts = np.searchsorted(s, candidates)
    possible = (counts >= FEWEST) & (len(s) - counts >= FEWEST)
    if not possible.any():
        raise RodError(f"Fewer than {FEWEST} points lie on one side of d = {candidates[0]:g} mm; give another d.")
    candidates, counts = candidates[possible], counts[possible]
    pairs = [[_line(delta[part], moment[part]) for part in (slice(n), slice(n, None))] for n in counts]
    r2 = np.array([1.0 - sum(line[2] for line in pair) / spread for pair in pairs])
    best = int(np.argmax(r2))
    (alpha1, m01, _), (alpha2, m02, _) = pairs[best]
    alpha, _, rest = _line(delta, moment)
    points = np.column_stack([s, delta, moment])
    points.setflags(write=False)
    law = TwoSlopes(alpha1, alpha2, m01, m02, float(candidates[best]))
    return FreeLines(law, float(r2[best]), alpha, 1.0 - rest / spread, points)


def _line(delta: Array, moment: Array) -> tuple[float, float, float]:
    """Slope (N mm2), offset (N mm) and sum of squares of the least-squares line moment over delta, (n,) each."""
    x, y = delta - delta.mean(), moment - moment.mean()
    slope = float(x @ y) / float(x @ x)
    return slope, float(moment.mean() - slope * delta.mean()), float(np.sum((y - slope * x) ** 2))
