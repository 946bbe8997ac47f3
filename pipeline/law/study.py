"""The command that measures the arm's own law: law.json, law.html, and the record of the run."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

from pipeline.config.config import Config
from pipeline.law.build import MeasuredLaw, deliver_law
from pipeline.law.pieces import ArmPieces, NoArmLaw
from pipeline.law.plane import check_plane
from pipeline.law.table import law_page
from pipeline.results.unloaded import delivered_numbers
from pipeline.results.unloaded_states import unloaded_states
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import begin_loading
from pipeline.store.context import run_context
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.store import Store, open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import JsonObject
from pipeline.values.law import BesideLaw, DeliveredLaw
from pipeline.values.reasons import render, render_all
from rod.arm_law.kinds import law_record


@dataclass(frozen=True, eq=False)  # arrays inside
class LawReport:
    """The law of an arm as it was measured; the same numbers stand in the files of `directory`."""

    directory: Path
    config: Config
    measured: MeasuredLaw
    seconds: float  #: wall time of this call

    def raise_if_failed(self) -> None:
        """Raise RunFailed where a pressure was not reached."""
        if self.measured.failures:
            known = f"the law goes up to {self.measured.law.pressures[-1]:g} kPa"
            sentence = f"{render_all(self.measured.failures)}; {known}; what was reached is in {self.directory}"
            raise RunFailed(sentence, directory=self.directory)

    def record(self) -> JsonObject:
        """The content of run.json."""
        failure = render_all(self.measured.failures)
        return {
            "format": FORMAT,
            "config": self.config.record(),
            "config_hash": self.config.hash,
            **provenance(),
            "seconds": {**self.measured.seconds, "this call": self.seconds},
            "factorizations": self.measured.factorizations,
            "degrees_of_freedom": self.measured.unknowns,
            **({"failure": failure} if failure else {}),
        }


def measure_law(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> LawReport:
    """From a configuration to `out`/law.json; curves that `out` already holds are not measured again.

    The mesh of the configuration is that of the arm; with an accuracy the law comes from finer ones of the cell
    (`pipeline.law.build`).

    A pressure that is not reached is named in the report; the law of those below it is in `out` then. Raises InputError
    for an arm without such a law, a body that cannot be meshed and a folder that cannot be used, and RunFailed where
    not even the lowest pressure is borne.
    """
    begin = perf_counter()
    with open_store(out, config, fresh=fresh) as store, run_context(store, jobs, progress) as context:
        loading = begin_loading(context, config)
        progress.stage("mesh")
        try:
            pieces = ArmPieces.of(Scene.meshed(config))
            progress.stage("kernels (compiled once)")
            for pending in loading:
                pending.result()
            progress.stage("cell and ends")
            check_plane(pieces)
            measured = deliver_law(pieces, context)
        except NoArmLaw as refusal:
            raise InputError(f"{config.source}: {refusal}") from None
        report = LawReport(out, config, measured, perf_counter() - begin)
        law = save_law(store, measured, config.pressures_kPa)
        if law.beside.unloaded:
            progress.remark(delivered_numbers(law))
        store.save_json("run.json", report.record())
        store.save_text("law.html", law_page(config.name, measured.law))
    return report


def save_law(store: Store, measured: MeasuredLaw, pressures_kPa: Sequence[float]) -> DeliveredLaw:
    """Write law.json, the law, its errors and where it ends, and return what the verdict and the report read.

    pressures_kPa: of the configuration, at which the arm without a load is told.
    """
    beside = BesideLaw(measured.mesh_error, unloaded_states(measured.law, pressures_kPa))
    content = {
        **law_record(measured.law),
        **asdict(beside),
        "added_pressures_kPa": measured.added_kPa,
        "end_half_cells": measured.half_cells,
        "interpolation_error": {
            "along_curves": measured.error_along,
            "along_clamped_end": measured.error_along_clamp,
            "between_pressures": measured.error_between,
            "ends_over_length": measured.error_ends,
        },
        "accuracy": measured.limit and measured.limit.record(),
        "limits": [*map(render, measured.limits)],
        "failures": [*map(render, measured.failures)],
        "factorizations": measured.factorizations,
        "seconds": measured.seconds,
        "degrees_of_freedom": measured.unknowns,
    }
    store.save_json("law.json", content)
    return DeliveredLaw(measured.law, beside)
