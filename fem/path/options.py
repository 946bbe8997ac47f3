"""How a path is followed, who is told of its progress, and how it ends without its target."""

from collections.abc import Callable
from dataclasses import dataclass, field

from fem.equations.linear import LinearSolver
from fem.path.newton import NewtonOptions
from fem.solution import End, Step


@dataclass(frozen=True)
class PathOptions:
    """How the path is followed."""

    newton: NewtonOptions = field(default_factory=NewtonOptions)
    #: smallest increment that is tried, as a fraction of the way to the next target or, where that is less, of the load
    #: that is reached
    min_increment: float = 1 / 256
    #: whether a target is not worth the search. Asked before a target is tried; the first one is tried at once, and
    #: this is asked before smaller increments
    give_up: Callable[[float], bool] = lambda target: False
    solver: Callable[[], LinearSolver] | None = None  #: makes the linear solver; None: the best installed one


@dataclass(frozen=True)
class PathObserver:
    """Functions that a path calls after each Newton iteration and each step; the defaults do nothing."""

    #: after every Newton iteration, with the target, the number of the iteration and the relative residual
    iteration: Callable[[float, int, float], None] = lambda target, iteration, residual: None
    #: with every finished step
    step_done: Callable[[Step], None] = lambda step: None


class PathEnded(ArithmeticError):
    """A target that was not reached."""

    def __init__(self, end: End) -> None:
        super().__init__(end.cause)
        self.end = end
