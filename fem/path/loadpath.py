"""Driving the load from zero to the asked factors: predictor, cut-back, growth and restore."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import final

import numpy as np

from fem.effects.effect import Terms, at_constant_fraction, smallest_gap
from fem.equations.linear import LinearSolver
from fem.equations.state import State
from fem.equations.system import System
from fem.model import Model
from fem.path import newton
from fem.path.active_set import ActiveSet
from fem.path.course import Course, LoadCourse, VolumeCourse
from fem.path.diagnosis import beyond_the_law, instability, near_limit_point
from fem.path.newton import Converged, NewtonOptions, StepFailed
from fem.path.predictor import Place, Predictor
from fem.post.extremes import extremes_of, in_words
from fem.solution import End, NotConverged, Seconds, Solution, Step
from geometry.arrays import Array


@dataclass(frozen=True)
class PathOptions:
    """How the path is walked."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)
    smallest: float = 1 / 256  #: smallest share of the way to the next asked factor that is tried
    solver: Callable[[], LinearSolver] | None = None  #: what makes the linear solver, the best installed one by default


#: called after every Newton iteration with the asked value, the iteration and the relative residual
Watch = Callable[[float, int, float], None]
#: called with every finished step
Keep = Callable[[Step], None]


def _nobody(value: float, iteration: int, residual: float) -> None:
    pass


def follow(
    model: Model,
    factors: Sequence[float],
    options: PathOptions | None = None,
    watch: Watch = _nobody,
    keep: Keep = lambda step: None,
    resume: Sequence[Step] = (),
) -> Solution:
    """Equilibrium at the asked load factors, in their order.

    `resume` are steps finished earlier, whose end the path takes up.

    Raises `NotConverged`, which carries the reason and the steps reached so far.
    """
    begin = perf_counter()
    options = options or PathOptions()
    path = Path(model.system(options.solver), LoadCourse(), options, watch)
    return _walk(path, factors, keep, resume, begin)


def follow_volume(
    model: Model,
    where: str,
    volumes: Sequence[float],
    options: PathOptions | None = None,
    watch: Watch = _nobody,
    keep: Keep = lambda step: None,
    resume: Sequence[Step] = (),
) -> Solution:
    """Equilibrium at the asked volumes (mm3) behind the named faces, in their order; the load factor is what it takes.

    The volume is that of the meshed part, as `Step.cavity_volume` gives it. The path goes through limit points of the
    pressure, where `follow` ends.

    Raises `NotConverged`, which carries the reason and the steps reached so far, and ValueError for faces that do not
    exist or prescribed displacements that grow with the load factor.
    """
    begin = perf_counter()
    options = options or PathOptions()
    system = model.system(options.solver)
    path = Path(system, VolumeCourse.of(system, where), options, watch)
    return _walk(path, volumes, keep, resume, begin)


def _walk(path: "Path", values: Sequence[float], keep: Keep, resume: Sequence[Step], begin: float) -> Solution:
    steps = list(resume)
    path.take_up(steps)
    set_up = perf_counter() - begin - path.system.solver.times.analysis
    try:
        for value in values[len(steps) :]:
            step = path.advance(value)
            steps.append(step)
            keep(step)
        return path.solution(steps, set_up)
    except PathEnded as ended:
        raise NotConverged(ended.end, path.solution(steps, set_up)) from None
    finally:
        path.system.solver.close()


class PathEnded(ArithmeticError):
    """An asked value that was not reached."""

    def __init__(self, end: End) -> None:
        super().__init__(end.cause)
        self.end = end


