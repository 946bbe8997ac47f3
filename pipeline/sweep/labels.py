"""Short labels for the values of an axis that are words or whole sections of a configuration."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.errors import shortened

#: characters of a label; longer values are numbered
LONGEST_LABEL = 12


@dataclass(frozen=True)
class Labels:
    """Values of a column of the table where some are texts, and how they are written below a panel."""

    values: tuple[Any, ...]  #: as in the table, each once
    short: tuple[str, ...]  #: one for each
    legend: tuple[str, ...]  #: what numbers among them stand for, one line each; empty without numbers

    @staticmethod
    def of(cells: Sequence[Any]) -> "Labels | None":
        """Of the cells of a column; None where all are numbers."""
        values = tuple(dict.fromkeys(cells))
        if not any(isinstance(value, str) for value in values):
            return None
        texts = tuple(f"{value:g}" if isinstance(value, float) else str(value) for value in values)
        if all(len(text) <= LONGEST_LABEL for text in texts):
            return Labels(values, texts, ())
        laws = tuple(map(_law, texts))
        if all(laws) and len(set(laws)) == len(laws):
            return Labels(values, laws, ())
        numbers = tuple(str(number) for number in range(1, len(values) + 1))
        return Labels(values, numbers, tuple(f"{n}: {shortened(text)}" for n, text in zip(numbers, texts, strict=True)))

    def place(self, value: Any) -> int:
        """The position of a value on the axis of a panel."""
        return self.values.index(value)


def _law(text: str) -> str:
    """The law of a material that is written as a section; empty for other values."""
    try:
        section = json.loads(text)
    except ValueError:
        return ""
    return str(section.get("law", "")) if isinstance(section, dict) else ""
