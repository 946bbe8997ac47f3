"""The three experiments on one body, side by side in processes, each state kept when it is reached."""

import multiprocessing
import os
import threading
from collections.abc import Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from typing import Any

import fem
from geometry import Centreline
from geometry.arrays import Array, Index
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.processes import SPAWN, side_by_side
from pipeline.progress import Progress, ToQueue, relayed
from pipeline.simulation.loadcase import Case
from pipeline.simulation.scene import Scene
from pipeline.store.store import Store
from rod import Load

#: the loaded one first, for it takes longest
EXPERIMENTS = ("III", "II", "I")


@dataclass(frozen=True)
class Record:
    """One experiment at one pressure: what later stages need of it. Forces and volumes are those of the whole body."""

    experiment: str
    pressure_kPa: float
    row: dict[str, Any]  #: as in experiments.json
    centreline: Centreline
    load: Load  #: end force, and its couple about the end of the curve
    displacement: Array = field(repr=False)  #: (n, 3), mm
    fields: dict[str, Array] = field(repr=False)  #: per element
    effects: tuple[str, ...]  #: names of the effects that took part
    spent: fem.Seconds


@dataclass(frozen=True)
class Outcome:
    """One experiment as far as it went."""

    experiment: str  #: the name of its case
    records: tuple[Record, ...]
    failure: str  #: empty, or a sentence
    failed_kPa: float  #: the pressure that was not reached, NaN where all were
    lost: tuple[int, int]  #: attempts at it that failed, and the factorizations of all of them
    seconds: fem.Seconds
    factorizations: int
    degrees_of_freedom: int
    solver: str
    points: Array = field(repr=False)  #: (n, 3) all nodes at rest, mm
    nodes: Index = field(repr=False)  #: (e, 10), (e, 4) with linear elements


def simulate(scene: Scene, context: RunContext, experiments: Sequence[str | Case] = EXPERIMENTS) -> dict[str, Outcome]:
    """Run the experiments, `context.jobs` at a time; one that fails does not stop the others.

    A name stands for that experiment at the pressures of the run. Raises RunFailed where the faces that are to touch
    cannot.
    """
    cases = [one if isinstance(one, Case) else Case.of(scene.config, one) for one in experiments]
    for case in sorted(cases, key=lambda case: case.name):
        context.progress.experiment(case.name, case.pressures_kPa)
    try:
        if context.jobs == 1 or len(cases) == 1:
            outcomes = [_experiment(case, scene, context.store, context.progress) for case in cases]
        else:
            outcomes = _side_by_side(scene, context, cases)
    except fem.ContactError as failure:
        raise RunFailed(str(failure)) from None
    except BrokenProcessPool:
        raise RunFailed(
            "the process of an experiment was ended from outside, as happens when memory runs out; what is finished is "
            "kept, and the same command goes on from there, with --jobs 1 in less memory"
        ) from None
    return {outcome.experiment: outcome for outcome in sorted(outcomes, key=lambda outcome: outcome.experiment)}


