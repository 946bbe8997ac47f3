"""The planar, inextensible rod in equilibrium (paper, section 2.1; design notes, "The rod").

    theta' = kappa,  x' = cos theta,  y' = sin theta,  M' = n_x sin theta - n_y cos theta,  kappa = kappa_0 + (M -
    m0_i)/alpha_i

clamped at s = 0, with n(s) = F + q (l - s), end force F, end moment M(l) and a dead load q per length (gravity). Known
are F or components of the end position, in which case the force components that hold them are found.

The unknowns are M(0) and the force components that hold the end. They are found by shooting (`shooting`), and large
loads by continuation: all loads, the prescribed end and the intercepts grow together from the unloaded rod, whose
shape is that of kappa_0. So the solution is the one that the rod reaches, and a path that folds or splits is reported,
not stepped over.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .law import FiveParameters, RodError
from .profile import Profile, Steps, cut_into_steps
from .shooting import converge, sweep

Array = NDArray[np.float64]

#: rad, the largest change of a tangent angle in one step of the load; keeps Newton's method on its branch
LARGEST_TURN = 1.0
SMALLEST_STEP = 1e-5
#: alpha/l^2, where errors grow too much along the rod, like exp(l sqrt(F/alpha)), for shooting from one end
FORCE_LIMIT = 200.0


@dataclass(frozen=True)
class RodSolution:
    """A rod in equilibrium. All arrays are read-only; at s = d kappa is that of the piece beyond d."""

    s: Array  #: (n,) mm, arc length
    x: Array  #: (n,) mm
    y: Array  #: (n,) mm
    theta: Array  #: (n,) rad, tangent angle
    kappa: Array  #: (n,) 1/mm
    moment: Array  #: (n,) N mm
    force: Array  #: (2,) N, F_x and F_y on the end s = l
    load_steps: int  #: steps of the continuation

    def positions(self, s: Array) -> Array:
        """(m, 2) mm: x and y at the arc lengths s (m,), by cubic Hermite interpolation with the tangents.

        Raises `RodError` for an s off the rod.
        """
        s = np.asarray(s, float)
        if s.size and (s.min() < -1e-9 * self.s[-1] or s.max() > (1 + 1e-9) * self.s[-1]):
            raise RodError(
                f"The rod goes from s = 0 to {self.s[-1]:g} mm; it has no point at s = {s.min():g} ... {s.max():g}."
            )
        i = np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2)
        h = self.s[i + 1] - self.s[i]
        t = (s - self.s[i]) / h
        a, b = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2
        c, e = t * t * (3 - 2 * t), t * t * (t - 1)
        x = a * self.x[i] + c * self.x[i + 1] + h * (b * np.cos(self.theta[i]) + e * np.cos(self.theta[i + 1]))
        y = a * self.y[i] + c * self.y[i + 1] + h * (b * np.sin(self.theta[i]) + e * np.sin(self.theta[i + 1]))
        return np.column_stack([x, y])


@dataclass(frozen=True)
class Rod:
    """A clamped planar rod with the five-parameter law.

    kappa_0 (1/mm) is a number, an array (n,) of values at equally spaced points from 0 to length, an array (n, 2) of
    columns s and kappa_0, or a function of s; samples are joined by straight lines. Raises `RodError` for a length
    that is not positive, a kappa_0 that does not fit it, or a break d off the rod.
    """

    length: float  #: mm
    kappa_0: Profile  #: 1/mm
    law: FiveParameters
    theta0: float = 0.0  #: rad, tangent angle at the clamp
    start: tuple[float, float] = (0.0, 0.0)  #: mm, x and y of the clamp
    fade: float = 0.0  #: N mm, below this |M| the intercepts fade to zero (see `law`)
    steps: Steps = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise RodError(f"The length of a rod must be positive, not {self.length} mm.")
        if not 0.0 < self.law.d < self.length:
            raise RodError(f"The break d = {self.law.d:g} mm lies off the rod of {self.length:g} mm.")
        if not (math.isfinite(self.fade) and self.fade >= 0.0):
            raise RodError(f"fade is a moment of at least 0 N mm, not {self.fade}.")
        object.__setattr__(self, "steps", cut_into_steps(self.length, self.kappa_0, self.law))

    def solve(
        self,
        force: Sequence[float] | None = None,
        *,
        end: Sequence[float] | None = None,
        end_x: float | None = None,
        end_y: float | None = None,
        moment: float = 0.0,
        weight: Sequence[float] = (0.0, 0.0),
    ) -> RodSolution:
        """The equilibrium reached from the unloaded rod when all loads grow together.

        force: dead end force (F_x, F_y) in N; or end = (x, y), end_x or end_y in mm, the position of the end (the
        other force component is zero: end_y alone is Test III). Either may be combined with moment, M(l) in N mm, and
        weight, a dead load (q_x, q_y) per length in N/mm. Raises `RodError` when the loads contradict each other, when
        the end is put farther away than the rod is long, and when the path ends before the whole load is applied.
        """
        if end is not None and (end_x is not None or end_y is not None):
            raise RodError("Give either end = (x, y) or one of end_x and end_y, not both.")
        if end is not None:
            end_x, end_y = _pair(end, "end")
        if force is not None and (end_x is not None or end_y is not None):
            raise RodError("Give either the force on the end or its position, not both: one follows from the other.")
        given = _pair((0.0, 0.0) if force is None else force, "force")
        loads = (given, end_x, end_y, float(moment), _pair(weight, "weight"))
        solution = _follow(_Task.of(self, self.steps, *loads))
        refinement = _refinement(self, solution, loads[-1])
        if refinement > 1.0:
            steps = cut_into_steps(self.length, self.kappa_0, self.law, refinement)
            solution = _follow(_Task.of(self, steps, *loads))
        return solution


def _refinement(rod: Rod, solution: RodSolution, weight: tuple[float, float]) -> float:
    """How much finer than the usual the steps must be: at large forces errors grow like exp(s sqrt(F/alpha))."""
    softest = min(rod.law.alpha1, rod.law.alpha2)
    force = np.hypot(*solution.force) + rod.length * math.hypot(*weight)
    growth = rod.length * math.sqrt(force / softest)
    return max(1.0, growth / 4.0 * math.exp((growth - 4.0) / 6.0))


def _pair(values: Sequence[float], name: str) -> tuple[float, float]:
    pair = tuple(float(v) for v in values)
    if len(pair) != 2 or not all(math.isfinite(v) for v in pair):
        raise RodError(f"{name} is a pair of finite numbers, x and y; {values!r} is not.")
    return pair


@dataclass(frozen=True)
class _Task:
    """One problem in units of the rod: length l, rigidity B = alpha2, moments B/l, forces B/l^2."""

    rod: Rod
    steps: Steps
    alpha: Array  #: (n,) over B
    m0: Array  #: (n,)
    fade: float
    free: Array  #: (3,) bool: M(0), F_x, F_y unknown
    force: Array  #: (2,) given components, zero where unknown
    weight: Array  #: (2,)
    target: Array  #: (3,) M(l), x(l), y(l), the latter two from the clamp and only where free
    rest: Array  #: (n + 1, 4) states of the unloaded rod

    @staticmethod
    def of(
        rod: Rod,
        steps: Steps,
        force: tuple[float, float],
        end_x: float | None,
        end_y: float | None,
        moment: float,
        weight: tuple[float, float],
    ) -> _Task:
        law, length = rod.law, rod.length
        base = law.alpha2
        alpha = np.where(steps.first, law.alpha1 / base, 1.0)
        m0 = np.where(steps.first, law.m01, law.m02) * length / base
        rest = np.empty((len(steps.s), 4))
        sweep(steps.s, steps.kappa_0, alpha, 0.0 * m0, 0.0, rod.theta0, np.zeros(3), np.zeros(2), rest, np.empty(16))
        target = np.array([moment * length / base, rest[-1, 2], rest[-1, 3]])
        for i, place in enumerate((end_x, end_y)):
            if place is not None:
                target[1 + i] = (place - rod.start[i]) / length
        reach = math.hypot(*(target[1 + i] if p is not None else 0.0 for i, p in enumerate((end_x, end_y))))
        if not math.isfinite(moment):
            raise RodError("The end moment must be a finite number.")
        if not reach < 1.0:
            raise RodError(
                f"The end cannot be {reach * length:g} mm from the clamp: the rod of {length:g} mm is inextensible."
            )
        free = np.array([True, end_x is not None, end_y is not None])
        unit = length**2 / base
        return _Task(
            rod,
            steps,
            alpha,
            m0,
            rod.fade * length / base,
            free,
            np.array(force) * unit,
            np.array(weight) * unit * length,
            target,
            rest,
        )

    @property
    def unloaded(self) -> bool:
        """Nothing acts: no load, and the end is held, if at all, where it already is."""
        away = self.target - np.array([0.0, self.rest[-1, 2], self.rest[-1, 3]])
        return bool(np.all(np.abs(away[self.free]) < 1e-13) and not self.force.any() and not self.weight.any())


@dataclass(frozen=True)
class _Point:
    """A converged point of the path."""

    factor: float  #: 0 unloaded, 1 whole load
    unknowns: Array  #: (3,)
    states: Array  #: (n + 1, 4)
    determinant: float


def _at(task: _Task, factor: float, guess: Array) -> _Point | None:
    """Newton's method at one load factor, or None where it does not converge."""
    steps = task.steps
    unknowns = np.where(task.free, guess, np.concatenate([[0.0], task.force * factor]))
    start = np.array([0.0, task.rest[-1, 2], task.rest[-1, 3]])
    target = start + factor * (task.target - start)
    states = np.empty((len(steps.s), 4))
    converged, determinant = converge(
        steps.s,
        steps.kappa_0,
        task.alpha,
        factor * task.m0,
        task.fade,
        task.rod.theta0,
        unknowns,
        factor * task.weight,
        target,
        task.free,
        states,
        np.empty(16),
    )
    return _Point(factor, unknowns, states, determinant) if converged else None


