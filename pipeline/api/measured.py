"""An arm that was built and measured, and its rubber."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.api.course import given_choice, given_path, given_progress, reached
from pipeline.api.options import Align, Folder, Given, MeasuredFile, Ratio
from pipeline.store.progress import Progress
from pipeline.values.errors import RunFailed

__all__ = ["calibrate", "compare", "material"]

if TYPE_CHECKING:
    from pipeline.answers.material.study import Material
    from pipeline.answers.measured.calibrate import CalibrationReport
    from pipeline.answers.measured.compare import Comparison


def compare(
    results: Annotated[Given, typer.Argument(metavar="DIR", help="Results of a run, of `cell` or of `calibrate`.")],
    measured: MeasuredFile,
    *,
    align: Align = False,
    ratio: Ratio = None,
    progress: "bool | Progress" = False,
) -> "Comparison":
    """Compare a measured arm with its rod.

    Every number has its prediction and what is allowed. measured: the file, with columns as docs/results.md has them.
    align: move the rows so that those at rest lie on the rod. progress: tell the time left on the terminal, where one
    waits, or to a `Progress`. Raises InputError with file, line and column.
    """
    from pipeline.answers.measured.compare import compare_files

    folder, file = given_path(results, "results", "results/arm"), given_path(measured, "measured", "arm.csv")
    return compare_files(folder, file, given_choice(align, "align"), ratio, given_progress(progress).remark)


def calibrate(
    results: Folder,
    measured: MeasuredFile,
    out: Annotated[
        Path | str | None, typer.Option("--out", metavar="DIR2", help="Its folder (default: DIR_calibrated).")
    ] = None,
    *,
    free: Annotated[
        Sequence[str], list[str], typer.Option("--free", metavar="KEY", help="A dimension: geometry.wall. Repeatable.")
    ] = (),
    align: Align = False,
    ratio: Ratio = None,
    progress: "bool | Progress" = False,
) -> "CalibrationReport":
    """Fit modulus and dimensions to measurements, with intervals.

    out: "RESULTS_calibrated" by default; `pneurod.read_results(out)` reads it. free: dimensions ("geometry.wall"), by
    default those whose tolerances move the tip most. align, progress: as in `compare`. An earlier calibration in `out`
    is replaced. Raises InputError with file, line and column, and RunFailed, which has the report as `reached`, for a
    fit that misses a large part of the motion.
    """
    from pipeline.answers.measured.calibrate import calibrate_files

    folder, file = given_path(results, "results", "results/arm"), given_path(measured, "measured", "arm.csv")
    new = None if out is None else given_path(out, "out", "results/arm_calibrated")
    told, onto = given_progress(progress).remark, given_choice(align, "align")
    report = calibrate_files(folder, file, new, tuple(free), align=onto, ratio=ratio, tell=told)
    return reached(report, report.raise_if_failed)


def material(
    tests: Annotated[Sequence[Path | str], list[Path], typer.Argument(metavar="TEST.csv...", help="Files of tests.")],
    out: Annotated[Path | str, typer.Option("--out", metavar="DIR", help="Result folder.")] = Path("results/material"),
    *,
    run: Annotated[
        Path | str | None,
        typer.Option("--for", metavar="DIR", help="Results: the stretches needed. Or a configuration: its law."),
    ] = None,
    kind: Annotated[
        Sequence[str],
        list[str],
        typer.Option("--kind", metavar="KIND", help="uniaxial, planar, equibiaxial: of all files, or each."),
    ] = (),
    length: Annotated[str | None, typer.Option(metavar="L", help="At rest, for extensions: '33 mm'.")] = None,
    area: Annotated[str | None, typer.Option(metavar="A", help="At rest, for forces: '16 mm^2'.")] = None,
    cycle: Annotated[int, typer.Option(metavar="N", min=0, help="A later loading than the first one.")] = 0,
    start: Annotated[str | None, typer.Option("--from", metavar="STRAIN", help="Leave out smaller strains.")] = None,
    nu: Annotated[float, typer.Option(metavar="NU", help="Poisson ratio; it gives rubber its kappa.")] = 0.495,
    density: Annotated[str | None, typer.Option(metavar="RHO", help="For the configuration: '1070 kg/m^3'.")] = None,
    hold: Annotated[
        Path | str | None,
        typer.Option("--hold", metavar="HOLD.csv", help="One that is held: stress or strain over time; or DMA."),
    ] = None,
) -> "Material":
    """Fit laws to tests: the law to take, its constants, and the stretches over which it can be used.

    hold gives the branches of relaxation; kind says of what kind the tests are where titles do not. Raises
    `pneurod.InputError` for a wrong file or argument, and `pneurod.RunFailed` where no law can be used.
    """
    from pipeline.answers.material import page, study

    files = [given_path(test, "tests", "tensile.csv") for test in tests]
    needing = None if run is None else given_path(run, "run", "results/arm")
    texts = {"length": length, "area": area, "start": start, "density": density}
    held = None if hold is None else given_path(hold, "hold", "hold.csv")
    options = study.FitOptions.read(texts, nu, cycle, needing, held, kind)
    found = page.fit_material(files, options, given_path(out, "out", "results/material"))
    if not found.judged.usable:
        raise RunFailed(" ".join(found.words)).with_reached(found)
    return found
