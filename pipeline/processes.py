"""Pools of processes: how many threads each process has, and that all end when one fails."""

import multiprocessing
import os
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from types import MappingProxyType, ModuleType
from typing import Any


class _Worker(SpawnProcess):
    """A process that does not import the program that started it, and begins with an environment of its own.

    Python's own would run a program without `if __name__ == "__main__"` once more in every worker.
    """

    environment: Mapping[str, str] = MappingProxyType({})  #: what differs from that of this process

    def start(self) -> None:
        program, before = sys.modules["__main__"], {name: os.environ.get(name) for name in self.environment}
        sys.modules["__main__"] = ModuleType("__main__")
        os.environ.update(self.environment)
        try:
            super().start()
        finally:
            sys.modules["__main__"] = program
            for name, value in before.items():
                os.environ.pop(name) if value is None else os.environ.update({name: value})


class _Spawn(SpawnContext):
    """Workers begin afresh: the libraries they load read the number of threads then."""

    def __init__(self, environment: Mapping[str, str] | None = None) -> None:
        super().__init__()
        self._environment = dict(environment or {})

    def Process(self, *args: Any, **kwargs: Any) -> _Worker:  # type: ignore[override]
        worker = _Worker(*args, **kwargs)
        worker.environment = self._environment
        return worker


SPAWN = _Spawn()
THREADS = ("MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")
#: What the environment of a worker begins with so that glibc keeps freed memory for the next arrays. Given back to the
#: system at once, as Dask has it by default, a quarter of the time of a worker would be page faults.
KEPT_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(1 << 30),
    "MALLOC_MMAP_THRESHOLD_": str(1 << 25),
    "MALLOC_ARENA_MAX": "1",
}


def available_cores() -> int:
    """The processor cores that this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def process_pool(jobs: int, threads: int, **options: Any) -> Iterator[ProcessPoolExecutor]:
    """`jobs` workers of `threads` threads; `options` are those of ProcessPoolExecutor. An exception ends them all."""
    environment = {**dict.fromkeys(THREADS, str(threads)), **KEPT_MEMORY}
    with ProcessPoolExecutor(jobs, _Spawn(environment), **options) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                child.terminate()
            raise
