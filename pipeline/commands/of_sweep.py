"""The command that solves many designs: sweep."""

from pathlib import Path
from typing import Annotated

import typer

from pipeline.commands.ending import errors_as_sentences, print_lines
from pipeline.errors import InputError
from pipeline.processes import available_cores


def sweep(
    files: Annotated[list[Path], typer.Argument(metavar="SWEEP...", help="Base configuration and axes in YAML.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Result folder; of several: DIR/NAME (default: results/NAME)."),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler instead of workers on this machine.")
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Number of worker processes (default: number of cores).")
    ] = None,
    memory: Annotated[
        str | None, typer.Option(metavar="SIZE", help="Of each worker: '4 GB' (default: equal parts of the machine's).")
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Try points that were not reached again.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Delete earlier results in DIR and begin again.")] = False,
) -> None:
    """Many designs: a base configuration and axes, every point a run of its own, one table, on Dask."""
    with errors_as_sentences():
        if scheduler is not None and (jobs is not None or memory is not None):
            raise InputError("--scheduler: its workers are started apart; leave out --jobs and --memory")

        from pipeline.sweep.spec import read_sweep
        from pipeline.sweep.study import Course, run_sweeps
        from pipeline.sweep.workers import LocalWorkers, RemoteScheduler

        sweeps = [read_sweep(file) for file in files]
        local = LocalWorkers.of(jobs or available_cores(), memory)
        workers = local if scheduler is None else RemoteScheduler(scheduler)
        parent = out or Path("results")
        folders = [parent / sweep.name if out is None or len(sweeps) > 1 else out for sweep in sweeps]
        requests = list(zip(sweeps, folders, strict=True))
        reports = run_sweeps(requests, Course(workers, fresh, retry, print_lines))
        for report in reports:
            folder = report.directory
            print_lines(f"{report.sentence()}; table: {folder / 'sweep.csv'}, picture: {folder / 'sweep.html'}")
        for report in reports:
            report.raise_if_failed()
