"""Who does the tasks of a run: worker processes that live as long as the run, or the run itself.

A task is a function of a module, which a worker can import, with `TaskContext` as its first argument. Tasks are begun
in the order in which they were submitted. Chains of tasks, such as the law of a cell, are `beside` each other: each
waits in a thread of its own for the tasks it has submitted.
"""

from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, final

from pipeline.store.cores import available_cores
from pipeline.store.processes import LOST, Processes
from pipeline.store.progress import PassedOn, Progress
from pipeline.store.worker import tell
from pipeline.values.errors import WorkerLost

P = ParamSpec("P")
Value = TypeVar("Value")

#: chains of tasks that wait at the same time
CHAINS = 8


@dataclass(frozen=True)
class TaskContext:
    """What every task is given beside its input."""

    progress: Progress  #: receives pressures and Newton iterations
    _kept: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)

    def kept(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """What an earlier task of this process has made under this key, or what is made now."""
        if key not in self._kept:
            self._kept[key] = make()
        value: Value = self._kept[key]
        return value


@final
class Pending(Generic[Value]):
    """Work that was begun, or that this process does when its result is asked for the first time."""

    def __init__(self, future: "Future[Value]", work: Callable[[], Value] | None = None) -> None:
        self._future = future
        self._work = work

    @classmethod
    def done(cls, value: Value) -> "Pending[Value]":
        """What needs no work."""
        return cls(Future(), lambda: value)

    def result(self) -> Value:
        """The result, when it is there. Raises what the work has raised, and `WorkerLost`."""
        if self._work is not None and not self._future.done():
            try:
                self._future.set_result(self._work())
            except Exception as failure:
                self._future.set_exception(failure)
        try:
            return self._future.result()
        except CancelledError:
            raise WorkerLost(LOST) from None


@final
class Workers:
    """Who does the tasks: a pool of processes, or without one the run itself, each when its result is asked for."""

    def __init__(
        self,
        progress: Progress,
        jobs: int = 1,
        pool: Processes | None = None,
        chains: ThreadPoolExecutor | None = None,
    ) -> None:
        self.jobs = jobs  #: tasks that are done at the same time
        self._context = TaskContext(progress)
        self._pool = pool
        self._chains = chains

    def submit(
        self, task: Callable[Concatenate[TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A task, which begins when a worker is free."""
        if self._pool is None:
            return Pending(Future(), partial(task, self._context, *args, **kwargs))
        try:
            future = self._pool.submit(_in_worker, partial(task, **kwargs), args)
        except RuntimeError:  # a worker was lost, or the run ends
            future = Future()
            future.cancel()
        future.add_done_callback(self._end_if_lost)
        return Pending(future)

    def _end_if_lost(self, future: "Future[Value]") -> None:
        """One lost worker ends all: without its task the run cannot be completed."""
        if self._pool is not None and not future.cancelled() and isinstance(future.exception(), WorkerLost):
            self._pool.end()

    def beside(self, work: Callable[P, Value], *args: P.args, **kwargs: P.kwargs) -> Pending[Value]:
        """A chain of tasks, which begins at once."""
        if self._chains is None:
            return Pending(Future(), partial(work, *args, **kwargs))
        return Pending(self._chains.submit(work, *args, **kwargs))


@contextmanager
def workers(jobs: int, progress: Progress) -> Iterator[Workers]:
    """`jobs` workers until the block ends; the run itself instead of a single one."""
    if jobs == 1:
        yield Workers(progress)
        return
    threads = max(1, available_cores() // jobs)
    with ThreadPoolExecutor(CHAINS) as chains, Processes(jobs, threads=threads, listen=progress.tell) as pool:
        yield Workers(progress, jobs, pool, chains)


@cache
def _context() -> TaskContext:
    """That of all tasks of this worker."""
    return TaskContext(PassedOn(tell))


def _in_worker(task: Callable[..., Value], arguments: tuple[Any, ...]) -> Value:
    return task(_context(), *arguments)
