"""Workers for the points of a sweep: processes on this machine, or those of a Dask scheduler. The only door to Dask."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from typing import Any, TypeAlias, TypeVar

from distributed import Client, KilledWorker
from distributed.cfexecutor import ClientExecutor
from distributed.comm import CommClosedError
from distributed.system import MEMORY_LIMIT

from pipeline.store.processes import Processes
from pipeline.store.worker import THREADS
from pipeline.study.sweep.points import Point, PointResult
from pipeline.values.errors import InputError, RunFailed, WorkerLost, argument

Value = TypeVar("Value")

#: how long a scheduler may take to answer, seconds
PATIENCE = 10
#: bytes that a worker needs for the smallest arm: 0.78 GB with a whole run; the part of its memory that a worker may
#: use; and how often a point is begun whose worker ends, as Dask has it by default
LEAST_MEMORY, PART, ATTEMPTS = 900_000_000, 0.95, 4
#: what the result of a point raises whose workers were ended from outside
LOST = (WorkerLost, KilledWorker)


@dataclass(frozen=True)
class LocalWorkers:
    """Processes on this machine, each with one thread."""

    jobs: int
    memory: int  #: bytes that each may use before it is ended

    @staticmethod
    def of(jobs: int) -> "LocalWorkers":
        """Workers with equal parts of the memory of the machine. Raises InputError where these are too small."""
        each = MEMORY_LIMIT // jobs
        if jobs > 1 and each < LEAST_MEMORY:
            needs = f"needs {_gigabytes(LEAST_MEMORY)} of the {_gigabytes(MEMORY_LIMIT)} of this machine"
            most = argument("jobs", max(1, MEMORY_LIMIT // LEAST_MEMORY))
            raise InputError(f"{argument('jobs', jobs)}: each worker {needs}; give at most {most}")
        return LocalWorkers(jobs, each)


def _gigabytes(number: int) -> str:
    return f"{number / 1e9:.3g} GB"


#: workers started here, or the address of a Dask scheduler with workers of its own
Workers: TypeAlias = LocalWorkers | str


def solve(point: Point) -> PointResult:
    """The result of a point; runs on a worker. Raises OSError where the folder cannot be written."""
    os.environ.update(dict.fromkeys(THREADS, "1"))  # read by the libraries when they are loaded

    from pipeline.study.sweep.work import work_on

    return work_on(point)


@contextmanager
def connected(workers: Workers) -> Iterator[tuple[Executor, str]]:
    """An executor until the block ends, and who its workers are.

    Raises InputError for a scheduler that cannot be reached, and RunFailed where it ends or has workers without
    pneurod.
    """
    if isinstance(workers, LocalWorkers):
        each = f"each a process with one thread and at most {_gigabytes(workers.memory)} of memory"
        with Processes(workers.jobs, memory=int(PART * workers.memory), attempts=ATTEMPTS) as processes:
            yield processes, f"{workers.jobs} workers, {each}"
        return
    try:
        client = Client(workers, timeout=PATIENCE)
    except (OSError, ValueError) as failure:
        remedy = "start one with `dask scheduler` and give the address that it prints"
        given = argument("scheduler", workers)
        raise InputError(f"{given}: no scheduler answers there ({failure}); {remedy}") from None
    with client:
        number = len(client.scheduler_info(n_workers=-1)["workers"])
        try:
            yield _InOrder(client), f"scheduler {workers}: {number} workers"
        except (CancelledError, CommClosedError):
            raise RunFailed("the scheduler ended before the sweep; the same command continues") from None
        except ImportError as failure:
            raise RunFailed(f"a worker cannot import what a point needs ({failure}); install pneurod for it") from None


class _InOrder(ClientExecutor):
    """The workers of a scheduler as an executor. Dask begins tasks without priorities in any order."""

    def __init__(self, client: Client) -> None:
        super().__init__(client, pure=False)
        self._numbers = count()

    def submit(self, fn: Callable[..., Value], *args: Any, **kwargs: Any) -> "Future[Value]":
        """A task after all earlier ones."""
        return super().submit(fn, *args, **kwargs, priority=-next(self._numbers))
