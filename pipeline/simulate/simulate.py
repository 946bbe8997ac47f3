"""The load cases on one body, each a task; each state is stored as soon as it is reached.

An arm of which II and III reach no pressure of the configuration together has states below its limit solved instead.
"""

from collections.abc import Iterable, Sequence
from math import inf
from typing import TypeAlias

import fem
from geometry import Reason
from pipeline.config.config import Config
from pipeline.simulate.case_path import CasePath
from pipeline.simulate.known_limit import FIRST, EndOfII, waits_for_II
from pipeline.simulate.loadcase import LoadCase, identification_case, schedule
from pipeline.simulate.outcome import Failure, Outcome, Outcomes
from pipeline.simulate.records import record_of, steps_before_crossing, with_falls_sideways
from pipeline.simulate.scene import Scene, material_of
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending, TaskContext
from pipeline.store.store import Store
from pipeline.values.errors import RunFailed
from pipeline.values.reasons import render_all
from rod import too_few_pitches

#: II first, because the others are told where it ends; then the loaded one, which takes longest
EXPERIMENTS = ("II", "III", "I")
#: the outcomes of the experiments with states below the limit, and a remark on these
Completed: TypeAlias = tuple[Outcomes, Reason | None]

#: pressures over the lower limit of II and III: high enough to say something about the arm as it was to be loaded
PARTS = (0.4, 0.8)
#: digits of these pressures, so that they can be typed
DIGITS = 3


def experiments_of(config: Config) -> tuple[str, ...]:
    """The experiments of a run, without what `why_not_free` leaves out."""
    return keep_balanced(config, [name for name in EXPERIMENTS if name in config.experiments])


def keep_balanced(config: Config, names: Iterable[str]) -> tuple[str, ...]:
    """These experiments, without I where it is not simulated."""
    return tuple(name for name in names if name != "I" or not why_not_free(config))


def why_not_free(config: Config) -> Reason | None:
    """Why experiment I is not simulated, because forces on a free body are not in balance; None where it is."""
    if config.effects.gravity.on:
        return Reason("weight_not_held")
    return Reason("opening_not_held") if config.design.is_open_at_clamp else None


def begin_II(scene: Scene, context: RunContext) -> Pending[Outcome] | None:
    """Experiment II of a run, submitted; None where it is not simulated."""
    if FIRST not in experiments_of(scene.config):
        return None
    case = identification_case(scene.config, FIRST)
    context.progress.experiment(case.name, case.schedule.pressures_kPa)
    return context.submit(_solve, case, scene, context.store, None)


def simulate(
    scene: Scene,
    context: RunContext,
    experiments: Sequence[str | LoadCase] | None = None,
    second: Pending[Outcome] | None = None,
) -> Outcomes:
    """Solve the load cases, by default `experiments_of`; one that fails does not stop others.

    A name stands for that experiment at the pressures of the run. Cases that the end of II concerns, or that begin at
    states of II, are begun when II, if it is among them, has ended. second: II, where it was submitted before. Raises
    RunFailed where the faces that are to touch cannot.
    """
    requested = experiments_of(scene.config) if experiments is None else experiments
    cases = [c if isinstance(c, LoadCase) else identification_case(scene.config, c) for c in requested]
    pending = {} if second is None else {FIRST: second}
    new = sorted((case for case in cases if case.name not in pending), key=lambda case: case.name)
    for case in new:
        context.progress.experiment(case.name, case.schedule.pressures_kPa)
    has_II = any(case.name == FIRST for case in cases)
    later = [case for case in cases if has_II and (case.experiment == "dead" or waits_for_II(case))]
    for case in sorted((case for case in new if case not in later), key=lambda case: case.name != FIRST):
        pending[case.name] = context.submit(_solve, case, scene, context.store, None)
    try:
        if later:
            end = EndOfII.of(pending[FIRST].result())
            for case in later:
                told = end if waits_for_II(case) else None
                pending[case.name] = context.submit(_solve, case, scene, context.store, told)
        return Outcomes({name: pending[name].result() for name in sorted(pending)})
    except fem.ContactError as failure:
        raise RunFailed(str(failure)) from None


