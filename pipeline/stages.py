"""The stages of a run, each a function of the state of the run and of what earlier stages have found."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from math import isfinite
from time import perf_counter
from typing import Any, TypeAlias

from geometry import Reason, Values
from pipeline.answers.rods.budget import make_budgets
from pipeline.answers.rods.in_time import with_remark
from pipeline.config.config import Config
from pipeline.identify.compare import ArmRods, Comparison, compare, curves_of
from pipeline.identify.mesh_error import predictions, with_mesh_error, with_mesh_error_of_laws
from pipeline.identify.parameters import Identified, Parameters, identify_run
from pipeline.identify.record import parameters_record
from pipeline.identify.state_notes import Solved, check_states
from pipeline.identify.validate import Validated, find_loads_beyond_II, keep_reached_loads
from pipeline.identify.validate import validate as compare_loads
from pipeline.law.effort import expected_of
from pipeline.law.of_run import LawOfRun, deliver_law_of_run, law_on_mesh_of_arm
from pipeline.law.study import save_law
from pipeline.results.files import LAW_ON_MESH_OF_ARM, save_curves, save_value
from pipeline.results.laws import law_record
from pipeline.results.unloaded import delivered_numbers
from pipeline.simulate.design_notes import check_design
from pipeline.simulate.effects_record import list_effects
from pipeline.simulate.loadcase import validation_cases
from pipeline.simulate.mesh_notes import check_body
from pipeline.simulate.outcome import Outcome, Outcomes
from pipeline.simulate.scene import Scene, mesh_with_progress
from pipeline.simulate.simulate import begin_loading, complete_experiments, find_highest_pressure, simulate
from pipeline.store.context import RunContext
from pipeline.store.parallel import Pending
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.values.reasons import render, render_all, report_reason
from pipeline.values.record import RunRecord
from pipeline.values.run import Run
from rod import ArmLaw, RodError

#: the stage of a run whose configuration has a second mesh
_COARSER_MESH = "coarser mesh"
#: the stages of the arm's own law: as it is delivered, and on the mesh on which the whole arm is solved
_LAW, _LAW_ON_MESH_OF_ARM = "cell and ends", "cell and ends on the mesh of the arm"
#: in their order
_STAGES = (
    *("mesh", "kernels (compiled once)", _LAW, "experiments", "identification", _LAW_ON_MESH_OF_ARM),
    *(_COARSER_MESH, "rod", "validation", "pictures", "report"),
)
#: those of a run with the arm's own law alone
_STAGES_OF_LAW = ("mesh", "kernels (compiled once)", _LAW, "pictures", "report")


def stage_names(config: Config) -> tuple[str, ...]:
    """The stages of a run in their order, without a second mesh of the arm that its own law replaces."""
    if config.is_law_alone:
        return _STAGES_OF_LAW
    is_replaced = config.accuracy is not None and config.law != "five"
    left_out = {_COARSER_MESH} if is_replaced or not config.mesh.coarser else set()
    left_out |= {_LAW, _LAW_ON_MESH_OF_ARM} if config.law == "five" else set()
    return tuple(name for name in _STAGES if name not in left_out)


class Stages:
    """The stages of a run. Each is reported with its number as it begins; what is kept is how long the run waited."""

    def __init__(self, progress: Progress, names: Sequence[str]) -> None:
        self._progress = progress
        self._names = names
        self.seconds: dict[str, float] = {}

    def add(self, name: str, before: str) -> None:
        """Count a stage that turned out to be needed."""
        if name not in self._names:
            at = self._names.index(before)
            self._names = (*self._names[:at], name, *self._names[at:])

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """While the block runs, the run is in this stage."""
        if name not in self._names:
            yield
            return
        self._progress.stage(f"{name} ({self._names.index(name) + 1} of {len(self._names)})")
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start


#: the parameters with the errors of the mesh, and reasons where there are none at some pressure
WithMeshError: TypeAlias = tuple[tuple[Parameters, ...], tuple[Reason, ...]]


@dataclass(frozen=True)
class RunState:
    """What the stages of a run share."""

    config: Config
    context: RunContext
    stages: Stages
    scene: Scene
    remarks: tuple[Reason, ...]  #: on the design and on how far it went, which the user was told
    written: Run  #: the results that are in the files already

    def with_remarks(self, *remarks: Reason) -> "RunState":
        """Tell these remarks."""
        for remark in remarks:
            self.context.progress.remark(render(remark))
        return replace(self, remarks=(*self.remarks, *remarks))

    def with_results(self, **results: Any) -> "RunState":
        """With further parts of `Run`, which are in their files."""
        return replace(self, written=replace(self.written, **results))


@dataclass(frozen=True)
class SolvedRun:
    """The results of a run as its files have them, and what they were made from."""

    results: Run
    config: Config
    outcomes: Outcomes  #: of experiments I, II and III
    parameters: tuple[Parameters, ...]  #: by ascending pressure
    comparisons: tuple[Comparison, ...]  #: rod against finite elements, loads of the identification first
    arm: LawOfRun  #: the arm's own law as it is delivered


def mesh(config: Config, context: RunContext) -> RunState:
    """Mesh the body, while the workers load the solver."""
    stages = Stages(context.progress, stage_names(config))
    loading = begin_loading(context, config)
    with stages.timed("mesh"):
        scene = mesh_with_progress(config, context.progress)
    state = RunState(config, context, stages, scene, (), Run(context.store.directory))
    state = state.with_remarks(*check_body(scene.body, config))
    with stages.timed("kernels (compiled once)"):
        for pending in loading:
            pending.result()
    context.progress.expect(expected_of(config))
    return state


def deliver_law(state: RunState, begin_others: Callable[[], object] = lambda: None) -> tuple[RunState, LawOfRun]:
    """Measure the arm's own law, write law.json and tell the arm without a load.

    begin_others: called when the first numbers are told, unless the arm has no law.
    """
    with state.stages.timed(_LAW):
        arm = deliver_law_of_run(state.scene, state.context, begin_others)
    return _with_law(state, arm), arm


def _with_law(state: RunState, arm: LawOfRun) -> RunState:
    if arm.measured is None:
        return state
    law = save_law(state.context.store, arm.measured, state.config.pressures_kPa)
    if law.unloaded:
        state.context.progress.remark(delivered_numbers(law))
    return state.with_results(law=law)


def solve_experiments(
    state: RunState, arm: LawOfRun, second: Pending[Outcome] | None
) -> tuple[RunState, Outcomes, Pending[LawOfRun]]:
    """Solve experiments I, II, which is begun, and III, and begin to measure the arm's own law on their mesh."""
    scene, context = state.scene, state.context
    with state.stages.timed("experiments"):
        complete = context.workers.beside(complete_experiments, scene, context, second)
        is_same_law = scene.config.accuracy is None and arm.law is not None
        law = (
            Pending.done(arm)
            if is_same_law
            else law_on_mesh_of_arm(scene, context, lambda: find_highest_pressure(scene, second, complete))
        )
        outcomes, remark = complete.result()
    return state.with_remarks(*filter(None, [remark])), outcomes, law


