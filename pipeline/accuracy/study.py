"""The convergence study: error against seconds over meshes, elements, tolerances and contact distances."""

from dataclasses import dataclass, field
from pathlib import Path

from pipeline.accuracy.figure import study_page
from pipeline.accuracy.ladder import Rung, ladder
from pipeline.accuracy.measure import measure
from pipeline.accuracy.record import ConvergenceStudy, convergence_study
from pipeline.accuracy.result import RungResult
from pipeline.config.config import Config
from pipeline.progress import Progress
from pipeline.remaining_time import RemainingTime
from pipeline.simulation.scene import Scene
from pipeline.store.store import Store, open_store
from pipeline.study import Study


def run_study(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> ConvergenceStudy:
    """Measure every rung that `out` does not hold yet; writes accuracy.json and accuracy.html.

    Raises InputError for a body that cannot be meshed or a folder that cannot be used, and RunFailed where no pressure
    was reached by enough rungs to extrapolate from.
    """
    with open_store(out, config, fresh=fresh) as store:
        contact_mm = Scene.meshed(config).activation_distance
        record = RungRecord(store, progress)
        rungs = Study(ladder(config, contact_mm), measure, record)
        missing = rungs.missing()
        record.expect(len(missing))
        progress.stage(f"{len(rungs.cases)} configurations, {len(missing)} of them to be measured")
        study = convergence_study(config, rungs.run_in_processes(jobs), contact_mm)
        store.save_json("accuracy.json", study.record())
        store.save_text("accuracy.html", study_page(study))
    return study


#: under which name the clock counts rungs, which have numbers instead of pressures there
_CLOCK = "rungs"


@dataclass
class RungRecord:
    """Results of rungs in the result folder, valid for the sources that measured them."""

    store: Store
    progress: Progress
    clock: RemainingTime = field(default_factory=RemainingTime)
    measured: int = 0  #: since `expect`

    def expect(self, count: int) -> None:
        """So many rungs will be measured; from now on the time that they still take is reported."""
        self.clock.add(_CLOCK, range(count))

    def read(self, rung: Rung) -> RungResult | None:
        """The result that `save` kept, None where there is none from these sources."""
        kept = self.store.read_json(_file(rung))
        return RungResult.read(kept) if kept is not None and kept["key"] == self.store.numbers_key else None

    def save(self, rung: Rung, result: RungResult) -> None:
        """Keep a result and report it."""
        self.store.save_json(_file(rung), {"key": self.store.numbers_key, **result.record()})
        outcome = result.failure if result.cost is None else f"{result.cost.cpu_seconds:.0f} s of CPU"
        seconds = 0.0 if result.cost is None else result.cost.wall_seconds
        self.clock.reach(_CLOCK, self.measured, seconds)
        self.measured += 1
        left = self.clock.remaining()
        self.progress.stage(f"{rung.series} {rung.value:g}: {outcome}{f'; about {left}' if left else ''}")


def _file(rung: Rung) -> str:
    return f"rungs/{rung.folder}.json"
