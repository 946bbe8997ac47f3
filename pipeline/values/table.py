"""The table of texts that reports, pages and the terminal show."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table of texts."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""

    @property
    def words(self) -> frozenset[int]:
        """Positions of the columns that hold no numbers, whose cells begin at the left."""
        columns = enumerate(zip(*self.rows, strict=True))
        return frozenset(number for number, cells in columns if not any(map(_NUMBER.fullmatch, cells)))