@final
class Path:
    """The walk along one path."""

    def __init__(self, system: System, course: Course, options: PathOptions, watch: Watch) -> None:
        self.system = system
        self.course = course
        self.options = options
        self.watch = watch
        rest = system.space.points
        self.active_set = ActiveSet.of(system.terms, rest)
        start = at_constant_fraction(self.active_set.active, 0.0)
        self.places = [Place(course.rest, 0.0, system.rest_state(), terms=start)]
        self.predictor = Predictor(system, course)
        self.misled = False  #: whether a predicted start has failed on the way to the asked value

    def take_up(self, steps: Sequence[Step]) -> None:
        """Go on from the last of the given steps."""
        for step in steps:
            state = self.system.state_at(step.displacement, step.factor)
            x = self.system.space.points + step.displacement
            self.active_set = ActiveSet.resumed(self.system.terms, step.active, x)
            terms = at_constant_fraction(self.active_set.active, 1.0)
            place = Place(self.course.at(step), 1.0, state, self.active_set.touching(x), terms=terms)
            if step.rate is not None:
                place = replace(place, rate=self.system.rate(state, self.system.assemble(state, ()), step.rate))
            self.places = [self.places[-1], place]

    def advance(self, value: float) -> Step:
        """Equilibrium at `value`, in as few pieces as converge; raises `PathEnded`."""
        begin, spent, before = perf_counter(), self.system.solver.times.factorizations, self.spent()
        origin = self.places[-1]
        done, piece, cutbacks = 0.0, 1.0, 0
        self.misled, self.active_set = False, self.active_set.restored()
        while True:
            share = min(1.0, done + piece)
            try:
                found = self._attempt(origin, value, share)
                here = self._reached(origin, value, share, found)
            except StepFailed as failure:
                cutbacks += 1
                piece = (share - done) / 2
                if piece < self.options.smallest:
                    spent = self.system.solver.times.factorizations - spent
                    raise PathEnded(self._end(origin, value, done, cutbacks, spent, str(failure))) from None
                continue
            if share == 1.0:
                self.places = [origin, here]  # the next prediction starts from asked values alone
                break
            self.places = [self.places[-1], here]
            done = share
            piece *= 2.0 if found.iterations <= 8 else 1.0
        spent = self.system.solver.times.factorizations - spent
        return self._step(found, spent, cutbacks, perf_counter() - begin, self.spent() - before)

    def _attempt(self, origin: Place, value: float, share: float) -> Converged:
        aim = self._place(origin, value, share, self.places[-1].state)
        if self.active_set.is_tightened:
            found = self._solve(value, aim, aim.state, self.active_set.active)
        else:
            found = self._ahead(value, aim)
        found = self._activate(value, aim, found)
        while violations := self.active_set.violations(x := self._positions(found)):
            tightened = self.active_set.tightened(x)
            if tightened is self.active_set:
                raise StepFailed(violations[0])
            self.active_set = tightened
            start = aim.state if tightened.needs_admissible_start else found.state
            found = self._activate(value, aim, self._solve(value, aim, start, tightened.active))
        if found.assembly.jacobian.min() <= 0:
            worst = extremes_of(self.system.space, found.assembly.strain, found.assembly.jacobian)
            raise StepFailed(f"an element is turned inside out at {in_words(worst.min_J_at)} (J = {worst.min_J:.3g})")
        return found

    def _activate(self, value: float, aim: Place, found: Converged) -> Converged:
        """Equilibrium with those contacts too that a state activates; each may activate the next."""
        while (activated := self.active_set.activated(self._positions(found))) is not self.active_set:
            self.active_set = activated
            found = self._solve(value, aim, found.state, activated.active)
        return found

    def _positions(self, found: Converged) -> Array:
        return self.system.space.points + found.state.displacement

    def _ahead(self, value: float, aim: Place) -> Converged:
        """Equilibrium, or a state that wakes effects, from the first start that leads to one."""
        failed = StepFailed("no start was tried")
        for start in self.predictor.starts(self.places, aim, self.active_set.active):
            foretold = start.iterations is not None
            if foretold and self.misled:
                continue
            newton_options = self.options.newton
            if start.iterations is not None:
                newton_options = replace(newton_options, iterations=min(start.iterations, newton_options.iterations))
            if start.trial:
                newton_options = replace(newton_options, limited=0)
            try:
                return self._solve(value, aim, start.state, start.terms, newton_options)
            except StepFailed as failure:
                failed = failure
                self.misled = self.misled or foretold
        raise failed

    def _reached(self, origin: Place, value: float, share: float, found: Converged) -> Place:
        """The place where an attempt has led, with its rate where the factor at hand tells it."""
        place = self._place(origin, value, share, found.state, self.active_set.touching(self._positions(found)))
        place = replace(place, terms=at_constant_fraction(self.active_set.active, place.share))
        return replace(place, rate=self.predictor.rate(place, found, place.terms))

    def _solve(
        self, value: float, aim: Place, start: State, terms: Terms, options: newton.NewtonOptions | None = None
    ) -> Converged:
        return newton.solve(
            self.system,
            at_constant_fraction(terms, aim.share),
            start,
            self.course.control(self.system, aim.value, aim.share),
            options or self.options.newton,
            lambda iteration, residual: self.watch(value, iteration, residual),
            self.active_set.inactive,
        )

    @staticmethod
    def _place(origin: Place, value: float, share: float, state: State, touching: bool = False) -> Place:
        return Place(
            value if share == 1.0 else origin.value + share * (value - origin.value),
            origin.share + share * (1.0 - origin.share),
            state,
            touching,
        )

    def _end(self, origin: Place, value: float, done: float, cutbacks: int, spent: int, failure: str) -> End:
        reached = self._place(origin, value, done, self.places[-1].state)
        last = self.places[-1]
        limits = beyond_the_law(self.system, last.state), near_limit_point(self.system, last.state, last.terms)
        cause = failure + "".join(limits)
        return End(self.course.name, value, reached.value, reached.share, cutbacks, spent, cause)

    def _step(self, found: Converged, factorizations: int, cutbacks: int, seconds: float, spent: Seconds) -> Step:
        displacement = found.state.displacement
        x = self.system.space.points + displacement
        return Step(
            space=self.system.space,
            factor=found.state.factor,
            displacement=displacement,
            stress=found.state.stress,
            rate=None if (rate := self.places[-1].rate) is None else rate.change,
            gradient=np.where(self.system.constraints.constrained, found.assembly.gradient, 0.0),
            extremes=extremes_of(self.system.space, found.assembly.strain, found.assembly.jacobian),
            min_gap=smallest_gap(self.system.terms, x),
            negative_pivots=found.negative_pivots,
            instability=instability(self.system, found, self.places[-1].terms),
            newton_iterations=factorizations,
            factorizations=factorizations,
            cutbacks=cutbacks,
            effects=self.active_set.effects,
            active=self.active_set.is_active,
            seconds=seconds,
            spent=spent,
        )

    def solution(self, steps: Sequence[Step], set_up: float) -> Solution:
        """What was reached, with the seconds spent."""
        times = self.system.solver.times
        return Solution(
            steps=tuple(steps),
            seconds=Seconds(set_up=set_up) + self.spent(),
            factorizations=times.factorizations,
            analyses=times.analyses,
            solver=type(self.system.solver).__name__,
            degrees_of_freedom=self.system.size,
        )

    def spent(self) -> Seconds:
        """Seconds spent so far, without the set-up."""
        times, effects = self.system.solver.times, dict(self.system.clock.seconds)
        assembly = effects.pop("assembly", 0.0)
        return Seconds(0.0, assembly, times.analysis, times.factorization, times.solve, effects)
