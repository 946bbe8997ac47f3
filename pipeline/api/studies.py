"""Many designs: effects on and off, meshes, axes of a sweep, and a design for a wish."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pipeline.api.course import (
    MOST_JOBS,
    course_of,
    design_of,
    given_choice,
    given_folder,
    given_jobs,
    given_path,
    given_progress,
    load_notes,
    reached,
)
from pipeline.api.options import ConfigFile, Draft, Fresh, Out, Settings, jobs_option, out_option
from pipeline.store.cores import available_cores
from pipeline.store.progress import Progress, Silent
from pipeline.values.errors import InputError, RunFailed, argument

__all__ = ["accuracy", "design", "effects", "sweep"]

if TYPE_CHECKING:
    from pipeline.study.accuracy.study import ConvergenceStudy
    from pipeline.study.effects.study import EffectsTable
    from pipeline.study.sweep.study import SweepReport
    from pipeline.study.wishes.report import DesignReport


def effects(
    config: ConfigFile,
    out: Annotated[Path | str | None, out_option("_effects")] = None,
    *,
    settings: Settings = None,
    jobs: Annotated[int | None, jobs_option("number of cores, at most 2")] = None,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "EffectsTable":
    """Compare each effect on and off: what it changes, what it costs.

    Raises InputError for a wrong configuration or folder, and RunFailed, which has the table as `reached`, where rows
    lack numbers.
    """
    from pipeline.study.effects.study import compare_effects

    design, folder, _ = design_of(config, {}, settings, out, "_effects")
    table = course_of(jobs, 2, fresh, progress).solve(compare_effects, design, folder, load_notes(design))
    if table.failures:
        missing = sum(bool(row.reason) for row in table.rows)
        lacking = f"{missing} of {len(table.rows)} rows lack numbers"
        brief = f"{lacking}, for the reasons above"
        raise RunFailed(f"{lacking}: {'; '.join(table.failures)}", folder, brief).with_reached(table)
    return table


def accuracy(
    config: ConfigFile,
    out: Annotated[Path | str | None, out_option("_accuracy")] = None,
    *,
    settings: Settings = None,
    jobs: Annotated[int | None, jobs_option("number of cores, at most 2")] = None,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "ConvergenceStudy":
    """Study the convergence: error against seconds over meshes, elements and tolerances.

    Raises InputError for a wrong configuration or folder.
    """
    from pipeline.study.accuracy.run import run_study

    design, folder, _ = design_of(config, {}, settings, out, "_accuracy")
    return course_of(jobs, 2, fresh, progress).solve(run_study, design, folder, load_notes(design))


def sweep(
    files: Annotated[
        Sequence[Path | str],
        list[Path],
        typer.Argument(metavar="SWEEP...", help="Base configuration and axes in YAML."),
    ],
    out: Annotated[
        Path | str | None,
        typer.Option("--out", metavar="DIR", help="Result folder; of several: DIR/NAME (default: results/NAME)."),
    ] = None,
    *,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="Of Dask, instead of own workers.")] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes (default: number of cores).")] = None,
    draft: Draft = False,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "tuple[SweepReport, ...]":
    """Run many designs: a base configuration and axes, each point a run of its own, one table, on all cores or on Dask.

    One report for each file. Raises InputError for a wrong file, folder or scheduler, and RunFailed, which has the
    reports as `reached`, where a point did not finish.
    """
    from pipeline.study.sweep import spec, study, workers

    if scheduler is not None and jobs is not None:
        raise InputError(f"{argument('scheduler')}: its workers are started apart; leave out {argument('jobs')}")
    sweeps = [spec.read_sweep(given_path(file, "files", "sweep.yaml")) for file in files]
    sweeps = [sweep.as_draft() for sweep in sweeps] if given_choice(draft, "draft") else sweeps
    who = scheduler or workers.LocalWorkers.of(given_jobs(jobs) or available_cores())
    parent = Path("results") if out is None else given_path(out, "out", "results/sweep")
    folders = [parent / sweep.name if out is None or len(sweeps) > 1 else parent for sweep in sweeps]
    say = (lambda _: None) if isinstance(given_progress(progress), Silent) else typer.echo
    course = study.Course(who, given_choice(fresh, "fresh"), say)
    reports = tuple(study.run_sweeps(list(zip(sweeps, folders, strict=True)), course))
    for report in reports:
        reached(reports, report.raise_if_failed)
    return reports


def design(
    wish: Annotated[Path | str, typer.Argument(metavar="WISH", help="Base, what is free, wishes and limits in YAML.")],
    out: Out = None,
    *,
    jobs: Annotated[int | None, jobs_option("number of cores, at most 3")] = None,
    run: Annotated[
        bool, typer.Option(" /--no-run", show_default=False, help="Leave out the run of the design.")
    ] = True,
    draft: Annotated[
        bool,
        typer.Option("--draft", help="Search with drafts, whose error is unknown; the design found is run in full."),
    ] = False,
    fresh: Fresh = False,
    progress: "bool | Progress" = False,
) -> "DesignReport":
    """Find dimensions and pressures for a wish: curvature, angle, tip, force, stiffness, within limits.

    wish: a YAML file with a base, what is free, wishes and limits. out: the result folder, "results/NAME" by default;
    designs that it holds are not measured again. run: whether the design is run in full. draft: search
    with laws on the mesh of the base, whose error is unknown. jobs: number of worker
    processes, by default the number of cores, at most 3. fresh: delete what `out` holds first. progress: report the
    designs that are tried on the terminal; nothing is printed otherwise.

    `report.given_up` says what is missed, where wishes contradict each other. Raises `pneurod.InputError` for a wrong
    file and limits that no design keeps, and `pneurod.RunFailed` where no design has a law, or its run fails.
    """
    from pipeline.study.wishes import design, spec

    file = replace(spec.read_wishes(given_path(wish, "wish", "wish.yaml")), draft=given_choice(draft, "draft"))
    find = partial(design.find_best, with_run=given_choice(run, "run"))
    return course_of(jobs, MOST_JOBS, fresh, progress).solve(find, file, given_folder(out, file.name))
