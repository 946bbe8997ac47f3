"""A worker process of a run: how it starts, when it ends, where its progress goes."""

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

from pipeline.processes import SPAWN, end_with_main_process, ignore_interrupts
from pipeline.progress import Progress, ToQueue, relayed
from pipeline.simulation.known_limit import KnownLimit

Value = TypeVar("Value")


@dataclass(frozen=True)
class TaskContext:
    """What every task is given beside its input."""

    progress: Progress  #: receives pressures and Newton iterations
    known_limit: KnownLimit  #: what experiment II tells the others
    _kept: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False)

    def kept(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """What an earlier task of this process has made under this key, or what is made now."""
        if key not in self._kept:
            self._kept[key] = make()
        value: Value = self._kept[key]
        return value


class _Worker:
    """The state of this process. Set once, when the process starts."""

    context: TaskContext


@contextmanager
def connected(progress: Progress) -> Iterator[Any]:
    """A queue for `start_worker`; while the block runs, `progress` receives what the workers report."""
    queue = SPAWN.Queue()
    queue.cancel_join_thread()  # a worker that was killed may hold the queue's lock for ever
    with relayed(queue, progress):
        yield queue


def start_worker(queue: Any, known: KnownLimit) -> None:
    """Runs first in a worker: interrupts are left to the main process, progress goes into the queue."""
    ignore_interrupts()
    end_with_main_process()
    _Worker.context = TaskContext(ToQueue(queue), known)


def in_worker(task: Callable[..., Value], arguments: tuple[Any, ...]) -> Value:
    """Runs a task in a worker."""
    return task(_Worker.context, *arguments)
