"""Numbers that users give, in calls and in files: finite, and as many as are needed."""

import math
import reprlib
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from geometry.arrays import Array
from rod.errors import RodError

#: lengths of the axes of an array: a number, or a letter that is the same number in all arrays of a table
Shape = tuple[int | str, ...]


def finite(value: Any, name: str) -> float:
    """A number as a finite float. Raises `RodError`, naming what it is, for anything else, texts too."""
    try:
        number = math.nan if isinstance(value, str | bytes | bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise RodError(f"{name} must be a finite number, not {reprlib.repr(value)}.")
    return number


def positive(value: Any, name: str) -> float:
    """A number above zero as a float. Raises `RodError`, naming what it is, for anything else."""
    number = finite(value, name)
    if number <= 0.0:
        raise RodError(f"{name} must be positive, not {number:g}.")
    return number


def numbers_in(value: Any) -> Array | None:
    """A number, or lists of numbers, as an array of floats of the same shape, NaN for None.

    None for anything else: texts, complex numbers, lists of different lengths.
    """
    try:
        array = np.array(value)
        return None if array.dtype.kind in "USc" else array.astype(float)
    except (TypeError, ValueError, OverflowError):
        return None


def check_table(
    table: Any, shapes: Mapping[str, Shape], name: str = "", sizes: Mapping[str, int] | None = None
) -> None:
    """Raise `RodError`, with the name of the table and of the key, unless every key has finite numbers of its shape.

    A letter stands for the size that most keys have, or for that in sizes.
    """
    of = f" of {name}" if name else ""
    if not isinstance(table, Mapping):
        raise RodError(f"{name or 'The file'} must have keys, and is {reprlib.repr(table)}.")
    missing = next((key for key in shapes if key not in table), None)
    if missing is not None:
        raise RodError(f"The key {missing!r}{of} is missing.")
    arrays = {key: numbers_in(table[key]) for key in shapes}
    counts = {**_usual(arrays, shapes), **(sizes or {})}
    for key, shape in shapes.items():
        expected = tuple(counts.get(size, -1) if isinstance(size, str) else size for size in shape)
        array = arrays[key]
        if array is None or array.shape != expected or not np.isfinite(array).all():
            size = " × ".join("n" if count == -1 else str(count) for count in expected) or "one"
            plural = "" if size in ("one", "1") else "s"
            raise RodError(f"{key}{of} must be {size} finite number{plural}{_instead(array, expected)}.")


def check_positive(table: Mapping[str, Any], keys: Sequence[str], name: str = "") -> None:
    """Raise `RodError`, with the name of the table and of the key, for a number that is not above zero."""
    for key in keys:
        smallest = float(np.min(table[key]))
        if smallest <= 0.0:
            raise RodError(f"{key}{f' of {name}' if name else ''} must be positive, and has {smallest:g}.")


def _usual(arrays: Mapping[str, Array | None], shapes: Mapping[str, Shape]) -> dict[str, int]:
    """The size that every letter has in most keys."""
    counts: dict[str, Counter[int]] = {}
    for key, shape in shapes.items():
        array = arrays[key]
        if array is not None and array.ndim == len(shape):
            for letter, size in zip(shape, array.shape, strict=True):
                if isinstance(letter, str):
                    counts.setdefault(letter, Counter())[size] += 1
    return {letter: sizes.most_common(1)[0][0] for letter, sizes in counts.items()}


def _instead(array: Array | None, expected: tuple[int, ...]) -> str:
    """What there is instead."""
    if array is None:
        return ", without texts and with lists of equal length"
    if array.shape == expected:
        return ", and has one that is none"
    return f", and has {' × '.join(map(str, array.shape)) or 'one'}"
