"""Sweeps on workers: processes of this machine, workers that were started by hand, and what remains when some end."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

import pytest

from pipeline.study.sweep import study, workers
from pipeline.study.sweep.points import PointResult
from pipeline.study.sweep.spec import Sweep, read_sweep
from pipeline.study.sweep.study import Course, SweepReport, run_sweeps
from pipeline.study.sweep.workers import LocalWorkers, Workers
from pipeline.values.errors import InputError

HERE = Path(__file__).resolve().parent.parent.parent.parent.parent
BASE = """
name: tiny
geometry: {family: pneunet, chambers: 3}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [2 kPa, 4 kPa]
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""
SWEEP = """
name: tiny_walls
base: base.yaml
run: II
axes:
  - geometry.wall: [1 mm, 4.5 mm]         # 4.5 mm leave no cavity in a chamber of 8 mm
  - geometry.chamber_length: [8 mm, 12 mm]
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "base.yaml").write_text(BASE, encoding="utf-8")
    (folder / "sweep.yaml").write_text(SWEEP, encoding="utf-8")
    return folder / "sweep.yaml"


@pytest.fixture(scope="module")
def sweep(file: Path) -> Sweep:
    return read_sweep(file)


def solved(sweep: Sweep, out: Path, on: Workers, lines: list[str] | None = None) -> SweepReport:
    [report] = run_sweeps([(sweep, out)], Course(on, False, (lines if lines is not None else []).append))
    return report


@pytest.fixture(scope="module")
def results(sweep: Sweep, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("results")
    solved(sweep, out, LocalWorkers.of(2))
    return out


def table(out: Path) -> bytes:
    return (out / "sweep.csv").read_bytes() + (out / "sweep.html").read_bytes()


def test_every_point_is_a_row_per_pressure_and_a_refused_one_a_row_with_its_reason(results: Path) -> None:
    lines = (results / "sweep.csv").read_text().splitlines()
    assert lines[0].startswith("point,geometry.wall_mm,geometry.chamber_length_mm,pressure_kPa,status,reason,folder,")
    rows = [line.split(",")[:5] for line in lines[1:]]
    finished = [[str(n), wall, length, p, "finished"] for n, wall, length in _FINISHED for p in ("2.0", "4.0")]
    assert rows == [*finished[:4], ["3", "4.5", "8.0", "", "refused"], *finished[4:]]
    assert "geometry.wall" in lines[5]
    assert "II_end_y_mm" in lines[0]
    content = json.loads((results / "sweep.json").read_text())
    assert [point["status"] for point in content["points"]] == ["finished", "finished", "refused", "finished"]
    for point in content["points"]:
        assert not point["folder"] or (results / point["folder"] / "states" / "II_4kPa.npz").is_file()


_FINISHED = (("1", "1.0", "8.0"), ("2", "1.0", "12.0"), ("4", "4.5", "12.0"))


class NotNeeded(Executor):
    def submit(self, *_: object) -> Future:
        raise AssertionError("a task was begun though nothing was left to do")


def test_finished_points_are_not_solved_again(sweep: Sweep, results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before, lines = table(results), []
    monkeypatch.setattr(study, "connected", lambda _: nullcontext((NotNeeded(), "no workers")))
    report = solved(sweep, results, LocalWorkers(2, 1), lines)
    assert lines == ["4 points: 1 refused, 3 kept from earlier, 0 to be solved"]
    assert table(results) == before
    with pytest.raises(Exception, match="1 of 4 points did not finish"):
        report.raise_if_failed()


@pytest.mark.slow
def test_several_sweeps_share_the_workers_and_each_has_its_table(
    file: Path, sweep: Sweep, results: Path, tmp_path: Path
) -> None:
    text = SWEEP.replace("[1 mm, 4.5 mm] ", "[1 mm] ").replace("tiny_walls", "other")
    file.with_name("other.yaml").write_text(text, encoding="utf-8")
    other = read_sweep(file.with_name("other.yaml"))
    requests = [(sweep, tmp_path / "first"), (other, tmp_path / "second")]
    lines: list[str] = []
    reports = run_sweeps(requests, Course(LocalWorkers.of(2), False, lines.append))
    assert table(tmp_path / "first") == table(results)
    assert [[point.status for point in report.points] for report in reports] == [
        ["finished", "finished", "refused", "finished"],
        ["finished", "finished"],
    ]
    rows = (tmp_path / "second" / "sweep.csv").read_text().splitlines()
    first = (tmp_path / "first" / "sweep.csv").read_text().splitlines()
    assert rows == first[:5]
    assert lines[0] == "6 points: 1 refused, 0 kept from earlier, 5 to be solved"
    assert len([line for line in lines if "finished after" in line]) == 5
    with pytest.raises(InputError, match="two sweeps would write into this folder"):
        run_sweeps([requests[0], requests[0]], Course(LocalWorkers.of(2), False, lines.append))


def test_the_folder_of_another_sweep_is_not_written_into(file: Path, results: Path) -> None:
    other = file.with_name("another.yaml")
    other.write_text(SWEEP.replace("tiny_walls", "another"), encoding="utf-8")
    before = table(results)
    with pytest.raises(InputError, match=r"holds the results of a sweep with another name; .*fresh=True"):
        solved(read_sweep(other), results, LocalWorkers(2, 1))
    assert table(results) == before


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("run: II", "run: [II]\nset: {material.E: 1.1 MPa}", "set"),
        ("run: II", "run: III", "run"),
        ("base: base.yaml", "base: softer.yaml", "base"),
    ],
)
def test_a_changed_sweep_is_not_written_over_the_old_one(
    file: Path, results: Path, old: str, new: str, key: str
) -> None:
    file.with_name("softer.yaml").write_text(BASE.replace("1.2 MPa", "1 MPa"), encoding="utf-8")
    file.with_name("changed.yaml").write_text(SWEEP.replace(old, new), encoding="utf-8")
    before = table(results)
    with pytest.raises(InputError, match=f"holds the results of a sweep with another {key}; .*fresh=True"):
        solved(read_sweep(file.with_name("changed.yaml")), results, LocalWorkers(2, 1))
    assert table(results) == before


def test_an_interrupted_sweep_leaves_a_table_of_its_own(
    file: Path, results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Future] = []

    class Begun(Executor):
        def submit(self, *_: object) -> Future:
            begun.append(Future())
            if len(begun) == 2:  # before that there is nothing to interrupt
                begun[0].set_result(first)
            return begun[-1]

    class Lines(list[str]):
        """The second point is interrupted when the first has ended."""

        def append(self, sentence: str) -> None:
            super().append(sentence)
            if sentence.startswith("1 of 2: "):
                begun[1].set_exception(KeyboardInterrupt())

    def connected(_: object) -> AbstractContextManager[tuple[Executor, str]]:
        return nullcontext((Begun(), "no workers"))

    first = PointResult("finished", "", ({"pressure_kPa": 2.0, "II_end_y_mm": -0.1},), 3.0)
    out = tmp_path / "out"
    shutil.copytree(results, out)
    fewer = file.with_name("fewer.yaml")  # the axes may change: two points are kept and two are new
    fewer.write_text(SWEEP.replace("[1 mm, 4.5 mm]", "[1 mm, 1.3 mm]"), encoding="utf-8")
    monkeypatch.setattr(study, "connected", connected)
    lines = Lines()
    with pytest.raises(KeyboardInterrupt):
        solved(read_sweep(fewer), out, LocalWorkers(1, 1), lines)
    rows = [line.split(",")[:5] for line in (out / "sweep.csv").read_text().splitlines()[1:]]
    assert [(row[1], row[2], row[4]) for row in rows] == [
        *[("1.0", "8.0", "finished")] * 2,
        *[("1.0", "12.0", "finished")] * 2,
        ("1.3", "8.0", "finished"),
        ("1.3", "12.0", "waiting"),
    ]
    points = json.loads((out / "sweep.json").read_text())["points"]
    assert [point["status"] for point in points] == ["finished", "finished", "finished", "waiting"]
    assert not (out / "sweep.html").exists()
    assert re.search(r"finished after 3\.0 s; about [0-9.]+ s left$", lines[-1])


def test_ctrl_c_in_a_terminal_ends_with_one_sentence(file: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pipeline", "sweep", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    before = signal.signal(signal.SIGINT, signal.SIG_DFL)  # else ignored, where the tests run in the background
    try:
        started = subprocess.Popen(command, cwd=HERE, **options)
    finally:
        signal.signal(signal.SIGINT, before)
    with started as process:
        for line in process.stdout:
            if line.startswith("1 workers"):
                os.killpg(process.pid, signal.SIGINT)  # as a terminal does, workers included
                break
        _, said = process.communicate(timeout=60)
    sentence = "pneurod: interrupted; finished results are kept, and the same command continues from there\n"
    assert (process.returncode, said) == (130, sentence)


@pytest.mark.slow
def test_a_killed_sweep_continues_without_its_finished_points(file: Path, results: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pipeline", "sweep", str(file), "--out", str(tmp_path / "out"), "--jobs", "1"]
    finished: list[str] = []
    with subprocess.Popen(command, cwd=HERE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("1 of 3: "):
                finished.append(line)
                process.kill()
                break
    ended = subprocess.run(command, cwd=HERE, capture_output=True, text=True)
    finished += [line for line in ended.stdout.splitlines() if " finished after " in line]
    folders = [point["folder"] for point in json.loads((results / "sweep.json").read_text())["points"]]
    names = [folder.rpartition("/")[2] for folder in folders if folder]
    order = [next(name for name in names if name in line) for line in finished]
    assert order == [name for name in names if name in order]  # that of the file
    first, *_ = ended.stdout.splitlines()
    assert re.fullmatch("4 points: 1 refused, [12] kept from earlier, [12] to be solved", first)
    assert ended.returncode == 1
    assert "1 of 4 points did not finish" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert table(tmp_path / "out") == table(results)


@contextmanager
def started(*commands: Sequence[str]) -> Iterator[list[subprocess.Popen]]:
    processes: list[subprocess.Popen] = []
    try:
        for command in commands:
            processes.append(
                subprocess.Popen(
                    [sys.executable, "-m", *command], cwd=HERE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
            )
        yield processes
    finally:
        for process in processes:
            process.kill()
            process.wait()


def until(condition) -> None:
    end = time.monotonic() + 300.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)


def test_two_workers_started_by_hand_give_the_same_table_though_one_is_killed(
    sweep: Sweep, results: Path, tmp_path: Path
) -> None:
    scheduler_file, out = tmp_path / "scheduler.json", tmp_path / "out"
    scheduler = ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    worker = ["distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    worker += ["--local-directory", str(tmp_path), "--scheduler-file", str(scheduler_file)]
    with started([*scheduler, "--scheduler-file", str(scheduler_file)], worker, worker) as (_, doomed, _):

        class KillAtFirst(list[str]):
            def append(self, sentence: str) -> None:
                if sentence.startswith("1 of 3: "):
                    os.kill(doomed.pid, signal.SIGKILL)
                super().append(sentence)

        until(lambda: scheduler_file.is_file() and scheduler_file.read_text().endswith("}"))
        lines = KillAtFirst()
        solved(sweep, out, json.loads(scheduler_file.read_text())["address"], lines)
    assert doomed.returncode == -signal.SIGKILL
    assert lines[1].startswith("scheduler tcp://127.0.0.1:")
    assert table(out) == table(results)


def test_a_scheduler_that_does_not_answer_is_named(
    sweep: Sweep, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "PATIENCE", 0.2)
    for address in ("tcp://127.0.0.1:1", "nonsense://x", "a b"):
        with pytest.raises(InputError, match=r"scheduler=.*: no scheduler answers there") as refused:
            solved(sweep, tmp_path, address)
        assert "\n" not in str(refused.value)


def test_memory_that_workers_cannot_have_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "MEMORY_LIMIT", 25_000_000_000)
    with pytest.raises(InputError, match=r"jobs=64: .* 0.9 GB of the 25 GB of this machine; give at most jobs=27$"):
        LocalWorkers.of(64)
    assert LocalWorkers.of(27).memory == 25_000_000_000 // 27
    monkeypatch.setattr(workers, "MEMORY_LIMIT", 500_000_000)
    assert LocalWorkers.of(1).memory == 500_000_000
