"""Workers for the points of a sweep: processes on this machine, or those of a Dask scheduler. The only door to Dask."""

import logging
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

import dask
from dask.utils import parse_bytes
from distributed import Client, Future, KilledWorker, LocalCluster, as_completed
from distributed.comm import CommClosedError
from distributed.system import MEMORY_LIMIT

from pipeline.store.processes import KEPT_MEMORY, THREADS
from pipeline.study.sweep.record import WAITING, PointRecord, PointTask
from pipeline.values.errors import InputError, RunFailed

Resource = TypeVar("Resource")

#: loaded by every local worker in its main thread as it starts: interrupts are left to the main process
_PRELOAD = """from pipeline.store.processes import ignore_interrupts

def dask_setup(worker):
    ignore_interrupts()
"""
#: settings of Dask for local workers: a worker gets its next point when it is free, not one ahead of time, and is not
#: interrupted a hundred times a second to see what it does. It holds no data of Dask that could be written to disk, and
#: one that paused until its memory is free again would pause for ever
_SETTINGS = {
    "distributed.nanny.pre-spawn-environ": {**dict.fromkeys(THREADS, "1"), **KEPT_MEMORY},
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.worker.profile.enabled": False,
    **dict.fromkeys((f"distributed.worker.memory.{name}" for name in ("target", "spill", "pause")), False),
    "distributed.worker.preload": [_PRELOAD],
}
#: first part of the keys of all tasks
GROUP = "point"
#: how long a scheduler may take to answer, seconds
PATIENCE = 10
#: bytes that a worker needs for the smallest arm: 0.78 GB with a whole run, of which Dask allows it 95 %
LEAST_MEMORY = 900_000_000


@dataclass(frozen=True)
class LocalWorkers:
    """Processes on this machine, each with one thread."""

    jobs: int
    memory: int  #: bytes that each may use before it is ended

    @staticmethod
    def of(jobs: int, memory: str | None) -> "LocalWorkers":
        """memory: of each worker with its unit, or None for equal parts of that of the machine. Raises InputError."""
        share = MEMORY_LIMIT // jobs
        try:
            each = share if memory is None else parse_bytes(memory)
        except ValueError:
            raise InputError(f"--memory {memory}: is no amount of memory; for example --memory '4 GB'") from None
        if (memory is not None or jobs > 1) and not LEAST_MEMORY <= each <= share:
            given = f"--jobs {jobs}" if memory is None else f"--memory {memory}"
            most = max(1, MEMORY_LIMIT // max(each, LEAST_MEMORY))
            allowed = f"from {_gigabytes(LEAST_MEMORY)} to its part of the {_gigabytes(MEMORY_LIMIT)} of this machine"
            remedy = f"give at most --jobs {most}, or --memory with its unit, for example '4 GB'"
            raise InputError(f"{given}: each of {jobs} workers needs {allowed}; {remedy}")
        return LocalWorkers(jobs, each)


def _gigabytes(number: int) -> str:
    return f"{number / 1e9:.3g} GB"


#: workers started here, or the address of a Dask scheduler with workers of its own
Workers: TypeAlias = LocalWorkers | str


def solve(task: PointTask) -> PointRecord:
    """The record of a point; runs on a worker. Raises OSError where the folder cannot be written."""
    os.environ.update(dict.fromkeys(THREADS, "1"))  # read by the libraries when they are loaded

    from pipeline.study.sweep.work import work_on

    return work_on(task)


@dataclass(frozen=True)
class Connected:
    """Workers that are ready."""

    client: Client
    sentence: str  #: who they are, and where they can be watched

    def records(self, tasks: Sequence[PointTask]) -> Iterator[tuple[PointTask, PointRecord]]:
        """The records of the tasks, which are begun in their order, as they end.

        A worker that is ended from outside is replaced, and its point goes on.

        Raises OSError where a folder cannot be written, and RunFailed where the scheduler ends or has workers without
        pneurod.
        """
        # Dask begins tasks without priorities in any order. It keeps tasks for the next free worker only where many
        # have the same first part of their key, and gives others to workers beforehand, some of which then wait
        futures = {
            self.client.submit(solve, task, key=(GROUP, f"{task.folder}-{task.key}"), priority=-number): task
            for number, task in enumerate(tasks)
        }
        try:
            for future in as_completed(futures):
                yield futures[future], _record(future)
        finally:
            self.client.cancel(list(futures))


@contextmanager
def connected(workers: Workers) -> Iterator[Connected]:
    """Workers until the block ends. Raises InputError for a scheduler that cannot be reached."""
    if isinstance(workers, str):
        try:
            remote = Client(workers, timeout=PATIENCE)
        except (OSError, ValueError) as failure:
            remedy = "start one with `dask scheduler` and give the address that it prints"
            raise InputError(f"--scheduler {workers}: no scheduler answers there ({failure}); {remedy}") from None
        with remote:
            number = len(remote.scheduler_info(n_workers=-1)["workers"])
            yield Connected(remote, f"scheduler {workers}: {number} workers; dashboard: {remote.dashboard_link}")
        return
    with (
        dask.config.set(_SETTINGS),
        closed_after(
            LocalCluster(
                n_workers=workers.jobs,
                threads_per_worker=1,
                processes=True,
                memory_limit=workers.memory,
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
            )
        ) as cluster,
        closed_after(Client(cluster)) as client,
    ):
        each = f"each a process with one thread and at most {_gigabytes(workers.memory)} of memory"
        sentence = f"{workers.jobs} workers, {each}; dashboard: {cluster.dashboard_link}"
        yield Connected(client, sentence)


@contextmanager
def closed_after(resource: AbstractContextManager[Resource]) -> Iterator[Resource]:
    """A resource that is closed when the block ends; where an exception ends it, as an interrupt does, a failure of
    closing, which may take longer than Dask waits, does not hide it."""
    entered = resource.__enter__()
    try:
        yield entered
    except BaseException as failure:
        with suppress(Exception):
            resource.__exit__(type(failure), failure, failure.__traceback__)
        raise
    resource.__exit__(None, None, None)


def _record(future: Future) -> PointRecord:
    try:
        record: PointRecord = future.result()
    except KilledWorker:
        return PointRecord(
            WAITING, "its workers were ended from outside, as when memory runs out; the same command goes on"
        )
    except (CancelledError, CommClosedError):
        raise RunFailed("the scheduler ended before the sweep; the same command continues") from None
    except ImportError as failure:
        raise RunFailed(f"a worker cannot import what a point needs ({failure}); install pneurod for it") from None
    return record
