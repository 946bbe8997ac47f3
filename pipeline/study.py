"""A study: one measurement of many cases, each result kept as soon as it is there.

The convergence study, the study of effects and the benchmarks are studies; they differ in their cases, in what is
measured, and in where results are kept.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pipeline.processes import process_pool
from pipeline.store.atomic_file import write_atomic

Case = TypeVar("Case")
Result = TypeVar("Result")
Given = TypeVar("Given", contravariant=True)


class Record(Protocol[Given, Result]):
    """Where the results of a study are kept."""

    def read(self, case: Given) -> Result | None:
        """The result of an earlier run that is still valid, or None."""

    def save(self, case: Given, result: Result) -> None:
        """Keep a result."""


@dataclass(frozen=True)
class JsonFiles(Generic[Case, Result]):
    """A record with one JSON file per case, valid while the case has the key that stands in it."""

    file: Callable[[Case], Path]
    key: Callable[[Case], str]  #: of all that decides the result
    to_json: Callable[[Result], Any]
    from_json: Callable[[Any], Result]

    def read(self, case: Case) -> Result | None:
        """The result in the file of a case, None where there is no file, or one with another key or without one."""
        path = self.file(case)
        content = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        return self.from_json(content["result"]) if content.get("key") == self.key(case) else None

    def save(self, case: Case, result: Result) -> None:
        """Write the file of a case."""
        path = self.file(case)
        path.parent.mkdir(parents=True, exist_ok=True)
        content = {"key": self.key(case), "result": self.to_json(result)}
        write_atomic(path, json.dumps(content, indent=2).encode())


@dataclass(frozen=True)
class Study(Generic[Case, Result]):
    """Cases, what is measured on each, and where results are kept."""

    cases: Sequence[Case]
    measure: Callable[[Case], Result]  #: a module's function where it runs in worker processes
    record: Record[Case, Result]

    def missing(self) -> list[Case]:
        """The cases without a result in the record."""
        return [case for case in self.cases if self.record.read(case) is None]

    def run(self) -> Iterator[tuple[Case, Result]]:
        """Cases with their results, in order; what is missing is measured in this process."""
        for case in self.cases:
            result = self.record.read(case)
            if result is None:
                result = self.measure(case)
                self.record.save(case, result)
            yield case, result

    def run_in_processes(self, jobs: int) -> list[tuple[Case, Result]]:
        """All cases with their results; each missing one is measured in a process of its own with one thread, `jobs`
        at a time, so that processes share neither memory nor warm caches."""
        missing = self.missing()
        if missing:
            with process_pool(jobs, 1, max_tasks_per_child=1) as pool:
                cases = {pool.submit(self.measure, case): case for case in missing}
                for future in as_completed(cases):
                    self.record.save(cases[future], future.result())
        return list(self.run())
