"""The commands that solve a design: run, mesh, effects, accuracy, cell, design."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypeVar

import typer
from rich.console import Console

from pipeline.cli.ending import print_json, print_lines, print_sentences
from pipeline.store.worker import available_cores

if TYPE_CHECKING:
    from pipeline.config.config import Config
    from pipeline.law.in_space.rows import RowSpec
    from pipeline.store.progress import Progress
    from pipeline.study.pairs.spec import PairSpec
    from pipeline.values.run import Run
    from pipeline.values.table import Table

    Result = TypeVar("Result")
    #: a command that solves: configuration, result folder, jobs, fresh, progress
    Task: TypeAlias = Callable[[Config, Path, int, bool, Progress], Result]


def _out(suffix: str = "") -> Any:
    """The option --out; what the program finds by default stands in round brackets, because the terminal drops square
    ones."""
    return typer.Option("--out", metavar="DIR", help=f"Result folder (default: results/NAME{suffix}).")


def _jobs(default: str) -> Any:
    return typer.Option("--jobs", min=1, help=f"Number of worker processes (default: {default}).")


ConfigFile = Annotated[Path, typer.Argument(metavar="CONFIG", help="A design in YAML, such as configs/pneunet.yaml.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace a value: --set mesh.size='4 mm'. May be repeated."),
]
Accuracy = Annotated[
    str | None,
    typer.Option("--accuracy", metavar="P%", help="Error that the mesh may make of the arm's own law: 1%, or off."),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Delete earlier results in DIR and begin again.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="No progress, only the verdict.")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="Every Newton iteration, and the time of every stage.")]
Json = Annotated[bool, typer.Option("--json", help="The verdict as JSON on standard output; progress on stderr.")]


def run(
    config: ConfigFile,
    out: Annotated[Path | None, _out()] = None,
    settings: Settings = None,
    accuracy: Accuracy = None,
    jobs: Annotated[int | None, _jobs("number of cores, at most 3")] = None,
    fresh: Fresh = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    as_json: Json = False,
) -> None:
    """Mesh, experiments I, II and III, the five parameters, the rod, the report."""
    given = _with_accuracy(settings, accuracy)

    from pipeline.config.document import read_document
    from pipeline.study.pairs.spec import read_pairs

    if (pairs := read_pairs(read_document(config, given))) is not None:
        progress = _listener(quiet, as_json, verbose)
        _run_pairs(pairs, out, jobs or min(3, available_cores()), fresh, progress, as_json)
        return
    design, folder = _design(config, given, out)

    from pipeline.results.verdict import verdict_of
    from pipeline.run import run as run_design
    from pipeline.show import tables

    progress = _listener(quiet, as_json, verbose)
    results = _solve(run_design, design, folder, jobs or min(3, available_cores()), fresh, progress).results
    verdict = verdict_of(results)
    if as_json:
        print_json(verdict.record())
    else:
        print_sentences(*verdict.lines)
        if not quiet:
            shown = (tables.five_parameters(results), *(_details(results) if verbose else ()))
            print_lines(*shown)
            print_sentences(*(f"Note: {note.text}" for note in results.remarks if verbose))
        print_lines(f"report: {folder / 'report.html'}")
    results.raise_if_failed()


def _listener(quiet: bool, as_json: bool, verbose: bool) -> "Progress":
    from pipeline.show.progress import progress_for
    from pipeline.store.progress import Silent

    return Silent() if quiet else progress_for(Console(stderr=as_json), verbose=verbose)


def _run_pairs(spec: "PairSpec", out: Path | None, jobs: int, fresh: bool, progress: "Progress", as_json: bool) -> None:
    from pipeline.study.pairs.run import record, run_pairs
    from pipeline.study.pairs.table import pairs_table, save_page

    folder = out or Path("results") / spec.name
    try:
        made = run_pairs(spec, folder, jobs, fresh, progress)
    finally:
        progress.done()
    save_page(made)
    if as_json:
        print_json(record(made))
    else:
        print_lines(pairs_table(made))
        print_sentences(*made.sentences)
        print_lines(f"law and pairs: {folder / 'pairs.json'}, page: {folder / 'pairs.html'}")
    made.raise_if_failed()


def _details(results: "Run") -> tuple["Table", ...]:
    """What `-v` shows besides the verdict."""
    from pipeline.show import tables

    made = (tables.rods, tables.loads, tables.states, tables.effects, tables.design, tables.cost)
    return tuple(table(results) for table in made)


def mesh(config: ConfigFile, out: Annotated[Path | None, _out("_mesh")] = None, settings: Settings = None) -> None:
    """Only the body: DIR/mesh.vtu, volumes and the quality of the elements."""
    design, folder = _design(config, settings, out, "_mesh")

    from pipeline.show.progress import progress_for
    from pipeline.show.terminal import body_table
    from pipeline.simulate.design_notes import check_load
    from pipeline.simulate.mesh_notes import check_body
    from pipeline.simulate.scene import mesh_with_progress
    from pipeline.simulate.too_short import too_short
    from pipeline.store.atomic_file import replacing
    from pipeline.store.result_folder import open_folder
    from pipeline.store.store import check_owner
    from pipeline.values.reasons import render

    results = open_folder(folder)
    check_owner(results.directory, design, "give another --out")
    progress = progress_for(Console())
    try:
        progress.stage("mesh")
        for reason in check_load(design):
            progress.remark(render(reason))
        scene = mesh_with_progress(design, progress)
    finally:
        progress.done()
    body, file = scene.body, results.path("mesh.vtu")
    with replacing(file) as part:
        body.mesh.write(part)
    print_lines(body_table(file, design, body))
    notes = filter(None, (too_short(design), *check_body(body, design)))
    print_sentences(*(f"Note: {render(reason)}." for reason in notes))


def effects(
    config: ConfigFile,
    out: Annotated[Path | None, _out("_effects")] = None,
    settings: Settings = None,
    jobs: Annotated[int | None, _jobs("number of cores, at most 2")] = None,
    fresh: Fresh = False,
) -> None:
    """Each effect on and off: what it changes, what it costs."""
    from pipeline.values.errors import RunFailed

    design, folder = _design(config, settings, out, "_effects")

    from pipeline.study.effects.rows import effects_table
    from pipeline.study.effects.study import compare_effects

    table = _solve(compare_effects, design, folder, jobs or min(2, available_cores()), fresh)
    print_lines(effects_table(table.rows))
    print_lines(f"table: {folder / 'effects_table.json'}")
    if table.failures:
        print_sentences(*(f"{sentence}." for sentence in table.failures))
        missing = sum(bool(row["reason"]) for row in table.rows)
        raise RunFailed(f"{missing} of {len(table.rows)} rows lack numbers, for the reasons above")


def accuracy(
    config: ConfigFile,
    out: Annotated[Path | None, _out("_accuracy")] = None,
    settings: Settings = None,
    jobs: Annotated[int | None, _jobs("number of cores, at most 2")] = None,
    fresh: Fresh = False,
) -> None:
    """Convergence study: error against seconds over meshes, elements and tolerances."""
    design, folder = _design(config, settings, out, "_accuracy")

    from pipeline.study.accuracy.run import run_study
    from pipeline.study.accuracy.table import orders_table, references_table, study_table

    study = _solve(run_study, design, folder, jobs or min(2, available_cores()), fresh)
    print_lines(*(table(study) for table in (study_table, references_table, orders_table)))
    print_lines(f"picture: {folder / 'accuracy.html'}")


def cell(
    config: ConfigFile,
    out: Annotated[Path | None, _out("_cell")] = None,
    settings: Settings = None,
    accuracy: Accuracy = None,
    jobs: Annotated[int | None, _jobs("1")] = None,
    fresh: Fresh = False,
) -> None:
    """The arm's own law from one cell and its two ends, for every load and length."""
    given = _with_accuracy(settings, accuracy)

    from pipeline.config.document import read_document
    from pipeline.law.in_space.rows import read_rows, rows_of
    from pipeline.law.in_space.study import leaves_plane

    if (rows := read_rows(read_document(config, given))) is not None:
        _cell_in_space(rows, out, jobs or 1, fresh)
        return
    design, folder = _design(config, given, out, "_cell")
    if leaves_plane(design):
        _cell_in_space(rows_of(design), out, jobs or 1, fresh)
        return

    from pipeline.law.study import measure_law
    from pipeline.law.table import law_remarks, law_table, mesh_table, space_table
    from pipeline.values.law import LawMeshError
    from pipeline.values.reasons import render

    report = _solve(measure_law, design, folder, jobs or 1, fresh)
    measured = report.measured
    print_lines(law_table(measured), space_table(measured.law, measured.mesh_error or LawMeshError()))
    if measured.limit is not None:
        print_lines(mesh_table(measured.limit))
    print_sentences(*(f"Note: {render(remark)}." for remark in law_remarks(report)))
    print_lines(f"law: {folder / 'law.json'}, picture: {folder / 'law.html'}")
    report.raise_if_failed()


