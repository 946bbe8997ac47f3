"""The whole story of a run on one screen: config, body, experiments, five numbers, rod, report."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

from fem import compile_kernels
from pipeline.accuracy.plan import plan_discretisation, review
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.identification.added_pressures import with_added_pressures
from pipeline.identification.mesh_error import with_mesh_error
from pipeline.identification.parameters import identify_all
from pipeline.identification.record import parameters_record
from pipeline.progress import Progress
from pipeline.report.page import render_report
from pipeline.simulation.effects_record import effect_rows
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.pictures import draw_all
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.provenance import provenance
from pipeline.store.store import Store, open_store
from pipeline.validation.compare import CURVE_COLUMNS, compare, curve_rows
from pipeline.validation.validate import validate


def run(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> None:
    """From a config to `out`/report.html.

    Raises InputError for a body that cannot be meshed or a folder that cannot be used, and RunFailed with the reason
    when a pressure was not reached; everything finished is in `out` then, the report included.
    """
    with open_store(out, config, fresh=fresh) as store:
        seconds: dict[str, float] = {}
        context = RunContext(store, jobs, progress)
        config, plan = plan_discretisation(config, store, progress)
        with _stage("mesh", progress, seconds):
            scene = Scene.meshed(config)
        with _stage("kernels (compiled once)", progress, seconds):
            compile_kernels(config.mesh.formulation)
        with _stage("experiments", progress, seconds):
            outcomes = simulate(scene, context)
            store.save_json("experiments.json", outcomes.rows())
            store.save_json("effects.json", effect_rows(scene, outcomes))
        with _stage("identification", progress, seconds):
            found, refused = identify_all(outcomes, scene.body.pitch)
            outcomes, found, more = with_added_pressures(scene, context, outcomes, found)
            store.save_json("experiments.json", outcomes.rows())
        with _stage("coarser mesh", progress, seconds):
            found = with_mesh_error(config, context, found)
            store.save_json("parameters.json", parameters_record(config, found))
        with _stage("rod", progress, seconds):
            comparisons = compare(found)
            store.save_rows("curves.csv", CURVE_COLUMNS, curve_rows(outcomes, comparisons, scene.body.pitch))
            store.save_json("validation.json", [comparison.row() for comparison in comparisons])
        with _stage("validation", progress, seconds):
            validated = validate(scene, context, found)
            validated.save(store, comparisons)
        with _stage("pictures", progress, seconds):
            draw_all(scene.body, outcomes, store)
        failure = "; ".join([*outcomes.failures, *refused, *more, *validated.failures])
        with _stage("report", progress, seconds):
            indicator = outcomes.largest_indicator
            errors = {
                **({"indicator": indicator.record()} if indicator else {}),
                **({"accuracy": plan.record(review(plan, outcomes, found, indicator))} if plan else {}),
            }
            _write_report(store, config, outcomes, seconds, errors, failure)
    if failure:
        raise RunFailed(f"{failure}; what was reached is in {out}")


@contextmanager
def _stage(name: str, progress: Progress, seconds: dict[str, float]) -> Iterator[None]:
    progress.stage(name)
    start = perf_counter()
    yield
    seconds[name] = perf_counter() - start


def _write_report(
    store: Store,
    config: Config,
    outcomes: Outcomes,
    seconds: Mapping[str, float],
    errors: Mapping[str, Any],
    failure: str,
) -> None:
    record = {
        "config": config.record(),
        "config_hash": config.hash,
        **provenance(),
        "seconds": seconds,
        "solver_seconds": outcomes.seconds_by_stage,
        "factorizations": {outcome.name: outcome.factorizations for outcome in outcomes},
        "degrees_of_freedom": {outcome.name: outcome.degrees_of_freedom for outcome in outcomes},
        "solver": sorted({outcome.solver for outcome in outcomes}),
        **errors,
        **({"failure": failure} if failure else {}),
    }
    store.save_json("run.json", record)
    store.save_text("report.html", render_report(store.directory))
