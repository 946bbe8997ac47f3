"""What every stage of a run is given beside its input: where results are kept, who works, who listens."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Concatenate, ParamSpec, TypeVar

from pipeline.store.parallel import Pending, TaskContext, Workers, workers
from pipeline.store.progress import Progress
from pipeline.store.store import Store

P = ParamSpec("P")
Value = TypeVar("Value")


@dataclass(frozen=True)
class RunContext:
    """The surroundings of a run; they decide no result."""

    store: Store  #: the result directory, with the states of earlier runs
    progress: Progress  #: receives stages, pressures and Newton iterations
    workers: Workers

    @classmethod
    def alone(cls, store: Store, progress: Progress) -> "RunContext":
        """Everything in this process, one after the other."""
        return cls(store, progress, Workers(progress))

    def submit(
        self, task: Callable[Concatenate[TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A task for a worker."""
        return self.workers.submit(task, *args, **kwargs)


@contextmanager
def run_context(store: Store, jobs: int, progress: Progress) -> Iterator[RunContext]:
    """With `jobs` workers until the block ends."""
    with workers(jobs, progress) as working:
        yield RunContext(store, progress, working)
