"""The table of texts that reports, pages and the terminal show."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table of texts."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
