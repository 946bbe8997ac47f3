"""The course of a function that solves: its number of processes, and who is told of its progress."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from geometry.errors import Reason
from pipeline.api.described import Body
from pipeline.api.given import document_of, given_choice, given_folder, given_jobs, given_progress
from pipeline.store.progress import Progress
from pipeline.store.worker import available_cores
from pipeline.values.errors import InputError, RunFailed, argument
from pipeline.values.json_values import Written
from pipeline.values.reasons import render

if TYPE_CHECKING:
    from pipeline.config.config import Config

Given = TypeVar("Given")
Value = TypeVar("Value")
#: of a run: its three experiments
MOST_JOBS = 3


@dataclass(frozen=True)
class Course:
    """Processes, folder and listener of a task; they decide no result."""

    jobs: int
    fresh: bool
    progress: Progress

    def solve(
        self,
        task: Callable[[Given, Path, int, bool, Progress], Value],
        given: Given,
        folder: Path,
        notes: Iterable[Reason] = (),
    ) -> Value:
        """Do a task on the design that is given, in a result folder; notes on the design are told first."""
        try:
            for note in notes:
                self.progress.remark(render(note))
            return task(given, folder, self.jobs, self.fresh, self.progress)
        finally:
            self.progress.done()


def course_of(jobs: int | None, most: int, fresh: bool, progress: bool | Progress) -> Course:
    """The course that is asked for; most: of the processes, where their number is not given. Raises InputError."""
    at_once = given_jobs(jobs) or min(most, available_cores())
    return Course(at_once, given_choice(fresh, "fresh"), given_progress(progress))


def design_of(
    config: Path | str | Body,
    arguments: Mapping[str, Written],
    settings: Mapping[str, Written] | Sequence[str] | None,
    out: Path | str | None,
    suffix: str = "",
    command: str = "run",
) -> "tuple[Config, Path, tuple[Reason, ...]]":
    """The configuration for a command, the result folder, and notes. Raises InputError."""
    from pipeline.config import load

    design, notes = load.for_command(command, document_of(config, arguments, settings), load.checked)
    return design, given_folder(out, f"{design.name}{suffix}"), notes


def error_of(accuracy: str | None, draft: bool) -> dict[str, Any]:
    """The keys of the error of the mesh and of a draft. Raises InputError for both: a draft knows no such error."""
    if not given_choice(draft, "draft"):
        return {"accuracy": accuracy}
    if accuracy not in (None, "off"):
        contradiction = f"{argument('draft', True)} leaves the error of the mesh unknown; leave one of them out"
        raise InputError(f"{argument('accuracy', accuracy)}: {contradiction}")
    return {"accuracy": accuracy, "draft": True}


def load_notes(design: "Config") -> "tuple[Reason, ...]":
    """What is odd about the load of a design, before anything is solved."""
    from pipeline.simulate.design_notes import check_load

    return check_load(design)


def reached(value: Value, raise_if_failed: Callable[[], None]) -> Value:
    """The value. Raises RunFailed, which has it as `reached`, where something was not."""
    try:
        raise_if_failed()
    except RunFailed as failure:
        raise failure.with_reached(value) from None
    return value
