"""`pressures` of which entries are rows, with a pressure for each cavity, instead of one pressure for all of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.section import in_sentences, read, read_each
from pipeline.config.units import PRESSURE, convert
from pipeline.values.errors import InputError

_KEY = "pressures"
#: pressures of all cavities, kPa
Row = tuple[float, ...]


@dataclass(frozen=True)
class PressureRows:
    """A configuration whose pressures are rows."""

    document: Document
    rows: tuple[Row, ...]

    def config(self, pressures_kPa: Sequence[float], values: Mapping[str, Any]) -> Config:
        """The configuration at these pressures instead of the rows, with other values by their keys.

        Messages name the file, and what the user has set. Raises InputError.
        """
        file, naming = self.document.path, self.document.naming
        given = {_KEY: [f"{pressure!r} kPa" for pressure in pressures_kPa], **values}
        made = self.document.with_values(
            list(given.items()), lambda key: f"{file}: {key}" if key in given else naming(key)
        )
        return read(Config, made)

    def wrong(self, complaint: str, *row: int) -> InputError:
        """The refusal of the pressures, or of the row with this number."""
        return self.document.wrong((_KEY, *row), complaint)


def has_rows(document: Document) -> bool:
    """True where an entry of the pressures is a list."""
    given = document.content.get(_KEY)
    return isinstance(given, list) and any(isinstance(entry, list) for entry in given)


def pressure_rows(document: Document, name: str, otherwise: str, check: Callable[[Row], None]) -> PressureRows | None:
    """The rows of a document; None where no entry of its pressures is a list.

    name: of such entries. otherwise: what is said of an entry that is none. check: raises ValueError for a row that is
    not allowed. Raises InputError for each wrong row, and beside fractions of cavities, which contradict them.
    """
    if not has_rows(document):
        return None
    effects = document.content.get("effects")
    pressure = effects.get("pressure") if isinstance(effects, Mapping) else None
    if isinstance(pressure, Mapping) and "cavities" in pressure:
        sentence = f"contradicts {name} of pressures, which say it already; leave it out"
        raise document.wrong(("effects", "pressure", "cavities"), sentence)

    def row(_: int, entry: Any) -> Row:
        if not isinstance(entry, list) or len(entry) < 2:
            raise ValueError(otherwise)
        values = tuple(convert(value, PRESSURE) for value in entry)
        check(values)
        return values

    with in_sentences(document):
        return PressureRows(document, tuple(read_each(dict(enumerate(document.content[_KEY])), row, (_KEY,)).values()))
