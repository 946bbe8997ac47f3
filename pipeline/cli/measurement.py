"""The commands for an arm that was built and measured: compare, calibrate."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.cli.ending import print_lines, print_sentences

MeasuredFile = Annotated[Path, typer.Argument(metavar="MEASURED.csv", help="Measured rows, see docs/results.md.")]
Align = Annotated[bool, typer.Option("--align", help="Move the rows so that those at rest lie on the rod.")]


def compare(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a run, of `cell` or of `calibrate`.")],
    measured: MeasuredFile,
    align: Align = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The picture (default: DIR/compared_MEASURED.html).")
    ] = None,
) -> None:
    """An arm that was built and measured beside its rod: how far they differ, and whether that was to be expected."""
    from pipeline.answers.measured.compare import compare_files
    from pipeline.answers.measured.page import comparison_page, comparison_table
    from pipeline.results.options import write_new

    found = compare_files(folder, measured, align)
    picture = out or folder / f"compared_{measured.stem}.html"
    write_new(picture, comparison_page(found.design, found.rows))
    print_lines(comparison_table(found.rows))
    print_sentences(*found.lines)
    print_lines(f"picture: {picture}")


def calibrate(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Results of a run or of `pneurod cell`.")],
    measured: MeasuredFile,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR2", help="New folder (default: DIR_calibrated).")
    ] = None,
    free: Annotated[
        list[str] | None, typer.Option("--free", metavar="KEY", help="A dimension: geometry.wall. Repeatable.")
    ] = None,
    align: Align = False,
    samples: Annotated[int, typer.Option(metavar="N", min=0, help="Check the result with N samples.")] = 0,
) -> None:
    """The rod of an arm that was built: modulus and dimensions from measured rows, with intervals."""
    from pipeline.answers.measured.calibrate import CalibrateOptions, calibrate_files, estimates_table

    report = calibrate_files(folder, measured, out, CalibrateOptions(tuple(free or ()), align, samples))
    print_lines(estimates_table(report.found))
    print_sentences(*report.lines, *report.verdict.lines)
    print_lines(f"written: {report.directory / 'calibration.json'}, law.json, predictions.csv, run.json")