def begin_validation(state: RunState, outcomes: Outcomes) -> tuple[Scene, Pending[Outcomes]]:
    """Begin to solve the loads of the validation, which go on from states of the experiments.

    The scene is that of the run with the loads that are solved.
    """
    scene, context = keep_reached_loads(state.scene, outcomes), state.context
    return scene, context.workers.beside(simulate, scene, context, validation_cases(scene.config, outcomes.reached_kPa))


def identify(state: RunState, outcomes: Outcomes, arm: LawOfRun) -> tuple[RunState, Identified, Pending[WithMeshError]]:
    """Identify the five parameters, write experiments.json, and begin with their error on the coarser mesh.

    Without a coarser mesh where two laws tell it.
    """
    with state.stages.timed("identification"):
        identified = identify_run(state.scene, state.context, outcomes)
        states = save_value(state.context.store, "experiments.json", identified.outcomes.states)
        context, parameters = state.context, identified.parameters
        if state.config.accuracy is not None and arm.law is not None:
            improved = Pending[WithMeshError].done((parameters, ()))
        else:
            if state.config.mesh.coarser:
                state.stages.add(_COARSER_MESH, before="rod")
            improved = context.workers.beside(with_mesh_error, state.config, context, parameters)
    return state.with_results(states=states), identified, improved


