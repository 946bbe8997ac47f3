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
from pipeline.results.files import CURVES, save_curves, save_value
from pipeline.run import run
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import keep_balanced, simulate, why_not_free
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import ALL_SOURCES, result_key
from pipeline.store.store import locked, open_store
from pipeline.study.effects.rows import EFFECTS_RUN, solve_variant
from pipeline.study.sweep.numbers import rows_of_experiments, rows_of_law, rows_of_run
from pipeline.study.sweep.record import FAILED, FINISHED, INCOMPLETE, REFUSED, WAITING, PointRecord, PointTask, Row
from pipeline.study.sweep.spec import CELL, WHOLE
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.reasons import render

#: seconds that a point waits for the end of a run in its folder, such as that of a worker that is being killed
PATIENCE = 60.0
#: a process works on one point at a time, however many threads its worker has
_ONE_POINT = threading.Lock()
#: rows of the table, and a sentence for everything that was not reached
Worked = tuple[Sequence[Row], Sequence[str]]


def work_on(task: PointTask) -> PointRecord:
    """The record of a point: that in its folder, or that of the work, which goes on from the states in the folder.

    Raises OSError where the folder cannot be written.
    """
    with _ONE_POINT:
        folder = open_folder(task.folder)
        _wait_for(task.folder)
        if (kept := task.kept.read()) is not None:
            return kept
        if result_key("", ALL_SOURCES) != task.sources_key:
            return PointRecord(WAITING, "its worker has another version of pneurod or of a package")
        begin = perf_counter()
        record = replace(_ended(task, folder), seconds=perf_counter() - begin)
        if record.status in (FINISHED, INCOMPLETE, FAILED):  # the same work would end in the same way again
            task.kept.save(record)
        return task.kept.read() or record


def _wait_for(folder: Path) -> None:
    """Return when no run is at work in a folder, or after `PATIENCE` seconds."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with suppress(InputError), locked(folder):
            return
        time.sleep(0.2)


def _ended(task: PointTask, folder: ResultFolder) -> PointRecord:
    """How the work ended. Whatever stops one point becomes its record, so that the others go on.

    Raises OSError where the folder cannot be written.
    """
    try:
        rows, failures = _WORK.get(task.run, _experiments)(task)
    except InputError as refused:
        return PointRecord(REFUSED, "; ".join(refused.sentences))
    except RunFailed as failed:
        return PointRecord(FAILED, str(failed))
    except MemoryError:
        return PointRecord(WAITING, "the memory of its worker did not suffice; give fewer --jobs, or a coarser mesh")
    except OSError:
        raise
    except Exception as error:
        folder.save_text("error.txt", traceback.format_exc())
        return PointRecord(FAILED, f"an error of the program ({type(error).__name__}: {error}); error.txt says where")
    return PointRecord(INCOMPLETE if failures else FINISHED, "; ".join(failures), tuple(rows))


def _whole(task: PointTask) -> Worked:
    solved = run(task.config, task.folder, 1, False, Silent())
    return rows_of_run(solved), [failure.text for failure in solved.results.failures]


def _cell(task: PointTask) -> Worked:
    report = measure_law(task.config, task.folder, 1, False, Silent())
    return rows_of_law(task.config, report.measured), [*map(render, report.measured.failures)]


def _effects(task: PointTask) -> Worked:
    with open_store(task.folder, task.config) as store:
        return solve_variant(task.config, RunContext.alone(store, Silent()))


def _experiments(task: PointTask) -> Worked:
    """The experiments alone: their states, experiments.json and curves.csv."""
    config = task.config
    with open_store(task.folder, config) as store:
        scene = Scene.meshed(config)
        outcomes = simulate(scene, RunContext.alone(store, Silent()), keep_balanced(config, task.run))
        save_value(store, "experiments.json", outcomes.states)
        save_curves(store, CURVES, curves_of(outcomes, (), scene.body.pitch))
    not_free = why_not_free(config) if "I" in task.run else None
    remark = render(not_free) if not_free else ""
    return rows_of_experiments(config, outcomes, remark), [*map(render, outcomes.failures)]


#: what is run; else experiments
_WORK: dict[tuple[str, ...], Callable[[PointTask], Worked]] = {
    (WHOLE,): _whole,
    (CELL,): _cell,
    EFFECTS_RUN: _effects,
}
