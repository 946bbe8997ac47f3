"""The command that measures error against seconds over meshes, elements, tolerances and contact distances."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from pipeline.config.config import Config
from pipeline.simulate.scene import Scene
from pipeline.store.kept import KeptFile
from pipeline.store.processes import Processes
from pipeline.store.progress import Progress
from pipeline.store.store import Store, open_store
from pipeline.study.accuracy.ladder import Rung, ladder
from pipeline.study.accuracy.measure import RungResult, measure
from pipeline.study.accuracy.study import ConvergenceStudy, convergence_study
from pipeline.study.accuracy.table import study_page
from pipeline.study.study import Study


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


def measured(rungs: Sequence[Rung], store: Store, jobs: int, progress: Progress) -> list[tuple[Rung, RungResult]]:
    """All rungs with their results. Each that the store does not hold from these sources is measured in a process of
    its own with one thread, `jobs` at a time, and kept as soon as it is there."""
    with Processes(jobs, is_fresh=True) as processes:
        study = Study(rungs, partial(measure_and_keep, store), processes, partial(_kept, store))
        progress.stage(f"{len(rungs)} configurations, {len(study.missing)} of them to be measured")
        results = {rung.name: result for rung, result in (*study.kept, *study.solve(progress.stage, _ending))}
    return [(rung, results[rung.name]) for rung in rungs]


def measure_and_keep(store: Store, rung: Rung) -> RungResult:
    """The result of a rung, which is then in the store; runs in a worker."""
    return _kept(store, rung).read_or_make(lambda: measure(rung.config))


def _kept(store: Store, rung: Rung) -> KeptFile[RungResult]:
    return KeptFile.of_run(store, f"rungs/{rung.name}.json", RungResult)


def _ending(rung: Rung, result: RungResult) -> str:
    outcome = result.failure if result.cost is None else f"{result.cost.cpu_seconds:.0f} s of CPU"
    return f"{rung.series} {rung.value:g}: {outcome}"
