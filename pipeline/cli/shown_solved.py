"""Values of the functions that solve finite elements, as the command line prints them; loaded when they are printed.

The first parameter is the value. Others are options of the command, or arguments of the function by the same name.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.cli.ending import print_json, print_lines, print_sentences
from pipeline.law.build import MeasuredLaw
from pipeline.law.in_space.measure import MeasuredInSpace
from pipeline.law.study import LawReport
from pipeline.law.table import law_remarks, law_table, mesh_table, rows_table, space_sentences, space_table
from pipeline.show.tables import five_parameters
from pipeline.show.terminal import body_table
from pipeline.simulate.meshed import MeshedArm
from pipeline.study.accuracy.study import ConvergenceStudy
from pipeline.study.accuracy.table import orders_table, references_table, study_table
from pipeline.study.effects.rows import effects_table
from pipeline.study.pairs.run import PairRuns, record
from pipeline.study.pairs.table import pairs_table
from pipeline.values.law import LawMeshError
from pipeline.values.reasons import render

if TYPE_CHECKING:  # Dask and pandas come with these
    from pipeline.api.results import Results
    from pipeline.study.effects.study import EffectsTable
    from pipeline.study.sweep.study import SweepReport
    from pipeline.study.wishes.report import DesignReport


def show_results(made: "Results | PairRuns", quiet: bool = False, as_json: bool = False) -> None:
    """Print the verdict of a run and its tables."""
    if isinstance(made, PairRuns):
        _show_pairs(made, as_json)
        return
    if as_json:
        print_json(made.verdict.record())
        return
    print_sentences(*made.verdict.lines)
    if not quiet:
        print_lines(five_parameters(made.run))
    print_lines(f"report: {made.report}")


def _show_pairs(made: PairRuns, as_json: bool) -> None:
    if as_json:
        print_json(record(made))
    else:
        print_lines(pairs_table(made))
        print_sentences(*made.sentences)
        print_lines(f"law: {made.directory / 'law.json'}, page: {made.directory / 'pairs.html'}")


def show_mesh(meshed: MeshedArm) -> None:
    """Print volumes and the quality of the elements."""
    print_lines(body_table(meshed.file, meshed.design, meshed.body))
    print_sentences(*(f"Note: {render(reason)}." for reason in meshed.notes))


def show_effects(table: "EffectsTable") -> None:
    """Print the changes and the costs of each effect."""
    print_lines(effects_table(table.rows))
    print_lines(f"table: {table.directory / 'effects_table.json'}")
    print_sentences(*(f"{sentence}." for sentence in table.failures))


def show_accuracy(study: ConvergenceStudy, out: Path | None) -> None:
    """Print errors, references and orders of convergence."""
    print_lines(*(table(study) for table in (study_table, references_table, orders_table)))
    folder = out or Path("results") / f"{study.config.name}_accuracy"
    print_lines(f"picture: {folder / 'accuracy.html'}")


def show_cell(report: LawReport[MeasuredLaw] | LawReport[MeasuredInSpace]) -> None:
    """Print the law of an arm, and how far it may be trusted."""
    folder, measured = report.directory, report.measured
    if isinstance(measured, MeasuredInSpace):
        print_lines(rows_table(measured.law))
        print_sentences(*space_sentences(measured), *report.lines)
        print_lines(f"law: {folder / 'law.json'}, report: {folder / 'report.html'}")
        return
    shown = [law_table(measured), space_table(measured.law, measured.mesh_error or LawMeshError())]
    shown += [] if measured.limit is None else [mesh_table(measured.limit)]
    print_lines(*shown)
    print_sentences(*(f"Note: {render(remark)}." for remark in law_remarks(measured)), *report.lines)
    print_lines(f"law: {folder / 'law.json'}, report: {folder / 'report.html'}")


def show_design(report: "DesignReport", quiet: bool = False) -> None:
    """Print the dimensions that were found, and the wishes. Raises RunFailed where one is missed."""
    folder = report.directory
    print_lines(*report.tables)
    print_lines(f"configuration: {folder / 'design.yaml'}, picture: {folder / 'design.html'}")
    if report.run is not None:
        print_lines(f"report of its run: {report.run / 'report.html'}")
    report.raise_if_missed()


def show_sweep(reports: "Sequence[SweepReport]") -> None:
    """Print how the points of each sweep ended."""
    for report in reports:
        folder = report.directory
        print_lines(f"{report.sentence()}; table: {folder / 'sweep.csv'}, picture: {folder / 'sweep.html'}")
