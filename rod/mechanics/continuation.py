"""Continuation: the path of a rod from no load to the full load, in load steps that shrink and grow.

Everything is dimensionless as in `shooting`. Large loads have several equilibria; the solution is the one on the path
from the unloaded rod. A path that folds or branches is reported, not stepped over: the matrix of Newton's method keeps
the sign of its determinant as long as neither happens.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array, Mask
from rod.law import RodError
from rod.mechanics.profile import Steps
from rod.mechanics.shooting import RodArrays, converge, sweep

#: rad, the largest change of a tangent angle in one step of the load; keeps Newton's method on its branch
LARGEST_TURN = 1.0
SMALLEST_STEP = 1e-5
#: alpha/l^2, where errors grow too much along the rod, like exp(l sqrt(F/alpha)), for shooting from one end
FORCE_LIMIT = 200.0


@dataclass(frozen=True)
class Problem:
    """One rod, one set of loads. The clamp is the origin."""

    steps: Steps
    alpha: Array  #: (n,)
    m0: Array  #: (n,)
    fade: float
    stretch: Array  #: (n, 6) of the rod without load, at the stages of every step
    eccentricity: float
    theta0: float  #: rad
    free: Mask  #: (3,): M(0), F_x, F_y are unknown
    force: Array  #: (2,) given components, zero where unknown
    weight: Array  #: (2,)
    moment: float  #: at the tip
    end: Array  #: (2,) prescribed x and y of the tip, used where the force is unknown
    together: bool  #: kappa_0 and the rest stretch grow with the loads, from the straight rod

    @cached_property
    def start(self) -> "Point":
        """The rod before any load: straight, or with the shape of kappa_0."""
        states, end = np.empty((len(self.steps.s), 4)), np.empty(16)
        nothing = np.zeros(3)
        sweep(self.arrays(0.0)._replace(fade=0.0), nothing, nothing[:2], states, end)
        # columns of derivatives by M(0), F_x, F_y; rows M, x, y; a given force component keeps a trivial row
        matrix = np.where(np.outer(self.free, self.free), end[4:].reshape(3, 4)[:, 1:].T, np.eye(3))
        return Point(0.0, nothing, states, float(np.linalg.det(matrix)))

    def arrays(self, factor: float) -> RodArrays:
        """The rod at a load factor: its intercepts grow with the load, kappa_0 and rest stretch if `together`."""
        kappa_0, stretch = self.steps.kappa_0, self.stretch
        if self.together:
            kappa_0, stretch = factor * kappa_0, 1.0 + factor * (stretch - 1.0)
        m0 = factor * self.m0
        return RodArrays(self.steps.s, kappa_0, stretch, self.alpha, m0, self.fade, self.eccentricity, self.theta0)

    @property
    def idle(self) -> bool:
        """Nothing acts on the rod, which already has its curvature; an end that is held is held where it is."""
        if self.together:
            return False
        away = (self.end - self.start.states[-1, 2:])[self.free[1:]]
        loaded = self.moment != 0.0 or self.force.any() or self.weight.any()
        return not loaded and bool(np.all(np.abs(away) < 1e-13))


@dataclass(frozen=True)
class Point:
    """A converged point of the path."""

    factor: float  #: 0 nothing acts, 1 the whole load
    unknowns: Array  #: (3,) M(0), F_x, F_y
    states: Array  #: (n + 1, 4) theta, M, x, y
    determinant: float


def follow(problem: Problem) -> tuple[Point, int]:
    """The equilibrium under the whole load and the number of load steps. Raises `RodError` where the path ends."""
    before = here = problem.start
    if problem.idle:
        return here, 0
    step, count, sign = 1.0, 0, math.copysign(1.0, here.determinant)
    while here.factor < 1.0:
        factor = min(1.0, here.factor + step)
        tangent = np.zeros(3)
        if here.factor > 0.0:
            tangent = (here.unknowns - before.unknowns) / (here.factor - before.factor)
        there = _at(problem, factor, here.unknowns + (factor - here.factor) * tangent)
        near = there is not None and np.max(np.abs(there.states[:, 0] - here.states[:, 0])) < LARGEST_TURN
        if there is None or not near or there.determinant * sign < 0.0:
            step = 0.4 * (factor - here.factor)
            if step < SMALLEST_STEP:
                raise RodError(_end_of_path(problem, here, there is not None and bool(near)))
            continue
        before, here = here, there
        step, count = 2.0 * (factor - before.factor), count + 1
    return here, count


def _at(problem: Problem, factor: float, guess: Array) -> Point | None:
    """Newton's method at one load factor, or None where it does not converge."""
    unknowns = np.where(problem.free, guess, np.concatenate([[0.0], problem.force * factor]))
    start = problem.start.states[-1, 2:]
    target = np.concatenate([[factor * problem.moment], start + factor * (problem.end - start)])
    states = np.empty((len(problem.steps.s), 4))
    converged, determinant = converge(
        problem.arrays(factor), unknowns, factor * problem.weight, target, problem.free, states
    )
    return Point(factor, unknowns, states, determinant) if converged else None


def _end_of_path(problem: Problem, point: Point, split: bool) -> str:
    size = float(np.hypot(*point.unknowns[1:]) / problem.alpha.min())
    if size > FORCE_LIMIT:
        return (
            f"The end force has grown to {size:.0f} alpha/l^2; this solver follows the rod to about {FORCE_LIMIT:.0f}."
        )
    reached = f"{100 * point.factor:.3g} % of the load"
    if split:
        return f"The rod buckles at {reached}: beyond it what grows from the unloaded rod is unstable or ends."
    return f"No equilibrium was found beyond {reached}: the path from the unloaded rod ends there."
