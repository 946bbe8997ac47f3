"""Numbers that users give in calls: finite, also as texts with a unit."""

import math
import reprlib
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from geometry.units import USUAL, with_unit
from rod.errors import RodError

#: a number in the unit inside, or a text with its unit, such as "20 mm"
Amount: TypeAlias = float | str
#: a field for which such an amount is given, and which is the number
Given: TypeAlias = Any


def finite(value: Any, name: str, unit: str = "") -> float:
    """A number, or with a unit a text such as "20 mm", as a finite float. Raises `RodError` for anything else."""
    given: Any = with_unit(value, USUAL.get(unit, {})) if isinstance(value, str) and unit else value
    try:
        number = math.nan if isinstance(given, str | bytes | bool) else float(given)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        written = f"; write it in {unit}, or with its unit" if unit else ""
        raise RodError(f"{name} must be a finite number, not {reprlib.repr(value)}{written}.")
    return number


def positive(value: Any, name: str, unit: str = "") -> float:
    """A number above zero as a float, given as for `finite`. Raises `RodError` for anything else."""
    number = finite(value, name, unit)
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
