"""Who does the tasks of a run: worker processes that live as long as the run, or the run itself.

A task is a function of a module, which a worker can import, with `TaskContext` as its first argument. Chains of tasks,
such as the law of a cell, are `beside` each other: each waits in a thread of its own for the tasks it has submitted.
Of the tasks that wait for a worker the most urgent one is next, and among equals the one submitted first.
"""

import heapq
import itertools
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, Concatenate, Generic, ParamSpec, Protocol, TypeAlias, TypeVar, final

from pipeline.errors import WorkerLost
from pipeline.parallel.worker import TaskContext, connected, in_worker, start_worker
from pipeline.processes import available_cores, process_pool
from pipeline.progress import Progress
from pipeline.simulation.known_limit import KnownLimit

P = ParamSpec("P")
Value = TypeVar("Value")
Given = TypeVar("Given", covariant=True)

#: chains of tasks that wait at the same time
CHAINS = 8


class Pending(Protocol[Given]):
    """Work that was begun, or will be when its result is asked for."""

    def result(self) -> Given:
        """The result, when it is there; raises what the work has raised, and `WorkerLost`."""
        ...


class Workers(Protocol):
    """Who does the tasks."""

    jobs: int  #: tasks that are done at the same time

    def submit(
        self, urgency: int, task: Callable[Concatenate[TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A task; the smaller its urgency the sooner it begins."""
        ...

    def beside(self, work: Callable[P, Value], *args: P.args, **kwargs: P.kwargs) -> Pending[Value]:
        """A chain of tasks."""
        ...


@final
@dataclass(frozen=True)
class Done(Generic[Value]):
    """What needs no work."""

    value: Value

    def result(self) -> Value:
        """At once."""
        return self.value


@final
class _Later(Generic[Value]):
    """Work that this process does when its result is asked for the first time."""

    def __init__(self, work: Callable[[], Value]) -> None:
        self._work = work
        self._done: Future[Value] = Future()

    def result(self) -> Value:
        if not self._done.done():
            try:
                self._done.set_result(self._work())
            except Exception as failure:
                self._done.set_exception(failure)
        return self._done.result()


@final
class InTurn:
    """The run itself, one task after the other, each when its result is asked for."""

    jobs = 1

    def __init__(self, progress: Progress) -> None:
        self._context = TaskContext(progress, KnownLimit())

    def submit(
        self, urgency: int, task: Callable[Concatenate[TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """Whatever its urgency."""
        return _Later(partial(task, self._context, *args, **kwargs))

    def beside(self, work: Callable[P, Value], *args: P.args, **kwargs: P.kwargs) -> Pending[Value]:
        """When its result is asked for."""
        return _Later(partial(work, *args, **kwargs))


@final
class _FromWorker(Generic[Value]):
    """The result of a worker, or of a chain that waits for workers."""

    def __init__(self, future: "Future[Value]") -> None:
        self._future = future

    def result(self) -> Value:
        try:
            return self._future.result()
        except (BrokenProcessPool, CancelledError):
            raise WorkerLost(
                "a process of the run was ended from outside, as happens when memory runs out; finished results "
                "are kept, and the same command continues from there, with --jobs 1 in less memory"
            ) from None


#: urgency, number, result, task and its arguments
_Waiting: TypeAlias = tuple[int, int, Future[Any], Callable[..., Any], tuple[Any, ...]]


@final
class _Processes:
    """Worker processes. The queue of the pool is kept empty, so that an urgent task is next."""

    def __init__(self, jobs: int, pool: ProcessPoolExecutor, chains: ThreadPoolExecutor) -> None:
        self.jobs = jobs
        self._pool = pool
        self._chains = chains
        self._free = jobs
        self._waiting: list[_Waiting] = []
        self._numbers = itertools.count()
        self._lock = threading.Lock()
        self._failure: Exception | None = None  #: why no more tasks are done: a worker was lost, or the run ends

    def submit(
        self, urgency: int, task: Callable[Concatenate[TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """To the first worker that is free."""
        promised: Future[Value] = Future()
        entry: _Waiting = (urgency, next(self._numbers), promised, partial(task, **kwargs), args)
        with self._lock:
            heapq.heappush(self._waiting, entry)
        self._begin()
        return _FromWorker(promised)

    def beside(self, work: Callable[P, Value], *args: P.args, **kwargs: P.kwargs) -> Pending[Value]:
        """In a thread, at once."""
        return _FromWorker(self._chains.submit(work, *args, **kwargs))

    def _begin(self) -> None:
        """Give tasks to workers that are free."""
        if self._failure:
            self._give_up(self._failure)
        while True:
            with self._lock:
                if not (self._free and self._waiting):
                    return
                self._free -= 1
                _, _, promised, task, arguments = heapq.heappop(self._waiting)
            try:
                running = self._pool.submit(in_worker, task, arguments)
            except (RuntimeError, OSError) as ended:  # a worker was lost, the run ends, or there is no other process
                failure = ended if isinstance(ended, OSError) else CancelledError()
                promised.set_exception(failure)
                self._give_up(failure)
            else:
                running.add_done_callback(partial(self._ended, promised))

    def _ended(self, promised: "Future[Any]", running: "Future[Any]") -> None:
        failure = CancelledError() if running.cancelled() else running.exception()
        if isinstance(failure, BrokenProcessPool | CancelledError):
            self._give_up(CancelledError())  # and leave the pool alone, which calls this while it closes
        else:
            with self._lock:
                self._free += 1
            self._begin()
        if failure is None:
            promised.set_result(running.result())
        else:
            promised.set_exception(failure)

    def _give_up(self, failure: Exception) -> None:
        """No task that waits will be done, nor one that is submitted later."""
        self._failure = failure
        with self._lock:
            waiting, self._waiting = self._waiting, []
        for _, _, promised, _, _ in waiting:
            promised.set_exception(failure)


@contextmanager
def workers(jobs: int, progress: Progress) -> Iterator[Workers]:
    """`jobs` workers until the block ends; the run itself instead of a single one."""
    if jobs == 1:
        yield InTurn(progress)
        return
    threads = max(1, available_cores() // jobs)
    with (
        connected(progress) as queue,
        ThreadPoolExecutor(CHAINS) as chains,
        process_pool(jobs, threads, initializer=start_worker, initargs=(queue, KnownLimit())) as pool,
    ):
        yield _Processes(jobs, pool, chains)
