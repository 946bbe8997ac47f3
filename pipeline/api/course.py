"""Arguments of the functions, checked; and the course of one that solves: its processes, and who is told of it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from geometry.errors import Reason
from pipeline.api.described import Body
from pipeline.store.cores import available_cores
from pipeline.store.progress import Progress
from pipeline.values.errors import InputError, RunFailed, argument
from pipeline.values.json_values import Written
from pipeline.values.reasons import render

if TYPE_CHECKING:
    from pipeline.config.config import Config
import os

from pipeline.api.described import given_settings, setting_name
from pipeline.config.document import Document, key_and_value, on_command_line, read_document
from pipeline.show.progress import progress_for
from pipeline.store.progress import Silent
from pipeline.values.errors import quoted
from pipeline.values.json_values import plain


def given_path(value: Any, name: str, example: str) -> Path:
    """A path that is given as a text, as a `Path`, or as results with a `directory`.

    Raises InputError, naming the argument, for anything else.
    """
    try:
        text = os.fspath(getattr(value, "directory", value))
    except TypeError:
        text = None
    if not isinstance(text, str) or not text or "\0" in text:
        raise InputError(f'{name}: {quoted(value)} is no path; give a text or a Path, for example "{example}"')
    return Path(text)


def given_choice(value: Any, name: str) -> bool:
    """True or False. Raises InputError, naming the argument, for anything else."""
    choice = plain(value)
    if not isinstance(choice, bool):
        raise InputError(f"{name}: {quoted(value)} is not allowed; give True or False")
    return choice


def given_jobs(value: Any) -> int | None:
    """A number of processes, or None. Raises InputError for anything else."""
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
        raise InputError(f"jobs: {value!r} is not allowed; give a whole number from 1 on")
    return value


def document_of(
    config: Path | str | Body, arguments: Mapping[str, Written], settings: Mapping[str, Written] | Sequence[str] | None
) -> Document:
    """The configuration in a file or of a body, with other values: those of arguments by their names, then settings.

    settings: by dotted key, or as texts KEY=VALUE. A file that a body names is seen from the working folder. Raises
    InputError.
    """
    given = {key: value for key, value in arguments.items() if value is not None}
    values, naming = given_settings(given, argument), setting_name
    if isinstance(settings, list | tuple) and all(isinstance(text, str) for text in settings):
        values += [key_and_value(text) for text in settings]
        naming = on_command_line
    else:
        values += given_settings(settings)
    if isinstance(config, Body):
        keys: list[tuple[str, Written]] = [("name", str(config.values["family"])), ("geometry", config.values)]
        made = Document(Path(type(config).__name__), {}, ()).with_values(keys, str)
        document = Document(made.path, made.content, ())
    else:
        document = read_document(given_path(config, "config", "configs/pneunet.yaml"))
    return document.with_values(values, lambda key: argument(key) if key in given else naming(key))


def given_folder(out: Path | str | None, name: str) -> Path:
    """The result folder; results/NAME where none is given. Raises InputError."""
    return Path("results") / name if out is None else given_path(out, "out", "results/arm")


def given_progress(progress: bool | Progress) -> Progress:
    """The listener to the progress: the terminal for True, nothing for False. Raises InputError for anything else."""
    if isinstance(progress, Progress):
        return progress
    return progress_for() if given_choice(progress, "progress") else Silent()


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
