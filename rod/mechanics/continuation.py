"""Continuation: the path of a rod from no load to the full load, in load steps that shrink and grow.

Everything is dimensionless as in `shooting`. Large loads have several equilibria; the solution is the one on the path
from the unloaded rod. A path that folds or branches is reported, not stepped over: the matrix of Newton's method keeps
the sign of its determinant as long as neither happens.

Newton's method may also converge to an equilibrium far from the path: with prescribed ends to modes of buckling with
many waves, whose angles are close to the last ones. But a path is smooth. Its states follow the straight line through
the two states before ever more closely the smaller the step is, and those of another equilibrium do not.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array, Mask
from rod.errors import RodError, buckles_at
from rod.mechanics.profile import Steps
from rod.mechanics.shooting import RodArrays, converge, sweep

#: rad, largest change of a tangent angle in one load step; keeps Newton's method on its branch
MAX_ROTATION_STEP = 1.0
#: first load step, which gives the direction of the path: the response is linear in it, also that of a rod that is
#: nearly straight and compressed
FIRST_STEP = 1e-6
#: largest distance of a state from the line through the two before, over its distance from the last one
SMOOTH = 0.5
#: changes of the angle (rad) and the moment that are small on any path, however far from that line
SMALL = np.array([1e-3, 1e-2])
#: smallest load step over the full load
MIN_LOAD_STEP = 1e-7
#: alpha/l^2, limit of shooting from one end: errors grow along the rod like exp(l sqrt(F/alpha))
MAX_FORCE = 200.0
#: smallest load step beyond this force: towards an end that cannot be reached there would be thousands of smaller ones
MIN_STEP_BEYOND = 1e-3


@dataclass(frozen=True)
class Problem:
    """A dimensionless rod under one set of loads. The clamp is the origin."""

    steps: Steps
    kappa_0: Array  #: (n, 6) of the rod without load, under its own weight, at the stages of every step
    alpha: Array  #: (n,)
    m0: Array  #: (n,)
    fade: float
    stretch: Array  #: (n, 6) at the stages of every step
    eccentricity: float
    theta0: float  #: rad
    free: Mask  #: (3,): M(0), F_x, F_y are unknown
    force: Array  #: (2,) given components, zero where unknown
    weight: Array  #: (4,) of the load, as in `shooting`
    own_weight: Array  #: (4,) of the rod itself, in full from the start, or growing with kappa_0 if `together`
    rest_moment: Array  #: (n, 6) of the own weight on the rod without load, about the neutral axis (`own_weight`)
    rest_clamp_moment: float  #: of the same about the curve, at the clamp
    moment: float  #: at the tip
    end: Array  #: (2,) prescribed x and y of the tip, used where the force is unknown
    together: bool  #: kappa_0 and the rest stretch grow with the loads, from the straight rod

    @cached_property
    def start(self) -> "LoadPoint":
        """The rod before any load: straight, or with the shape of kappa_0."""
        states, end = np.empty((len(self.steps.s), 4)), np.empty(16)
        unknowns = np.array([0.0 if self.together else self.rest_clamp_moment, 0.0, 0.0])
        sweep(self.arrays(0.0)._replace(fade=0.0), unknowns, self.weight_at(0.0), states, end)
        # columns of derivatives by M(0), F_x, F_y; rows M, x, y; a given force component keeps a trivial row
        matrix = np.where(np.outer(self.free, self.free), end[4:].reshape(3, 4)[:, 1:].T, np.eye(3))
        return LoadPoint(0.0, unknowns, states, float(np.linalg.det(matrix)))

    def arrays(self, factor: float) -> RodArrays:
        """The rod at a load factor: its intercepts grow with the load, kappa_0 and rest stretch if `together`."""
        kappa_0, stretch, rest_moment = self.kappa_0, self.stretch, self.rest_moment
        if self.together:
            kappa_0, stretch, rest_moment = factor * kappa_0, 1.0 + factor * (stretch - 1.0), factor * rest_moment
        s, m0 = self.steps.s, factor * self.m0
        return RodArrays(s, kappa_0, stretch, self.alpha, m0, rest_moment, self.fade, self.eccentricity, self.theta0)

    def weight_at(self, factor: float) -> Array:
        """(4,) weight at a load factor."""
        return factor * self.weight + (factor if self.together else 1.0) * self.own_weight

    @property
    def idle(self) -> bool:
        """Whether no load acts on the pressurised rod; a prescribed end is then where the unloaded rod has it."""
        if self.together:
            return False
        away = (self.end - self.start.states[-1, 2:])[self.free[1:]]
        loaded = self.moment != 0.0 or self.force.any() or self.weight.any()
        return not loaded and bool(np.all(np.abs(away) < 1e-13))


@dataclass(frozen=True)
class LoadPoint:
    """A converged point of the path."""

    factor: float  #: load factor, 0 to 1
    unknowns: Array  #: (3,) M(0), F_x, F_y
    states: Array  #: (n + 1, 4) theta, M, x, y
    determinant: float


def continue_to_full_load(problem: Problem) -> tuple[LoadPoint, int]:
    """The equilibrium under the full load and the number of load steps. Raises `RodError` where the path ends."""
    previous = current = problem.start
    if problem.idle:
        return current, 0
    previous, current, step, count = current, _first(problem, current), 1.0, 1
    sign = math.copysign(1.0, current.determinant)
    while current.factor < 1.0:
        factor = min(1.0, current.factor + step)
        tangent = (current.unknowns - previous.unknowns) / (current.factor - previous.factor)
        trial = _at(problem, factor, current.unknowns + (factor - current.factor) * tangent)
        near = trial is not None and _is_near(previous, current, trial)
        if trial is None or not near or trial.determinant * sign < 0.0:
            step = 0.4 * (factor - current.factor)
            if step < (MIN_LOAD_STEP if _force(problem, current) <= MAX_FORCE else MIN_STEP_BEYOND):
                raise RodError(_end_of_path(problem, current, near))
            continue
        previous, current = current, trial
        step, count = 2.0 * (factor - previous.factor), count + 1
    return current, count


def _first(problem: Problem, start: LoadPoint) -> LoadPoint:
    """The point after the first step. Raises `RodError` where there is none: an end that is put nearer to the clamp
    buckles a straight rod at once, to either side."""
    point = _at(problem, FIRST_STEP, start.unknowns)
    if point is None or not _has_small_turn(start, point) or point.determinant * start.determinant < 0.0:
        raise RodError(buckles_at(0.0))
    return point


def _is_near(previous: LoadPoint, current: LoadPoint, trial: LoadPoint) -> bool:
    """Whether a point may follow two others on the path."""
    if not _has_small_turn(current, trial):
        return False
    part = (trial.factor - current.factor) / (current.factor - previous.factor)
    change, before = ((b.states - a.states)[:, :2] for a, b in ((current, trial), (previous, current)))
    off, size = np.abs(change - part * before).max(axis=0), np.abs(change).max(axis=0)
    return bool((off <= np.maximum(SMOOTH * size, SMALL)).all())


def _has_small_turn(current: LoadPoint, trial: LoadPoint) -> bool:
    return bool(np.max(np.abs(trial.states[:, 0] - current.states[:, 0])) < MAX_ROTATION_STEP)


def _at(problem: Problem, factor: float, guess: Array) -> LoadPoint | None:
    """Newton's method at one load factor, or None where it does not converge."""
    unknowns = np.where(problem.free, guess, np.concatenate([[0.0], problem.force * factor]))
    start = problem.start.states[-1, 2:]
    target = np.concatenate([[factor * problem.moment], start + factor * (problem.end - start)])
    states = np.empty((len(problem.steps.s), 4))
    converged, determinant = converge(
        problem.arrays(factor), unknowns, problem.weight_at(factor), target, problem.free, states
    )
    return LoadPoint(factor, unknowns, states, determinant) if converged else None


def _force(problem: Problem, point: LoadPoint) -> float:
    """On the end, alpha/l^2."""
    return float(np.hypot(*point.unknowns[1:]) / problem.alpha.min())


def too_large(force: float) -> str:
    """The sentence on a force (alpha/l^2) that this solver does not follow."""
    return f"The end force has grown to {force:.0f} alpha/l^2; this solver follows the rod to about {MAX_FORCE:.0f}."


def _end_of_path(problem: Problem, point: LoadPoint, split: bool) -> str:
    if (force := _force(problem, point)) > MAX_FORCE:
        return too_large(force)
    if split:
        return buckles_at(point.factor)
    reached = f"{100 * point.factor:.3g} % of the load"
    return f"No equilibrium was found beyond {reached}: the path from the unloaded rod ends there."