def _side_by_side(scene: Scene, context: RunContext, cases: Sequence[Case]) -> list[Outcome]:
    jobs = min(context.jobs, len(cases))
    queue = SPAWN.Queue()
    queue.cancel_join_thread()  # a worker that was killed may hold the queue's lock for ever
    threads = max(1, len(os.sched_getaffinity(0)) // jobs)
    workers = side_by_side(jobs, threads, initializer=_take_queue, initargs=(queue,))
    with relayed(queue, context.progress), workers as pool:
        futures = [pool.submit(_in_worker, case, scene, context.store) for case in cases]
        return [future.result() for future in futures]


_listener: list[ToQueue] = []


def _take_queue(queue: Any) -> None:
    """Runs first in a worker: interrupts are the main process's business, messages go into the queue.

    A worker whose main process was killed ends as well, or it would write into a folder that another run holds, and
    then wait for work for ever.
    """
    import signal

    for interrupt in (signal.SIGINT, signal.SIGHUP):
        signal.signal(interrupt, signal.SIG_IGN)
    threading.Thread(target=_end_with_main_process, daemon=True).start()
    _listener.append(ToQueue(queue))


def _end_with_main_process() -> None:
    main_process = multiprocessing.parent_process()
    if main_process is not None:
        main_process.join()
        os._exit(1)


def _in_worker(case: Case, scene: Scene, store: Store) -> Outcome:
    return _experiment(case, scene, store, _listener[0])


def _experiment(case: Case, scene: Scene, store: Store, progress: Progress) -> Outcome:
    name, asked, config = case.name, case.pressures_kPa, scene.config
    experiment = fem.Experiment.of(case.experiment, scene.body, case.end_y_mm, case.force_N)
    material = scene.material
    largest = config.pressures_MPa[-1]
    model = experiment.model(material, scene.effects(largest), config.mesh.formulation)
    space = model.space
    pressures = {float(f"{p / 1000.0:.12g}") / largest: p for p in asked}
    remembered = _remembered(name, asked, space, store)
    for step in remembered:
        progress.step_done(name, pressures[step.factor], 0.0)

    def keep(step: fem.Step) -> None:
        store.save_state(name, pressures[step.factor], **fem.step_to_arrays(step))
        progress.step_done(name, pressures[step.factor], step.seconds)

    def watch(factor: float, iteration: int, residual: float) -> None:
        progress.iteration(name, pressures[factor], iteration, residual)

    failure, failed, lost = "", float("nan"), (0, 0)
    try:
        options = fem.PathOptions(fem.NewtonOptions(tolerance=config.newton_tolerance))
        solution = fem.follow(model, list(pressures), options, watch=watch, keep=keep, resume=remembered)
    except fem.NotConverged as ended:
        solution, failure = ended.partial, in_kPa(ended.end, largest, case)
        lost = (ended.end.cutbacks, ended.end.factorizations)
    steps, crossed = _apart(scene, solution.steps)
    failure = crossed or failure
    if failure:
        failed = list(pressures.values())[len(steps)]
    seconds = sum((step.spent for step in solution.steps), fem.Seconds(set_up=solution.seconds.set_up))
    return Outcome(
        experiment=name,
        records=tuple(_record(experiment, step, pressures[step.factor], material) for step in steps),
        failure=failure,
        failed_kPa=failed,
        lost=lost,
        seconds=seconds,
        factorizations=sum(step.factorizations for step in solution.steps),
        degrees_of_freedom=solution.degrees_of_freedom,
        solver=solution.solver,
        points=space.points,
        nodes=space.nodes,
    )


def in_kPa(end: fem.End, largest_MPa: float, case: Case) -> str:
    """Why a path ended, in the units of the configuration."""
    reached, asked = (f"{1000.0 * value * largest_MPa:.4g} kPa" for value in (end.reached, end.asked))
    if case.end_y_mm and end.share < 1.0:
        reached += f" with the end moved {end.share * case.end_y_mm:.4g} mm"
        asked += f" and {case.end_y_mm:g} mm"
    return f"no equilibrium found beyond {reached} on the way to {asked}: {end.cause}"


def _apart(scene: Scene, steps: Sequence[fem.Step]) -> tuple[Sequence[fem.Step], str]:
    """The steps before the body passes through itself where no contact is looked for, and a sentence if it does.

    Where contact is switched off it may.
    """
    if scene.config.effects["self_contact"] == "off":
        return steps, ""
    for count, step in enumerate(steps):
        if where := fem.crossing(step.space, step.positions, scene.body.half):
            return steps[:count], f"the body {where}, where contact is not simulated"
    return steps, ""


def _remembered(name: str, pressures: Sequence[float], space: fem.Discretisation, store: Store) -> list[fem.Step]:
    """The finished steps of an earlier run with this configuration, up to the first that is missing."""
    steps: list[fem.Step] = []
    for pressure in pressures:
        arrays = store.load_state(name, pressure)
        if arrays is None:
            break
        steps.append(fem.step_from_arrays(space, arrays))
    return steps


def _record(experiment: fem.Experiment, step: fem.Step, pressure_kPa: float, material: fem.Material) -> Record:
    end, force = experiment.end(step), experiment.end_force(step)
    curve = experiment.centreline(step)
    air = sum(step.cavity_volume(name) for name in experiment.body.cavities[:1]) * experiment.whole
    clamp = experiment.clamp_force(step)
    off = fem.stress_error(step, material)
    row = {
        "experiment": experiment.name,
        "pressure_kPa": pressure_kPa,
        "end_x_mm": end[0],
        "end_y_mm": end[1],
        "reaction_N": force.tolist(),
        "clamp_reaction_N": clamp.tolist(),
        "clamp_moment_N_mm": experiment.clamp_moment(step),
        "cavity_volume_mm3": air,
        "stretch_of_curve": curve.stretch,
        "min_J": step.extremes.min_J,
        "max_stretch": step.extremes.max_stretch,
        "min_stretch": step.extremes.min_stretch,
        "min_J_at_mm": step.extremes.min_J_at,
        "max_stretch_at_mm": step.extremes.max_stretch_at,
        "min_stretch_at_mm": step.extremes.min_stretch_at,
        "min_gap_mm": step.min_gap,
        "stress_error": off.energy,
        "stress_error_at_mm": off.worst_at,
        "negative_pivots": step.negative_pivots,
        "newton_iterations": step.newton_iterations,
        "factorizations": step.factorizations,
        "cutbacks": step.cutbacks,
        "seconds": step.seconds,
        "status": "converged",
        "reason": _remarks(step, material),
    }
    return Record(
        experiment=experiment.name,
        pressure_kPa=pressure_kPa,
        row=row,
        centreline=curve,
        load=Load((float(force[0]), float(force[1])), experiment.end_couple(step)),
        displacement=step.displacement,
        fields=fem.element_fields(step, material),
        effects=step.effects,
        spent=step.spent,
    )


def _remarks(step: fem.Step, material: fem.Material) -> str:
    """What limits the trust in an equilibrium; empty where nothing does."""
    return "; ".join(filter(None, (fem.beyond_the_law(step.extremes, material), step.instability)))
