"""A run from beginning to end: configuration, body, experiments, five parameters, rod, report."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

from fem import compile_kernels
from pipeline.accuracy.plan import plan_discretisation, review
from pipeline.cell.of_run import law_of_run
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.identification.added_pressures import identify_run
from pipeline.identification.mesh_error import with_mesh_error
from pipeline.identification.record import parameters_record
from pipeline.plausibility import Solved, after_solving, before_solving, of_mesh
from pipeline.progress import Progress
from pipeline.report.saved import save_report
from pipeline.run_report import ReviewedPlan, RunReport
from pipeline.simulation.effects_record import effect_states
from pipeline.simulation.mesh_record import MeshRecord
from pipeline.simulation.pictures import draw_all
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.simulation.waiting import told_while_waiting
from pipeline.store.store import open_store
from pipeline.validation.compare import CURVE_COLUMNS, compare, curve_rows
from pipeline.validation.rods import ArmRods
from pipeline.validation.validate import validate


def run(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> RunReport:
    """From a configuration to `out`/report.html, `jobs` experiments at a time; `fresh` replaces earlier results.

    A pressure that is not reached is named in the report's `failures`; everything finished is in `out` then, the report
    included. Raises InputError for a body that cannot be meshed or a folder that cannot be used, and RunFailed where
    nothing more can be solved (faces that cannot touch, a process that was ended from outside).
    """
    with open_store(out, config, fresh=fresh) as store:
        stages = _Stages(progress)
        context = RunContext(store, jobs, progress)
        unusual = before_solving(config)
        for sentence in unusual:
            progress.remark(sentence)
        config, plan = plan_discretisation(config, store, progress)
        with stages.timed("mesh"), told_while_waiting(progress, "meshing the body"):
            scene = Scene.meshed(config)
        for sentence in of_mesh(scene.body.mesh):
            progress.remark(sentence)
            unusual = (*unusual, sentence)
        with stages.timed("kernels (compiled once)"):
            compile_kernels(config.mesh.formulation)
        with stages.timed("experiments"):
            outcomes = simulate(scene, context)
            store.save_json("experiments.json", outcomes.rows())
        with stages.timed("cell law"):
            arm = law_of_run(scene, context)
            arm.save(store)
            effects = (*effect_states(scene, outcomes), arm.effect)
            store.save_json("effects.json", [state.row() for state in effects])
        with stages.timed("identification"):
            identified = identify_run(scene, context, outcomes, other_rod=arm.law is not None)
            outcomes, parameters = identified.outcomes, identified.parameters
            store.save_json("experiments.json", outcomes.rows())
        with stages.timed("coarser mesh"):
            parameters, no_mesh_error = with_mesh_error(config, context, parameters)
            if config.law != "cell":
                store.save_json("parameters.json", parameters_record(config, parameters, arm.law, no_mesh_error))
        with stages.timed("rod"):
            rods = ArmRods(parameters, arm.law, (0.0, scene.body.curve_y))
            comparisons = compare(outcomes, rods, scene.body.pitch)
            store.save_rows("curves.csv", CURVE_COLUMNS, curve_rows(outcomes, comparisons, scene.body.pitch))
            store.save_json("validation.json", [row for c in comparisons for row in c.rows()])
        with stages.timed("validation"):
            validated = validate(scene, context, rods)
            validated.save(store, comparisons)
        with stages.timed("pictures"):
            draw_all(scene.body, outcomes, store)
        with stages.timed("report"):
            reviewed = review(plan, outcomes, parameters, outcomes.largest_indicator) if plan else None
            report = RunReport(
                directory=out,
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
                failures=(*outcomes.failures, *arm.failures, *identified.failures, *validated.failures),
                remarks=(*unusual, *identified.remarks, *after_solving(Solved(config, outcomes, parameters))),
            )
            save_report(store, report.record())
    return report


#: in their order
_STAGES = (
    *("mesh", "kernels (compiled once)", "experiments", "cell law", "identification", "coarser mesh", "rod"),
    *("validation", "pictures", "report"),
)


class _Stages:
    """The stages of a run: each is reported with its number as it begins, and its wall time is kept."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.seconds: dict[str, float] = {}

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        self._progress.stage(f"{name} ({_STAGES.index(name) + 1} of {len(_STAGES)})")
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start
