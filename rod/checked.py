"""Numbers that users give in calls: finite."""

import math
import reprlib
from typing import Any

import numpy as np

from geometry.arrays import Array
from rod.errors import RodError


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
