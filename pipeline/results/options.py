"""Arguments with a unit: texts such as "30 mm", and in Python also numbers."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from pipeline.config import units
from pipeline.store.result_folder import ResultFolder, open_file
from pipeline.values.errors import InputError, argument, ask, quoted
from pipeline.values.json_values import plain


def option_value(name: str, given: Any, dimension: units.Dimension) -> float:
    """A number in the unit of its dimension. Raises InputError, naming the argument."""
    value = plain(given)
    if isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value):
        return float(value)
    return ask(argument(name), units.convert, value, dimension)


def write_new(file: Path, text: str) -> None:
    """Write a file, or again one that is there as this program wrote it.

    Raises InputError for another one, which a user made or changed, and for one that cannot be written.
    """
    folder = ResultFolder(open_file(file).parent)
    if file.exists() and not folder.was_made(file.name):
        raise InputError(f"{file}: exists and was not made by this command, or changed since; rename it")
    folder.save_text(file.name, text)


def option_pressures(name: str, given: Any) -> float | tuple[float, ...]:
    """A pressure, or those of all cavities, kPa. Raises InputError."""
    values = option_list(name, given, units.PRESSURE)
    return values if is_list(given) else values[0]


def option_list(name: str, given: Any, dimension: units.Dimension) -> tuple[float, ...]:
    """Numbers, written as [x, y]; one number is a list of one. Raises InputError."""
    if isinstance(given, str):
        values: Sequence[Any] = given.strip().removeprefix("[").removesuffix("]").split(",")
    else:
        values = plain(given) if is_list(given) else [given]
    return tuple(option_value(name, value, dimension) for value in values)


def option_vector(
    name: str, given: Any, dimension: units.Dimension
) -> tuple[float, float] | tuple[float, float, float]:
    """Two or three numbers, written as [x, y] or [x, y, z]. Raises InputError."""
    values = option_list(name, given, dimension)
    if len(values) not in (2, 3):
        raise InputError(
            f"{argument(name)}: {quoted(given)} is not a pair; write x and y, for example [0 {dimension.unit}, "
            f"{dimension.example}], and z for a load across the plane of the arm"
        )
    x, y, *across = values
    return (x, y, across[0]) if across else (x, y)


def is_list(given: Any) -> bool:
    """True for several values, also where they are written in one text."""
    value = plain(given)
    return value.strip().startswith("[") if isinstance(value, str) else isinstance(value, Sequence)
