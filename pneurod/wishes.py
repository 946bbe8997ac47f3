"""A design for a wish from Python: what `pneurod design` does, with its result as values."""

from pathlib import Path

from pipeline.show.progress import progress_for
from pipeline.store.progress import Silent
from pipeline.study.wishes.design import Course, find_design
from pipeline.study.wishes.report import DesignReport
from pipeline.study.wishes.spec import read_wishes
from pneurod.arguments import IN_PYTHON, given_choice, given_jobs, given_path


def design(
    wish: Path | str,
    out: Path | str | None = None,
    *,
    run: bool = True,
    jobs: int | None = None,
    fresh: bool = False,
    progress: bool = False,
) -> DesignReport:
    """Dimensions and pressures that give an arm what a file wishes.

    wish: a YAML file with a base, what is free, wishes and limits. out: the result folder, "results/NAME" by default;
    designs that it holds are not measured again. run: whether the design is run in full. jobs: number of worker
    processes, by default the number of cores, at most 3. fresh: delete what `out` holds first. progress: report the
    designs that are tried on the terminal; nothing is printed otherwise.

    `report.given_up` says what is missed, where wishes contradict each other. Raises `pneurod.InputError` for a wrong
    file and limits that no design keeps, and `pneurod.RunFailed` where no design has a law, or its run fails.
    """
    file = read_wishes(given_path(wish, "wish", "wish.yaml"))
    folder = Path("results") / file.name if out is None else given_path(out, "out", "results/wish")
    replaces, shown, in_full = (
        given_choice(fresh, "fresh"),
        given_choice(progress, "progress"),
        given_choice(run, "run"),
    )
    listener = progress_for() if shown else Silent()
    try:
        return find_design(file, folder, Course.of(given_jobs(jobs), replaces, in_full, IN_PYTHON), listener)
    finally:
        listener.done()
