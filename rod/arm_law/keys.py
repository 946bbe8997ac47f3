"""Values as rows of a file: the key of a field, and the lengths of its axes, stand with its type.

    kappa: Annotated[Array, "kappa_per_mm", "k"]

has the key kappa_per_mm and one axis; a letter is the same number in all fields of a row. Fields that are empty by
default may be missing in a row.
"""

from collections.abc import Collection, Mapping
from dataclasses import MISSING, Field, fields
from typing import Any, TypeVar, get_args

import numpy as np

from rod.checked import Shape, check_table
from rod.errors import RodError

Value = TypeVar("Value")


def key_of(field: "Field[Any]") -> str:
    """The key of a field in a file; empty for a field without one."""
    known = get_args(field.type)
    return str(known[1]) if len(known) > 1 and isinstance(known[1], str) else ""


def keys_of(kind: type[Any]) -> dict[str, str]:
    """The keys of those fields that have one, by field."""
    return {field.name: key for field in fields(kind) if (key := key_of(field))}


def shapes_of(kind: type[Any], given: Collection[str] = ()) -> dict[str, Shape]:
    """By the key of a field in the file, of those that it must have or that are given."""
    keys = {key: field for field in fields(kind) if (key := key_of(field))}
    return {key: get_args(field.type)[2:] for key, field in keys.items() if key in given or not _may_be_missing(field)}


def record_of(value: Any) -> dict[str, Any]:
    """One value under the keys of the file."""
    known = [field for field in fields(value) if key_of(field)]
    known = [field for field in known if not (_may_be_missing(field) and getattr(value, field.name).size == 0)]
    values = {key_of(field): getattr(value, field.name) for field in known}
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in values.items()}


def curve_of(kind: type[Value], row: Mapping[str, Any]) -> Value:
    """A value from a row that `record_of` made."""
    return kind(**_given(kind, row))


def fields_of(kind: type[Any], row: Any, name: str = "") -> dict[str, Any]:
    """Numbers of a value from its row, by field. Raises `RodError`, with the name of the row, for another content."""
    check_table(row, shapes_of(kind, row if isinstance(row, Mapping) else ()), name)
    return _numbers(kind, row)


def value_of(kind: type[Value], row: Any, name: str) -> Value:
    """A value of nothing but numbers from its row. Raises `RodError` as `fields_of` does."""
    return kind(**fields_of(kind, row, name))


def values_of(kind: type[Value], rows: Any, name: str, rising: Collection[str] = ()) -> tuple[Value, ...]:
    """Values from a list of rows; rising: keys of numbers that rise. Raises `RodError` as `value_of` does."""
    if not isinstance(rows, list):
        raise RodError(f"{name} must be a list of curves.")
    for k, row in enumerate(rows):
        check_table(row, shapes_of(kind, row if isinstance(row, Mapping) else ()), f"{name}[{k}]")
        for key in frozenset(rising).intersection(row):
            if np.any(np.diff(row[key]) <= 0.0):
                raise RodError(f"{key} of {name}[{k}] must rise.")
    return tuple(kind(**_numbers(kind, row)) for row in rows)


def _given(kind: type[Any], row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: row[key] for name, key in keys_of(kind).items() if key in row}


def _numbers(kind: type[Any], row: Mapping[str, Any]) -> dict[str, Any]:
    """By field: numbers, and arrays of them."""
    single = {field.name for field in fields(kind) if get_args(field.type)[:1] == (float,)}
    return {name: float(value) if name in single else np.array(value) for name, value in _given(kind, row).items()}


def _may_be_missing(field: "Field[Any]") -> bool:
    return field.default_factory is not MISSING
