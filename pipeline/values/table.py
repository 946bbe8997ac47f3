"""Tables of texts, as reports, pages and the terminal show them."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

T = TypeVar("T")
#: a cell with a number, perhaps with its unit or a second number
_NUMBER = re.compile(r"[-+<]?\d.{,40}", re.DOTALL)
#: what stands for numbers that are none
_WORDS = {"nan": "unknown", "inf": "infinite", "-inf": "infinite"}


@dataclass(frozen=True)
class Table:
    """A table of texts."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""

    def __post_init__(self) -> None:
        rows = tuple(tuple(_WORDS.get(cell, cell) for cell in row) for row in self.rows)
        object.__setattr__(self, "rows", rows)

    @staticmethod
    def of(items: Iterable[T], *columns: tuple[str, Callable[[T], str]], caption: str = "") -> "Table":
        """A table with a row for each item; columns: the head of each, and what it shows of an item."""
        rows = tuple(tuple(cell(item) for _, cell in columns) for item in items)
        return Table(tuple(head for head, _ in columns), rows, caption)

    def __str__(self) -> str:
        """As lines of text, numbers at the right of their columns."""
        rows = [self.heads, *self.rows]
        wide = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
        sides = ["<" if number in self.words else ">" for number in range(len(wide))]
        told = (
            "  ".join(f"{c:{side}{w}}" for c, side, w in zip(row, sides, wide, strict=True)).rstrip() for row in rows
        )
        return "\n".join([*told, *filter(None, [self.caption])])

    def __bool__(self) -> bool:
        """Whether it has rows."""
        return bool(self.rows)

    @property
    def words(self) -> frozenset[int]:
        """Positions of the columns that hold no numbers, whose cells begin at the left."""
        columns = enumerate(zip(*self.rows, strict=True))
        return frozenset(number for number, cells in columns if not any(map(_NUMBER.fullmatch, cells)))