def complete_law(state: RunState, arm: LawOfRun, law: Pending[LawOfRun]) -> tuple[RunState, LawOfRun, LawOfRun]:
    """The law that is delivered, and the one on the mesh of the whole arm, which is written beside it.

    Where the cell bears no pressure of the run, the law below the limit of the whole arm is the one that is delivered.
    """
    with state.stages.timed(_LAW_ON_MESH_OF_ARM):
        on_mesh = law.result()
    if arm.law is None:
        return _with_law(state, on_mesh), on_mesh, on_mesh
    if on_mesh.law is not None and on_mesh is not arm:
        state.context.store.save_json(LAW_ON_MESH_OF_ARM, law_record(on_mesh.law))
    return state, arm, on_mesh


def add_mesh_error(
    state: RunState, identified: Identified, improved: Pending[WithMeshError], arm: LawOfRun, on_mesh: LawOfRun
) -> tuple[RunState, Identified]:
    """Write parameters.json, with the errors of the mesh: from a coarser one, or from the laws on two meshes."""
    with state.stages.timed(_COARSER_MESH):
        parameters, no_mesh_error = improved.result()
        predicted, coarser = None if arm.law is None else predictions(parameters, arm.law), state.config.mesh.coarser
        if predicted is not None and on_mesh.law and on_mesh is not arm:
            parameters = with_mesh_error_of_laws(parameters, predicted, predictions(parameters, on_mesh.law))
            coarser = None
    identified = replace(identified, parameters=parameters)
    content = parameters_record(state.config, parameters, predicted, coarser, render_all(no_mesh_error))
    return state.with_results(parameters=save_value(state.context.store, "parameters.json", content)), identified


def compare_rods(
    state: RunState, identified: Identified, on_mesh: LawOfRun
) -> tuple[RunState, ArmRods, tuple[Comparison, ...]]:
    """Compare the rods with experiments II and III; write curves.csv.

    on_mesh: the law on the mesh of the experiments.
    """
    body, outcomes = state.scene.body, identified.outcomes
    with state.stages.timed("rod"):
        rods = ArmRods(state.written.parameters, on_mesh.law, (0.0, body.curve_y))
        comparisons = compare(outcomes, rods, body.pitch)
        curves = curves_of(outcomes, comparisons, body.pitch)
        save_curves(state.context.store, curves)
    return state.with_results(curves=curves), rods, comparisons


def validate(
    state: RunState, loads: tuple[Scene, Pending[Outcomes]], rods: ArmRods, comparisons: Sequence[Comparison]
) -> tuple[RunState, Validated]:
    """Compare the rods with the loads of the validation; write validation.json, with the comparisons before."""
    scene, pending = loads
    with state.stages.timed("validation"):
        validated = compare_loads(scene, pending.result(), rods) if rods.identified_kPa or rods.law else Validated()
        compared = (*comparisons, *validated.comparisons)
        errors = tuple(error for comparison in compared for error in comparison.errors)
        errors, curves = save_value(state.context.store, "validation.json", errors), validated.curves
        save_curves(state.context.store, curves, has_loads=True)
    return state.with_results(rod_errors=errors, validation_curves=curves), validated


