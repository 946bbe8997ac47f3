"""How numbers are written: on the page of the report, on the terminal and in the verdict."""

import math
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

#: digits that a number without a standard deviation is written with
DIGITS = 4
#: the smallest number of per cent that is written
LEAST_PERCENT = 0.001


def number(value: Any) -> str:
    """A number in four digits, without an exponent between 1e-4 and 1e5."""
    if value is None:
        return "-"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if value == 0 or 1e-4 <= abs(value) < 1e5:
        return f"{Decimal(f'{value:.{DIGITS - 1}e}').normalize():f}"
    return f"{value:.3e}"


def percent(value: float | None) -> str:
    """A fraction in per cent with two digits; what is smaller than LEAST_PERCENT is not told from zero."""
    if value is None:
        return "-"
    if 0.0 < abs(100.0 * value) < LEAST_PERCENT:
        return f"<{LEAST_PERCENT:g} %"
    return f"{number(float(f'{100 * value:.2g}'))} %"


def duration(seconds: float) -> str:
    """A time in seconds, or in minutes and seconds."""
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes >= 2 else f"{round(seconds)} s"


def listed(words: Sequence[str]) -> str:
    """The words in one sentence: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def round_down(value: float, digits: int) -> float:
    """A positive number rounded down to significant digits."""
    decimals = digits - 1 - math.floor(math.log10(value))
    return round(math.floor(value * 10.0**decimals + 1e-9) / 10.0**decimals, decimals)
