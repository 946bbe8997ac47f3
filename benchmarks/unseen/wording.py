"""Words and numbers that both pages write in the same way."""

from collections.abc import Mapping
from textwrap import fill
from typing import Any

WIDTH = 118  #: characters of a line

Record = Mapping[str, Any]


def name_of(record: Record) -> str:
    """Seed and number of a design."""
    return f"{record['seed']}-{record['number']}"


def percent(value: float) -> str:
    """Two digits, or whole per cents."""
    return f"{100 * value:.2g} %" if abs(value) < 0.995 else f"{100 * value:.0f} %"


def share(value: float) -> str:
    """With one decimal, so that a goal that is narrowly missed does not look met."""
    return f"{100 * value:.1f} %"


def item(line: str) -> str:
    """An entry of a list."""
    return fill(line.rstrip(".") + ".", WIDTH, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)
