"""Worker processes and the tasks of a run on them: results, order, errors, and what happens when one is lost."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numba
import numpy as np
import psutil
import pytest

from pipeline.store.parallel import TaskContext, Workers, workers
from pipeline.store.processes import Processes
from pipeline.store.progress import Message, Progress, Silent
from pipeline.store.worker import KEPT_MEMORY, THREADS, tell
from pipeline.values.errors import InputError, WorkerLost

HERE = Path(__file__).resolve().parents[3]


def own_processes(main: int | None = None) -> list[int]:
    """Workers that a process, or this one, has started."""
    children = psutil.Process(main).children()
    return [child.pid for child in children if "import serve" in " ".join(child.cmdline())]


def pid(*_: object) -> int:
    return os.getpid()


def killed_at_first(flag: Path) -> int:
    if not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid()


def printing() -> int:
    sys.stdout.write("to whom?\n")
    os.write(1, b"and this?\n")
    return 3


def large(size: int) -> int:
    content = bytearray(b"1") * size
    time.sleep(30.0)
    return content[0]


def test_a_process_that_ends_loses_its_task_alone_and_is_replaced(tmp_path: Path) -> None:
    with Processes(2) as pool:
        futures = [pool.submit(killed_at_first, tmp_path / "never"), *(pool.submit(pid) for _ in range(4))]
        with pytest.raises(WorkerLost, match=r"was ended from outside.* status -9\)"):
            futures[0].result()
        assert len({future.result() for future in futures[1:]}) <= 2
        with pytest.raises(AttributeError, match="pickle local object"):
            pool.submit(lambda: 1).result()
        assert pool.submit(pid).result() in own_processes()
    assert not own_processes()


def test_a_task_begins_again_as_often_as_it_may(tmp_path: Path) -> None:
    with Processes(1, attempts=2) as pool:
        assert pool.submit(killed_at_first, tmp_path / "begun").result() > 0


def test_every_task_may_have_a_process_of_its_own() -> None:
    with Processes(1, is_fresh=True) as pool:
        assert len({pool.submit(pid).result() for _ in range(3)}) == 3


def test_a_process_that_uses_more_memory_than_it_may_ends() -> None:
    with Processes(1, memory=200_000_000) as pool:
        with pytest.raises(WorkerLost):
            pool.submit(large, 400_000_000).result()
        assert pool.submit(pid).result() > 0


def test_what_a_library_prints_does_not_hide_a_result() -> None:
    with Processes(1) as pool:
        assert pool.submit(printing).result() == 3
        assert pool.submit(printing).result() == 3


PROGRAM = """
import sys, time
from pipeline.store.processes import Processes
sys.stdout.write("program\\n")  # without `if __name__ == "__main__"`
with Processes(2) as pool:
    futures = [pool.submit(time.sleep, 60.0) for _ in range(2)]
    sys.stdout.write("begun\\n")
    sys.stdout.flush()
    futures[0].result()
"""


@contextmanager
def program(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A program with two workers at work, which does not guard its main part."""
    (tmp_path / "program.py").write_text(PROGRAM, encoding="utf-8")
    command, environment = [sys.executable, str(tmp_path / "program.py")], {**os.environ, "PYTHONPATH": str(HERE)}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert [process.stdout.readline() for _ in range(2)] == ["program\n", "begun\n"]
        yield process


def test_workers_end_with_a_main_process_that_is_killed(tmp_path: Path) -> None:
    with program(tmp_path) as process:
        main = psutil.Process(process.pid)
        while len(children := main.children()) < 2:
            time.sleep(0.01)
        process.kill()
        assert process.wait() == -signal.SIGKILL
        _, alive = psutil.wait_procs(children, timeout=20.0)
        assert not alive
        assert process.stdout.read() == ""


def telling_numbers(numbers: int) -> None:
    for number in range(numbers):
        tell(number)


def test_the_listener_hears_one_value_at_a_time() -> None:
    heard: list[int] = []

    def listen(number: int) -> None:
        before = len(heard)
        time.sleep(0.001)
        assert len(heard) == before
        heard.append(number)

    with Processes(2, listen=listen) as pool:
        for future in [pool.submit(telling_numbers, 20) for _ in range(2)]:
            future.result()
    assert sorted(heard) == sorted([*range(20), *range(20)])


def test_a_listener_that_fails_ends_the_task_with_its_failure() -> None:
    def listen(_: int) -> None:
        raise BrokenPipeError("the output was closed")

    with Processes(1, listen=listen) as pool:
        with pytest.raises(BrokenPipeError, match="the output was closed"):
            pool.submit(telling_numbers, 2).result()
        assert pool.submit(pid).result() > 0


def doubled(context: TaskContext, number: float) -> float:
    return 2.0 * number


def noted(context: TaskContext, folder: Path, name: str) -> None:
    (folder / f"{time.monotonic_ns()}_{name}").touch()


