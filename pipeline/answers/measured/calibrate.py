"""The command that calibrates the rod of a result folder to a measured arm, and writes a folder of its own."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from geometry import Reason
from pipeline.answers.material.sentences import OF_ONE_BATCH
from pipeline.answers.measured.aligned import aligned
from pipeline.answers.measured.calibration import Calibration, calibrated, law_to_calibrate
from pipeline.answers.measured.page import calibration_page
from pipeline.answers.measured.predicted import LawRods, Setup
from pipeline.answers.measured.saved import calibrated_config, read_calibration, save_calibration
from pipeline.answers.measured.table import read_measurements
from pipeline.answers.measured.unknowns import MODULUS
from pipeline.answers.rods.budget import budget_of
from pipeline.answers.rods.choice import run_along
from pipeline.answers.rods.in_time import with_remark
from pipeline.results.files import read_results
from pipeline.results.verdict import Verdict, verdict_of
from pipeline.store.owner import CALIBRATION, claim
from pipeline.values.errors import InputError, RunFailed, argument
from pipeline.values.reasons import render, report_reason
from pipeline.values.record import Reported
from pipeline.values.run import Run
from pipeline.values.table import Table

#: what is said of moduli that differ more than those of one batch
OTHER_BATCH = (
    "The moduli are {:.2g} times those of the arm that was calibrated before; arms of one batch differ by less than a "
    "fifth."
)


@dataclass(frozen=True, eq=False)  # arrays inside
class CalibrationReport:
    """A calibration and where it was written."""

    directory: Path
    file: Path  #: that was measured
    found: Calibration
    verdict: Verdict  #: of the calibrated arm

    @property
    def lines(self) -> tuple[str, ...]:
        """What was found, in words."""
        return (*self.found.notes, *self.found.undetermined, self.found.next_measurement.text)

    @property
    def table(self) -> Table:
        """One row for each unknown."""
        rows = tuple(
            (one.name, one.unit, f"{one.drawn:.4g}", f"{one.mean:.4g}", f"{one.std:.2g}", one.source)
            for one in self.found.estimates
        )
        spread = self.found.posterior.spread
        scatter = ", ".join(f"{std:.2g} {unit}".removesuffix(" 1") for unit, std in spread.scatter.items())
        caption = f"Scatter of the measurement {scatter}; error of the model {100 * spread.model:.2g} % of the modulus."
        return Table(("unknown", "unit", "before", "mean", "std", "known before by"), rows, caption)

    def raise_if_failed(self) -> None:
        """Raise RunFailed where the fit is no calibration."""
        if self.found.missed:
            sentence = f"{self.file}: the fit is no calibration; {render(self.found.missed)}"
            raise RunFailed(sentence, directory=self.directory)


def calibrate_files(
    folder: Path,
    file: Path,
    out: Path | None = None,
    free: Sequence[str] = (),
    *,
    align: bool = False,
    ratio: str | None = None,
    tell: Callable[[str], object] = str,
) -> CalibrationReport:
    """The calibrated arm of a result folder and a file of measurements, written to another folder.

    out: FOLDER_calibrated by default; an earlier calibration in it is replaced. free: dimensions; none: those
    whose tolerances move the tip most. align: move the rows onto the rod at rest. ratio: of the pressures of a law
    that has several. tell: is told the time left. Raises InputError.
    """
    run, measurements = run_along(folder, ratio), read_measurements(file)
    law = law_to_calibrate(run)
    out = out or folder.with_name(f"{folder.name}_calibrated")
    if out.resolve() == folder.resolve():
        raise InputError(f"{argument('out', out)}: is the folder of the law itself; give another one")
    earlier = read_calibration(run.directory)
    drawn = earlier.setup.drawn_mm if earlier else law.length
    store = claim(out, CALIBRATION)
    if align:
        measurements = aligned(measurements, LawRods(law), Setup(drawn_mm=drawn))
    found = calibrated(law, run.config, measurements, free, drawn, tell)
    if earlier and abs(found[MODULUS].mean - 1.0) > OF_ONE_BATCH:
        found = replace(found, notes=(*found.notes, OTHER_BATCH.format(found[MODULUS].mean)))
    reported = report_reason(found.missed or _remark(run, found)), *_in_time(run, found)
    save_calibration(store, run, file, found, reported)
    made, error = read_results(store.directory), found.posterior.quantile * found.next_measurement.tip_std_mm
    page = calibration_page(made, found.predictions, found.curves, found.setup, error)
    store.save_text("calibration.html", page)
    return CalibrationReport(store.directory, file, found, verdict_of(made))


def _in_time(run: Run, found: Calibration) -> Sequence[Reported]:
    """What the verdict says of the calibrated arm in time, where its rubber was measured so."""
    if not (found.rubber and run.law):
        return ()
    record = replace(run.record, config=calibrated_config(run.config, found), remarks=())
    parameters, law = replace(run.parameters, material=None), replace(run.law, law=found.law)
    return with_remark(replace(run, record=record, parameters=parameters, law=law)).remarks


def _remark(run: Run, found: Calibration) -> Reason:
    """What the calibration makes of the tip, for the verdict."""
    percent = 100.0 * found.posterior.quantile * found.next_measurement.tip_std_mm / found.law.length
    values = {"numbers": len(found.predictions), "percent": percent}
    if before := budget_of(run):
        return Reason("calibrated", {**values, "before": 100.0 * before.total("tip")})
    return Reason("calibrated_alone", values)
