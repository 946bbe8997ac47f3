"""A sweep from its file to its table: what is kept, what is left to do, and the workers that do it."""

import json
import shutil
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path

from pipeline.store.atomic_file import remove_parts
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.state_key import ALL_SOURCES, result_key
from pipeline.store.store import locked
from pipeline.study.study import Study
from pipeline.study.sweep.points import Point, RefusedPoint, points_of
from pipeline.study.sweep.record import FINISHED, REFUSED, WAITING, PointRecord, PointTask
from pipeline.study.sweep.spec import Run, Sweep
from pipeline.study.sweep.table import Column, SolvedPoint, save_table, sweep_page, table_rows
from pipeline.study.sweep.workers import LOST, Workers, connected, solve
from pipeline.values.errors import InputError, RunFailed, argument
from pipeline.values.formatting import duration
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DRAFT

#: the folder of the points, and the file that says what the folder is
POINTS, RECORD = "points", "sweep.json"
TABLE, PAGE = ("sweep.csv", "sweep.parquet"), "sweep.html"
#: while points are solved the table is written again after so many seconds at least, and so many times as long as
#: writing it takes
PAUSE, PAUSE_OVER_WRITING = 2.0, 20.0


@dataclass(frozen=True)
class Course:
    """How a sweep is carried out; it decides no result."""

    workers: Workers
    fresh: bool  #: whether earlier results are deleted
    say: Callable[[str], None]  #: receives sentences about the progress


@dataclass
class PointSet:
    """Points to be solved in one folder, how their table is written, and the records that are known."""

    out: Path
    identity: JsonObject  #: what the results in the folder belong to, the points apart; `name` is one of the keys
    run: Run
    points: Sequence[Point | RefusedPoint]
    files: tuple[str, ...]  #: that `write` writes
    #: writes what is known; the last argument says whether every point has ended
    write: Callable[[ResultFolder, Sequence[SolvedPoint], bool], None]
    records: dict[str, PointRecord] = field(default_factory=dict, init=False)  #: by the name of the folder
    _next_save: float = field(default=0.0, init=False)  #: when the table may be written again, s

    @cached_property
    def folder(self) -> ResultFolder:
        """The folder, made if it is missing. Raises InputError."""
        return open_folder(self.out)

    @cached_property
    def tasks(self) -> list[PointTask]:
        """What is to be done; equal points share a task."""
        key, home = result_key("", ALL_SOURCES), self.folder.directory.resolve() / POINTS
        accepted = {point.name: point for point in self.points if isinstance(point, Point)}
        return [
            PointTask(home / name, point.config, self.run, point.work_key(key, self.run), key)
            for name, point in accepted.items()
        ]

    def begin(self, fresh: bool) -> None:
        """Clear what is left of interrupted writing, and the files of an earlier call.

        Raises InputError where the folder holds another sweep.
        """
        directory = self.folder.directory
        of_points = (directory / POINTS).rglob("*")  # other folders below may belong to a run at work
        remove_parts([directory, *filter(Path.is_dir, of_points)])
        if fresh and (directory / RECORD).is_file():
            (directory / RECORD).unlink()
            shutil.rmtree(directory / POINTS, ignore_errors=True)
        self._refuse_other()
        for name in self.files:
            (directory / name).unlink(missing_ok=True)
        self.folder.save_json(RECORD, self.identity)

    def _refuse_other(self) -> None:
        """Raise InputError where the folder holds a sweep that differs in more than its axes."""
        try:
            record = self.folder.read_json(RECORD)
        except ValueError:  # it was not written to its end
            return
        own = json.loads(json.dumps(self.identity))
        kept = record if isinstance(record, Mapping) else {}
        unlike = [key.removesuffix("_hash") for key in own if key != "base" and key in kept and kept[key] != own[key]]
        if not unlike:
            return
        name = f"the sweep '{kept.get('name')}'"
        other = f", not of '{own['name']}'" if "name" in unlike else f" with another {' and '.join(unlike)}"
        held = f"{argument('out', self.folder.directory)}: holds the results of {name}{other}"
        raise InputError(f"{held}; give another {argument('out')}, or {argument('fresh', True)} to replace them")

    @property
    def is_complete(self) -> bool:
        """Whether every task has a record."""
        return len(self.records) == len(self.tasks)

    @property
    def solved(self) -> tuple[SolvedPoint, ...]:
        """All points; those without a record are waiting."""
        return tuple(map(self._solved, self.points))

    def _solved(self, point: Point | RefusedPoint) -> SolvedPoint:
        if isinstance(point, RefusedPoint):
            return SolvedPoint(REFUSED, point.reason, number=point.number, folder="", values=point.setting)
        record, folder = self.records.get(point.name, PointRecord(WAITING, "")), f"{POINTS}/{point.name}"
        return SolvedPoint(**vars(record), number=point.number, folder=folder, values=point.setting)

    def save(self, *, now: bool = False) -> None:
        """Write what is known, unless it was written a moment ago and points are missing. Raises OSError."""
        begin = time.monotonic()
        if not now and not self.is_complete and begin < self._next_save:
            return
        solved = self.solved
        self.write(self.folder, solved, self.is_complete)
        points = [{key: value for key, value in vars(one).items() if key != "rows"} for one in solved]
        self.folder.save_json(RECORD, {**self.identity, **provenance(), "points": points})
        end = time.monotonic()
        self._next_save = end + max(PAUSE, PAUSE_OVER_WRITING * (end - begin))


