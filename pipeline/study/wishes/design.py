"""The command for a wish: search, files, and a run of the design that was found."""

import shutil
from dataclasses import replace
from pathlib import Path

from pipeline.results.files import read_plane_law
from pipeline.run import run
from pipeline.simulate.simulate import begin_loading
from pipeline.store.context import run_context
from pipeline.store.owner import RUN as RUN_FILES
from pipeline.store.progress import Progress
from pipeline.store.provenance import provenance
from pipeline.store.store import Store, open_store
from pipeline.study.wishes.measured import POINTS, NotBorne, numbers_of, store_of
from pipeline.study.wishes.report import FILES, DesignReport, design_page, history_rows, report_of
from pipeline.study.wishes.search import Search, SearchResult
from pipeline.study.wishes.step import check_feasible
from pipeline.study.wishes.wish import WishFile
from pipeline.values.errors import InputError, RunFailed
from rod import RodError

#: the folder of the run of a design
RUN = "run"
#: the folder of the curves of a law
LAW = "law"


def find_design(
    file: WishFile, out: Path, jobs: int, fresh: bool, progress: Progress, *, with_run: bool
) -> DesignReport:
    """From a wish to `out`/design.yaml; designs that `out` already holds are not measured again.

    with_run: whether the design that was found is run in full.

    Raises InputError for limits that no design keeps and a folder that cannot be used, and RunFailed where no design
    has a law. Where wishes are missed the report says so (`DesignReport.raise_if_missed`).
    """
    check_feasible(file)
    with open_store(out, file, fresh=fresh) as store:
        if fresh:
            for name in (POINTS, RUN):
                shutil.rmtree(out / name, ignore_errors=True)
        with run_context(store, jobs, progress) as context:
            for pending in begin_loading(context, file.start):
                pending.result()
            try:
                found = Search(file, context).run()
            except NotBorne as failure:
                kept = f"the material may be too soft; designs that were tried are kept in {out}"
                raise RunFailed(f"no design was found: {failure}; {kept}") from None
        report = report_of(file, found, out)
        _save(store, file, found, report)
        if with_run:
            report = _run(file, found, store, jobs, progress)
            _save(store, file, found, report)
    return report


def find_best(file: WishFile, out: Path, jobs: int, fresh: bool, progress: Progress, *, with_run: bool) -> DesignReport:
    """The best of `find_design` with the numbers of chambers of the file one by one, each in a folder of its own.

    The first that misses nothing is taken, or the nearest; where something is made small, the best of all.
    """
    if not file.counts:
        return find_design(file, out, jobs, fresh, progress, with_run=with_run)
    found, failure = list[tuple[DesignReport, WishFile]](), Exception()
    for count in file.counts:
        one = file.with_chambers(count)
        try:
            found.append((find_design(one, out / f"{count}_chambers", jobs, fresh, progress, with_run=False), one))
        except (InputError, RunFailed) as refused:
            progress.remark(f"{count} chambers: {refused}")
            failure = refused
            continue
        if not found[-1][0].given_up and not file.wishes.minimize:
            break
    if not found:
        raise failure
    best, one = min(found, key=lambda pair: pair[0].worth(pair[1]))
    return find_design(one, best.directory, jobs, False, progress, with_run=True) if with_run else best


def _save(store: Store, file: WishFile, found: SearchResult, report: DesignReport) -> None:
    verdict = "meets every wish" if not report.given_up else f"misses: {'; '.join(report.given_up)}"
    head = f"# Found by `pneurod design {file.source}`; it {verdict}.\n"
    store.save_text(FILES[0], head + file.document(found.trial.point).text)
    store.save_json(FILES[1], {**report.record(), **provenance()})
    columns, rows = history_rows(file.wishes, report.history)
    store.save_rows(FILES[2], columns, rows)
    store.save_text(FILES[3], design_page(file.wishes, report, found.trial))


def _run(file: WishFile, found: SearchResult, store: Store, jobs: int, progress: Progress) -> DesignReport:
    """The report with the numbers of a run of the design, whose law is partly there already.

    A run that misses something says so in its own results.
    """
    config = file.config(found.trial.point)
    known, folder = store_of(store, config).directory / LAW, store.directory / RUN
    if RUN_FILES.unlike(folder, {"config_hash": config.hash}):  # of another design of this wish
        RUN_FILES.clear(folder)
    if known.is_dir():
        shutil.copytree(known, folder / LAW, dirs_exist_ok=True)
    run(replace(config, draft=False), folder, jobs, False, progress)
    try:
        law = read_plane_law(folder)
        values = numbers_of(law, file.wishes, file.wishes.values(found.trial.point))
    except (InputError, RodError):
        return report_of(file, found, store.directory, folder)
    return report_of(file, found, store.directory, folder, values)
