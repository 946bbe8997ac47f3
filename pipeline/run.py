"""A run from beginning to end: configuration, body, experiments, five parameters, rod, report."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from pipeline.accuracy.plan import review
from pipeline.accuracy.planning import Planned, plan_discretisation
from pipeline.cell.of_run import law_of_run
from pipeline.config.config import Config
from pipeline.context import RunContext, run_context
from pipeline.identification.added_pressures import identify_run
from pipeline.identification.mesh_error import with_mesh_error
from pipeline.identification.record import parameters_record
from pipeline.parallel.loading import loaded
from pipeline.plausibility.after import Solved, after_solving, largest_bend_rad
from pipeline.plausibility.before import Borne, before_solving
from pipeline.plausibility.body import of_body
from pipeline.plausibility.units import of_contact, of_units
from pipeline.progress import Progress
from pipeline.report.saved import save_report
from pipeline.run_report import ReviewedPlan, RunReport
from pipeline.simulation.below_limit import completed, highest_of_use
from pipeline.simulation.effects_record import effect_states
from pipeline.simulation.mesh_record import MeshRecord
from pipeline.simulation.pictures import draw_all
from pipeline.simulation.simulate import begun
from pipeline.simulation.waiting import meshed_with_progress
from pipeline.store.formats import CURVE_COLUMNS
from pipeline.store.result_folder import ON_COMMAND_LINE, FolderWords
from pipeline.store.store import open_store
from pipeline.validation.compare import compare, curve_rows
from pipeline.validation.rods import ArmRods
from pipeline.validation.validate import (
    Validated,
    beyond_end_of_II,
    validate,
    validation_outcomes,
    with_reached_loads,
)

#: which of the tasks that wait for a worker are next: those of the longest chain first
_OF_LAW, _OF_EXPERIMENTS, _OF_COARSER_MESH, _OF_VALIDATION = range(4)


def run(
    config: Config, out: Path, jobs: int, fresh: bool, progress: Progress, words: FolderWords = ON_COMMAND_LINE
) -> RunReport:
    """From a configuration to `out`/report.html, `jobs` tasks at a time; `fresh` replaces earlier results.

    A pressure that is not reached is named in the report's `failures`; everything finished is in `out` then, the report
    included. Raises InputError for a body that cannot be meshed, a folder that cannot be used (in the words of the
    caller) or a requested accuracy that no mesh reaches, and RunFailed where nothing more can be solved (faces that
    cannot touch, a process that was ended from outside).
    """
    with open_store(out, config, fresh=fresh, words=words) as store:
        for sentence in (*before_solving(config), *of_units(config)):
            progress.remark(sentence)
        planned = plan_discretisation(config, store, progress)
        with run_context(store, jobs, progress) as context:
            return _solved(planned, context)


def _solved(planned: Planned, context: RunContext) -> RunReport:
    """The stages of the run. One waits for what it needs; tasks of later ones are done meanwhile."""
    config, plan = planned.config, planned.plan
    store, progress, workers = context.store, context.progress, context.workers
    stages = _Stages(progress, stage_names(config))
    loading = loaded(context, config)
    with stages.timed("mesh"):
        scene = meshed_with_progress(config, progress)
    unusual = tuple(filter(None, (*of_body(scene.body, config), of_contact(scene))))
    for sentence in unusual:
        progress.remark(sentence)
    unusual = (*planned.remarks, *unusual)
    with stages.timed("kernels (compiled once)"):
        for pending in loading:
            pending.result()
    with stages.timed("experiments"):
        simulation = begun(scene, replace(context, urgency=_OF_EXPERIMENTS))
        complete = workers.beside(completed, scene, context, simulation)
        of_law = replace(context, urgency=_OF_LAW)
        measured = law_of_run(scene, of_law, lambda: highest_of_use(scene, simulation, complete))
        outcomes, remark = complete.result()
        store.save_json("experiments.json", outcomes.rows())
    if remark:
        progress.remark(remark)
        unusual = (*unusual, remark)
    # II and III at pressures between go on from the states of the experiments
    tested = with_reached_loads(scene, outcomes)
    of_validation = replace(context, urgency=_OF_VALIDATION)
    validation = workers.beside(validation_outcomes, tested, of_validation, outcomes.reached_kPa)
    with stages.timed("identification"):
        identified = identify_run(scene, context, outcomes)
        outcomes, parameters = identified.outcomes, identified.parameters
        store.save_json("experiments.json", outcomes.rows())
        improved = workers.beside(with_mesh_error, config, replace(context, urgency=_OF_COARSER_MESH), parameters)
    with stages.timed("pictures"):
        draw_all(scene.body, outcomes, store)
    with stages.timed("cell law"):
        arm = measured.result().beside(outcomes)
        arm.save(store)
        effects = (*effect_states(scene, outcomes), arm.effect)
        store.save_json("effects.json", [state.row() for state in effects])
    with stages.timed(_COARSER_MESH):
        parameters, no_mesh_error = improved.result()
    with stages.timed("rod"):
        if config.law != "cell":
            store.save_json("parameters.json", parameters_record(config, parameters, arm.law, no_mesh_error))
        rods = ArmRods(parameters, arm.law, (0.0, scene.body.curve_y), config.effects.straight_without_pressure)
        comparisons = compare(outcomes, rods, scene.body.pitch)
        store.save_rows("curves.csv", CURVE_COLUMNS, curve_rows(outcomes, comparisons, scene.body.pitch))
        store.save_json("validation.json", [row for c in comparisons for row in c.rows()])
    with stages.timed("validation"):
        validated = validate(tested, validation.result(), rods) if parameters or arm.law else Validated()
        validated.save(store, comparisons)
    with stages.timed("report"):
        other_rod = arm.law is not None
        not_identified, left_out = identified.failures(other_rod), beyond_end_of_II(config, outcomes)
        regions = {name: scene.body.mesh.regions[name] for name in config.materials}
        solved = Solved(config, outcomes, parameters, regions)
        reached = max(outcomes.reached_kPa, default=0.0)
        borne = Borne(outcomes.lowest_end_kPa(), reached, largest_bend_rad(solved))
        of_design = (*before_solving(config, borne), *of_units(config))
        of_states = after_solving(solved)
        remarks = (*of_design, *unusual, *identified.remarks(other_rod), *arm.remarks(outcomes), *of_states)
        remarks = tuple(dict.fromkeys(remarks))  # why there are no five parameters is known before and after
        reviewed = review(plan, outcomes, parameters, outcomes.largest_indicator) if plan else None
        report = RunReport(
            directory=store.directory,
            config=config,
            outcomes=outcomes,
            parameters=parameters,
            comparisons=(*comparisons, *validated.comparisons),
            arm=arm,
            laws=validated.laws,
            effects=effects,
            accuracy=ReviewedPlan(plan, reviewed) if plan else None,
            mesh=MeshRecord.of(scene),
            seconds=dict(stages.seconds),
            failures=(*outcomes.failures, *arm.failures, *not_identified, *validated.failures, *left_out),
            remarks=remarks,
        )
        save_report(store, report.record())
    return report


#: the stage of a run whose configuration has a second mesh
_COARSER_MESH = "coarser mesh"
#: in their order
_STAGES = (
    *("mesh", "kernels (compiled once)", "experiments", "identification", "pictures", "cell law", _COARSER_MESH),
    *("rod", "validation", "report"),
)


def stage_names(config: Config) -> tuple[str, ...]:
    """The stages of a run in their order; a second mesh only where the five parameters are to have its error."""
    has_coarser = config.mesh.coarser is not None and config.law != "cell"
    return tuple(name for name in _STAGES if has_coarser or name != _COARSER_MESH)


class _Stages:
    """The stages of a run. Each is reported with its number as it begins; what is kept is how long the run waited."""

    def __init__(self, progress: Progress, names: Sequence[str]) -> None:
        self._progress = progress
        self._names = names
        self.seconds: dict[str, float] = {}

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        if name not in self._names:
            yield
            return
        self._progress.stage(f"{name} ({self._names.index(name) + 1} of {len(self._names)})")
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start