def _solve(context: TaskContext, case: LoadCase, scene: Scene, store: Store, end_of_II: EndOfII | None) -> Outcome:
    """Follow the load path of one case from its stored states on."""
    load_kernels(context, scene.config)
    at_end, progress = case.end, context.progress
    experiment = fem.Experiment.of(case.experiment, scene.body, at_end.y_mm, at_end.force_N, at_end.x_mm)
    material = scene.material
    effects = scene.effects(case.schedule.reference_MPa)
    model = experiment.model(material, effects, scene.config.mesh.formulation)
    newton = fem.NewtonOptions(tolerance=scene.config.newton.tolerance)
    path = CasePath(case, model, newton, store, progress, end_of_II)
    solution, failure = path.follow()
    steps, crossing = steps_before_crossing(scene, with_falls_sideways(scene, experiment, model, solution.steps))
    pressures = case.schedule.pressures_kPa
    if crossing:
        reached_kPa = pressures[len(steps) - 1] if steps else 0.0
        failure = Failure(pressures[len(steps)], crossing, 0, 0, reached_kPa=reached_kPa, passes_through_itself=True)
    if failure:
        progress.stopped(case.name, pressures[len(steps) :], render_all(failure.brief))
    seconds = sum((step.spent for step in solution.steps), fem.Seconds(set_up=solution.seconds.set_up))
    rejected = path.cpu_seconds[len(steps) :]
    states = zip(pressures[: len(steps)], steps, path.cpu_seconds[: len(steps)], strict=True)
    return Outcome(
        name=case.name,
        records=tuple(record_of(scene, experiment, case, *state) for state in states),
        failure=failure,
        seconds=seconds,
        factorizations=sum(step.factorizations for step in solution.steps),
        degrees_of_freedom=solution.degrees_of_freedom,
        solver=solution.solver,
        points=model.space.points,
        nodes=model.space.nodes_of_tets,
        unused_cpu_seconds=sum(rejected) + path.cpu_seconds_since,
    )


def begin_loading(context: RunContext, config: Config) -> list[Pending[None]]:
    """Load the kernels of the solver in every worker. The results are there when nothing has to be compiled."""
    others = [context.submit(_import_solver) for _ in range(context.workers.jobs - 1)]
    return [context.submit(load_kernels, config), *others]


def load_kernels(context: TaskContext, config: Config) -> None:
    """Load the kernels of a configuration in this process, once, so that no experiment is charged with it.

    Raises InputError as `material_of`.
    """
    layer = config.effects.strain_limiting_layer.on or config.effects.hoops.on
    key = ("kernels", config.mesh.formulation, repr((config.material, config.materials)), layer)
    context.kept(key, lambda: fem.compile_kernels(config.mesh.formulation, material_of(config), layer))


def _import_solver(context: TaskContext) -> None:
    """Nothing but the imports of this module."""


def add_states_below_limit(scene: Scene, context: RunContext, outcomes: Outcomes) -> Completed:
    """The outcomes with states at pressures below the limit, and a remark on them.

    The limit is where one of II and III ended (`Failure.end_kPa`). Unchanged, without a remark, where both have
    reached a pressure of the configuration or neither has an equilibrium but that at rest, and where the arm is too
    short for five parameters, for which alone these states are solved. Raises RunFailed as `simulate`.
    """
    limit = inf if outcomes.pairs else outcomes.lowest_end_kPa("II", "III")
    if limit == inf or too_few_pitches(scene.body.length, scene.body.pitch):
        return outcomes, None
    pressures = tuple(_rounded(part * limit) for part in PARTS)
    names = experiments_of(scene.config)
    cases = [LoadCase(name, name, schedule(scene.config, pressures), scene.config.end) for name in names]
    more = simulate(scene, context, cases)
    if not more.pairs:
        return outcomes, None
    return outcomes.merged(more), Reason(
        "solved_below_limit", {"reached_kPa": list(more.reached_kPa), "limit_kPa": float(f"{limit:.{DIGITS}g}")}
    )


def complete_experiments(scene: Scene, context: RunContext, second: Pending[Outcome] | None) -> Completed:
    """The outcomes of the experiments of a run, II of which is submitted, with states below the limit, as above."""
    return add_states_below_limit(scene, context, simulate(scene, context, second=second))


def find_highest_pressure(scene: Scene, second: Pending[Outcome] | None, complete: Pending[Completed]) -> float:
    """Highest pressure in kPa at which a rod of the arm can be compared with experiment II: the largest of its states
    and of the validation loads below its end, or a part of that end where there are none.

    Infinite where II reaches all pressures of the run, has no equilibrium but that at rest, or is not simulated. Waits
    until that is known.

    second: experiment II. complete: the outcomes with states below the limit.
    """
    failure = second.result().failure if second else None
    if failure is None:
        return inf
    outcomes, _ = complete.result()
    end, loads = failure.end_kPa, scene.config.validation
    given = [pressure for pressure in loads.pressures_kPa if pressure < end and loads.with_experiments]
    states = [record.pressure_kPa for record in outcomes[FIRST].records]
    return max((*states, *given), default=_rounded(PARTS[-1] * end) or inf)


def _rounded(pressure_kPa: float) -> float:
    return float(f"{pressure_kPa:.{DIGITS}g}")
