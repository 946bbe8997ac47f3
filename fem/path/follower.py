"""Follows a path from target to target, each reached in as few increments as converge.

An increment that fails is halved; one that converges quickly is doubled. Within an increment contact is activated and
stiffened as the states demand (`fem.path.active_set`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Self, final

import numpy as np

from fem.effects.effect import at_constant_fraction, smallest_gap
from fem.equations.linear import LinearSolver
from fem.equations.system import System
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.control import Control, LoadControl
from fem.path.diagnosis import instability, law_limit_clause, near_limit_point
from fem.path.newton import Converged, NewtonOptions, NotAdmissible, Start, StepFailed
from fem.path.predictor import PathPoint, Predictor
from fem.post.extremes import extremes_of, position_text
from fem.solution import End, Seconds, Solution, Step
from geometry.arrays import Array

#: iterations of a quick increment, after which the next one is twice as large
QUICK_ITERATIONS = 8
#: where an increment to a load has failed, this fraction of it is small enough to try the same load once more
RETRY = 0.25
#: fraction of the way to the target above which an increment may not lead from a stable equilibrium to an unstable one:
#: near a sharp bend of the path a smaller one stays on the stable part
STABLE_INCREMENT = 1 / 16
#: largest number of iterations once an increment to the same target has failed: smaller ones converge in fewer
RETRY_ITERATIONS = 12


@dataclass(frozen=True)
class PathOptions:
    """How the path is followed."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)
    min_increment: float = 1 / 256  #: smallest increment that is tried, as a fraction of the way to the next target
    solver: Callable[[], LinearSolver] | None = None  #: makes the linear solver; None: the best installed one


@dataclass(frozen=True)
class PathObserver:
    """What is called while a path is followed."""

    #: after every Newton iteration, with the target, the number of the iteration and the relative residual
    iteration: Callable[[float, int, float], None] = lambda target, iteration, residual: None
    #: with every finished step
    step_done: Callable[[Step], None] = lambda step: None


class PathEnded(ArithmeticError):
    """A target that was not reached."""

    def __init__(self, end: End) -> None:
        super().__init__(end.cause)
        self.end = end


@dataclass(frozen=True)
class _Costs:
    """What a system has spent so far, or between two times."""

    wall: float  #: s
    seconds: Seconds  #: by stage, without the set-up
    factorizations: int

    @classmethod
    def of(cls, system: System) -> Self:
        """So far."""
        times, effects = system.solver.times, dict(system.clock.seconds)
        assembly = effects.pop("assembly", 0.0)
        seconds = Seconds(0.0, assembly, times.analysis, times.factorization, times.solve, effects)
        return cls(perf_counter(), seconds, times.factorizations)

    def __sub__(self, before: Self) -> Self:
        return replace(
            self,
            wall=self.wall - before.wall,
            seconds=self.seconds - before.seconds,
            factorizations=self.factorizations - before.factorizations,
        )


@dataclass(frozen=True)
class _LoadStep:
    """The way from one target to the next."""

    origin: PathPoint
    target: float

    def control(self, control: Control, fraction: float) -> Control:
        """What is prescribed at a fraction of the way."""
        start, applied = self.origin.value, self.origin.constant_fraction
        value = self.target if fraction == 1.0 else start + fraction * (self.target - start)
        return control.target(value, applied + fraction * (1.0 - applied))