def refused(context: TaskContext) -> None:
    raise InputError("mesh.size: too small", "material: unknown")


def asleep(context: TaskContext, flag: Path) -> None:
    flag.touch()
    time.sleep(60.0)


def environment(context: TaskContext) -> dict[str, str]:
    return {name: os.environ[name] for name in (*THREADS, *KEPT_MEMORY)}


def threads_of_numba(context: TaskContext) -> int:
    return int(numba.config.NUMBA_NUM_THREADS)


def counted(context: TaskContext) -> int:
    calls: list[int] = context.kept("calls", list)
    calls.append(1)
    return len(calls)


def chain(working: Workers, number: float) -> float:
    for _ in range(3):
        number = working.submit(doubled, number).result()
    return number


@pytest.mark.parametrize("jobs", [1, 2])
def test_tasks_and_chains_give_their_results_and_errors(jobs: int) -> None:
    with workers(jobs, Silent()) as working:
        chains = [working.beside(chain, working, float(number)) for number in range(3)]
        assert [pending.result() for pending in chains] == [0.0, 8.0, 16.0]
        with pytest.raises(InputError) as raised:
            working.submit(refused).result()
        assert raised.value.sentences == ("mesh.size: too small", "material: unknown")


def test_a_single_job_does_nothing_that_nobody_asks_for(tmp_path: Path) -> None:
    with workers(1, Silent()) as working:
        first, second = (working.submit(noted, tmp_path, name) for name in ("first", "second"))
        second.result()
        second.result()
        assert [path.name.partition("_")[2] for path in tmp_path.iterdir()] == ["second"]
        first.result()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_worker_has_one_thread_of_two_cores_keeps_memory_and_what_it_has_made() -> None:
    before = dict(os.environ)
    with workers(2, Silent()) as working:
        variables = working.submit(environment).result()
        assert all(int(variables[name]) >= 1 for name in THREADS)
        assert {name: variables[name] for name in KEPT_MEMORY} == KEPT_MEMORY
        assert dict(os.environ) == before
        assert max(working.submit(counted).result() for _ in range(4)) >= 2


def test_numba_has_the_threads_of_its_worker() -> None:
    """numba reads its number of threads from the environment whenever it compiles, which another thread may do then."""
    before = {name: os.environ.get(name) for name in THREADS}
    with Processes(1, threads=1) as pool:
        assert pool.submit(threads_of_numba, TaskContext(Silent())).result() == 1
    assert {name: os.environ.get(name) for name in THREADS} == before


class Recorder(Progress):
    def __init__(self) -> None:
        self.messages: list[Message] = []

    def tell(self, message: Message) -> None:
        self.messages.append(message)


def telling(context: TaskContext, name: str) -> None:
    context.progress.experiment(name, (1.0, 2.0))
    context.progress.iteration(name, 1.0, 1, np.float64(0.5))
    context.progress.done()


def test_progress_reaches_the_listener_before_the_result_but_the_end_of_a_worker_does_not() -> None:
    recorder = Recorder()
    with workers(2, recorder) as working:
        working.submit(telling, "II").result()
        assert recorder.messages == [("experiment", ("II", (1.0, 2.0))), ("iteration", ("II", 1.0, 1, 0.5))]


def until(flag: Path) -> None:
    while not flag.exists():
        time.sleep(0.01)


def test_a_lost_worker_ends_all_tasks_and_chains(tmp_path: Path) -> None:
    flag = tmp_path / "begun"
    with workers(2, Silent()) as working:
        pending = [working.submit(asleep, flag) for _ in range(4)]
        waiting = working.beside(chain, working, 1.0)
        until(flag)
        os.kill(own_processes()[0], signal.SIGKILL)
        for lost in (*pending, waiting):
            with pytest.raises(WorkerLost, match="was ended from outside"):
                lost.result()
        later = [working.submit(asleep, flag) for _ in range(4)]  # more than there were workers
        for lost in later:
            with pytest.raises(WorkerLost, match="was ended from outside"):
                lost.result()


def test_an_error_of_the_run_ends_workers_and_chains_at_once(tmp_path: Path) -> None:
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        _interrupted(tmp_path / "begun")
    assert not own_processes()  # none of them writes any more
    assert time.monotonic() - begin < 50.0


def _interrupted(flag: Path) -> None:
    with workers(2, Silent()) as working:
        for _ in range(3):
            working.submit(asleep, flag)
        working.beside(chain, working, 1.0)
        until(flag)
        raise KeyboardInterrupt


def test_without_workers_a_task_that_fails_is_not_done_again() -> None:
    calls: list[int] = []

    def failing(context: TaskContext) -> None:
        calls.append(1)
        raise InputError("material: unknown")

    with workers(1, Silent()) as working:
        pending = working.submit(failing)
        assert not calls
        for _ in range(2):
            with pytest.raises(InputError, match="material"):
                pending.result()
    assert len(calls) == 1
