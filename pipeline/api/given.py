"""Arguments of the functions, and the documents and listeners that follow from them; wrong ones are refused."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pipeline.api.described import Body, Setting, given_settings, plain, setting_name
from pipeline.config.document import Document, key_and_value, on_command_line, read_document
from pipeline.config.units import LENGTH, PRESSURE, Dimension, convert
from pipeline.show.progress import progress_for
from pipeline.store.progress import Progress, Silent
from pipeline.values.errors import InputError, argument, quoted


def given_path(value: Any, name: str, example: str) -> Path:
    """A path that is given as a text or as a `Path`. Raises InputError, naming the argument, for anything else."""
    try:
        text = os.fspath(value)
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


def given_pressure(value: Any) -> float:
    """kPa, of a number or a text with its unit. Raises InputError for anything else."""
    pressure = given_number(value, PRESSURE, "pressure_kPa")
    if pressure is None:
        raise InputError("pressure_kPa: None is no pressure; write it in kPa or as 12 kPa")
    return pressure


def given_number(value: Any, dimension: Dimension, name: str) -> float | None:
    """A number in the unit of a dimension, of a number or a text with its unit; None for None. Raises InputError."""
    from rod.checked import finite

    if value is None:
        return None
    try:
        return convert(value, dimension) if isinstance(value, str) else finite(value, name)
    except ValueError as failure:  # a RodError is one
        raise InputError(f"{name}: {failure}") from None


def given_pressures(value: Any) -> float | tuple[float, ...]:
    """A pressure, or a sequence of those of all cavities. Raises InputError for anything else."""
    pressures = plain(value)
    if isinstance(pressures, Sequence) and not isinstance(pressures, str | bytes):
        return tuple(given_pressure(one) for one in pressures)
    return given_pressure(value)


def given_place(values: Any, name: str) -> tuple[float, float] | tuple[float, float, float]:
    """Two or three lengths. Raises InputError for anything else."""
    place = plain(values)
    if not isinstance(place, Sequence) or isinstance(place, str) or len(place) not in (2, 3) or None in place:
        raise InputError(f"{name}: {quoted(values)} is no pair; give x and y, for example (30.0, -40.0)")
    x, y, *across = (given_number(value, LENGTH, name) or 0.0 for value in place)
    return (x, y, across[0]) if across else (x, y)


def given_jobs(value: Any) -> int | None:
    """A number of processes, or None. Raises InputError for anything else."""
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
        raise InputError(f"jobs: {value!r} is not allowed; give a whole number from 1 on")
    return value


def document_of(
    config: Path | str | Body, arguments: Mapping[str, Any], settings: Mapping[str, Setting] | Sequence[str] | None
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
        keys = [("name", str(config.values["family"])), ("geometry", config.values)]
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
