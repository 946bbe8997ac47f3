"""A sweep from its file to its table: what is kept, what is left to do, and the workers that do it."""

import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path

from pipeline.store.atomic_file import remove_parts
from pipeline.store.owner import SWEEP, claim
from pipeline.store.provenance import provenance
from pipeline.store.result_folder import ResultFolder, open_folder
from pipeline.store.store import locked
from pipeline.study.study import Study
from pipeline.study.sweep.points import FINISHED, POINTS, REFUSED, WAITING, Point, PointResult
from pipeline.study.sweep.spec import Sweep, points_of
from pipeline.study.sweep.table import Column, sweep_page, table_rows
from pipeline.study.sweep.workers import LOST, Workers, connected, solve
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.formatting import duration
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DRAFT

TABLE, PAGE = "sweep.csv", "sweep.html"
#: while points are solved the table is written again after so many seconds at least, and so many times as long as
#: writing it takes
PAUSE, PAUSE_OVER_WRITING = 2.0, 20.0
ENDED_OUTSIDE = "its workers were ended from outside, as when memory runs out; the same command goes on"


@dataclass(frozen=True)
class Course:
    """How a sweep is carried out; it decides no result."""

    workers: Workers
    fresh: bool  #: whether earlier results are deleted
    say: Callable[[str], None]  #: receives sentences about the progress


@dataclass
class PointSet:
    """Points to be solved in one folder, how their table is written, and the results that are known."""

    out: Path
    identity: JsonObject  #: what the results in the folder belong to, the points apart
    points: Sequence[Point | PointResult]  #: results are those of points that are refused
    #: writes what is known; the last argument says whether every point has ended
    write: Callable[[ResultFolder, Sequence[PointResult], bool], None]
    results: dict[str, PointResult] = field(default_factory=dict, init=False)  #: by the name of the point
    _next_save: float = field(default=0.0, init=False)  #: when the table may be written again, s

    @cached_property
    def folder(self) -> ResultFolder:
        """The folder, made if it is missing. Raises InputError."""
        return open_folder(self.out)

    @cached_property
    def tasks(self) -> list[Point]:
        """What is to be done; equal points are done once."""
        return list({point.name: point for point in self.points if isinstance(point, Point)}.values())

    def begin(self, fresh: bool) -> None:
        """Clear what is left of interrupted writing, and the files of an earlier call. Raises InputError as `claim`."""
        directory = self.folder.directory
        of_points = (directory / POINTS).rglob("*")  # other folders below may belong to a run at work
        remove_parts([directory, *filter(Path.is_dir, of_points)])
        decides = {key: value for key, value in self.identity.items() if key != "base"}  # that may be moved
        claim(directory, SWEEP, decides, fresh=fresh)
        for name in SWEEP.files:
            (directory / name).unlink(missing_ok=True)
        self.folder.save_json(SWEEP.mark, self.identity)

    @property
    def is_complete(self) -> bool:
        """Whether every point has ended."""
        return len(self.results) == len(self.tasks)

    @property
    def solved(self) -> tuple[PointResult, ...]:
        """All points; those without a result are waiting."""
        return tuple(point if isinstance(point, PointResult) else self._solved(point) for point in self.points)

    def _solved(self, point: Point) -> PointResult:
        known, folder = self.results.get(point.name, PointResult(WAITING)), f"{POINTS}/{point.name}"
        return replace(known, number=point.number, folder=folder, values=point.setting)

    def save(self, *, now: bool = False) -> None:
        """Write what is known, unless it was written a moment ago and points are missing. Raises OSError."""
        begin = time.monotonic()
        if not now and not self.is_complete and begin < self._next_save:
            return
        solved = self.solved
        self.write(self.folder, solved, self.is_complete)
        points = [{key: value for key, value in vars(one).items() if key != "rows"} for one in solved]
        self.folder.save_json(SWEEP.mark, {**self.identity, **provenance(), "points": points})
        end = time.monotonic()
        self._next_save = end + max(PAUSE, PAUSE_OVER_WRITING * (end - begin))


@dataclass(frozen=True)
class SweepReport:
    """The points of a sweep as far as they went; the same stands in the files of `directory`."""

    directory: Path
    points: tuple[PointResult, ...]

    def sentence(self) -> str:
        """How many points ended in each way."""
        statuses = Counter(point.status for point in self.points)
        return ", ".join(f"{number} {status}" for status, number in statuses.items())

    def raise_if_failed(self) -> None:
        """Raise RunFailed with the reason of the first point that was not finished, if there is one."""
        others = [point for point in self.points if point.status != FINISHED]
        if others:
            first = others[0]
            missing = f"{len(others)} of {len(self.points)} points did not finish, as {self.directory / TABLE} says"
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
        PointSet(out, sweep.identity, points_of(sweep, out), partial(_save_sweep, sweep)) for sweep, out in requests
    ]
    solved = solve_points(sets, course)
    return [SweepReport(out, points) for (_, out), points in zip(requests, solved, strict=True)]


def _save_sweep(sweep: Sweep, folder: ResultFolder, points: Sequence[PointResult], is_complete: bool) -> None:
    columns = [Column.of(key, [point.values for point in points]) for key in sweep.keys]
    rows = table_rows(columns, points)
    folder.save_rows(TABLE, list(rows[0]), [list(row.values()) for row in rows])
    if is_complete:
        name = f"{sweep.name} ({DRAFT})" if sweep.common.get("draft") else sweep.name
        folder.save_text(PAGE, sweep_page(name, sweep.run, sweep.axes, columns, rows))


def solve_points(sets: Sequence[PointSet], course: Course) -> list[tuple[PointResult, ...]]:
    """Solve the points that the folders do not hold yet; of each set the points as far as they went. Raises as
    `run_sweeps`."""
    with connected(course.workers) as (executor, who), ExitStack() as locks:
        for own in sets:
            locks.enter_context(locked(own.folder.directory))
            own.begin(course.fresh)
        tasks = [task for own in sets for task in own.tasks]
        _solve(sets, Study(tasks, solve, executor, lambda point: point.kept, LOST), who, course.say)
    return [own.solved for own in sets]


def _solve(sets: Sequence[PointSet], study: Study[Point, PointResult], who: str, say: Callable[[str], None]) -> None:
    """Complete the results of all sets, and write what belongs to a set as soon as its results are complete."""
    owners = {point.folder: own for own in sets for point in own.tasks}
    for point, result in study.kept:
        owners[point.folder].results[point.name] = result
    say(_counted([point for own in sets for point in own.solved]))
    for own in sets:
        own.save(now=True)
    if study.missing:
        say(who)
    try:
        for point, result in study.solve(say, _told, lambda *_: PointResult(WAITING, ENDED_OUTSIDE)):
            owners[point.folder].results[point.name] = result
            owners[point.folder].save()
    finally:
        for own in sets:
            if not own.is_complete:
                with suppress(OSError):  # it may be the reason
                    own.save(now=True)


def _counted(points: Sequence[PointResult]) -> str:
    refused = sum(point.status == REFUSED for point in points)
    left = sum(point.status == WAITING for point in points)
    kept = len(points) - refused - left
    return f"{len(points)} points: {refused} refused, {kept} kept from earlier, {left} to be solved"


def _told(point: Point, result: PointResult) -> str:
    reason = f": {result.reason}" if result.reason else ""
    return f"{point.name} {result.status} after {duration(result.seconds)}{reason}"
