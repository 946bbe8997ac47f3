"""Independent work on many points: what is kept is not done again, and the others are done by an executor."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

from pipeline.store.kept import KeptFile
from pipeline.store.time_left import TimeLeft
from pipeline.values.errors import WorkerLost

Point = TypeVar("Point")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Study(Generic[Point, Result]):
    """One task on many points."""

    points: Sequence[Point]
    #: a function of a module, which a worker can import; it keeps its result, so that no other process is needed for it
    task: Callable[[Point], Result]
    executor: Executor
    cache: Callable[[Point], KeptFile[Result]]  #: where the result of a point is kept
    lost: tuple[type[Exception], ...] = (WorkerLost,)  #: raised by the executor where a worker was ended from outside

    @cached_property
    def kept(self) -> list[tuple[Point, Result]]:
        """The points whose results an earlier call has kept."""
        known = ((point, self.cache(point).read()) for point in self.points)
        return [(point, result) for point, result in known if result is not None]

    @cached_property
    def missing(self) -> list[Point]:
        """The other points."""
        there = {id(point) for point, _ in self.kept}
        return [point for point in self.points if id(point) not in there]

    def solve(
        self,
        say: Callable[[str], None],
        ended: Callable[[Point, Result], str],
        without: Callable[[Point, Exception], Result] | None = None,
    ) -> Iterator[tuple[Point, Result]]:
        """The missing points as they end, which are begun in their order.

        say: receives a sentence for each, with the time left; ended: the sentence of a point. without: the result of a
        point whose workers were ended from outside, for one of `lost`; if it is not given, this is raised.
        """
        left = TimeLeft({"": [1.0] * len(self.missing)})
        futures = {self.executor.submit(self.task, point): point for point in self.missing}
        try:
            for number, future in enumerate(as_completed(futures), start=1):
                point = futures[future]
                try:
                    result = future.result()
                except self.lost as failure:
                    if without is None:
                        raise
                    result = without(point, failure)
                say(f"{number} of {len(futures)}: {ended(point, result)}{left.end('', 1.0)}")
                yield point, result
        finally:
            for future in futures:
                future.cancel()
