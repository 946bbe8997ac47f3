"""Follows a path from target to target, each reached in as few increments as converge.

An increment that fails is halved; one that converges quickly is doubled (`fem.path.increments`). How one is solved is
in `fem.path.solver`, and how long an equilibrium is sought in `fem.path.effort`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.effects.effect import at_constant_fraction, smallest_gap
from fem.path.active_set import ActiveSet
from fem.path.control import Control
from fem.path.costs import Costs
from fem.path.diagnosis import NOT_FOLLOWED_EARLIER, instability, near_limit_point
from fem.path.effort import effort_of
from fem.path.exact_contact import with_exact_distances
from fem.path.increments import Increments
from fem.path.limit import announced_limit, difference, way_between
from fem.path.move import MoveControl
from fem.path.newton import Converged, NotAdmissible, StepFailed, Unstable, Watch
from fem.path.options import PathEnded, PathObserver, PathOptions
from fem.path.predictor import PathPoint, Predictor
from fem.path.solver import Increment, IncrementSolver
from fem.post.extremes import extremes_of, unstable_stretches
from fem.reasons import Reasons
from fem.solution import End, ExactContact, Seconds, Solution, Step
from geometry import Reason

#: part of the way to the first target on which constant loads are brought up, before the rest of the driven one
CONSTANTS_FIRST = 1e-3
#: largest strain under them, linearised at rest, up to which they are brought up first: where they bend an arm far, the
#: way back under the driven load takes more than that of both together (54 instead of 15 factorizations for `pneunet`
#: with a force of 0.05 N on its end, strain 0.18); on the half discs whose limits were jumped it is 0.002 and 0.004
CONSTANTS_STRAIN = 0.1
#: largest difference of an equilibrium whose contact is that of its load alone from the one to which the path leads;
#: where a divider folds onto its wall (design 131-73 of studies/unseen_designs.csv) it was 0.011
NEAR_SETTLED = 0.05
#: smallest increment that is tried there, as a part of it; where it takes more the loads grow together
CONSTANTS_INCREMENT = 1 / 16


@dataclass(frozen=True, eq=False)
class _Reached:
    """An equilibrium at a target, and what it took."""

    control: Control
    converged: Converged
    iterations: int
    cutbacks: int


@final
class PathFollower:
    """A path that is being followed."""

    def __init__(self, control: Control, options: PathOptions, observer: PathObserver) -> None:
        self.system = control.system
        self.control = control
        self.options = options
        self.observer = observer
        self._begin_at_rest()

    def _begin_at_rest(self) -> None:
        control = self.control
        active_set = ActiveSet.of(self.system.terms, self.system.space.points)
        terms = at_constant_fraction(active_set.active, 0.0)
        self.points = [PathPoint(control.value, 0.0, self.system.rest_state(), terms=terms)]  #: the last two
        self.predictor = Predictor(self.points[0], control)
        self.solver = IncrementSolver(self.system, self.predictor, active_set, self.options.newton)
        #: the last point on the way to the first target, with its rate while constant loads grow as well
        self.arrival: PathPoint | None = None
        self.is_stable = True  #: whether the last equilibrium is
        #: where the path lost its stability on the way to the target, or before and has not regained it
        self.not_followed: Reason | None = None
        #: of the last equilibrium at a target (`fem.solution.Step`)
        self.path_dependence = 0.0

    def resume(self, steps: Sequence[Step], goes_on: bool) -> None:
        """Go on from the last of the given steps; goes_on: whether more targets follow.

        From the first step the way on depends on the rate at rest, which is computed again (one factorization), unless
        constant loads or displacements were applied in between.
        """
        for step in steps:
            point = self._resumed(step, self.control.value_of(step))
            if step.rate is not None:
                assembly = self.system.assemble(point.state, ())
                point = replace(point, rate=self.system.rate(point.state, assembly, step.rate))
            self.points = [self.points[-1], point]
        if goes_on and len(steps) == 1 and not self.predictor.nonsmooth_start:
            self.predictor.rate_from_rest(self.control.target(self.points[-1].value, 1.0))
        if steps:
            self.system.storage.hold(steps[-1].added_pairs)

    def move(self, begin: Step, control: MoveControl) -> Step:
        """The stable equilibrium to which a control leads from a step of another path, in one increment.

        Raises `StepFailed` and `fem.equations.linear.SingularMatrix`.
        """
        before, increments = Costs.of(self.system), Increments(0.0, 1.0, 1.0)
        self.system.storage.hold(begin.added_pairs)
        point = self._resumed(begin, control.value)
        point = replace(point, rate=control.rate_at_begin(point.state, point.terms))
        self.points, control = [point, point], control.target(1.0, 1.0)
        self.solver.begin_target()
        converged = self.solver.solve(self._increment(control, increments, increments.target))
        if converged.negative_pivots:
            raise Unstable(Reason("equilibrium_unstable", {"negative_pivots": converged.negative_pivots}))
        point = self._point(control, converged)
        self._check_continuation(control, converged, point, increments)
        self.points = [self.points[-1], point]
        reached = _Reached(control, converged, self.solver.iterations, 0)
        return self._step(reached, 1.0, before)

    def _resumed(self, step: Step, value: float) -> PathPoint:
        """The point of the path at a finished step; the path goes on with the contacts that are active there."""
        state = self.system.state_at(step.displacement, step.factor)
        active_set = ActiveSet.of_step(self.system.terms, step)
        self.solver.active_set, self.is_stable = active_set, step.negative_pivots == 0
        was_left = any(reason.code.startswith("not_followed") for reason in step.instability)
        self.not_followed = NOT_FOLLOWED_EARLIER if was_left else None
        terms = at_constant_fraction(active_set.active, 1.0)
        return PathPoint(value, 1.0, state, active_set.touching(step.positions), terms=terms)

    def advance(self, target: float) -> Step:
        """Equilibrium at `target`, in as few increments as converge; raises `PathEnded`.

        On the way to the first target constant loads are brought up before the driven one: while both grow, the rates
        of their motions hide a step that jumps past a limit of the driven load.
        """
        before, is_first, rest = Costs.of(self.system), len(self.points) == 1, self.points[0]
        self.not_followed = NOT_FOLLOWED_EARLIER if self.not_followed and not self.is_stable else None
        constant = None
        if is_first and self.control.gives_load and self.predictor.has_constant_loads:
            constant = self._with_constant_loads(target, before)
            if constant is None:
                self._begin_at_rest()
        try:
            reached = self._reach(target, target, self.options.min_increment, before, is_first=is_first)
        except PathEnded as ended:
            if constant and ended.end.reached == constant.control.value:  # nothing of the driven load
                raise PathEnded(replace(ended.end, reached=rest.value)) from None
            raise
        if constant:
            self.points = [rest, self.points[-1]]  # as where the path is resumed
            iterations, cutbacks = reached.iterations + constant.iterations, reached.cutbacks + constant.cutbacks
            reached = replace(reached, iterations=iterations, cutbacks=cutbacks)
        return self._step(reached, target, before)

    def _with_constant_loads(self, target: float, before: Costs) -> _Reached | None:
        """The equilibrium with all constant loads and hardly anything of the driven one; None where they strain the
        body much or there is no stable one: with more of the driven load it may bear them."""
        rest = self.points[0].value
        value = rest + CONSTANTS_FIRST * (target - rest)
        rate = self.predictor.rate_from_rest(self.control.target(value, 1.0))
        if rate is None or float(np.abs(rate.strain).max()) * abs(value - rest) > CONSTANTS_STRAIN:
            return None
        try:
            reached = self._reach(value, target, CONSTANTS_INCREMENT, before, is_first=True)
        except PathEnded:
            return None
        return None if reached.converged.negative_pivots else reached

    def _reach(self, target: float, announced: float, smallest: float, before: Costs, *, is_first: bool) -> _Reached:
        """announced: the target on whose way this one lies, for the observer; smallest: increment that is tried;
        is_first: whether it lies on the way to the first target. Raises `PathEnded`."""
        origin = self.points[-1]
        increments = Increments(origin.value, target, smallest)
        increments.limit = self._announced_limit(self.points[0], self.points[-1])
        iterations, cause = 0, StepFailed(Reason("nothing_tried"))
        self.solver.begin_target()
        give_up_checked = False
        while True:
            fraction = increments.next
            if not give_up_checked and (fraction < 1.0 or not is_first):
                give_up_checked = True
                if self.options.give_up(announced):
                    last = self._control(origin, target, increments.reached)
                    raise PathEnded(self._end(last, increments, before, (Reason("given_up"),)))
            control = self._control(origin, target, fraction)
            try:
                increment = self._increment(control, increments, announced)
                converged = self.solver.solve(increment)
                point = self._point(control, converged)
                arrival = self._check_continuation(control, converged, point, increments)
                if fraction == 1.0:
                    converged, point = self._settled(converged, point, increment)
            except StepFailed as failure:
                # an equilibrium that no body can have tells more than none
                cause = cause if isinstance(cause, NotAdmissible) > isinstance(failure, NotAdmissible) else failure
                increments.failed(fraction, isinstance(failure, Unstable))
                last = self._control(origin, target, increments.reached)
                if not increments.reached and self.solver.keep_contact():
                    cause = StepFailed(Reason("nothing_tried"))  # softer contact tells nothing of the end of the path
                elif increments.ended:
                    raise PathEnded(self._end_after(cause, last, increments, before)) from None
                continue
            iterations += self.solver.iterations
            self._note_stability(converged, increments.reached, fraction)
            limit = self._announced_limit(self.points[-1], point)
            self.points, self.arrival = [self.points[-1], point], arrival
            increments.accepted(fraction, limit)
            if fraction == 1.0:
                self.points = [origin, point]  # the next extrapolation uses points at targets alone
                return _Reached(control, converged, iterations, increments.cutbacks)
            if increments.is_confirmed_or_exhausted:
                raise PathEnded(self._end_after(cause, control, increments, before))

    def _control(self, origin: PathPoint, target: float, fraction: float) -> Control:
        """What is prescribed at a fraction of the way from a point of the path to a target."""
        start, applied = origin.value, origin.constant_fraction
        value = target if fraction == 1.0 else start + fraction * (target - start)
        return self.control.target(value, applied + fraction * (1.0 - applied))

    def _note_stability(self, converged: Converged, reached: float, fraction: float) -> None:
        """Keep whether an equilibrium at a fraction of the way is stable, and where the path lost its stability.

        reached: the fraction of the equilibrium before. Under a prescribed volume the path goes on where the given load
        would lose its stability.
        """
        is_stable = converged.negative_pivots == 0
        if self.control.gives_load and self.is_stable and not is_stable and fraction < 1.0:
            self.not_followed = Reason("not_followed", {"stable": reached, "unstable": fraction})
        elif is_stable and self.not_followed == NOT_FOLLOWED_EARLIER:
            self.not_followed = None
        self.is_stable = is_stable

    def _increment(self, control: Control, increments: Increments, announced: float) -> Increment:
        """The next one."""
        effort = effort_of(control, increments, self.points, self.is_stable)
        return Increment(self.points, control, increments.limit, effort, self._watch(announced))

    def _watch(self, announced: float) -> Watch:
        """Tells the observer of every iteration."""
        return lambda iteration, residual: self.observer.iteration(announced, iteration, residual)

    def _check_continuation(
        self, control: Control, converged: Converged, point: PathPoint, increments: Increments
    ) -> PathPoint:
        """The point with its rate on the way that led to it, while constant loads grow as well.

        Raises `Unstable` where an equilibrium under a given load is not on the path that led to the last one.
        """
        if not self.control.gives_load:
            return point
        last, arrival = self._with_rate(self.points[-1]), point
        if self.predictor.nonsmooth_start and last.constant_fraction < 1.0:
            last = self.arrival or replace(last, rate=self.predictor.rate_at_rest)
            arrival = replace(point, rate=self.predictor.rate_with_constants(control, converged, point.terms))
        way = way_between(last, arrival)
        if self.is_stable and converged.negative_pivots:
            is_small = increments.is_small
            if not (way.is_straight or (is_small and way.is_smooth) if way else is_small):
                raise Unstable(Reason("equilibrium_unstable", {"negative_pivots": converged.negative_pivots}))
        if way and way.is_jump:
            raise Unstable(Reason("jump"))
        if increments.passes_limit and way and not way.is_smooth:
            raise Unstable(Reason("beyond_limit"))
        return arrival

    def _settled(self, converged: Converged, point: PathPoint, increment: Increment) -> tuple[Converged, PathPoint]:
        """An equilibrium at a target with its point, or the one near it whose contact does not depend on the way.

        That has other pairs in creases than the last equilibrium on the way, so that the rates there do not tell how
        far away it is. The given one where it differs too much, or none is found: the path dependence says so.
        """
        before, self.path_dependence = self.solver.active_set, 0.0
        settled = self.solver.settled(converged, increment)
        if settled is converged:
            return converged, point
        apart = math.inf if settled is None else difference(converged.state, settled.state)
        if settled is not None and apart <= NEAR_SETTLED:
            return settled, self._point(increment.control, settled)
        self.solver.active_set, self.path_dependence = before, apart
        return converged, point

    def _announced_limit(self, before: PathPoint, last: PathPoint) -> float | None:
        """The load at which the path announces a limit; None where it announces none."""
        is_smooth = before.constant_fraction == 1.0 or not self.predictor.nonsmooth_start
        return announced_limit(self._with_rate(before), last) if self.control.gives_load and is_smooth else None

    def _with_rate(self, point: PathPoint) -> PathPoint:
        """The point, with its rate at rest too where that is known."""
        is_rest = point is self.predictor.rest and not self.predictor.nonsmooth_start
        return replace(point, rate=self.predictor.rate_at_rest) if is_rest else point

    def _point(self, control: Control, converged: Converged) -> PathPoint:
        """The point of the path at an equilibrium, with its rate where the last tangent matrix gives it."""
        active_set = self.solver.active_set
        terms = at_constant_fraction(active_set.active, control.constant_fraction)
        touching = active_set.touching(self.solver.positions(converged))
        rate = self.predictor.rate(control, converged, terms)
        return PathPoint(control.value, control.constant_fraction, converged.state, touching, rate, terms)

    def _end(
        self, reached: Control, increments: Increments, before: Costs, reasons: Reasons, limit: float | None = None
    ) -> End:
        factorizations = (Costs.of(self.system) - before).factorizations
        ways = reached.value, reached.constant_fraction, increments.cutbacks
        return End(self.control.name, increments.target, *ways, factorizations, reasons, limit)

    def _end_after(self, failure: StepFailed, reached: Control, increments: Increments, before: Costs) -> End:
        """The end of the path where increments fail, with what is known of the limit."""
        limit = increments.confirmed_limit
        search = (Reason("search_ended", {"increments": increments.tried}),) if increments.is_exhausted else ()
        system, last = self.system, self.points[-1]
        law = unstable_stretches(system.space, last.state.displacement, system.material)
        point = near_limit_point(system, last, bool(law), limit is not None, self.control.gives_load)
        return self._end(reached, increments, before, (*search, *failure.reasons, *law, *point), limit)

    def _step(self, reached: _Reached, target: float, before: Costs) -> Step:
        control, converged = reached.control, reached.converged
        system, state, rate = self.system, converged.state, self.points[-1].rate
        active_set, options = self.solver.active_set, self.options.newton
        unstable = instability(system, converged, self.points[-1].terms)  # factorizes where it is unstable
        # under a prescribed volume the pressure would differ as well
        compared: tuple[ExactContact | None, Reasons] = None, ()
        if self.control.gives_load:
            compared = with_exact_distances(control, converged, active_set, options, self._watch(target))
        costs = Costs.of(system) - before
        return Step(
            space=system.space,
            factor=state.factor,
            displacement=state.displacement,
            stress=state.stress,
            rate=None if rate is None else rate.change,
            gradient=np.where(system.constraints.constrained, converged.assembly.gradient, 0.0),
            extremes=extremes_of(system.space, converged.assembly.strain, converged.assembly.jacobian),
            min_gap=smallest_gap(active_set.stiffened, self.solver.positions(converged)),
            negative_pivots=converged.negative_pivots,
            instability=(*unstable, self.not_followed) if self.not_followed else unstable,
            newton_iterations=reached.iterations,
            factorizations=costs.factorizations,
            cutbacks=reached.cutbacks,
            effects=active_set.effects,
            active=active_set.is_active,
            added_pairs=system.storage.added,
            contacts=active_set.tightenings,
            seconds=costs.wall,
            spent=costs.seconds,
            exact=compared[0],
            inexact=compared[1],
            path_dependence=self.path_dependence,
        )

    def solution(self, steps: Sequence[Step], set_up: float) -> Solution:
        """What was reached, with the seconds spent."""
        times = self.system.solver.times
        return Solution(
            steps=tuple(steps),
            seconds=Seconds(set_up=set_up) + Costs.of(self.system).seconds,
            factorizations=times.factorizations,
            analyses=times.analyses,
            solver=type(self.system.solver).__name__,
            degrees_of_freedom=self.system.size,
        )
