"""Pools of processes: how many threads each process has, and that all end when one fails."""

import multiprocessing
import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from multiprocessing.reduction import ForkingPickler
from types import ModuleType
from typing import Any

#: seconds that a worker may take to end
PATIENCE = 10.0
THREADS = ("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")
#: What the environment of a worker begins with so that glibc keeps freed memory for the next arrays. Given back to the
#: system at once, as Dask has it by default, a quarter of the time of a worker would be page faults.
KEPT_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_ARENA_MAX": "1",
}


class _Worker(SpawnProcess):
    """A process that does not import the program that started it, and begins with an environment of its own.

    Python's own would run a program without `if __name__ == "__main__"` once more in every worker.
    """

    threads: int = 1  #: of the libraries

    def start(self) -> None:
        program, before = sys.modules["__main__"], {name: os.environ.get(name) for name in KEPT_MEMORY}
        sys.modules["__main__"] = ModuleType("__main__")
        os.environ.update(KEPT_MEMORY)  # glibc reads it when the process starts; nothing in this one reads it
        try:
            super().start()
        finally:
            sys.modules["__main__"] = program
            for name, value in before.items():
                os.environ.pop(name) if value is None else os.environ.update({name: value})

    def __reduce__(self) -> tuple[Any, ...]:
        return _with_threads, (self.threads, type(self), bytes(ForkingPickler.dumps(self.__dict__)))


def _with_threads(threads: int, kind: type[_Worker], state: bytes) -> _Worker:
    """In the new process: the number of threads is set before what the worker needs is imported, numba among others.

    Set in the environment of the main process while workers start, it would be read there by a numba that compiles at
    the same time.
    """
    os.environ.update(dict.fromkeys(THREADS, str(threads)))
    worker = kind.__new__(kind)
    worker.__dict__.update(pickle.loads(state))
    return worker


class _Spawn(SpawnContext):
    """Workers begin afresh: the libraries they load read the number of threads then."""

    def __init__(self, threads: int = 1) -> None:
        super().__init__()
        self._threads = threads

    def Process(self, *args: Any, **kwargs: Any) -> _Worker:  # type: ignore[override]
        worker = _Worker(*args, **kwargs)
        worker.threads = self._threads
        return worker


SPAWN = _Spawn()


def available_cores() -> int:
    """The processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def process_pool(jobs: int, threads: int, **options: Any) -> Iterator[ProcessPoolExecutor]:
    """`jobs` workers of `threads` threads; `options` are those of ProcessPoolExecutor.

    An exception leaves the block when all of them have ended.
    """
    with ProcessPoolExecutor(jobs, _Spawn(threads), **options) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            children = [child for child in multiprocessing.active_children() if isinstance(child, _Worker)]
            for child in children:
                child.terminate()
            for child in children:
                child.join(PATIENCE)
                child.kill()
            raise


def ignore_interrupts() -> None:
    """Called in a new process: Ctrl-C and a closed terminal, which reach all processes, are left to the main one."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):  # Windows has no SIGHUP
            signal.signal(getattr(signal, name), signal.SIG_IGN)


def end_with_main_process() -> None:
    """Called in a new process: it ends at once when the process that started it has ended, killed or not.

    Else it would write into a folder that another run uses, and then wait for work for ever.
    """
    threading.Thread(target=_end_after_main_process, daemon=True).start()


def _end_after_main_process() -> None:
    main_process = multiprocessing.parent_process()
    if main_process is not None:
        main_process.join()
        os._exit(1)