def _follow(task: _Task) -> RodSolution:
    """The path from the unloaded rod to the whole load, with steps that shrink and grow."""
    here = _at(task, 0.0, np.zeros(3)) or _Point(0.0, np.zeros(3), task.rest, 1.0)
    if task.unloaded:
        return _solution(task, here, 0)
    # the path is the one without folds and branches as long as the matrix keeps the sign it has for the unloaded rod
    before, step, count, sign = here, 1.0, 0, math.copysign(1.0, here.determinant)
    while here.factor < 1.0:
        factor = min(1.0, here.factor + step)
        tangent = np.zeros(3)
        if here.factor > 0.0:
            tangent = (here.unknowns - before.unknowns) / (here.factor - before.factor)
        there = _at(task, factor, here.unknowns + (factor - here.factor) * tangent)
        near = there is not None and np.max(np.abs(there.states[:, 0] - here.states[:, 0])) < LARGEST_TURN
        if there is None or not near or there.determinant * sign < 0.0:
            step = 0.4 * (factor - here.factor)
            if step < SMALLEST_STEP:
                raise RodError(_end_of_path(task, here, there is not None and near))
            continue
        before, here = here, there
        step, count = 2.0 * (factor - before.factor), count + 1
    return _solution(task, here, count)


def _end_of_path(task: _Task, point: _Point, split: bool) -> str:
    size = float(np.hypot(*point.unknowns[1:]) / task.alpha.min())
    if size > FORCE_LIMIT:
        return (
            f"The end force has grown to {size:.0f} alpha/l^2; this solver follows the rod to about {FORCE_LIMIT:.0f}."
        )
    reached = f"{100 * point.factor:.3g} % of the load"
    if split:
        return f"The rod buckles at {reached}: beyond it what grows from the unloaded rod is unstable or ends."
    return f"No equilibrium was found beyond {reached}: the path from the unloaded rod ends there."


def _solution(task: _Task, point: _Point, count: int) -> RodSolution:
    rod, law, steps = task.rod, task.rod.law, task.steps
    moment = point.states[:, 1] * law.alpha2 / rod.length
    s = steps.s * rod.length
    share = point.factor if rod.fade == 0.0 else np.minimum(1.0, np.abs(moment) / rod.fade)
    first = np.append(steps.first, False)
    m0, alpha = np.where(first, law.m01, law.m02), np.where(first, law.alpha1, law.alpha2)
    kappa_0 = np.append(steps.kappa_0[:, 0], steps.kappa_0[-1, 1]) / rod.length
    arrays = {
        "s": s,
        "x": rod.start[0] + rod.length * point.states[:, 2],
        "y": rod.start[1] + rod.length * point.states[:, 3],
        "theta": point.states[:, 0].copy(),
        "kappa": kappa_0 + (moment - share * m0) / alpha,
        "moment": moment,
        "force": np.where(task.free[1:], point.unknowns[1:], task.force) * law.alpha2 / rod.length**2,
    }
    for array in arrays.values():
        array.setflags(write=False)
    return RodSolution(**arrays, load_steps=count)
