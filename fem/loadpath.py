"""Driving the load from zero to the asked factors: predictor, cut-back, growth and restore."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import final

import numpy as np
from numpy.typing import NDArray

from fem import newton
from fem.contact import ContactTerm
from fem.extremes import extremes_of
from fem.linear import LinearSolver
from fem.model import Model
from fem.newton import Converged, NewtonOptions, StepFailed
from fem.solution import NotConverged, Seconds, Solution, Step
from fem.system import State, System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PathOptions:
    """How the path is walked."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)
    smallest: float = 1 / 256  #: smallest share of the way to the next asked factor that is tried
    solver: type[LinearSolver] | None = None  #: linear solver, the best installed one by default


@dataclass(frozen=True)
class Place:
    """A converged point of the path: how far the load is, and the state there."""

    factor: float
    share: float  #: of the constant prescribed displacements, 0 at rest and 1 from the first asked factor on
    state: State


#: called after every Newton iteration with the asked factor, the iteration and the relative residual
Watch = Callable[[float, int, float], None]
#: called with every finished step
Keep = Callable[[Step], None]


def follow(
    model: Model,
    factors: Sequence[float],
    options: PathOptions | None = None,
    watch: Watch = lambda factor, iteration, residual: None,
    keep: Keep = lambda step: None,
    resume: Sequence[Step] = (),
) -> Solution:
    """Equilibrium at the asked load factors, in their order; `resume` are steps finished earlier, whose end the path takes up.

    Raises `NotConverged`, which carries the reason and the steps reached so far.
    """
    begin = perf_counter()
    path = Path(model.system((options or PathOptions()).solver), options or PathOptions(), watch)
    steps = list(resume)
    path.take_up(steps)
    set_up = perf_counter() - begin - path.system.solver.times.analysis
    for factor in factors[len(steps) :]:
        try:
            step = path.advance(factor)
        except StepFailed as failure:
            raise NotConverged(str(failure), path.solution(steps, set_up)) from None
        steps.append(step)
        keep(step)
    solution = path.solution(steps, set_up)
    path.system.solver.close()
    return solution


@final
class Path:
    """The walk along one load path."""

    def __init__(self, system: System, options: PathOptions, watch: Watch) -> None:
        self.system = system
        self.options = options
        self.watch = watch
        self.places = [Place(0.0, 0.0, system.start())]

    def take_up(self, steps: Sequence[Step]) -> None:
        """Go on from the last of the given steps."""
        for step in steps:
            self.places.append(Place(step.factor, 1.0, State(step.displacement, step.stress)))

    def advance(self, factor: float) -> Step:
        """Equilibrium at `factor`, in as few pieces as converge; raises `StepFailed`."""
        begin, spent = perf_counter(), self.system.solver.times.factorizations
        origin = self.places[-1]
        done, piece, cutbacks = 0.0, 1.0, 0
        while True:
            share = min(1.0, done + piece)
            try:
                found = self._attempt(origin, factor, share)
            except StepFailed as failure:
                cutbacks += 1
                piece = (share - done) / 2
                if piece < self.options.smallest:
                    raise StepFailed(self._explain(origin, factor, done, str(failure))) from None
                continue
            self.places = [*self.places[-1:], self._place(origin, factor, share, found.state)]
            if share == 1.0:
                break
            done = share
            piece *= 2.0 if found.iterations <= 8 else 1.0
        spent = self.system.solver.times.factorizations - spent
        return self._step(factor, found, spent, cutbacks, perf_counter() - begin)

    def _attempt(self, origin: Place, factor: float, share: float) -> Converged:
        aim = self._place(origin, factor, share, self.places[-1].state)
        start = aim.state
        found = newton.solve(
            self.system,
            start,
            aim.factor,
            self.system.prescribed(aim.factor, aim.share),
            self.options.newton,
            lambda iteration, residual: self.watch(factor, iteration, residual),
        )
        if found.assembly.jacobian.min() <= 0:
            worst = extremes_of(self.system.space, found.state.displacement, found.assembly.jacobian)
            raise StepFailed(f"an element is turned inside out at {_at(worst.min_J_at)} (J = {worst.min_J:.3g})")
        return found

    @staticmethod
    def _place(origin: Place, factor: float, share: float, state: State) -> Place:
        return Place(
            origin.factor + share * (factor - origin.factor),
            origin.share + share * (1.0 - origin.share),
            state,
        )

    def _explain(self, origin: Place, factor: float, done: float, failure: str) -> str:
        reached = origin.factor + done * (factor - origin.factor)
        return f"no equilibrium found beyond load factor {reached:.4g} on the way to {factor:.4g}: {failure}"

    def _step(self, factor: float, found: Converged, spent: int, cutbacks: int, seconds: float) -> Step:
        displacement = found.state.displacement
        x = self.system.space.points + displacement
        gaps = [term.gap(x) for term in self.system.terms if isinstance(term, ContactTerm)]
        return Step(
            space=self.system.space,
            factor=factor,
            displacement=displacement,
            stress=found.state.stress,
            gradient=np.where(self.system.constraints.fixed, found.assembly.gradient, 0.0),
            extremes=extremes_of(self.system.space, displacement, found.assembly.jacobian),
            min_gap=min(gaps, default=np.inf),
            negative_pivots=found.negative_pivots,
            newton_iterations=spent,
            factorizations=spent,
            cutbacks=cutbacks,
            seconds=seconds,
        )

    def solution(self, steps: Sequence[Step], set_up: float) -> Solution:
        """What was reached, with the seconds spent."""
        times, clock = self.system.solver.times, self.system.clock
        contact = sum(term.seconds for term in self.system.terms if isinstance(term, ContactTerm))
        return Solution(
            steps=tuple(steps),
            seconds=Seconds(
                set_up=set_up,
                assembly=clock.assembly - contact,
                contact=contact,
                analysis=times.analysis,
                factorization=times.factorization,
                solve=times.solve,
            ),
            factorizations=times.factorizations,
            solver=type(self.system.solver).__name__,
        )


def _at(place: tuple[float, float, float]) -> str:
    return f"({place[0]:.1f}, {place[1]:.1f}, {place[2]:.1f}) mm"
