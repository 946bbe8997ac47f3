"""How numbers are written: on the page of the report, on the terminal and in the verdict."""

import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import Any

#: digits that a number without a standard deviation is written with
DIGITS = 4
#: digits of a standard deviation
MOST_DIGITS = 3
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


def rounded(count: int) -> str:
    """A predicted number to two digits."""
    return f"{int(float(f'{count:.2g}'))}"


def duration(seconds: float) -> str:
    """A time in seconds, or in minutes and seconds."""
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes >= 2 else f"{round(seconds)} s"


def listed(words: Sequence[str]) -> str:
    """The words in one sentence: a, b and c."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""


def fixed(value: float, decimals: int) -> str:
    """A number with this many decimals, fewer than none round tens and hundreds; a negative number that is rounded to
    zero has no sign."""
    text = f"{value if decimals >= 0 else round(value, decimals):.{max(decimals, 0)}f}"
    return text.removeprefix("-") if not text.strip("-0.") else text


def decimals_of(values: Iterable[float | None], spreads: Iterable[float | None]) -> int:
    """Decimals with which a quantity is written wherever it stands.

    The smallest standard deviation decides: one digit of it is kept, two where it begins with 1 or 2. No value has more
    than four digits. Without a standard deviation the largest value has four digits.
    """
    known = [abs(value) for value in values if value is not None and math.isfinite(value) and value]
    allowed = DIGITS - 1 - math.floor(math.log10(max(known))) if known else 2
    smallest = min((s for s in spreads if s is not None and math.isfinite(s) and s > 0.0), default=None)
    if smallest is None:
        return max(0, allowed)
    exponent = math.floor(math.log10(smallest))
    digits = 2 if smallest < 2.95 * 10.0**exponent else 1
    return max(0, min(allowed, digits - 1 - exponent))


def with_spread(value: float | None, spread: float | None, decimals: int) -> str:
    """A number with its standard deviation; a deviation that would be rounded to zero is rounded up, and of a large one
    three digits are written."""
    if value is None or not math.isfinite(value):
        return "-"
    if spread is None or not math.isfinite(spread) or spread <= 0.0:
        return fixed(value, decimals)
    decimals = decimals_beside(spread, decimals)
    return f"{fixed(value, decimals)} ± {fixed(max(spread, 10.0**-decimals), decimals)}"


def decimals_beside(spread: float | None, decimals: int) -> int:
    """Decimals of a number with this standard deviation, of which not more than MOST_DIGITS digits are written."""
    if spread is None or not math.isfinite(spread) or spread <= 10.0**-decimals:
        return decimals
    return min(decimals, MOST_DIGITS - 1 - math.floor(math.log10(spread)))


def interval(bounds: Sequence[float] | None, decimals: int) -> str:
    """The two ends of an interval; empty where there is none."""
    return "" if bounds is None else f"{fixed(bounds[0], decimals)} … {fixed(bounds[1], decimals)}"


def round_down(value: float, digits: int) -> float:
    """A positive number rounded down to significant digits."""
    decimals = digits - 1 - math.floor(math.log10(value))
    return round(math.floor(value * 10.0**decimals + 1e-9) / 10.0**decimals, decimals)
