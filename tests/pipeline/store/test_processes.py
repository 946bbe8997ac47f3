"""Worker processes as an executor: what is lost with one of them, and when they end."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from pipeline.store.processes import Processes
from pipeline.store.worker import tell
from pipeline.values.errors import WorkerLost

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
        assert process.stdout is not None
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
        assert process.stdout is not None
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
