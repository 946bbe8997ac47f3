"""A sweep from its file to its table: what is kept, what is left to do, and the workers that do it."""

import json
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

from pipeline.errors import InputError, RunFailed
from pipeline.remaining_time import duration, remaining_of_points
from pipeline.store.atomic_file import remove_parts
from pipeline.store.json_values import JsonObject
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import NUMBER_SOURCES, result_key
from pipeline.store.store import locked
from pipeline.sweep.picture import svg_picture
from pipeline.sweep.points import Point, RefusedPoint, points_of, work_key
from pipeline.sweep.record import FINISHED, REFUSED, WAITING, PointRecord, kept_record
from pipeline.sweep.spec import Sweep
from pipeline.sweep.table import TablePoint, columns_of, overview, save_table, table_rows
from pipeline.sweep.task import PointTask
from pipeline.sweep.workers import LocalWorkers, RemoteScheduler, connected

#: the folder of the points, and the file that says what the folder is
POINTS, RECORD = "points", "sweep.json"
_FILES = (RECORD, "sweep.csv", "sweep.parquet", "sweep.svg")
#: so many points take seconds to be checked
MANY_POINTS = 300
#: while points are solved the table is written again after so many seconds at least, and so many times as long as
#: writing it takes
PAUSE, PAUSE_OVER_WRITING = 2.0, 20.0
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
            **_identity(self.sweep),
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

    The table of a sweep is written while its points are solved, and its picture when the last one has ended. A point
    that fails is a row with its reason. Raises InputError for a sweep that is refused, two sweeps with one folder, a
    scheduler that cannot be reached and a folder that cannot be used, OSError where a file cannot be written, and
    RunFailed where the scheduler ends; finished points are kept then.
    """
    folders = [request.out.resolve() for request in requests]
    if twice := [str(request.out) for request, path in zip(requests, folders, strict=True) if folders.count(path) > 1]:
        raise InputError(f"{twice[0]}: two sweeps would write into this folder; give them different names")
    if (number := sum(len(request.sweep.settings) for request in requests)) >= MANY_POINTS:
        course.say(f"{number} points are checked before the first one is solved")
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
        self._next_save = 0.0  #: when the table may be written again, s

    def begin(self, course: Course) -> None:
        """Clear what is left of interrupted writing and of earlier sweeps, and read the records that are kept.

        The table and the picture of an earlier call are removed. Raises InputError where the folder holds another
        sweep.
        """
        directory = self.folder.directory
        of_points = (directory / POINTS).rglob("*")  # other folders below may belong to a run at work
        remove_parts([directory, *filter(Path.is_dir, of_points)])
        if course.fresh:
            _clear(self.folder)
        self._refuse_other()
        for name in _FILES:
            (directory / name).unlink(missing_ok=True)
        self.folder.save_json(RECORD, _identity(self.sweep))
        for name, task in self.tasks.items():
            kept = kept_record(ResultFolder(task.folder), task.key)
            if kept is not None and (kept.status == FINISHED or not course.retry):
                self.records[name] = kept
            elif course.retry:
                (task.folder / "sweep_point.json").unlink(missing_ok=True)

    def _refuse_other(self) -> None:
        """Raise InputError where the folder holds a sweep that differs in more than its axes."""
        try:
            record = self.folder.read_json(RECORD)
        except ValueError:  # it was not written to its end
            return
        if not isinstance(record, Mapping):
            return
        remedy = "give another --out, or --fresh to replace them"
        name, own = record.get("name"), _identity(self.sweep)
        if name not in (None, self.sweep.name):
            raise InputError(
                f"--out {self.folder.directory}: holds the results of the sweep '{name}', not of '{self.sweep.name}'; "
                f"{remedy}"
            )
        keys = {"base_hash": "base", "run": "run", "set": "set"}
        unlike = [shown for key, shown in keys.items() if key in record and record[key] != own[key]]
        if unlike:
            raise InputError(
                f"--out {self.folder.directory}: holds the results of the sweep '{name}' with another "
                f"{' and '.join(unlike)}; {remedy}"
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
        """All points; those without a record are waiting."""
        points = tuple(_table_point(point, self.records) for point in self.points)
        return SweepReport(self.folder.directory, self.sweep, points)

    def save_so_far(self, *, now: bool = False) -> None:
        """Write the table and sweep.json with what is known, unless they were written a moment ago. Raises OSError."""
        begin = time.monotonic()
        if now or begin >= self._next_save:
            report = self.report
            save_table(self.folder, table_rows(columns_of(self.sweep.keys, report.points), report.points))
            self.folder.save_json(RECORD, report.record())
            end = time.monotonic()
            self._next_save = end + max(PAUSE, PAUSE_OVER_WRITING * (end - begin))

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
        if own.missing:
            own.save_so_far(now=True)
        else:
            own.save()
    if not owners:
        return
    try:
        with connected(course.workers) as workers:
            course.say(workers.sentence)
            begin, spent = time.monotonic(), []
            missing = [task for own in sweeps for task in own.missing]
            for ended, (task, record) in enumerate(workers.records(missing), start=1):
                own = owners[task.folder]
                own.records[task.folder.name] = record
                spent += [record.seconds] if record.seconds else []
                elapsed = time.monotonic() - begin
                left = remaining_of_points(spent, len(missing) - ended, workers.number(), elapsed)
                reason = f": {record.reason}" if record.reason else ""
                sentence = f"{task.folder.name} {record.status} after {duration(record.seconds)}{reason}"
                after = "" if left is None else f"; about {duration(left)} left"
                course.say(f"{ended} of {len(missing)}: {sentence}{after}")
                if own.missing:
                    own.save_so_far()
                else:
                    own.save()
    except BaseException:
        for own in sweeps:
            if own.missing:
                with suppress(OSError):  # it may be the reason
                    own.save_so_far(now=True)
        raise


def _table_point(point: Point | RefusedPoint, records: Mapping[str, PointRecord]) -> TablePoint:
    if isinstance(point, RefusedPoint):
        return TablePoint(point.number, "", point.setting, PointRecord(REFUSED, point.reason))
    record = records.get(point.name, PointRecord(WAITING, ""))
    return TablePoint(point.number, f"{POINTS}/{point.name}", point.setting, record)


def _identity(sweep: Sweep) -> JsonObject:
    """What the results in a folder belong to, the axes apart, as in sweep.json."""
    same: JsonObject = json.loads(json.dumps({"run": sweep.run, "set": sweep.common}))
    return {"name": sweep.name, "base": str(sweep.base), "base_hash": sweep.base_hash, **same}


def _clear(folder: ResultFolder) -> None:
    """Remove what an earlier sweep left, and nothing else."""
    if (folder.directory / RECORD).is_file():
        for name in _FILES:
            (folder.directory / name).unlink(missing_ok=True)
        shutil.rmtree(folder.directory / POINTS, ignore_errors=True)
