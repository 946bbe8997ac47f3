"""Values of the functions as the command line prints them.

The first parameter is the value. Those with an option are read from the command line; others are arguments of the
function that go by the same name.
"""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.cli.ending import print_json, print_lines, print_sentences

if TYPE_CHECKING:
    from pipeline.answers.budget import Budget
    from pipeline.answers.material.study import Material
    from pipeline.answers.measured.calibrate import CalibrationReport
    from pipeline.answers.measured.compare import Comparison
    from pipeline.answers.rods.export import Exported
    from pipeline.api.results import Results
    from pipeline.api.rods import RodShape, Solutions
    from pipeline.api.runs import MeshedArm
    from pipeline.doctor import Finding
    from pipeline.law.in_space.study import SpaceLawReport
    from pipeline.law.study import LawReport
    from pipeline.study.accuracy.study import ConvergenceStudy
    from pipeline.study.effects.study import EffectsTable
    from pipeline.study.pairs.run import PairRuns
    from pipeline.study.sweep.study import SweepReport
    from pipeline.study.wishes.report import DesignReport
    from pipeline.values.run import Run
    from pipeline.values.table import Table

Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="No progress, only the verdict.")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="Every Newton iteration, and the time of every stage.")]
Json = Annotated[bool, typer.Option("--json", help="The verdict as JSON on standard output; progress on stderr.")]


def show_results(
    made: "Results | PairRuns", quiet: Quiet = False, verbose: Verbose = False, as_json: Json = False
) -> None:
    """Print the verdict of a run and its tables."""
    from pipeline.api.results import Results
    from pipeline.show import tables

    if not isinstance(made, Results):
        _show_pairs(made, as_json)
        return
    results = made.run
    if as_json:
        print_json(made.verdict.record())
        return
    print_sentences(*made.verdict.lines)
    if not quiet:
        shown = (tables.five_parameters(results), *(_details(results) if verbose else ()))
        print_lines(*shown)
        print_sentences(*(f"Note: {note.text}" for note in results.remarks if verbose))
    print_lines(f"report: {made.report}")


def _details(results: "Run") -> "tuple[Table, ...]":
    """The tables that `-v` shows besides the verdict."""
    from pipeline.show import tables

    made = (tables.rods, tables.loads, tables.states, tables.effects, tables.design, tables.cost)
    return tuple(table(results) for table in made)


def _show_pairs(made: "PairRuns", as_json: bool) -> None:
    from pipeline.study.pairs.run import record
    from pipeline.study.pairs.table import pairs_table

    if as_json:
        print_json(record(made))
    else:
        print_lines(pairs_table(made))
        print_sentences(*made.sentences)
        print_lines(f"law: {made.directory / 'law.json'}, page: {made.directory / 'pairs.html'}")


def show_mesh(meshed: "MeshedArm") -> None:
    """Print volumes and the quality of the elements."""
    from pipeline.show.terminal import body_table
    from pipeline.values.reasons import render

    print_lines(body_table(meshed.file, meshed.design, meshed.body))
    print_sentences(*(f"Note: {render(reason)}." for reason in meshed.notes))


def show_effects(table: "EffectsTable") -> None:
    """Print the changes and the costs of each effect."""
    from pipeline.study.effects.rows import effects_table

    print_lines(effects_table(table.rows))
    print_lines(f"table: {table.directory / 'effects_table.json'}")
    print_sentences(*(f"{sentence}." for sentence in table.failures))


def show_accuracy(study: "ConvergenceStudy", out: Path | None) -> None:
    """Print errors, references and orders of convergence."""
    from pipeline.study.accuracy.table import orders_table, references_table, study_table

    print_lines(*(table(study) for table in (study_table, references_table, orders_table)))
    folder = out or Path("results") / f"{study.config.name}_accuracy"
    print_lines(f"picture: {folder / 'accuracy.html'}")


