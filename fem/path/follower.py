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
from fem.path.increments import LIMIT_ACCURACY, MAX_NEAR_FAILURES, Increments
from fem.path.limit import announced_limit, way_between
from fem.path.newton import Converged, Inverted, NewtonOptions, NotAdmissible, Start, StepFailed, Unstable
from fem.path.predictor import PathPoint, Predictor
from fem.post.extremes import extremes_of, position_text
from fem.solution import End, Seconds, Solution, Step
from geometry.arrays import Array

#: largest number of iterations once an increment to the same target has failed: smaller ones converge in fewer; and
#: near a limit that the path announces
RETRY_ITERATIONS, ITERATIONS_NEAR_LIMIT = 12, 8
#: largest number of iterations with an indefinite tangent from a stable equilibrium to the next; those that led
#: anywhere on the hard cases had at most 5
MAX_UNSTABLE = 7
#: the same with walls in contact near a limit that the path announces, and where a smaller increment follows one that
#: failed: 121 stable equilibria of benchmarks/limits.py took at most 2, before all iterations with a definite tangent
MAX_UNSTABLE_RETRY = 2
#: length of an increment over the last one from which on a smaller one costs less than other starts
FAR = 1.2


@dataclass(frozen=True)
class PathOptions:
    """How the path is followed."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)
    min_increment: float = 1 / 256  #: smallest increment that is tried, as a fraction of the way to the next target
    #: why a target is not worth smaller increments than the whole way to it, once that has failed or a limit is
    #: announced before it; empty where it is
    give_up: Callable[[float], str] = lambda target: ""
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


@dataclass(frozen=True)
class _Effort:
    """What a solution may cost."""

    iterations: int | None = None  #: largest number of iterations besides that of the options; None: no other
    unstable: int | None = None  #: largest number of those with an indefinite tangent; None: any
    stays_stable: bool = False  #: whether none of those may follow one with a definite tangent
    is_near_limit: bool = False  #: whether one start is enough, because it is near or the load is too large


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
        #: the last point on the way to the first target, with its rate while constant loads grow as well
        self.arrival: PathPoint | None = None
        self.is_stable = True  #: whether the last equilibrium is
        self.not_followed = ""  #: a clause where the path lost its stability on the way to the target
        self.effort = _Effort()  #: in the present increment
        self.predictor_failed = False  #: whether an extrapolated start has failed on the way to the target
        self.limit: float | None = None  #: value at which the path announces its end
        self.iterations = 0  #: of all solutions of the present increment that converged

    def resume(self, steps: Sequence[Step], goes_on: bool) -> None:
        """Go on from the last of the given steps; goes_on: whether more targets follow.

        From the first step the way on depends on the rate at rest, which is computed again (one factorization).
        """
        for step in steps:
            state = self.system.state_at(step.displacement, step.factor)
            self.active_set = ActiveSet.resumed(self.system.terms, step.active, step.positions)
            terms = at_constant_fraction(self.active_set.active, 1.0)
            touching = self.active_set.touching(step.positions)
            point = PathPoint(self.control.value_of(step), 1.0, state, touching, terms=terms)
            if step.rate is not None:
                point = replace(point, rate=self.system.rate(state, self.system.assemble(state, ()), step.rate))
            self.points, self.is_stable = [self.points[-1], point], step.negative_pivots == 0
        if goes_on and len(steps) == 1:
            self.predictor.rate_from_rest(self.control.target(self.points[-1].value, 1.0))
        if steps:
            self.system.storage.hold(steps[-1].added_pairs)

    def advance(self, target: float) -> Step:
        """Equilibrium at `target`, in as few increments as converge; raises `PathEnded`."""
        before, load_step = _Costs.of(self.system), _LoadStep(self.points[-1], target)
        increments = Increments(load_step.origin.value, target, self.options.min_increment)
        self.limit = increments.limit = self._announced_limit(self.points[0], self.points[-1])
        iterations, cause = 0, StepFailed("no increment was tried")
        self.predictor_failed, self.not_followed, self.active_set = False, "", self.active_set.restored()
        is_asked = False
        while True:
            fraction = increments.next
            if fraction < 1.0 and not is_asked and (reason := self.options.give_up(target)):
                last = load_step.control(self.control, increments.reached)
                raise PathEnded(self._given_up(last, increments, before, reason))
            is_asked = is_asked or fraction < 1.0
            control = load_step.control(self.control, fraction)
            try:
                converged = self._try_increment(control, target, self._effort(control, increments))
                point = self._point(control, converged)
                arrival = self._check_continuation(control, converged, point, increments)
            except StepFailed as failure:
                # an equilibrium that no body can have tells more than none
                cause = cause if isinstance(cause, NotAdmissible) > isinstance(failure, NotAdmissible) else failure
                increments.failed(fraction, isinstance(failure, Unstable), isinstance(failure, Inverted))
                last = load_step.control(self.control, increments.reached)
                if increments.ended:
                    raise PathEnded(self._end(last, increments, before, cause)) from None
                continue
            iterations += self.iterations
            if self.is_stable and converged.negative_pivots and fraction < 1.0:
                self.not_followed = _not_followed(increments.reached, fraction)
            self.is_stable = converged.negative_pivots == 0
            self.limit = self._announced_limit(self.points[-1], point)
            self.points, self.arrival = [self.points[-1], point], arrival
            increments.accepted(fraction, converged.iterations, self.limit)
            if fraction == 1.0:
                self.points = [load_step.origin, point]  # the next extrapolation uses points at targets alone
                return self._step(converged, iterations, increments.cutbacks, before)
            if increments.is_confirmed_or_exhausted:
                raise PathEnded(self._end(control, increments, before, cause))

    def _effort(self, control: Control, increments: Increments) -> _Effort:
        """How long an equilibrium is sought with the next increment.

        No longer than until the tangent is indefinite where no unstable equilibrium would be accepted: near an
        announced limit, and in large increments after one that failed. Contact makes the tangent indefinite on the way
        to stable equilibria as well.
        """
        most = MAX_UNSTABLE_RETRY if self.points[-1].touching else 0
        if increments.passes_limit or (increments.cutbacks and increments.nears_limit):
            return _Effort(ITERATIONS_NEAR_LIMIT, most if self.is_stable else None, self.is_stable, True)
        iterations = RETRY_ITERATIONS if increments.cutbacks else None
        if not (self._follows_load and self.is_stable):
            return _Effort(iterations)
        if increments.cutbacks and not increments.is_small:
            return _Effort(iterations, most, True)
        if len(self.points) > 1 and self._is_far(control):
            return _Effort(iterations, MAX_UNSTABLE_RETRY, True)
        return _Effort(iterations, MAX_UNSTABLE)

    @property
    def _follows_load(self) -> bool:
        return isinstance(self.control, LoadControl)

    def _try_increment(self, control: Control, target: float, effort: _Effort) -> Converged:
        """An admissible equilibrium where `control` puts it; raises `StepFailed`.

        Contact that was activated or stiffened stays so for the rest of the way to the target, after a failure too.
        """
        self.iterations, self.effort = 0, effort
        last, known = self.points[-1].state, self.active_set
        foreseen = self._approach(control)
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
        if foreseen and not self.active_set.touching(self._positions(converged)):
            self.active_set = known  # the contact did not come, and does nothing where the gaps are open
        if converged.assembly.jacobian.min() <= 0:
            worst = extremes_of(self.system.space, converged.assembly.strain, converged.assembly.jacobian)
            raise Inverted(
                f"an element is turned inside out at {position_text(worst.min_J_at)} (J = {worst.min_J:.3g})"
            )
        return converged

    def _check_continuation(
        self, control: Control, converged: Converged, point: PathPoint, increments: Increments
    ) -> PathPoint:
        """The point with its rate on the way that led to it, while constant loads grow as well.

        Raises `Unstable` where an equilibrium under a given load is not on the path that led to the last one.
        """
        if not self._follows_load:
            return point
        last, arrival = self._with_rate(self.points[-1]), point
        if self.predictor.nonsmooth_start and last.constant_fraction < 1.0:
            last = self.arrival or replace(last, rate=self.predictor.rate_at_rest)
            arrival = replace(point, rate=self.predictor.rate_with_constants(control, converged, point.terms))
        way = way_between(last, arrival)
        if self.is_stable and converged.negative_pivots:
            is_small = increments.is_small
            if not (way.is_straight or (is_small and way.is_smooth) if way else is_small):
                raise Unstable(f"the equilibrium is unstable ({converged.negative_pivots} negative pivots)")
        if way and way.is_jump:
            raise Unstable("the body jumps to another equilibrium, to which no continuous path leads")
        if increments.passes_limit and way and not (way.is_smooth and increments.may_pass_limit):
            raise Unstable("beyond the limit that the path announces there is another equilibrium only")
        return arrival

    def _announced_limit(self, before: PathPoint, last: PathPoint) -> float | None:
        """The load at which the path announces a limit; None where it announces none."""
        is_smooth = before.constant_fraction == 1.0 or not self.predictor.nonsmooth_start
        return announced_limit(self._with_rate(before), last) if self._follows_load and is_smooth else None

    def _with_rate(self, point: PathPoint) -> PathPoint:
        """The point, with its rate at rest too where that is known."""
        is_rest = point is self.predictor.rest and not self.predictor.nonsmooth_start
        return replace(point, rate=self.predictor.rate_at_rest) if is_rest else point

    def _approach(self, control: Control) -> bool:
        """Activate contact whose gaps close on the way at the rates of the last equilibrium; whether there is some.

        Behind the first contact an extrapolated path is far off, and is not tried.
        """
        last = self.points[-1]
        if len(self.points) == 1 or last.rate is None:  # rates at rest are too large by far where walls are thin
            return False
        motion = (control.value - last.value) * last.rate.displacement
        approached = self.active_set.approached(self.system.space.points + last.state.displacement, motion)
        if approached is self.active_set:
            return False
        self.active_set, self.predictor_failed = approached, True
        return True

    def _activate(self, converged: Converged, control: Control, target: float) -> Converged:
        """Equilibrium with those contacts too that a state activates; each may activate the next."""
        while (activated := self.active_set.activated(self._positions(converged))) is not self.active_set:
            self.active_set = activated
            converged = self._solve(Start(converged.state, activated.active), control, target)
        return converged

    def _from_predictor(self, control: Control, target: float) -> Converged:
        """Equilibrium, or a state that activates contact, from the first start of the predictor that leads to one."""
        failure = StepFailed("no start was tried")
        for start in self.predictor.starts(self.points, control, self.active_set.active, self.limit):
            is_extrapolated = start.max_iterations is not None
            if is_extrapolated and self.predictor_failed:
                continue
            try:
                return self._solve(start, control, target)
            except StepFailed as failed:
                failure, is_unstable = failed, isinstance(failed, Unstable)
                # where the load is too large, the start is not to blame
                self.predictor_failed = self.predictor_failed or (is_extrapolated and not is_unstable)
                is_enough = self.effort.is_near_limit or (is_unstable and self.effort.stays_stable)
                if is_enough and len(self.points) > 1:
                    break
        raise failure

    def _is_far(self, control: Control) -> bool:
        """Whether an increment under a given load is longer than the last one."""
        before, last = self.points[0], self.points[-1]
        return self._follows_load and abs(control.value - last.value) > FAR * abs(last.value - before.value)

    def _solve(self, start: Start, control: Control, target: float) -> Converged:
        def watch(iteration: int, residual: float) -> None:
            self.observer.iteration(target, iteration, residual)

        start = replace(start, terms=at_constant_fraction(start.terms, control.constant_fraction))
        if not self.active_set.needs_admissible_start:
            limits = [limit for limit in (self.effort.iterations, start.max_iterations) if limit]
            start = replace(start, max_iterations=min(limits, default=None), max_unstable=self.effort.unstable)
            start = replace(start, stays_stable=self.effort.stays_stable)
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

    def _end(self, reached: Control, increments: Increments, before: _Costs, failure: StepFailed) -> End:
        last, law = self.points[-1], law_limit_clause(self.system, self.points[-1].state)
        limit = increments.limit if increments.limit_is_confirmed else None
        if limit is not None and limit > increments.lowest_failed > reached.value:
            limit = increments.lowest_failed  # a load without an equilibrium is not below the limit
        cause = str(failure) + law + near_limit_point(self.system, last, bool(law), limit is not None)
        if increments.is_stuck:
            failed = f"{MAX_NEAR_FAILURES} increments of at most {LIMIT_ACCURACY:.0%} of the load failed there"
            cause = f"{failed}; the last one: {cause}"
        if increments.is_exhausted:
            cause = f"the search ended after {increments.tried} increments; the last one that failed: {cause}"
        factorizations = (_Costs.of(self.system) - before).factorizations
        ways = reached.value, reached.constant_fraction, increments.cutbacks
        return End(self.control.name, increments.target, *ways, factorizations, cause, limit)

    def _given_up(self, last: Control, increments: Increments, before: _Costs, reason: str) -> End:
        factorizations = (_Costs.of(self.system) - before).factorizations
        ways = last.value, last.constant_fraction, increments.cutbacks
        return End(self.control.name, increments.target, *ways, factorizations, reason)

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
            added_pairs=system.storage.added,
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
