"""Values of command-line options that are written with their unit."""

from pathlib import Path

from pipeline.config.units import Dimension, convert
from pipeline.errors import InputError
from pipeline.store.atomic_file import write_atomic
from pipeline.store.result_folder import open_file


def option_value(option: str, text: str, dimension: Dimension) -> float:
    """A number in the unit of its dimension. Raises InputError, naming the option."""
    try:
        return convert(text, dimension)
    except ValueError as failure:
        raise InputError(f"{option}: {failure}") from None


def write_new(file: Path, text: str) -> None:
    """Write a file that does not exist. Raises InputError for one that does, or that cannot be written."""
    if file.exists():
        raise InputError(f"{file}: exists; give another file")
    write_atomic(open_file(file), text.encode())


def option_pair(option: str, text: str, dimension: Dimension) -> tuple[float, float]:
    """Two numbers, written as [x, y]. Raises InputError, naming the option."""
    values = text.strip().removeprefix("[").removesuffix("]").split(",")
    if len(values) != 2:
        raise InputError(
            f"{option}: '{text}' is not a pair; write x and y, for example [0 {dimension.unit}, {dimension.example}]"
        )
    return option_value(option, values[0], dimension), option_value(option, values[1], dimension)
