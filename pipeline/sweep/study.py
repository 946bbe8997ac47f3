"""A sweep from its file to its table: what is kept, what is left to do, and the workers that do it."""

import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.errors import RunFailed
from pipeline.progress import duration
from pipeline.store.atomic_file import stale_parts
from pipeline.store.json_values import JsonObject
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import NUMBER_SOURCES, result_key
from pipeline.store.store import locked
from pipeline.sweep.picture import svg_picture
from pipeline.sweep.points import Point, RefusedPoint, points_of, work_key
from pipeline.sweep.record import FINISHED, REFUSED, PointRecord, kept_record
from pipeline.sweep.spec import Sweep
from pipeline.sweep.table import TablePoint, columns_of, overview, save_table, table_rows
from pipeline.sweep.task import PointTask
from pipeline.sweep.workers import LocalWorkers, RemoteScheduler, connected

#: the folder of the points, and the file that says what the folder is
POINTS, RECORD = "points", "sweep.json"
_FILES = (RECORD, "sweep.csv", "sweep.parquet", "sweep.svg")
#: receives sentences about the progress
Say = Callable[[str], None]


@dataclass(frozen=True)
class Course:
    """How a sweep is carried out; it decides no result."""

    workers: LocalWorkers | RemoteScheduler
    fresh: bool  #: whether earlier results are deleted
    retry: bool  #: whether points that were not reached are tried again
    say: Say


@dataclass(frozen=True)
class SweepReport:
    """The points of a sweep as far as they went; the same stands in the files of `directory`."""

    directory: Path
    sweep: Sweep
    points: tuple[TablePoint, ...]

    def sentence(self) -> str:
        """How many points ended in each way."""
        return ", ".join(f"{number} {status}" for status, number in overview(self.points).items())

    def raise_if_failed(self) -> None:
        """Raise RunFailed with the reason of the first point that was not finished, if there is one."""
        others = [point for point in self.points if point.record.status != FINISHED]
        if others:
            first = others[0]
            raise RunFailed(
                f"{len(others)} of {len(self.points)} points did not finish, as {self.directory / 'sweep.csv'} says; "
                f"point {first.number}: {first.record.reason}",
                directory=self.directory,
            )

    def record(self) -> JsonObject:
        """The content of sweep.json."""
        return {
            "name": self.sweep.name,
            "base": str(self.sweep.base),
            "run": self.sweep.run,
            "set": self.sweep.common,
            **provenance(),
            "points": [
                {
                    "number": point.number,
                    "folder": point.folder,
                    "values": point.setting,
                    "status": point.record.status,
                    "reason": point.record.reason,
                    "seconds": point.record.seconds,
                }
                for point in self.points
            ],
        }


def run_sweep(sweep: Sweep, out: Path, course: Course) -> SweepReport:
    """Solve the points of a sweep that `out` does not hold yet, and write the table and the picture of all.

    A point that fails is a row with its reason. Raises InputError for a sweep that is refused, a scheduler that cannot
    be reached and a folder that cannot be used, OSError where a file cannot be written, and RunFailed where the
    scheduler ends; finished points are kept then.
    """
    points = points_of(sweep)
    folder = open_folder(out)
    with locked(folder.directory):
        for part in stale_parts(folder.directory):
            part.unlink(missing_ok=True)
        if course.fresh:
            _clear(folder)
        folder.save_json(RECORD, {"name": sweep.name})
        records = _records(_tasks(sweep, points, folder), course)
        report = SweepReport(out, sweep, tuple(_table_point(point, records) for point in points))
        columns = columns_of(sweep.keys, report.points)
        rows = table_rows(columns, report.points)
        save_table(folder, rows)
        folder.save_text("sweep.svg", svg_picture(sweep.name, sweep.run, sweep.axes, columns, rows))
        folder.save_json(RECORD, report.record())
    return report


def _tasks(sweep: Sweep, points: Sequence[Point | RefusedPoint], folder: ResultFolder) -> dict[str, PointTask]:
    """The work by the name of its folder; points with equal values share it."""
    sources_key = result_key("", NUMBER_SOURCES)
    home = folder.directory.resolve() / POINTS
    accepted = {point.name: point for point in points if isinstance(point, Point)}
    return {
        name: PointTask(
            home / name, point.config, sweep.run, work_key(sources_key, point.config, sweep.run), sources_key
        )
        for name, point in accepted.items()
    }


def _records(tasks: Mapping[str, PointTask], course: Course) -> dict[str, PointRecord]:
    """The records of all tasks, kept ones first."""
    records: dict[str, PointRecord] = {}
    for name, task in tasks.items():
        kept = kept_record(ResultFolder(task.folder), task.key)
        if kept is not None and (kept.status == FINISHED or not course.retry):
            records[name] = kept
    missing = [task for name, task in tasks.items() if name not in records]
    course.say(f"{len(tasks)} points, {len(records)} of them kept from earlier")
    if not missing:
        return records
    for task in missing if course.retry else ():
        (task.folder / "sweep_point.json").unlink(missing_ok=True)
    with connected(course.workers) as workers:
        course.say(workers.sentence)
        begin = time.monotonic()
        for number, (task, record) in enumerate(workers.records(missing), start=1):
            records[task.folder.name] = record
            left = (time.monotonic() - begin) / number * (len(missing) - number)
            reason = f": {record.reason}" if record.reason else ""
            ended = f"{task.folder.name} {record.status} after {duration(record.seconds)}{reason}"
            course.say(f"{number} of {len(missing)}: {ended}; about {duration(left)} left")
    return records


def _table_point(point: Point | RefusedPoint, records: Mapping[str, PointRecord]) -> TablePoint:
    if isinstance(point, RefusedPoint):
        return TablePoint(point.number, "", point.setting, PointRecord(REFUSED, point.reason))
    return TablePoint(point.number, f"{POINTS}/{point.name}", point.setting, records[point.name])


def _clear(folder: ResultFolder) -> None:
    """Remove what an earlier sweep left, and nothing else."""
    if (folder.directory / RECORD).is_file():
        for name in _FILES:
            (folder.directory / name).unlink(missing_ok=True)
        shutil.rmtree(folder.directory / POINTS, ignore_errors=True)
