"""Values of arguments that are written with their unit."""

from pathlib import Path

from pipeline.config.units import Dimension, convert
from pipeline.store.atomic_file import write_atomic
from pipeline.store.result_folder import open_file
from pipeline.values.errors import InputError, argument


def option_value(name: str, text: str, dimension: Dimension) -> float:
    """A number in the unit of its dimension. Raises InputError, naming the argument."""
    try:
        return convert(text, dimension)
    except ValueError as failure:
        raise InputError(f"{argument(name)}: {failure}") from None


def write_new(file: Path, text: str) -> None:
    """Write a file that does not exist. Raises InputError for one that does, or that cannot be written."""
    if file.exists():
        raise InputError(f"{file}: exists; give another file")
    write_atomic(open_file(file), text.encode())


def option_pair(name: str, text: str, dimension: Dimension) -> tuple[float, float]:
    """Two numbers, written as [x, y]. Raises InputError."""
    values = option_vector(name, text, dimension)
    if len(values) != 2:
        raise InputError(f"{argument(name)}: '{text}' is not a pair; write x and y")
    return values


def option_list(name: str, text: str, dimension: Dimension) -> tuple[float, ...]:
    """Numbers, written as [x, y]. Raises InputError."""
    values = text.strip().removeprefix("[").removesuffix("]").split(",")
    return tuple(option_value(name, value, dimension) for value in values)


def option_vector(name: str, text: str, dimension: Dimension) -> tuple[float, float] | tuple[float, float, float]:
    """Two or three numbers, written as [x, y] or [x, y, z]. Raises InputError."""
    values = text.strip().removeprefix("[").removesuffix("]").split(",")
    if len(values) not in (2, 3):
        raise InputError(
            f"{argument(name)}: '{text}' is not a pair; write x and y, for example [0 {dimension.unit}, "
            f"{dimension.example}], and z for a load across the plane of the arm"
        )
    x, y, *across = (option_value(name, value, dimension) for value in values)
    return (x, y, across[0]) if across else (x, y)
