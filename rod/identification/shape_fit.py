"""The numbers whose rod comes closest to the shape and the end force of a loaded arm (paper, Fig. 11).

The rod takes the measured shape of Test II as its rest shape, wiggles included: kappa_0 from node to node. It is held
as in Test III, and the five numbers (with the wiggles of `lines` and the same weak prior knowledge) are those that
minimise

    sum |r_rod(s_i) - r(s_i)|^2 n_eff/(n sigma^2)  +  |F_rod - F|^2/(FORCE_ERROR |F|)^2

The shapes are taken without their stretch, which an inextensible rod cannot follow and would bend for; how far the rod
is from the shape with its stretch is reported beside. No curvature is differentiated, so noise of the nodes matters
little. The errors follow from the linearised fit: white noise of both shapes, and a misfit that neighbouring nodes
within a cell share.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import OptimizeResult, least_squares

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import Moment, chord_angles, moment_from_load, without_stretch
from rod.curves.uncertainty import (
    Interval,
    effective_observations,
    interval,
    misfit_correlation,
    sample_errors,
    total_covariance,
)
from rod.identification.regression import HARMONICS, OFFSET, RIPPLE, harmonics
from rod.identification.two_lines import NEAREST, default_breaks
from rod.law import FiveParameters, RodError
from rod.load import Load
from rod.mechanics.equilibrium import Rod, RodSolution

#: relative error of the end force that is always assumed
FORCE_ERROR = 1e-3
#: over the length, error of a position that is always assumed
SHAPE_ERROR = 1e-9
#: the range of compliances over the start's
COMPLIANCES = (0.02, 50.0)


@dataclass(frozen=True)
class LoadedShape:
    """Tests II and III at one pressure. Raises `RodError` unless both are the same material curve and F bends it."""

    free: Centreline  #: Test II
    loaded: Centreline  #: Test III
    load: Load  #: of the full body in experiment III; its force is what holds the end
    pitch: float  #: mm

    def __post_init__(self) -> None:
        if self.free.s.shape != self.loaded.s.shape or np.max(np.abs(self.free.s - self.loaded.s)) > 1e-6 * self.length:
            raise RodError("Both shapes must be of one material curve, with the same points s.")
        if not self.load.force_size > 0.0:
            raise RodError("Without an end force there is no moment from which rigidities could be read.")

    @property
    def length(self) -> float:
        """mm, at rest."""
        return float(self.free.s[-1] - self.free.s[0])

    @property
    def s(self) -> Array:
        """(n,) mm from the clamp."""
        return self.free.s - self.free.s[0]

    @property
    def points(self) -> Array:
        """(n, 2) mm, the loaded shape."""
        return np.column_stack([self.loaded.x, self.loaded.y])


@dataclass(frozen=True)
class RodFit:
    """The five numbers of the closest rod, their errors, and how close it comes."""

    law: FiveParameters
    alpha1: Interval  #: N mm2
    alpha2: Interval  #: N mm2
    m01: Interval  #: N mm
    m02: Interval  #: N mm
    d: Interval  #: mm
    distance: Array  #: (n,) mm, between rod and shape at the nodes
    shape_error: float  #: largest distance over the length
    shape_error_without_stretch: float  #: the same to the shape with its stretch taken out, as the rod is fitted
    force_error: float  #: |F_rod - F| / |F|
    objective: float  #: half the weighted squares, prior included


def rest_curvature(free: Centreline) -> tuple[float, Array]:
    """theta (rad) at the clamp, and (n, 2) columns s (mm) and kappa (1/mm) at the nodes of the unloaded shape.

    The integral of theta is a cubic spline through the chords, so that a rod with this curvature, straight between
    nodes, has the chords' directions. It wiggles as the shape does and is noisy if that is; only its integrals matter.
    """
    s = free.s - free.s[0]
    integral = CubicSpline(s, np.concatenate([[0.0], np.cumsum(np.diff(s) * chord_angles(free))]))
    return float(integral(0.0, 1)), np.column_stack([s, integral(s, 2)])


def fit_rod(
    shape: LoadedShape,
    starts: Sequence[FiveParameters],
    *,
    breaks: tuple[float, float] | None = None,
    draws: int = 400,
    seed: int = 0,
) -> RodFit:
    """The closest rod, from the best of several starts (the laws that `identify` found).

    breaks: range of d over the length, by default that of `identify`; equal numbers fix d.

    Raises `RodError` when there is no start or no rod near it.
    """
    if not starts:
        raise RodError("Fitting a rod needs a law to start from.")
    still = replace(shape, free=without_stretch(shape.free), loaded=without_stretch(shape.loaded))
    task = _Task.of(still, breaks, starts)
    rough = min((task.minimised(task.numbers(start)) for start in starts), key=lambda found: float(found.cost))
    if rough.cost >= 0.5 * _NO_ROD**2:
        raise RodError("No rod near the laws to start from is in equilibrium under these loads.")
    task = task.weighted(rough)
    found = task.minimised(rough.x)
    law = task.law(found.x)
    sampled = task.sampled(found, draws, np.random.default_rng(seed))
    best = (law.alpha1, law.alpha2, law.m01, law.m02, law.d)
    intervals = dict(zip(_NAMES, (interval(v, c) for v, c in zip(best, sampled.T, strict=True)), strict=True))
    rod = task.solved(found.x)
    inextensible = np.hypot(*(rod.positions(shape.s) - still.points).T)
    # the same numbers with the end held where it was seen, against the shape as it was seen
    rod = replace(task, shape=shape).solved(found.x)
    distance = np.hypot(*(rod.positions(shape.s) - shape.points).T)
    fx, fy = shape.load.force
    off = math.hypot(rod.force[0] - fx, rod.force[1] - fy) / shape.load.force_size
    return RodFit(
        law,
        **intervals,
        distance=distance,
        shape_error=float(distance.max()) / shape.length,
        shape_error_without_stretch=float(inextensible.max()) / shape.length,
        force_error=off,
        objective=float(found.cost),
    )


def profile_over_break(shape: LoadedShape, start: FiveParameters, breaks: Sequence[float]) -> Array:
    """(n, 3) d (mm), largest distance over length (without stretch), relative force error of the closest rods."""
    rows = []
    for d in breaks:
        fit = fit_rod(shape, [replace(start, d=d)], breaks=(d / shape.length, d / shape.length), draws=2)
        rows.append((d, fit.shape_error_without_stretch, fit.force_error))
    return np.array(rows)


_NAMES = ("alpha1", "alpha2", "m01", "m02", "d")
#: residual where there is no equilibrium
_NO_ROD = 1e6


@dataclass(frozen=True)
class _Task:
    """Unknowns z: compliances over `compliance`, offsets over `offset`, d over length, wiggles."""

    shape: LoadedShape
    moment: Moment
    theta0: float  #: rad
    kappa_0: Array  #: (n, 2)
    compliance: float  #: 1/(N mm2)
    offset: float  #: 1/mm
    breaks: tuple[float, float]
    weight: float  #: 1/mm, of a position
    noise: float  #: mm, white noise of each coordinate of a node
    misfit: Array  #: (n, n) mm2, covariance of what the law leaves, in each coordinate

    @staticmethod
    def of(shape: LoadedShape, breaks: tuple[float, float] | None, starts: Sequence[FiveParameters]) -> "_Task":
        low, high = breaks or default_breaks(shape.length, shape.pitch)
        if not 0.0 < low <= high < 1.0:
            raise RodError(f"The range of d over the length must lie between 0 and 1; {low:g} ... {high:g} does not.")
        if low < high:
            low = min(max(low, NEAREST * shape.pitch / shape.length), high)
        moment = moment_from_load(shape.loaded, shape.load)
        bent = max(float(np.abs(law.deviation(moment.s, moment.value)).max()) for law in starts)
        compliance, offset = 1.0 / starts[0].alpha2, OFFSET * bent
        n = len(shape.s)
        first = (1e-4 * shape.length) ** 2 * misfit_correlation(shape.pitch, shape.s)
        return _Task(
            shape,
            moment,
            *rest_curvature(shape.free),
            compliance,
            offset,
            (low, high),
            math.sqrt(effective_observations(first) / n / float(first[0, 0])),
            0.0,
            first,
        )

    def law(self, z: Array) -> FiveParameters:
        a1, a2 = z[0] * self.compliance, z[2] * self.compliance
        return FiveParameters(
            1 / a1, 1 / a2, z[1] * self.offset / a1, z[3] * self.offset / a2, z[4] * self.shape.length
        )

    def numbers(self, law: FiveParameters) -> Array:
        a1, a2 = 1.0 / law.alpha1, 1.0 / law.alpha2
        z = [a1 / self.compliance, law.m01 * a1 / self.offset, a2 / self.compliance, law.m02 * a2 / self.offset]
        return np.array([*z, law.d / self.shape.length, *[0.0] * (2 * HARMONICS)])

    def solved(self, z: Array) -> RodSolution:
        """The rod of these numbers, held as the loaded shape is. The wiggle multiplies Delta of the measured moment."""
        law, loaded, near = self.law(z), self.shape.loaded, 1e-7 * self.shape.length
        # both sides of the break are sampled, so that the wiggle jumps there and not at a node, whatever d is
        nodes = self.shape.s
        s = np.sort(np.append(nodes[np.abs(nodes - law.d) > 2.0 * near], [law.d - near, law.d + near]))
        deviation = law.deviation(s, np.interp(s, self.moment.s, self.moment.value))
        wiggle = deviation * (z[5:] @ np.array(harmonics(s, self.shape.pitch)))
        kappa_0 = np.column_stack([s, np.interp(s, *self.kappa_0.T) + wiggle])
        rod = Rod(self.shape.length, kappa_0, law, theta0=self.theta0, start=(float(loaded.x[0]), float(loaded.y[0])))
        return rod.under(self.shape.load, end_y=float(loaded.y[-1]))

    def residual(self, z: Array) -> Array:
        prior = np.concatenate([z[[1, 3]], z[5:] / RIPPLE])
        try:
            rod = self.solved(z)
        except RodError:
            return np.full(2 * len(self.shape.s) + 2 + len(prior), _NO_ROD)
        off = (rod.positions(self.shape.s) - self.shape.points) * self.weight
        load = self.shape.load
        force = (rod.force - np.array(load.force)) / (FORCE_ERROR * load.force_size)
        return np.concatenate([off.T.ravel(), force, prior])

    def minimised(self, z: Array) -> OptimizeResult:
        low = np.array([COMPLIANCES[0], -np.inf, COMPLIANCES[0], -np.inf, self.breaks[0], *[-np.inf] * (2 * HARMONICS)])
        high = np.array([COMPLIANCES[1], np.inf, COMPLIANCES[1], np.inf, self.breaks[1], *[np.inf] * (2 * HARMONICS)])
        free = np.array([True] * 4 + [self.breaks[0] < self.breaks[1]] + [True] * (2 * HARMONICS))
        fixed = np.where(free, z, low)

        def whole(part: Array) -> Array:
            full = fixed.copy()
            full[free] = part
            return full

        inside = np.clip(z, np.where(free, low * (1 + 1e-9), low), np.where(free, high * (1 - 1e-9), high))
        found = least_squares(
            lambda part: self.residual(whole(part)),
            inside[free],
            bounds=(low[free], high[free]),
            diff_step=1e-6,
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=60,
        )
        jac = np.zeros((len(found.fun), len(z)))
        jac[:, free] = found.jac
        return OptimizeResult(x=whole(found.x), cost=found.cost, fun=found.fun, jac=jac)

    def weighted(self, found: OptimizeResult) -> "_Task":
        """The same task with the weights that its residual suggests."""
        n = len(self.shape.s)
        parts = found.fun[: 2 * n].reshape(2, n) / self.weight
        # what a smooth misfit leaves next to nothing of; variance 20 of white noise
        variance = float(np.mean(np.diff(parts, 3, axis=1) ** 2)) / 20.0
        shared = np.kron(np.eye(2), misfit_correlation(self.shape.pitch, self.shape.s)).astype(float)
        least = SHAPE_ERROR * self.shape.length
        error = total_covariance(parts.ravel(), found.jac[: 2 * n], variance * np.eye(2 * n), shared, least)[:n, :n]
        weight = math.sqrt(effective_observations(error) / n / float(error[0, 0]))
        # across the curve both shapes are noisy, along it only the loaded one
        noise = math.sqrt(variance / 1.5)
        return replace(self, weight=weight, noise=noise, misfit=error - variance * np.eye(n))

    def sampled(self, found: OptimizeResult, draws: int, random: np.random.Generator) -> Array:
        """(draws, 5) the five numbers under drawn errors of both shapes and of the prior, by the linearised fit."""
        n = len(self.shape.s)
        moved = np.empty((len(found.fun), draws))
        for k in range(draws):
            moved[:, k] = self._with_noise(random).residual(found.x) - found.fun
        for rows in (slice(0, n), slice(n, 2 * n)):
            moved[rows] += self.weight * sample_errors(self.misfit, draws, random)
        moved[2 * n :] += random.standard_normal((len(moved) - 2 * n, draws))
        z = found.x[:, None] - np.linalg.pinv(found.jac, rcond=1e-12) @ moved
        a1, a2 = (np.clip(z[i], *COMPLIANCES) * self.compliance for i in (0, 2))
        d = np.clip(z[4], *self.breaks) * self.shape.length
        return np.column_stack([1 / a1, 1 / a2, z[1] * self.offset / a1, z[3] * self.offset / a2, d])

    def _with_noise(self, random: np.random.Generator) -> "_Task":
        free, loaded = (
            Centreline(
                c.s,
                c.x + self.noise * random.standard_normal(len(c.s)),
                c.y + self.noise * random.standard_normal(len(c.s)),
            )
            for c in (self.shape.free, self.shape.loaded)
        )
        theta0, kappa_0 = rest_curvature(free)
        return replace(self, shape=replace(self.shape, free=free, loaded=loaded), theta0=theta0, kappa_0=kappa_0)