@dataclass(frozen=True)
class SweepReport:
    """The points of a sweep as far as they went; the same stands in the files of `directory`."""

    directory: Path
    points: tuple[SolvedPoint, ...]

    def sentence(self) -> str:
        """How many points ended in each way."""
        statuses = Counter(point.status for point in self.points)
        return ", ".join(f"{number} {status}" for status, number in statuses.items())

    def raise_if_failed(self) -> None:
        """Raise RunFailed with the reason of the first point that was not finished, if there is one."""
        others = [point for point in self.points if point.status != FINISHED]
        if others:
            first = others[0]
            missing = f"{len(others)} of {len(self.points)} points did not finish, as {self.directory / TABLE[0]} says"
            raise RunFailed(f"{missing}; the first is point {first.number}: {first.reason}", directory=self.directory)


def run_sweeps(requests: Sequence[tuple[Sweep, Path]], course: Course) -> list[SweepReport]:
    """Solve the points of sweeps that their folders do not hold yet, all with the same workers, in the given order.

    requests: sweeps and the folders of their results. The table of a sweep is written while its points are solved, and
    its page when the last one has ended. A point that fails is a row with its reason. Raises InputError for a sweep
    that is refused, two sweeps with one folder, a scheduler that cannot be reached and a folder that cannot be used,
    OSError where a file cannot be written, and RunFailed where the scheduler ends; finished points are kept then.
    """
    folders = [out.resolve() for _, out in requests]
    if twice := [str(out) for (_, out), path in zip(requests, folders, strict=True) if folders.count(path) > 1]:
        raise InputError(f"{twice[0]}: two sweeps would write into this folder; give them different names")
    sets = [
        PointSet(out, sweep.identity, sweep.run, points_of(sweep), (*TABLE, PAGE), partial(_save_sweep, sweep))
        for sweep, out in requests
    ]
    solved = solve_points(sets, course)
    return [SweepReport(out, points) for (_, out), points in zip(requests, solved, strict=True)]


def _save_sweep(sweep: Sweep, folder: ResultFolder, points: Sequence[SolvedPoint], is_complete: bool) -> None:
    columns = [Column.of(key, [point.values for point in points]) for key in sweep.keys]
    rows = table_rows(columns, points)
    save_table(folder, rows)
    if is_complete:
        name = f"{sweep.name} ({DRAFT})" if sweep.common.get("draft") else sweep.name
        folder.save_text(PAGE, sweep_page(name, sweep.run, sweep.axes, columns, rows))


def solve_points(sets: Sequence[PointSet], course: Course) -> list[tuple[SolvedPoint, ...]]:
    """Solve the points that the folders do not hold yet; of each set the points as far as they went. Raises as
    `run_sweeps`."""
    with connected(course.workers) as (executor, who), ExitStack() as locks:
        for own in sets:
            locks.enter_context(locked(own.folder.directory))
            own.begin(course.fresh)
        tasks = [task for own in sets for task in own.tasks]
        _solve(sets, Study(tasks, solve, executor, lambda task: task.kept, LOST), who, course.say)
    return [own.solved for own in sets]


def _solve(
    sets: Sequence[PointSet], study: Study[PointTask, PointRecord], who: str, say: Callable[[str], None]
) -> None:
    """Complete the records of all sets, and write what belongs to a set as soon as its records are complete."""
    owners = {task.folder: own for own in sets for task in own.tasks}
    for task, record in study.kept:
        owners[task.folder].records[task.folder.name] = record
    say(_counted([point for own in sets for point in own.solved]))
    for own in sets:
        own.save(now=True)
    if study.missing:
        say(who)
    try:
        for task, record in study.solve(say, _told, _lost):
            owners[task.folder].records[task.folder.name] = record
            owners[task.folder].save()
    finally:
        for own in sets:
            if not own.is_complete:
                with suppress(OSError):  # it may be the reason
                    own.save(now=True)


def _counted(points: Sequence[SolvedPoint]) -> str:
    refused = sum(point.status == REFUSED for point in points)
    left = sum(point.status == WAITING for point in points)
    kept = len(points) - refused - left
    return f"{len(points)} points: {refused} refused, {kept} kept from earlier, {left} to be solved"


def _told(task: PointTask, record: PointRecord) -> str:
    reason = f": {record.reason}" if record.reason else ""
    return f"{task.folder.name} {record.status} after {duration(record.seconds)}{reason}"


def _lost(task: PointTask, failure: Exception) -> PointRecord:
    reason = "its workers were ended from outside, as when memory runs out; the same command goes on"
    return PointRecord(WAITING, reason)
