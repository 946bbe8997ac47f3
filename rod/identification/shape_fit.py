"""The five parameters whose rod comes closest to the shape and the end force of a loaded arm (paper, Fig. 11).

The rod takes the measured shape of experiment II as its rest shape, ripple included: kappa_0 from node to node. It is
supported as in experiment III, and the five parameters (with the ripple and the weak prior of `regression`) minimise

    sum |r_rod(s_i) - r(s_i)|^2 n_eff/(n sigma^2)  +  |F_rod - F|^2/(FORCE_ERROR |F|)^2

The shapes are taken without their stretch, which an inextensible rod cannot follow and would compensate by bending; the
distance from the shape with its stretch is reported beside. No curvature is differentiated, so noise of the nodes
matters little. The errors come from a parametric bootstrap of the linearised fit: white noise of both shapes, and a
misfit that is correlated within a cell. Derivatives of the rod are those of `rod.mechanics.response`.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import OptimizeResult, least_squares

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import Moment, moment_between, without_stretch
from rod.curves.uncertainty import (
    Bootstrap,
    effective_observations,
    misfit_correlation,
    sample_errors,
    total_covariance,
)
from rod.errors import RodError
from rod.identification.estimate import ParameterEstimate, intervals, parameters_of_lines
from rod.identification.observed import HARMONICS, harmonics
from rod.identification.regression import OFFSET, RIPPLE
from rod.identification.two_lines import MIN_BREAK, default_breaks
from rod.law import FiveParameters
from rod.load import Load
from rod.mechanics.equilibrium import Equilibrium, Rod
from rod.mechanics.profile import Steps
from rod.mechanics.response import Changes, response
from rod.solution import RodSolution

#: smallest relative standard deviation of the end force
FORCE_ERROR = 1e-3
#: smallest standard deviation of a position, over the length
SHAPE_ERROR = 1e-9
#: relative tolerance of the fits that choose the start and give the weights, and of the last one. Against 1e-12 for all
#: alpha2 changes by at most 0.2 % (12 pressures of six arms), as by rounding of the shapes
ROUGH, EXACT = 1e-4, 1e-12
#: range of compliances over that of the first start
COMPLIANCES = (0.02, 50.0)


@dataclass(frozen=True)
class LoadedShape:
    """Experiments II and III at one pressure.

    Raises `RodError` unless both are of one material curve and there is an end force.
    """

    free: Centreline  #: of experiment II
    loaded: Centreline  #: of experiment III
    load: Load  #: of the full body in experiment III; its force is the reaction of the held end, or a force on it
    pitch: float  #: mm
    held: tuple[bool, bool] = (False, True)  #: whether the position of the end along x and along y is prescribed

    def __post_init__(self) -> None:
        if self.free.s.shape != self.loaded.s.shape or np.max(np.abs(self.free.s - self.loaded.s)) > 1e-6 * self.length:
            raise RodError("Both shapes must be of one material curve, with the same points s.")
        if not self.load.force_size > 0.0:
            raise RodError("No force acts on the end in experiment III, so that no moment tells the rigidities.")

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


@dataclass(frozen=True, kw_only=True)
class RodFit(ParameterEstimate):
    """The five parameters of the closest rod, and how close it comes."""

    distance: Array  #: (n,) mm, between rod and shape at the nodes
    inextensible_distance: Array  #: (n,) mm, to the shape with its stretch taken out, as the rod is fitted
    force_error: float  #: |F_rod - F| / |F|
    objective: float  #: half the weighted squares, prior included


def rest_curvature(free: Centreline) -> tuple[float, Array]:
    """theta (rad) at the clamp, and (n, 2) columns s (mm) and kappa (1/mm) at the nodes of the unloaded shape.

    The integral of theta is a cubic spline through the chords, so that a rod with this curvature, straight between
    nodes, has the chords' directions. It has the ripple and the noise of the shape; only its integrals matter.
    """
    s = free.s - free.s[0]
    theta0, kappa = _smooth(s, free.angle)
    return float(theta0), np.column_stack([s, kappa])


def _smooth(s: Array, angle: Array) -> tuple[Array, Array]:
    """theta (...) at s = 0 and kappa (..., n) at s (n,) for the angles (..., n - 1) of the chords, linear in these."""
    rise = np.cumsum(np.diff(s) * angle, axis=-1)
    integral = CubicSpline(s, np.concatenate([np.zeros((*rise.shape[:-1], 1)), rise], axis=-1), axis=-1)
    return integral(0.0, 1), integral(s, 2)


def fit_rod(
    shape: LoadedShape,
    starts: Sequence[FiveParameters],
    *,
    breaks: tuple[float, float] | None = None,
    bootstrap: Bootstrap = Bootstrap(),  # noqa: B008  a frozen value
) -> RodFit:
    """The closest rod, from the best of several starts (such as the laws of `identify`).

    breaks: range of d over the length, by default that of `identify`; equal ends fix d.

    Raises `RodError` when there is no start or no rod near it.
    """
    if not starts:
        raise RodError("Fitting a rod needs a law to start from.")
    unstretched = replace(shape, free=without_stretch(shape.free), loaded=without_stretch(shape.loaded))
    task = _ShapeFit.of(unstretched, breaks, starts)
    rough = min((task.minimised(task.unknowns(start), ROUGH) for start in starts), key=lambda fit: float(fit.cost))
    if rough.cost >= 0.5 * _NO_ROD**2:
        raise RodError("No rod near the laws to start from is in equilibrium under these loads.")
    task = task.weighted(task.with_derivatives(rough))
    fit = task.with_derivatives(task.minimised(rough.x))
    law = task.law(fit.x)
    sampled = task.resampled(fit, bootstrap)
    rod = task.solved(fit.x)
    inextensible = np.hypot(*(rod.positions(shape.s) - unstretched.points).T)
    # the same parameters with the end held where it is with stretch, against the shape with its stretch
    rod = replace(task, shape=shape).solved(fit.x)
    distance = np.hypot(*(rod.positions(shape.s) - shape.points).T)
    fx, fy = shape.load.force
    off = math.hypot(rod.force[0] - fx, rod.force[1] - fy) / shape.load.force_size
    return RodFit(
        law=law,
        **intervals(law, sampled),
        distance=distance,
        inextensible_distance=inextensible,
        force_error=off,
        objective=float(fit.cost),
    )


#: place of the break among the unknowns
BREAK = 4
#: a node closer to d than twice this part of the length is left out of the samples, which lie at this distance from d
NEAR = 1e-7
#: of the difference quotient by the break, over the length: beyond such nodes
STEP_OF_BREAK = 1e-6
#: residual where there is no equilibrium
_NO_ROD = 1e6


@dataclass(frozen=True)
class _ShapeFit:
    """A nonlinear least-squares problem with unknowns z (5 + 2 HARMONICS,): compliance over `compliance` and offset
    over `offset` of the first line, the same of the second, d over length, ripple amplitudes.
    """

    shape: LoadedShape
    moment: Moment
    theta0: float  #: rad
    kappa_0: Array  #: (n, 2)
    compliance: float  #: 1/(N mm2)
    offset: float  #: 1/mm
    breaks: tuple[float, float]
    weight: float  #: 1/mm, of a position
    noise: float  #: mm, standard deviation of the white noise of each coordinate of a node
    misfit: Array  #: (n, n) mm2, covariance of the misfit of the law, in each coordinate

    @staticmethod
    def of(shape: LoadedShape, breaks: tuple[float, float] | None, starts: Sequence[FiveParameters]) -> "_ShapeFit":
        low, high = breaks or default_breaks(shape.length, shape.pitch)
        if not 0.0 < low <= high < 1.0:
            raise RodError(f"The range of d over the length must lie between 0 and 1; {low:g} ... {high:g} does not.")
        if low < high:
            low = min(max(low, MIN_BREAK * shape.pitch / shape.length), high)
        moment = moment_between(shape.free, shape.loaded, shape.load)
        bent = max(float(np.abs(law.deviation(moment.s, moment.value)).max()) for law in starts)
        compliance, offset = 1.0 / starts[0].alpha2, OFFSET * bent
        n = len(shape.s)
        first = (1e-4 * shape.length) ** 2 * misfit_correlation(shape.pitch, shape.s)
        return _ShapeFit(
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

    def unknowns(self, law: FiveParameters) -> Array:
        a1, a2 = 1.0 / law.alpha1, 1.0 / law.alpha2
        z = [a1 / self.compliance, law.m01 * a1 / self.offset, a2 / self.compliance, law.m02 * a2 / self.offset]
        return np.array([*z, law.d / self.shape.length, *[0.0] * (2 * HARMONICS)])

    def solved(self, z: Array) -> RodSolution:
        """The rod of the unknowns z in equilibrium."""
        return self._equilibrium(z).solution

    def _equilibrium(self, z: Array) -> Equilibrium:
        """The same, kept for the next call: derivatives are those of the rod that was solved last."""
        return self._of_bytes(z.tobytes())

    @cached_property
    def _of_bytes(self) -> Callable[[bytes], Equilibrium]:
        return lru_cache(maxsize=1)(lambda z: self._solved_anew(np.frombuffer(z)))

    def _solved_anew(self, z: Array) -> Equilibrium:
        """The rod of the unknowns z, supported as the loaded shape.

        The ripple multiplies Delta of the measured moment.
        """
        law, loaded, load = self.law(z), self.shape.loaded, self.shape.load
        s = self._samples(law)
        ripple = law.deviation(s, self._moment_at(s)) * (z[5:] @ self._harmonics_at(s))
        rod = Rod(
            self.shape.length,
            np.column_stack([s, np.interp(s, *self.kappa_0.T) + ripple]),
            law,
            self.theta0,
            (float(loaded.x[0]), float(loaded.y[0])),
            weight=load.weight,
            weight_height=load.weight_height,
        )
        end = (float(loaded.x[-1]), float(loaded.y[-1]))
        x, y = (value if held else None for value, held in zip(end, self.shape.held, strict=True))
        return rod.equilibrium_under(load.without_weight, end_y=y, end_x=x)

    def _samples(self, law: FiveParameters) -> Array:
        """(k,) mm: the nodes and both sides of the break, so that the ripple is discontinuous at d, not at a node."""
        nodes, near = self.shape.s, NEAR * self.shape.length
        return np.sort(np.append(nodes[np.abs(nodes - law.d) > 2.0 * near], [law.d - near, law.d + near]))

    def _moment_at(self, s: Array) -> Array:
        return np.interp(s, self.moment.s, self.moment.value)

    def _harmonics_at(self, s: Array) -> Array:
        return np.array(harmonics(s, self.shape.pitch))

    def residual(self, z: Array) -> Array:
        """(2 n + 2 + prior,) x of every node, y, force, prior."""
        try:
            rod = self.solved(z)
        except RodError:
            return np.full(2 * len(self.shape.s) + 2 + len(_prior(z)), _NO_ROD)
        return self._differences(rod, z)

    def _differences(self, rod: RodSolution, z: Array) -> Array:
        shape = self.shape
        return self._rows(rod.positions(shape.s) - shape.points, rod.force - shape.load.force, _prior(z))

    def _rows(self, positions: Array, force: Array, prior: Array) -> Array:
        """The rows of the residual, or of its changes, for positions (n, 2, ...) mm, force (2, ...) N and prior."""
        of_nodes = positions.swapaxes(0, 1).reshape(-1, *positions.shape[2:]) * self.weight
        return np.concatenate([of_nodes, force / (FORCE_ERROR * self.shape.load.force_size), prior])

    def jacobian(self, z: Array) -> Array:
        """(rows of the residual, unknowns): its derivatives; zero where z has no rod."""
        others = np.array([k for k in range(len(z)) if k != BREAK])
        matrix = np.zeros((2 * len(self.shape.s) + 2 + len(_prior(z)), len(z)))
        try:
            at = self._equilibrium(z)
            answer = response(at, self._changes_of_law(z, at.problem.steps))
        except RodError:
            return matrix
        prior = np.array([_prior(unit) for unit in np.eye(len(z))[others]]).T
        matrix[:, others] = self._rows(answer.shape_at(self.shape.s), answer.force, prior)
        if self.seeks_break:
            matrix[:, BREAK] = self._by_break(z, self._differences(at.solution, z))
        return matrix

    def _by_break(self, z: Array, residual: Array) -> Array:
        """The derivative of the residual by d to one side: beyond d, or before it at the end of its range and where a
        rod with a break beyond d has no equilibrium; zero where there is none on either side."""
        for step in (STEP_OF_BREAK, -STEP_OF_BREAK):
            moved = z.copy()
            moved[BREAK] += step
            if self.breaks[0] <= moved[BREAK] <= self.breaks[1]:
                there = self.residual(moved)
                if there[0] != _NO_ROD:
                    return np.asarray((there - residual) / (moved[BREAK] - z[BREAK]))
        return np.zeros(len(residual))

    def _changes_of_law(self, z: Array, steps: Steps) -> Changes:
        """What the unknowns other than d change, per unit: the law itself, and the ripple that it multiplies."""
        law = self.law(z)
        s = self._samples(law)
        moment, shapes = self._moment_at(s), self._harmonics_at(s)
        slope, shift = self.compliance * moment * (z[5:] @ shapes), -self.offset * (z[5:] @ shapes)
        first = s < law.d
        ripple = [slope * first, shift * first, slope * ~first, shift * ~first, *(law.deviation(s, moment) * shapes)]
        compliance, offset = np.zeros((2, len(steps.first), len(ripple)))
        for line, here in enumerate((steps.first, ~steps.first)):
            compliance[here, 2 * line], offset[here, 2 * line + 1] = self.compliance, self.offset
        return Changes(self._at_stages(s, ripple, steps), compliance, offset, np.zeros(len(ripple)))

    def _changes_of_rest(self, z: Array, steps: Steps) -> Changes:
        """The angle at the clamp, and kappa_0 at every node, per unit."""
        s, nodes = self._samples(self.law(z)), self.kappa_0[:, 0]
        hats = [np.interp(s, nodes, unit) for unit in np.eye(len(nodes))]
        none, at_clamp = np.zeros((len(steps.first), 1 + len(hats))), np.eye(1 + len(hats))[0]
        return Changes(self._at_stages(s, [np.zeros(len(s)), *hats], steps), none, none, at_clamp)

    def _at_stages(self, s: Array, values: Sequence[Array], steps: Steps) -> Array:
        """(n, 6, m) values m times (k,) at s (k,) mm, at the stages of the integration; straight lines between."""
        stages = steps.stages * self.shape.length
        return np.stack([np.interp(stages, s, each) for each in values], axis=-1)

    def minimised(self, z: Array, tolerance: float = EXACT) -> OptimizeResult:
        """The fit from z; its derivative with respect to d is one-sided where d lies at a node.

        At such a kink the steps shrink before the other unknowns have converged; these are fitted once more, d kept.
        """
        fit = self._fitted(z, tolerance)
        if self.seeks_break:
            fit = replace(self, breaks=(fit.x[BREAK],) * 2)._fitted(fit.x, tolerance)
        return fit

    def _fitted(self, z: Array, tolerance: float) -> OptimizeResult:
        low = np.array([COMPLIANCES[0], -np.inf, COMPLIANCES[0], -np.inf, self.breaks[0], *[-np.inf] * (2 * HARMONICS)])
        high = np.array([COMPLIANCES[1], np.inf, COMPLIANCES[1], np.inf, self.breaks[1], *[np.inf] * (2 * HARMONICS)])
        free = np.array([True] * 4 + [self.seeks_break] + [True] * (2 * HARMONICS))
        start = np.clip(z, np.where(free, low * (1 + 1e-9), low), np.where(free, high * (1 - 1e-9), high))

        def all_unknowns(part: Array) -> Array:
            full = start.copy()
            full[free] = part
            return full

        fit = least_squares(
            lambda part: self.residual(all_unknowns(part)),
            start[free],
            lambda part: self.jacobian(all_unknowns(part))[:, free],
            bounds=(low[free], high[free]),
            xtol=max(1e-10, tolerance),
            ftol=tolerance,
            gtol=tolerance,
            max_nfev=60,
        )
        return OptimizeResult(x=all_unknowns(fit.x), cost=fit.cost, fun=fit.fun)

    @property
    def seeks_break(self) -> bool:
        """Whether d is an unknown, and not given."""
        return self.breaks[0] < self.breaks[1]

    def with_derivatives(self, fit: OptimizeResult) -> OptimizeResult:
        """The same fit with its derivatives; that with respect to d is a difference over the nodes on both sides of d,
        where d is sought and there is a rod with a break at both nodes.

        The residual has kinks where the break passes a node, and minima are often there: rounding then decides on which
        side a derivative is taken, and that of one side says nothing of the other.
        """
        jac = self.jacobian(fit.x)
        if self.seeks_break:
            step = float(np.diff(self.shape.s).max()) / self.shape.length
            ends = np.array([fit.x, fit.x])
            ends[:, BREAK] = np.clip(fit.x[BREAK] + np.array([-step, step]), *self.breaks)
            before, behind = (self.residual(end) for end in ends)
            if _NO_ROD not in (before[0], behind[0]):
                jac[:, BREAK] = (behind - before) / (ends[1, BREAK] - ends[0, BREAK])
        return OptimizeResult(x=fit.x, cost=fit.cost, fun=fit.fun, jac=jac)

    def weighted(self, fit: OptimizeResult) -> "_ShapeFit":
        """The same task with the weights that the residual of a fit suggests."""
        n = len(self.shape.s)
        parts = fit.fun[: 2 * n].reshape(2, n) / self.weight
        # third differences: next to nothing of a smooth misfit, 20 times the variance of white noise
        variance = float(np.mean(np.diff(parts, 3, axis=1) ** 2)) / 20.0
        correlation = np.kron(np.eye(2), misfit_correlation(self.shape.pitch, self.shape.s)).astype(float)
        least = SHAPE_ERROR * self.shape.length
        error = total_covariance(parts.ravel(), fit.jac[: 2 * n], variance * np.eye(2 * n), correlation, least)[:n, :n]
        weight = math.sqrt(effective_observations(error) / n / float(error[0, 0]))
        # across the curve both shapes are noisy, along it only the loaded one
        noise = math.sqrt(variance / 1.5)
        return replace(self, weight=weight, noise=noise, misfit=error - variance * np.eye(n))

    def resampled(self, fit: OptimizeResult, bootstrap: Bootstrap) -> Array:
        """(draws, 5) the five parameters for drawn errors of both shapes and of the prior, by the linearised fit."""
        n, draws, random = len(self.shape.s), bootstrap.draws, bootstrap.generator()
        moved = self._moved(fit.x, self.noise * random.standard_normal((draws, 4, n)))
        for rows in (slice(0, n), slice(n, 2 * n)):
            moved[rows] += self.weight * sample_errors(self.misfit, draws, random)
        moved[2 * n :] += random.standard_normal((len(moved) - 2 * n, draws))
        z = fit.x[:, None] - np.linalg.pinv(fit.jac, rcond=1e-12) @ moved
        a1, a2 = (np.clip(z[i], *COMPLIANCES) * self.compliance for i in (0, 2))
        d = np.clip(z[4], *self.breaks) * self.shape.length
        return parameters_of_lines((a1, a2), (z[1] * self.offset, z[3] * self.offset), d)

    def _moved(self, z: Array, errors: Array) -> Array:
        """(rows of the residual, draws): its changes for small errors (draws, 4, n) mm of the nodes: x and y of the
        unloaded shape, x and y of the loaded one."""
        at, free = self._equilibrium(z), self.shape.free
        answer = response(at, self._changes_of_rest(z, at.problem.steps))
        x, y = np.diff(errors[:, 0]), np.diff(errors[:, 1])
        turned = (np.cos(free.angle) * y - np.sin(free.angle) * x) / free.chords
        theta0, kappa = _smooth(self.shape.s, turned)
        rest, loaded = np.vstack([theta0, kappa.T]), errors[:, 2:].T  # (1 + n, draws), (n, 2, draws)
        end = loaded[-1] - loaded[0]
        positions = answer.shape_at(self.shape.s) @ rest + answer.end_at(self.shape.s) @ end + loaded[0] - loaded
        prior = np.zeros((len(_prior(z)), len(errors)))
        return self._rows(positions, answer.force @ rest + answer.force_by_end @ end, prior)


def _prior(z: Array) -> Array:
    """The rows of the weak prior of `regression`."""
    return np.concatenate([z[[1, 3]], z[5:] / RIPPLE])
