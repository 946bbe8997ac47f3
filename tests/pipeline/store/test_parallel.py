"""Workers of a run: results, order, errors, and what happens when one is lost."""

import os
import signal
import time
from pathlib import Path

import numba
import numpy as np
import pytest

from pipeline.store.parallel import TaskContext, Workers, workers
from pipeline.store.processes import Processes
from pipeline.store.progress import Message, Progress, Silent
from pipeline.store.worker import KEPT_MEMORY, THREADS
from pipeline.values.errors import InputError, WorkerLost
from tests.pipeline.store.test_processes import own_processes


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
