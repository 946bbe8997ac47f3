"""Workers of a run: results, order, errors, and what happens when one is lost."""

import multiprocessing
import os
import signal
import time
from multiprocessing.context import SpawnProcess
from pathlib import Path

import numba
import pytest

from pipeline.store.parallel import TaskContext, Workers, _in_worker, start_worker, workers
from pipeline.store.processes import KEPT_MEMORY, SPAWN, THREADS, process_pool
from pipeline.store.progress import Silent
from pipeline.values.errors import InputError, WorkerLost


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


def test_numba_in_the_main_process_sees_no_other_threads_while_workers_start(monkeypatch: pytest.MonkeyPatch) -> None:
    """numba reads its number of threads from the environment whenever it compiles, which another thread may do then."""
    before, seen = {name: os.environ.get(name) for name in THREADS}, []
    start = SpawnProcess.start

    def watched(process: SpawnProcess) -> None:
        seen.append({name: os.environ.get(name) for name in THREADS})
        start(process)

    monkeypatch.setattr(SpawnProcess, "start", watched)
    with process_pool(1, 1, initializer=start_worker, initargs=(SPAWN.Queue(),)) as pool:
        assert pool.submit(_in_worker, threads_of_numba, ()).result() == 1
    assert seen == [before]


def test_a_lost_worker_ends_all_tasks_and_chains(tmp_path: Path) -> None:
    flag = tmp_path / "begun"
    with workers(2, Silent()) as working:
        pending = [working.submit(asleep, flag) for _ in range(4)]
        waiting = working.beside(chain, working, 1.0)
        while not flag.exists():
            time.sleep(0.01)
        children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text(encoding="ascii").split()
        spawned = [int(pid) for pid in children if "spawn_main" in Path(f"/proc/{pid}/cmdline").read_text()]
        os.kill(spawned[0], signal.SIGKILL)
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
    assert not multiprocessing.active_children()  # none of them writes any more
    assert time.monotonic() - begin < 50.0


def _interrupted(flag: Path) -> None:
    with workers(2, Silent()) as working:
        for _ in range(3):
            working.submit(asleep, flag)
        working.beside(chain, working, 1.0)
        while not flag.exists():
            time.sleep(0.01)
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
