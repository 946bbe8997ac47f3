"""Values of the functions as the command line prints them.

The first parameter is the value. Others are options of the command, or arguments of the function by the same name.
"""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.cli.ending import print_json, print_lines, print_sentences
from pipeline.results.options import write_new
from pipeline.values.table import Table

if TYPE_CHECKING:
    from pipeline.answers.material.study import Material
    from pipeline.answers.measured.calibrate import CalibrationReport
    from pipeline.answers.measured.compare import Comparison
    from pipeline.answers.rods import pressures
    from pipeline.answers.rods.budget import Budget
    from pipeline.doctor import Finding


def show_solutions(found: "pressures.Solutions", as_json: bool = False) -> None:
    """Print the pressures that were found."""
    if as_json:
        print_json({"solutions": [asdict(at) for at in found.solutions]})
    else:
        print_lines(*found.lines)


def show_budget(found: "Budget", folder: Path, out: Path | None) -> None:
    """Print by how much each tolerance moves the arm."""
    print_lines(found.table, f"picture: {out or folder / 'budget.html'}")


def show_comparison(found: "Comparison", results: Path, measured: Path, out: Path | None = None) -> None:
    """Print each measured number beside that of the rod, and draw both."""
    picture = out or results / f"compared_{measured.stem}.html"
    write_new(picture, found.page)
    print_lines(found.table)
    print_sentences(*found.lines)
    print_lines(f"picture: {picture}")


def show_calibration(report: "CalibrationReport") -> None:
    """Print each unknown, and the verdict of the calibrated arm."""
    print_lines(report.table)
    print_sentences(*report.lines, *report.verdict.lines)
    print_lines(f"written: {report.directory / 'calibration.json'}, law.json, predictions.csv, run.json")


def show_material(found: "Material", out: Path) -> None:
    """Print doubts about the data; of laws that can be used the one to take, and all others."""
    from pipeline.answers.material.page import law_table

    print_sentences(*(f"Note: {note}" for note in found.notes))
    if not found.judged.usable:
        return
    print_lines("", *found.words, "", *found.lines)
    for judged in found.kinds.taken.values():
        print_lines("", law_table(judged, found.options.need))
    if found.kinds.table:
        print_lines("", found.kinds.table)
    print_lines(f"\nwritten: {out / 'material.html'} (picture), material.json (all laws as lines), material_curves.csv")


def show_file(file: Path) -> None:
    """Print the name of the configuration that was written."""
    print_lines(f"written: {file}; change it and check the body with `pneurod mesh {file}`")


def show_findings(findings: "Sequence[Finding]") -> None:
    """Print each finding, in colours on a terminal."""
    columns = (
        ("", lambda finding: "[green]ok[/]" if finding.sound else "[red]no[/]"),
        ("checked", lambda finding: finding.subject),
        ("result", lambda finding: finding.result),
    )
    print_lines(Table.of(findings, *columns))
    if all(finding.sound for finding in findings):
        print_lines("everything pneurod needs is here")