def show_cell(report: "LawReport | SpaceLawReport") -> None:
    """Print the law of an arm, and how far it may be trusted."""
    from pipeline.law.study import LawReport
    from pipeline.law.table import law_remarks, law_table, mesh_table, space_table
    from pipeline.values.law import LawMeshError
    from pipeline.values.reasons import render

    folder = report.directory
    if not isinstance(report, LawReport):
        print_lines(report.table)
        print_sentences(*report.sentences)
        print_lines(f"law: {folder / 'law.json'}")
        return
    measured = report.measured
    tables = [law_table(measured), space_table(measured.law, measured.mesh_error or LawMeshError())]
    tables += [] if measured.limit is None else [mesh_table(measured.limit)]
    print_lines(*tables)
    print_sentences(*(f"Note: {render(remark)}." for remark in law_remarks(report.measured)))
    print_lines(f"law: {folder / 'law.json'}, picture: {folder / 'law.html'}")


def show_design(report: "DesignReport", quiet: Quiet = False) -> None:
    """Print the dimensions that were found, and the wishes. Raises RunFailed where one is missed."""
    from pipeline.study.wishes.design import raise_if_missed
    from pipeline.study.wishes.report import dimensions_table, wishes_table

    folder = report.directory
    print_lines(dimensions_table(report), wishes_table(report))
    print_lines(f"configuration: {folder / 'design.yaml'}, picture: {folder / 'design.html'}")
    if report.run is not None:
        print_lines(f"report of its run: {report.run / 'report.html'}")
    raise_if_missed(report)


def show_sweep(reports: "Sequence[SweepReport]") -> None:
    """Print how the points of each sweep ended."""
    for report in reports:
        folder = report.directory
        print_lines(f"{report.sentence()}; table: {folder / 'sweep.csv'}, picture: {folder / 'sweep.html'}")


def show_shape(found: "RodShape") -> None:
    """Print position, angle and force of the end, and the moment at the clamp."""
    from pipeline.answers.rods.end_loads import end_lines

    print_lines(*end_lines(found.rod, found.shape, found.errors))


def show_solutions(
    found: "Solutions", as_json: Annotated[bool, typer.Option("--json", help="The solutions as JSON.")] = False
) -> None:
    """Print the pressures that were found."""
    if as_json:
        print_json({"solutions": [asdict(at) for at in found.solutions]})
    else:
        print_lines(*(at.text for at in found.solutions), *found.notes)


def show_budget(found: "Budget", folder: Path, out: Path | None) -> None:
    """Print by how much each tolerance moves the arm."""
    from pipeline.answers.budget import budget_table

    print_lines(budget_table(found), f"picture: {out or folder / 'budget.html'}")


def show_comparison(
    found: "Comparison",
    results: Path,
    measured: Path,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The picture (default: DIR/compared_MEASURED.html).")
    ] = None,
) -> None:
    """Print each measured number beside that of the rod, and draw both."""
    from pipeline.answers.measured.page import comparison_page, comparison_table
    from pipeline.results.options import write_new

    picture = out or results / f"compared_{measured.stem}.html"
    write_new(picture, comparison_page(found.design, found.rows))
    print_lines(comparison_table(found.rows))
    print_sentences(*found.lines)
    print_lines(f"picture: {picture}")


def show_calibration(report: "CalibrationReport") -> None:
    """Print each unknown, and the verdict of the calibrated arm."""
    from pipeline.answers.measured.calibrate import estimates_table

    print_lines(estimates_table(report.found))
    print_sentences(*report.lines, *report.verdict.lines)
    print_lines(f"written: {report.directory / 'calibration.json'}, law.json, predictions.csv, run.json")


def show_material(found: "Material", out: Path) -> None:
    """Print doubts about the data; of laws that can be used the one to take, and all others."""
    from pipeline.answers.material.page import law_table

    print_sentences(*(f"Note: {note}" for note in found.notes))
    if not found.judged.usable:
        return
    print_lines("", *found.words, "", found.line, "", law_table(found))
    print_lines(f"\nwritten: {out / 'material.html'} (picture), material.json (all laws as lines), material_curves.csv")


def show_export(done: "Exported") -> None:
    """Print the names of the files, their error, and what they leave out."""
    print_lines(*(f"written: {file}" for file in done.files), *done.sentences)


def show_file(file: Path) -> None:
    """Print the name of the configuration that was written."""
    print_lines(f"written: {file}; change it and check the body with `pneurod mesh {file}`")


def show_findings(findings: "Sequence[Finding]") -> None:
    """Print each finding."""
    from pipeline.doctor import findings_table

    print_lines(findings_table(findings))
    if all(finding.sound for finding in findings):
        print_lines("everything pneurod needs is here")
