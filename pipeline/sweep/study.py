"""A sweep from its file to its table: what is kept, what is left to do, and the workers that do it."""

import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from pipeline.errors import InputError, RunFailed
from pipeline.remaining_time import duration
from pipeline.store.atomic_file import remove_parts
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
                f"the first of them is point {first.number}: {first.record.reason}",
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


@dataclass(frozen=True)
class RequestedSweep:
    """A sweep and the folder of its results."""

    sweep: Sweep
    out: Path


def run_sweep(sweep: Sweep, out: Path, course: Course) -> SweepReport:
    """One sweep, as `run_sweeps` solves several."""
    (report,) = run_sweeps([RequestedSweep(sweep, out)], course)
    return report


def run_sweeps(requests: Sequence[RequestedSweep], course: Course) -> tuple[SweepReport, ...]:
    """Solve the points of sweeps that their folders do not hold yet, all with the same workers, in the given order.

    The table and the picture of a sweep are written when its last point has ended. A point that fails is a row with its
    reason. Raises InputError for a sweep that is refused, two sweeps with one folder, a scheduler that cannot be
    reached and a folder that cannot be used, OSError where a file cannot be written, and RunFailed where the scheduler
    ends; finished points are kept then.
    """
    folders = [request.out.resolve() for request in requests]
    if twice := [str(request.out) for request, path in zip(requests, folders, strict=True) if folders.count(path) > 1]:
        raise InputError(f"{twice[0]}: two sweeps would write into this folder; give them different names")
    sweeps = [_SweepInProgress(request, points_of(request.sweep)) for request in requests]
    with ExitStack() as locks:
        for own in sweeps:
            locks.enter_context(locked(own.folder.directory))
            own.begin(course)
        _solve(sweeps, course)
    return tuple(own.report for own in sweeps)


class _SweepInProgress:
    """One sweep on its way: its tasks, and the records that are known."""

    def __init__(self, request: RequestedSweep, points: Sequence[Point | RefusedPoint]) -> None:
        self.sweep = request.sweep
        self.points = points
        self.folder = open_folder(request.out)
        self.tasks = _tasks(request.sweep, points, self.folder)
        self.records: dict[str, PointRecord] = {}

    def begin(self, course: Course) -> None:
        """Clear what is left of interrupted writing and of earlier sweeps, and read the records that are kept."""
        directory = self.folder.directory
        of_points = (directory / POINTS).rglob("*")  # other folders below may belong to a run at work
        remove_parts([directory, *filter(Path.is_dir, of_points)])
        if course.fresh:
            _clear(self.folder)
        self._refuse_other()
        self.folder.save_json(RECORD, {"name": self.sweep.name})
        for name, task in self.tasks.items():
            kept = kept_record(ResultFolder(task.folder), task.key)
            if kept is not None and (kept.status == FINISHED or not course.retry):
                self.records[name] = kept
            elif course.retry:
                (task.folder / "sweep_point.json").unlink(missing_ok=True)

    def _refuse_other(self) -> None:
        """Raise InputError where the folder holds a sweep of another name."""
        try:
            record = self.folder.read_json(RECORD)
        except ValueError:  # it was not written to its end
            return
        name = record.get("name") if isinstance(record, Mapping) else None
        if name not in (None, self.sweep.name):
            raise InputError(
                f"--out {self.folder.directory}: holds the results of the sweep '{name}', not of '{self.sweep.name}'; "
                "give another --out, or --fresh to replace them"
            )

    def count(self) -> tuple[int, int, int]:
        """How many points are refused, kept from earlier, and still to be solved."""
        names = [point.name for point in self.points if isinstance(point, Point)]
        kept = sum(name in self.records for name in names)
        return len(self.points) - len(names), kept, len(names) - kept

    @property
    def missing(self) -> list[PointTask]:
        """The tasks without a record."""
        return [task for name, task in self.tasks.items() if name not in self.records]

    @property
    def report(self) -> SweepReport:
        """All points; every one of them has a record."""
        points = tuple(_table_point(point, self.records) for point in self.points)
        return SweepReport(self.folder.directory, self.sweep, points)

    def save(self) -> None:
        """Write the table, the picture and sweep.json. Raises OSError."""
        report = self.report
        columns = columns_of(self.sweep.keys, report.points)
        rows = table_rows(columns, report.points)
        save_table(self.folder, rows)
        picture = svg_picture(self.sweep.name, self.sweep.run, self.sweep.axes, columns, rows)
        self.folder.save_text("sweep.svg", picture)
        self.folder.save_json(RECORD, report.record())


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


def _solve(sweeps: Sequence[_SweepInProgress], course: Course) -> None:
    """Complete the records of all sweeps, and write what belongs to a sweep as soon as its records are complete."""
    owners = {task.folder: own for own in sweeps for task in own.missing}
    counts = tuple(map(sum, zip(*(own.count() for own in sweeps), strict=True)))
    course.say("{} points: {} refused, {} kept from earlier, {} to be solved".format(sum(counts), *counts))
    for own in sweeps:
        if not own.missing:
            own.save()
    if not owners:
        return
    with connected(course.workers) as workers:
        course.say(workers.sentence)
        begin = time.monotonic()
        missing = [task for own in sweeps for task in own.missing]
        for ended, (task, record) in enumerate(workers.records(missing), start=1):
            own = owners[task.folder]
            own.records[task.folder.name] = record
            left = (time.monotonic() - begin) / ended * (len(missing) - ended)
            reason = f": {record.reason}" if record.reason else ""
            sentence = f"{task.folder.name} {record.status} after {duration(record.seconds)}{reason}"
            course.say(f"{ended} of {len(missing)}: {sentence}; about {duration(left)} left")
            if not own.missing:
                own.save()


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
