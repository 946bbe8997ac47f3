"""The load path: equilibria at load factors, or at volumes of a cavity, given in their order."""

from collections.abc import Sequence
from time import perf_counter

from fem.model import Model
from fem.path.control import LoadControl, VolumeControl
from fem.path.follower import PathEnded, PathFollower, PathObserver, PathOptions
from fem.solution import NotConverged, Solution, Step


def follow(
    model: Model,
    factors: Sequence[float],
    options: PathOptions | None = None,
    observer: PathObserver | None = None,
    resume: Sequence[Step] = (),
) -> Solution:
    """Equilibrium at the given load factors, in their order.

    `resume` are steps of the first factors, finished earlier: the path goes on from the last of them.

    Raises `NotConverged`, which carries the reason and the steps reached so far.
    """
    begin, options = perf_counter(), options or PathOptions()
    path = PathFollower(LoadControl.of(model.system(options.solver)), options, observer or PathObserver())
    return _follow(path, factors, resume, begin)


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
    begin, options = perf_counter(), options or PathOptions()
    path = PathFollower(VolumeControl.of(model.system(options.solver), where), options, observer or PathObserver())
    return _follow(path, volumes, resume, begin)


def _follow(path: PathFollower, targets: Sequence[float], resume: Sequence[Step], begin: float) -> Solution:
    steps = list(resume)
    path.resume(steps, goes_on=len(targets) > len(steps))
    set_up = perf_counter() - begin - path.system.solver.times.analysis
    try:
        for target in targets[len(steps) :]:
            step = path.advance(target)
            steps.append(step)
            path.observer.step_done(step)
        return path.solution(steps, set_up)
    except PathEnded as ended:
        raise NotConverged(ended.end, path.solution(steps, set_up)) from None
    finally:
        path.system.solver.close()
