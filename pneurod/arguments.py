"""Arguments of the Python interface whose type is wrong, refused in one sentence."""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pipeline.config.units import PRESSURE, Dimension, convert
from pipeline.store.result_folder import FolderWords
from pipeline.values.errors import InputError, quoted
from rod.checked import finite

#: numbers with their unit and words as texts, plain numbers, and lists of them
Setting = str | float | bool | Sequence[Any] | Mapping[str, Any]
_SETTING = 'a text such as "6 mm", a plain number, true or false, or a list of these'
#: how the refusal of a result folder names what was given in Python
IN_PYTHON = FolderWords(out="out", joint="=", fresh="fresh=True")


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
    plain = _plain(value)
    if not isinstance(plain, bool):
        raise InputError(f"{name}: {quoted(value)} is not allowed; give True or False")
    return plain


def given_pressure(value: Any) -> float:
    """kPa, of a number or a text with its unit. Raises InputError for anything else."""
    pressure = given_number(value, PRESSURE, "pressure_kPa")
    if pressure is None:
        raise InputError("pressure_kPa: None is no pressure; write it in kPa or as 12 kPa")
    return pressure


def given_number(value: Any, dimension: Dimension, name: str) -> float | None:
    """A number in the unit of a dimension, of a number or a text with its unit; None for None. Raises InputError."""
    if value is None:
        return None
    try:
        return convert(value, dimension) if isinstance(value, str) else finite(value, name)
    except ValueError as failure:  # a RodError is one
        raise InputError(f"{name}: {failure}") from None


def given_pair(values: Any, dimension: Dimension, name: str) -> tuple[float, float]:
    """Two such numbers. Raises InputError for anything else."""
    pair = _plain(values)
    if not isinstance(pair, Sequence) or isinstance(pair, str) or len(pair) != 2 or None in pair:
        raise InputError(f"{name}: {quoted(values)} is no pair; give x and y, for example (30.0, -40.0)")
    x, y = (given_number(value, dimension, name) or 0.0 for value in pair)
    return x, y


def given_jobs(value: Any) -> int | None:
    """A number of processes, or None. Raises InputError for anything else."""
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or value < 1):
        raise InputError(f"jobs: {value!r} is not allowed; give a whole number from 1 on")
    return value


def given_settings(given: Any, naming: Callable[[str], str] | None = None) -> list[tuple[str, Any]]:
    """The keys and values of `settings`, arrays as lists. Raises InputError, naming the key, for what is none."""
    if given is None:
        return []
    if not isinstance(given, Mapping):
        raise InputError('settings: give values by their keys, for example {"mesh.size": "6 mm"}')
    for key in given:
        if not isinstance(key, str):
            raise InputError(f'settings: {quoted(key)} is not a key; keys are texts such as "mesh.size"')
    return [(key, _setting(value, (naming or setting_name)(key))) for key, value in given.items()]


def setting_name(key: str) -> str:
    """One of the settings, as messages name it: settings["mesh.size"]."""
    return f'settings["{key}"]'


def _setting(value: Any, name: str) -> Any:
    plain = _plain(value)
    if isinstance(plain, str | float | int):
        return plain
    if isinstance(plain, Mapping):
        return {key: _setting(entry, name) for key, entry in plain.items()}
    if isinstance(plain, Sequence) and not isinstance(plain, bytes | bytearray):
        return [_setting(entry, name) for entry in plain]
    raise InputError(f"{name}: {quoted(value)} is not allowed; give {_SETTING}")


def _plain(value: Any) -> Any:
    """Numbers, arrays and columns of numpy and pandas as numbers and lists of Python."""
    to_list = getattr(value, "tolist", None)
    return to_list() if callable(to_list) else value
