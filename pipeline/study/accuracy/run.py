"""The command that measures error against seconds over meshes, elements, tolerances and contact distances."""

from collections.abc import Sequence
from concurrent.futures import as_completed
from pathlib import Path

from pipeline.config.config import Config
from pipeline.simulate.scene import Scene
from pipeline.store.kept import read_kept, save_kept
from pipeline.store.processes import process_pool
from pipeline.store.progress import Progress
from pipeline.store.store import Store, open_store
from pipeline.study.accuracy.ladder import Rung, ladder
from pipeline.study.accuracy.measure import Measured, measure
from pipeline.study.accuracy.study import ConvergenceStudy, convergence_study
from pipeline.study.accuracy.table import study_page


def run_study(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> ConvergenceStudy:
    """Measure every rung that `out` does not hold yet; writes accuracy.json and accuracy.html.

    Raises InputError for a body that cannot be meshed or a folder that cannot be used, and RunFailed where no pressure
    was reached by enough rungs to extrapolate from.
    """
    with open_store(out, config, fresh=fresh) as store:
        contact_mm = Scene.meshed(config).activation_distance
        rungs = ladder(config, contact_mm)
        study = convergence_study(config, measured(rungs, store, jobs, progress), contact_mm)
        store.save_json("accuracy.json", study.record())
        store.save_text("accuracy.html", study_page(study))
    return study


def measured(rungs: Sequence[Rung], store: Store, jobs: int, progress: Progress) -> list[tuple[Rung, Measured]]:
    """All rungs with their results. Each that the store does not hold from these sources is measured in a process of
    its own with one thread, `jobs` at a time, and kept as soon as it is there."""
    results = {rung.name: kept for rung in rungs if (kept := read_kept(store, _file(rung), Measured)) is not None}
    missing = [rung for rung in rungs if rung.name not in results]
    progress.stage(f"{len(rungs)} configurations, {len(missing)} of them to be measured")
    if missing:
        with process_pool(jobs, 1, max_tasks_per_child=1) as pool:
            futures = {pool.submit(measure, rung.config): rung for rung in missing}
            for future in as_completed(futures):
                rung, result = futures[future], future.result()
                results[rung.name] = result
                save_kept(store, _file(rung), Measured, result)
                progress.stage(_ending(rung, result))
    return [(rung, results[rung.name]) for rung in rungs]


def _file(rung: Rung) -> str:
    return f"rungs/{rung.name}.json"


def _ending(rung: Rung, result: Measured) -> str:
    outcome = result.failure if result.cost is None else f"{result.cost.cpu_seconds:.0f} s of CPU"
    return f"{rung.series} {rung.value:g}: {outcome}"