def _cell_in_space(spec: "RowSpec", out: Path | None, jobs: int, fresh: bool) -> None:
    from pipeline.law.in_space.study import measure_space_law
    from pipeline.show.progress import progress_for
    from pipeline.values.formats import LAW_IN_SPACE

    folder = out or Path("results") / f"{spec.config.name}_cell"
    progress = progress_for(Console())
    try:
        report = measure_space_law(spec, folder, jobs, fresh, progress)
    finally:
        progress.done()
    print_lines(report.table)
    print_sentences(*report.sentences)
    print_lines(f"law: {folder / LAW_IN_SPACE}")


def design(
    wish: Annotated[Path, typer.Argument(metavar="WISH", help="Base, what is free, wishes and limits in YAML.")],
    out: Annotated[Path | None, _out()] = None,
    jobs: Annotated[int | None, _jobs("number of cores, at most 3")] = None,
    no_run: Annotated[bool, typer.Option("--no-run", help="Leave out the run of the design.")] = False,
    fresh: Fresh = False,
    quiet: Quiet = False,
) -> None:
    """Dimensions and pressures for a wish: curvature, angle, tip, force, stiffness, within limits."""
    from pipeline.study.wishes.spec import read_wishes

    file = read_wishes(wish)
    folder = out or Path("results") / file.name

    from pipeline.show.progress import progress_for
    from pipeline.store.progress import Silent
    from pipeline.study.wishes.design import Course, find_design, raise_if_missed
    from pipeline.study.wishes.report import dimensions_table, wishes_table

    progress = Silent() if quiet else progress_for(Console())
    try:
        report = find_design(file, folder, Course.of(jobs, fresh, not no_run), progress)
    finally:
        progress.done()
    print_lines(dimensions_table(report), wishes_table(report))
    print_lines(f"configuration: {folder / 'design.yaml'}, picture: {folder / 'design.html'}")
    if report.run is not None:
        print_lines(f"report of its run: {report.run / 'report.html'}")
    raise_if_missed(report)


def _with_accuracy(settings: list[str] | None, accuracy: str | None) -> list[str]:
    """The settings with a requested accuracy."""
    return [*(settings or ()), *([f"accuracy={accuracy}"] if accuracy is not None else [])]


def _design(config: Path, settings: list[str] | None, out: Path | None, suffix: str = "") -> tuple["Config", Path]:
    """The configuration, checked, and the result folder."""
    from pipeline.config.load import load_config

    design = load_config(config, settings or ())
    return design, out or Path("results") / f"{design.name}{suffix}"


def _solve(
    task: "Task[Result]", design: "Config", folder: Path, jobs: int, fresh: bool, progress: "Progress | None" = None
) -> "Result":
    """The result of a task; a listener to its progress, if none is given, is first told the notes on the design."""
    from pipeline.show.progress import progress_for
    from pipeline.simulate.design_notes import check_load
    from pipeline.values.reasons import render

    notes = () if progress else check_load(design)
    progress = progress or progress_for(Console())
    try:
        for reason in notes:
            progress.remark(render(reason))
        return task(design, folder, jobs, fresh, progress)
    finally:
        progress.done()
