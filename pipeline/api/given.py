"""Arguments of the functions, and the documents and listeners that follow from them; wrong ones are refused."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pipeline.api.described import Body, given_settings, setting_name
from pipeline.config.document import Document, key_and_value, on_command_line, read_document
from pipeline.show.progress import progress_for
from pipeline.store.progress import Progress, Silent
from pipeline.values.errors import InputError, argument, quoted
from pipeline.values.json_values import Written, plain


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
