"""The load path: equilibria at load factors, or at volumes of a cavity, given in their order."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from time import perf_counter

from fem.equations.linear import SingularMatrix
from fem.model import Model
from fem.path.control import LoadControl, VolumeControl
from fem.path.costs import Costs
from fem.path.follower import PathFollower
from fem.path.move import MoveControl
from fem.path.newton import StepFailed
from fem.path.options import PathEnded, PathObserver, PathOptions
from fem.solution import NotConverged, Solution, Step

#: gives for the number of a target a state of another model from which the way to it begins; None: the path alone
Begin = Callable[[int], Step | None]


def follow(
    model: Model,
    factors: Sequence[float],
    options: PathOptions | None = None,
    observer: PathObserver | None = None,
    resume: Sequence[Step] = (),
    begin: Begin = lambda number: None,
) -> Solution:
    """Equilibrium at the given load factors, in their order.

    `resume` are steps of the first factors, finished earlier: the path goes on from the last of them. `begin` gives for
    the number of a factor, when it is its turn, a stable equilibrium of a model that differs in its supports, or None.
    The way from there is tried first, in one increment. Supports that are the same but for the displacements that they
    prescribe move on it, together with the load factor; others are released at once, and their forces vanish. Limit
    points on the way are not seen: the same model should bear both load factors with the other supports.

    Raises `NotConverged`, which carries the reason and the steps reached so far.
    """
    start, options = perf_counter(), options or PathOptions()
    path = PathFollower(LoadControl.of(model.system(options.solver)), options, observer or PathObserver())
    return _follow(path, factors, resume, start, begin)


def follow_volume(
    model: Model,
    where: str,
    volumes: Sequence[float],
    options: PathOptions | None = None,
    observer: PathObserver | None = None,
    resume: Sequence[Step] = (),
) -> Solution:
    """Equilibrium at the given volumes (mm3) behind the named faces, in their order; the load factor is an unknown.

    The volume is that of the meshed part, as `Step.cavity_volume` gives it. The path goes through limit points of the
    pressure, where `follow` ends.

    Raises `NotConverged`, which carries the reason and the steps reached so far, and ValueError for faces that do not
    exist or prescribed displacements that grow with the load factor.
    """
    start, options = perf_counter(), options or PathOptions()
    path = PathFollower(VolumeControl.of(model.system(options.solver), where), options, observer or PathObserver())
    return _follow(path, volumes, resume, start)


def _follow(
    path: PathFollower,
    targets: Sequence[float],
    resume: Sequence[Step],
    start: float,
    begin: Begin = lambda number: None,
) -> Solution:
    """start: when the work on the path began, s."""
    steps = list(resume)
    path.resume(steps)
    set_up = perf_counter() - start - path.system.solver.times.analysis
    try:
        for number in range(len(steps), len(targets)):
            target, near = targets[number], begin(number)
            step = path.advance(target) if near is None else _moved_or_advanced(path, near, target)
            steps.append(step)
            path.observer.step_done(step)
        return path.solution(steps, set_up)
    except PathEnded as ended:
        raise NotConverged(ended.end, path.solution(steps, set_up)) from None
    finally:
        path.system.solver.close()


def _moved_or_advanced(path: PathFollower, begin: Step, target: float) -> Step:
    """The next step, from that of another model or else on the path; its costs are those of both attempts.

    Raises `PathEnded`.
    """
    before, pairs = Costs.of(path.system), path.system.storage.added
    try:
        step = _moved(path, begin, target)
        path.system.storage.hold(pairs)
        if step is None:
            step = path.advance(target)
        else:  # as where an interrupted path goes on
            path.resume([step])
    except PathEnded as ended:
        factorizations = (Costs.of(path.system) - before).factorizations
        raise PathEnded(replace(ended.end, factorizations=factorizations)) from None
    costs = Costs.of(path.system) - before
    return replace(step, factorizations=costs.factorizations, seconds=costs.wall, spent=costs.seconds)


def _moved(path: PathFollower, begin: Step, factor: float) -> Step | None:
    """Equilibrium at a load factor from a stable one of another model; None where one increment does not lead there."""
    if begin.negative_pivots or begin.instability:
        return None
    callback = path.observer.iteration
    observer = PathObserver(lambda _, iteration, residual: callback(factor, iteration, residual))
    control = MoveControl.of(path.system, begin, factor)
    with suppress(StepFailed, SingularMatrix):
        return PathFollower(control, path.options, observer).move(begin, control)
    return None
