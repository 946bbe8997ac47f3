"""An arm that was built and measured, in Python."""

from collections.abc import Sequence
from pathlib import Path

from pipeline.answers.measured.calibrate import CalibrateOptions, CalibrationReport, calibrate_files
from pipeline.answers.measured.compare import Comparison, compare_files
from pneurod.arguments import given_choice, given_path


def compare(results: Path | str, measured: Path | str, *, align: bool = False) -> Comparison:
    """A measured arm beside the rod of a result folder: every number with its prediction and what is allowed.

    measured: the file, with columns as docs/results.md has them. align: move the rows so that those at rest lie on the
    rod. Raises InputError with file, line and column.
    """
    folder, file = given_path(results, "results", "results/arm"), given_path(measured, "measured", "arm.csv")
    return compare_files(folder, file, given_choice(align, "align"))


def calibrate(
    results: Path | str,
    measured: Path | str,
    out: Path | str | None = None,
    *,
    free: Sequence[str] = (),
    align: bool = False,
    samples: int = 0,
) -> CalibrationReport:
    """The rod of an arm that was built: modulus and dimensions with intervals, written to a folder of its own.

    out: "RESULTS_calibrated" by default; `pneurod.read_results(out)` reads it. free: dimensions ("geometry.wall"), by
    default those whose tolerances move the tip most. align: as in `compare`. samples: drawn to check the result.
    Raises InputError with file, line and column.
    """
    folder, file = given_path(results, "results", "results/arm"), given_path(measured, "measured", "arm.csv")
    new = None if out is None else given_path(out, "out", "results/arm_calibrated")
    options = CalibrateOptions(tuple(free), given_choice(align, "align"), samples)
    return calibrate_files(folder, file, new, options)
