"""The work on one point of a sweep: a whole run, the arm's own law, or some of the experiments, in one process."""

import threading
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from pipeline.identify.compare import curves_of
from pipeline.law.study import measure_law
from pipeline.results.files import save_curves, save_value
from pipeline.run import run
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import keep_balanced, simulate, why_not_free
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import program_key
from pipeline.store.store import locked, open_store
from pipeline.study.sweep.numbers import rows_of_experiments, rows_of_law, rows_of_run, rows_of_variant
from pipeline.study.sweep.points import FAILED, FINISHED, INCOMPLETE, REFUSED, WAITING, Point, PointResult, Row
from pipeline.study.sweep.spec import CELL, VARIANT, WHOLE
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render

#: seconds that a point waits for the end of a run in its folder, such as that of a worker that is being killed
PATIENCE = 60.0
#: a process works on one point at a time, however many threads its worker has
_ONE_POINT = threading.Lock()
#: rows of the table, and a sentence for everything that was not reached
Worked = tuple[Sequence[Row], Sequence[str]]


def work_on(point: Point) -> PointResult:
    """The result of a point: that in its folder, or that of the work, which goes on from the states in the folder.

    Raises OSError where the folder cannot be written.
    """
    with _ONE_POINT:
        folder = open_folder(point.folder)
        _wait_for(point.folder)
        if (kept := point.kept.read()) is not None:
            return kept
        if program_key() != point.program:
            return PointResult(WAITING, "its worker has another version of pneurod or of a package")
        begin = perf_counter()
        result = replace(_ended(point, folder), seconds=perf_counter() - begin)
        if result.status in (FINISHED, INCOMPLETE, FAILED):  # the same work would end in the same way again
            point.kept.save(result)
        return point.kept.read() or result


def _wait_for(folder: Path) -> None:
    """Return when no run is at work in a folder, or after `PATIENCE` seconds."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with suppress(InputError), locked(folder):
            return
        time.sleep(0.2)


def _ended(point: Point, folder: ResultFolder) -> PointResult:
    """How the work ended. Whatever stops one point becomes its result, so that the others go on.

    Raises OSError where the folder cannot be written.
    """
    try:
        rows, failures = _WORK.get(point.run, _experiments)(point)
    except InputError as refused:
        return PointResult(REFUSED, "; ".join(refused.sentences))
    except RunFailed as failed:
        return PointResult(FAILED, str(failed))
    except MemoryError:
        return PointResult(WAITING, "the memory of its worker did not suffice; give fewer --jobs, or a coarser mesh")
    except OSError:
        raise
    except Exception as error:
        folder.save_text("error.txt", traceback.format_exc())
        return PointResult(FAILED, f"an error of the program ({type(error).__name__}: {error}); error.txt says where")
    return PointResult(INCOMPLETE if failures else FINISHED, "; ".join(failures), tuple(rows))


def _whole(point: Point) -> Worked:
    solved = run(point.config, point.folder, 1, False, Silent())
    return rows_of_run(solved), [failure.text for failure in solved.results.failures]


def _cell(point: Point) -> Worked:
    report = measure_law(point.config, point.folder, 1, False, Silent())
    return rows_of_law(point.config, report.measured), [*map(render, report.measured.failures)]


def _effects(point: Point) -> Worked:
    with open_store(point.folder, point.config) as store:
        scene = Scene.meshed(point.config)
        rows = rows_of_variant(scene, simulate(scene, RunContext.alone(store, Silent()), ("III", "II")))
    return rows, list(dict.fromkeys(str(row["reason"]) for row in rows if row["reason"]))


def _experiments(point: Point) -> Worked:
    """The experiments alone: their states, experiments.json and curves.csv."""
    config = point.config
    with open_store(point.folder, config) as store:
        scene = Scene.meshed(config)
        outcomes = simulate(scene, RunContext.alone(store, Silent()), keep_balanced(config, point.run))
        save_value(store, "experiments.json", outcomes.states)
        save_curves(store, curves_of(outcomes, (), scene.body.pitch))
    not_free = why_not_free(config) if "I" in point.run else None
    remark = render(not_free) if not_free else ""
    return rows_of_experiments(config, outcomes, remark), [*map(render, outcomes.failures)]


#: what is run; else experiments
_WORK: dict[tuple[str, ...], Callable[[Point], Worked]] = {
    (WHOLE,): _whole,
    (CELL,): _cell,
    (VARIANT,): _effects,
}