def conclude(
    state: RunState, identified: Identified, arm: LawOfRun, comparisons: Sequence[Comparison], validated: Validated
) -> SolvedRun:
    """Write effects.json; the results have the content of run.json, which is written with the report."""
    outcomes, parameters = identified.outcomes, identified.parameters
    failures = _failures(state.config, identified, arm, validated)
    with state.stages.timed("report"):
        found = (*list_effects(state.scene, outcomes), arm.effect)
        effects = save_value(state.context.store, "effects.json", found)
        record = _record(state, identified, failures, _remarks(state, identified, arm, validated))
    results = with_remark(replace(state.written, effects=effects, record=record))
    compared = (*comparisons, *validated.comparisons)
    return SolvedRun(results, state.config, outcomes, parameters, compared, arm)


def _record(
    state: RunState, identified: Identified, failures: Sequence[Reason], remarks: Sequence[Reason]
) -> RunRecord:
    """The content of run.json."""
    config, outcomes = state.config, identified.outcomes
    end_kPa = outcomes.lowest_end_kPa()
    return RunRecord(
        config=config.record(),
        config_hash=config.hash,
        **provenance(),
        mesh=state.scene.mesh_record,
        seconds=dict(state.stages.seconds),
        solver_seconds=outcomes.seconds_by_stage,
        factorizations={outcome.name: outcome.factorizations for outcome in outcomes},
        degrees_of_freedom={outcome.name: outcome.degrees_of_freedom for outcome in outcomes},
        solver=tuple(sorted({outcome.solver for outcome in outcomes})),
        indicator=outcomes.largest_indicator,
        end_kPa=end_kPa if isfinite(end_kPa) else None,
        failures=tuple(map(report_reason, failures)),
        remarks=tuple(map(report_reason, remarks)),
    )


def _failures(config: Config, identified: Identified, arm: LawOfRun, validated: Validated) -> tuple[Reason, ...]:
    """One for everything that was to be solved and was not."""
    outcomes, not_identified = identified.outcomes, identified.failures(arm.law is not None)
    left_out = find_loads_beyond_II(config, outcomes)
    return (*outcomes.failures, *arm.failures, *not_identified, *validated.failures, *left_out)


def _tolerances(config: Config, law: ArmLaw | None) -> Iterator[Reason]:
    """What the tolerances of the built arm do to it at the highest pressure; nothing without derivatives of the law."""
    if law is None or not law.rates:
        return
    pressure = max(p for p in (0.0, *config.pressures_kPa) if p <= law.pressures[-1])
    with suppress(RodError):
        held = config.end.y_mm if config.end.x_mm is None else None
        (budget,) = make_budgets(law, config.tolerances, [pressure], held)
        most = budget.largest()
        values: Values = {
            "process": {"cast": "casting", "printed": "printing"}[budget.process],
            "percent": 100.0 * budget.total("tip"),
            "pressure_kPa": pressure,
            "parameter": most.parameter,
            "tolerance": most.tolerance,
            "most_percent": 100.0 * most.changes["tip"],
        }
        if isfinite(budget.total("tip")):  # else the arm has no equilibrium without a load
            yield Reason("tolerances", values)


def _remarks(state: RunState, identified: Identified, arm: LawOfRun, validated: Validated) -> tuple[Reason, ...]:
    """What is unusual about the design and its results, each remark once."""
    config, outcomes = state.config, identified.outcomes
    regions = {name: state.scene.body.mesh.regions[name] for name in config.materials}
    loads = tuple(comparison.record for comparison in validated.comparisons)
    solved = Solved(config, outcomes, identified.parameters, state.scene.body.mesh.volumes, regions, loads)
    of_results = (*identified.remarks(arm.law is not None), *arm.remarks(outcomes), *check_states(solved))
    of_results = (*of_results, *_tolerances(config, arm.law))
    return tuple(dict.fromkeys((*check_design(config), *state.remarks, *of_results)))
