"""The load path: equilibria at load factors, or at volumes of a cavity, given in their order."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import zip_longest
from time import perf_counter

from fem.equations.linear import SingularMatrix
from fem.finite import check_finite
from fem.model import Model
from fem.path.control import LoadControl, VolumeControl
from fem.path.costs import Costs
from fem.path.follower import PathFollower
from fem.path.move import MoveControl
from fem.path.newton import StepFailed
from fem.path.options import PathEnded, PathObserver, PathOptions
from fem.solution import NotConverged, Solution, Step


def follow(
    model: Model,
    factors: Sequence[float],
    options: PathOptions | None = None,
    observer: PathObserver | None = None,
    resume: Sequence[Step] = (),
    begin: Sequence[Step | None] = (),
) -> Solution:
    """Equilibrium at the given load factors, in their order.

    `resume` are steps of the first factors, finished earlier: the path goes on from the last of them. `begin` has for
    each factor an equilibrium near that, of a model that lacks the last loads or differs in the displacements that its
    supports prescribe, or None. The way from there is tried first, in one increment in which load factor, supports and
    those loads change together. Limit points on it are not seen: the model of that equilibrium should bear both load
    factors.

    Raises `NotConverged`, which carries the reason and the steps reached so far, and ValueError for a load factor that
    is not finite.
    """
    check_finite("load factors", factors)
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
    exist, prescribed displacements that grow with the load factor or a volume that is not finite.
    """
    check_finite("volumes (mm3)", volumes)
    start, options = perf_counter(), options or PathOptions()
    path = PathFollower(VolumeControl.of(model.system(options.solver), where), options, observer or PathObserver())
    return _follow(path, volumes, resume, start)


def _follow(
    path: PathFollower,
    targets: Sequence[float],
    resume: Sequence[Step],
    start: float,
    begin: Sequence[Step | None] = (),
) -> Solution:
    """start: when the work on the path began, s."""
    steps = list(resume)
    path.resume(steps, goes_on=len(targets) > len(steps))
    set_up = perf_counter() - start - path.system.solver.times.analysis
    try:
        for target, near in zip_longest(targets[len(steps) :], begin[len(steps) : len(targets)]):
            step = path.advance(target) if near is None else _moved_or_advanced(path, near, target, steps, targets)
            steps.append(step)
            path.observer.step_done(step)
        return path.solution(steps, set_up)
    except PathEnded as ended:
        raise NotConverged(ended.end, path.solution(steps, set_up)) from None
    finally:
        path.system.solver.close()


def _moved_or_advanced(
    path: PathFollower, begin: Step, target: float, steps: Sequence[Step], targets: Sequence[float]
) -> Step:
    """The next step, from that of another model or else on the path; its costs are those of both attempts.

    steps: so far. Raises `PathEnded`.
    """
    before, pairs = Costs.of(path.system), path.system.storage.added
    try:
        step = _moved(path, begin, target)
        path.system.storage.hold(pairs)
        if step is None:
            step = path.advance(target)
        else:  # as where an interrupted path goes on
            path.resume([step], goes_on=not steps and len(targets) > 1)
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
        step = PathFollower(control, path.options, observer).move(begin, control)
        return replace(step, rate=None)  # it is one by the part of the way, not by the load factor
    return None