@final
class PathFollower:
    """A path that is being followed: its last points and the terms that are active."""

    def __init__(self, control: Control, options: PathOptions, observer: PathObserver) -> None:
        self.system = control.system
        self.control = control
        self.options = options
        self.observer = observer
        self.active_set = ActiveSet.of(self.system.terms, self.system.space.points)
        terms = at_constant_fraction(self.active_set.active, 0.0)
        self.points = [PathPoint(control.value, 0.0, self.system.rest_state(), terms=terms)]  #: the last two
        self.predictor = Predictor(self.points[0], control)
        self.is_stable = True  #: whether the last equilibrium is
        self.not_followed = ""  #: a clause where the path lost its stability on the way to the target
        self.has_failed = False  #: whether an increment on the way to the target has failed
        self.predictor_failed = False  #: whether an extrapolated start has failed on the way to the target
        self.iterations = 0  #: of all solutions of the present increment that converged

    def resume(self, steps: Sequence[Step]) -> None:
        """Go on from the last of the given steps."""
        for step in steps:
            state = self.system.state_at(step.displacement, step.factor)
            self.active_set = ActiveSet.resumed(self.system.terms, step.active, step.positions)
            terms = at_constant_fraction(self.active_set.active, 1.0)
            touching = self.active_set.touching(step.positions)
            point = PathPoint(self.control.value_of(step), 1.0, state, touching, terms=terms)
            if step.rate is not None:
                point = replace(point, rate=self.system.rate(state, self.system.assemble(state, ()), step.rate))
            self.points, self.is_stable = [self.points[-1], point], step.negative_pivots == 0

    def advance(self, target: float) -> Step:
        """Equilibrium at `target`, in as few increments as converge; raises `PathEnded`."""
        before, load_step = _Costs.of(self.system), _LoadStep(self.points[-1], target)
        reached, increment, cutbacks, iterations = 0.0, 1.0, 0, 0
        cause = ""  # of the last equilibrium that no body can have
        failed, distance = np.inf, 0.0  # the lowest fraction that was not reached, and from how far
        self.has_failed, self.predictor_failed, self.active_set = False, False, self.active_set.restored()
        self.not_followed = ""
        while True:
            fraction = min(1.0, reached + increment)
            control = load_step.control(self.control, fraction)
            try:
                converged = self._try_increment(control, target)
                self._check_stability(converged, fraction - reached)
            except StepFailed as failure:
                cutbacks, self.has_failed = cutbacks + 1, True
                cause = str(failure) if isinstance(failure, NotAdmissible) else cause
                failed, distance = fraction, fraction - reached
                increment = distance / 2
                if increment < self.options.min_increment:
                    last = load_step.control(self.control, reached)
                    raise PathEnded(self._end(last, target, cutbacks, before, cause or str(failure))) from None
                continue
            iterations += self.iterations
            point = self._point(control, converged)
            if self.is_stable and converged.negative_pivots and fraction < 1.0:
                self.not_followed = _not_followed(reached, fraction)
            self.is_stable = converged.negative_pivots == 0
            if fraction == 1.0:
                self.points = [load_step.origin, point]  # the next extrapolation uses points at targets alone
                return self._step(converged, iterations, cutbacks, before)
            self.points = [self.points[-1], point]
            reached = fraction
            increment *= 2.0 if converged.iterations <= QUICK_ITERATIONS else 1.0
            if reached >= failed:
                failed = np.inf
            elif reached + increment >= failed and failed - reached > RETRY * distance:
                increment = (failed - reached) / 2

    def _try_increment(self, control: Control, target: float) -> Converged:
        """An admissible equilibrium where `control` puts it; raises `StepFailed`.

        Contact that was activated or stiffened stays so for the rest of the way to the target, after a failure too.
        """
        self.iterations = 0
        last = self.points[-1].state
        if self.active_set.is_tightened:
            converged = self._solve(Start(last, self.active_set.active), control, target)
        else:
            converged = self._from_predictor(control, target)
        converged = self._activate(converged, control, target)
        while violations := self.active_set.violations(x := self._positions(converged)):
            tightened = self.active_set.tightened(x)
            if tightened is self.active_set:
                raise NotAdmissible(violations[0])
            self.active_set = tightened
            start = Start(last if tightened.needs_admissible_start else converged.state, tightened.active)
            converged = self._activate(self._solve(start, control, target), control, target)
        if converged.assembly.jacobian.min() <= 0:
            worst = extremes_of(self.system.space, converged.assembly.strain, converged.assembly.jacobian)
            raise NotAdmissible(
                f"an element is turned inside out at {position_text(worst.min_J_at)} (J = {worst.min_J:.3g})"
            )
        return converged

    def _check_stability(self, converged: Converged, increment: float) -> None:
        """Raise `StepFailed` where a large increment of the load lost the stability of the last equilibrium."""
        follows_load = isinstance(self.control, LoadControl)
        if follows_load and self.is_stable and converged.negative_pivots and increment > STABLE_INCREMENT:
            raise StepFailed(f"the equilibrium is unstable ({converged.negative_pivots} negative pivots)")

    def _activate(self, converged: Converged, control: Control, target: float) -> Converged:
        """Equilibrium with those contacts too that a state activates; each may activate the next."""
        while (activated := self.active_set.activated(self._positions(converged))) is not self.active_set:
            self.active_set = activated
            converged = self._solve(Start(converged.state, activated.active), control, target)
        return converged

    def _from_predictor(self, control: Control, target: float) -> Converged:
        """Equilibrium, or a state that activates contact, from the first start of the predictor that leads to one."""
        failure = StepFailed("no start was tried")
        for start in self.predictor.starts(self.points, control, self.active_set.active):
            is_extrapolated = start.max_iterations is not None
            if is_extrapolated and self.predictor_failed:
                continue
            try:
                return self._solve(start, control, target)
            except StepFailed as failed:
                failure = failed
                self.predictor_failed = self.predictor_failed or is_extrapolated
        raise failure

    def _solve(self, start: Start, control: Control, target: float) -> Converged:
        def watch(iteration: int, residual: float) -> None:
            self.observer.iteration(target, iteration, residual)

        start = replace(start, terms=at_constant_fraction(start.terms, control.constant_fraction))
        if self.has_failed and not self.active_set.needs_admissible_start:
            start = replace(start, max_iterations=min(RETRY_ITERATIONS, start.max_iterations or RETRY_ITERATIONS))
        converged = newton.solve(start, control, self.options.newton, watch, self.active_set.inactive)
        self.iterations += converged.iterations
        return converged

    def _positions(self, converged: Converged) -> Array:
        return self.system.space.points + converged.state.displacement

    def _point(self, control: Control, converged: Converged) -> PathPoint:
        """The point of the path at an equilibrium, with its rate where the last tangent matrix gives it."""
        terms = at_constant_fraction(self.active_set.active, control.constant_fraction)
        touching = self.active_set.touching(self._positions(converged))
        rate = self.predictor.rate(control, converged, terms)
        return PathPoint(control.value, control.constant_fraction, converged.state, touching, rate, terms)

    def _end(self, reached: Control, target: float, cutbacks: int, before: _Costs, failure: str) -> End:
        last = self.points[-1]
        law = law_limit_clause(self.system, last.state)
        cause = failure + law + near_limit_point(self.system, last, law_is_named=bool(law))
        factorizations = (_Costs.of(self.system) - before).factorizations
        quantity, fraction = self.control.name, reached.constant_fraction
        return End(quantity, target, reached.value, fraction, cutbacks, factorizations, cause)

    def _step(self, converged: Converged, iterations: int, cutbacks: int, before: _Costs) -> Step:
        system, state, rate = self.system, converged.state, self.points[-1].rate
        unstable = instability(system, converged, self.points[-1].terms)  # factorizes where it is unstable
        costs = _Costs.of(system) - before
        return Step(
            space=system.space,
            factor=state.factor,
            displacement=state.displacement,
            stress=state.stress,
            rate=None if rate is None else rate.change,
            gradient=np.where(system.constraints.constrained, converged.assembly.gradient, 0.0),
            extremes=extremes_of(system.space, converged.assembly.strain, converged.assembly.jacobian),
            min_gap=smallest_gap(self.active_set.stiffened, self._positions(converged)),
            negative_pivots=converged.negative_pivots,
            instability="; ".join(filter(None, (unstable, self.not_followed))),
            newton_iterations=iterations,
            factorizations=costs.factorizations,
            cutbacks=cutbacks,
            effects=self.active_set.effects,
            active=self.active_set.is_active,
            seconds=costs.wall,
            spent=costs.seconds,
        )

    def solution(self, steps: Sequence[Step], set_up: float) -> Solution:
        """What was reached, with the seconds spent."""
        times = self.system.solver.times
        return Solution(
            steps=tuple(steps),
            seconds=Seconds(set_up=set_up) + _Costs.of(self.system).seconds,
            factorizations=times.factorizations,
            analyses=times.analyses,
            solver=type(self.system.solver).__name__,
            degrees_of_freedom=self.system.size,
        )


def _not_followed(stable: float, unstable: float) -> str:
    """A clause about a path that lost its stability between these two fractions of the way to a target."""
    return (
        f"the path was not followed: it lost its stability between {100 * stable:.1f} and {100 * unstable:.1f} % "
        "of the way to this state; smaller steps there end at a limit point or follow another branch"
    )
