"""Which pressure is meant: one written with six digits, as they are printed, is the one of a file with all its digits.

A number written with six digits differs from the number itself by less than SAME, and two that differ by more than SAME
are written differently. Configurations therefore refuse two pressures of a run that are the same.
"""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import numpy as np

from geometry.arrays import Array
from rod.checked import Amount, finite
from rod.errors import RodError

#: kPa, of the cavities of an arm in their order; of an arm with one pressure that one alone
Pressures: TypeAlias = tuple[float, ...]

#: largest difference of two pressures that are the same, over the larger one
SAME = 1e-5


def pressures_of(given: Amount | Sequence[Amount], cavities: Sequence[str]) -> Pressures:
    """A pressure in kPa for each cavity; one alone is a tuple of one. Raises `RodError` for another number of them."""
    values = (given,) if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray) else given
    found = tuple(finite(value, "The pressure", "kPa") for value in values)
    if len(found) != len(cavities):
        if len(cavities) == 1:
            raise RodError("This rod has one pressure; give it alone, such as 20 kPa.")
        example = ", ".join(["20 kPa", "5 kPa", *["0 kPa"] * (len(cavities) - 2)])
        raise RodError(f"This law has the pressures of {', '.join(cavities)}; give all, such as [{example}].")
    return found


def ratios_of(rows: Iterable[Pressures]) -> tuple[Pressures, ...]:
    """The ratios of rows of pressures, each as parts of the largest pressure; without the row of an arm at rest."""
    highest = [row for row in rows if max(row) > 0.0]
    return tuple(dict.fromkeys(tuple(float(f"{p / max(row):.9g}") for p in row) for row in highest))


def is_same(pressure: float, other: float) -> bool:
    """Whether two pressures (kPa) are the same."""
    return abs(pressure - other) <= SAME * max(abs(pressure), abs(other))


def known_at(pressures: Sequence[float] | Array, pressure: float) -> int | None:
    """The position of a pressure (kPa) among known ones, at least one; None where it is none of them."""
    nearest = int(np.argmin(np.abs(np.asarray(pressures, float) - pressure)))
    return nearest if is_same(float(pressures[nearest]), pressure) else None


def is_among(pressures: Iterable[float], pressure: float) -> bool:
    """Whether a pressure (kPa) is one of these."""
    return any(is_same(known, pressure) for known in pressures)


def as_known(pressures: Sequence[float] | Array, pressure: float) -> float:
    """The known pressure (kPa) that is the same as a pressure, or else the pressure itself."""
    k = known_at(pressures, pressure)
    return pressure if k is None else float(pressures[k])
