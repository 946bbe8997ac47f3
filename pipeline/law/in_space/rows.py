"""A configuration of an arm that bends in space, with the rows of pressures between which its law is measured."""

from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.section import read
from pipeline.config.units import PRESSURE, convert
from pipeline.law.in_space.pressure_lists import pressure_lists
from pipeline.law.in_space.states import Pressures

_KEY = "pressures"


@dataclass(frozen=True)
class RowSpec:
    """An arm and its rows of pressures."""

    config: Config  #: with the largest pressure of each row
    rows: tuple[Pressures, ...]  #: kPa, a pressure for each cavity


def read_rows(document: Document) -> RowSpec | None:
    """The rows of a configuration whose pressures are lists; None for others. Raises InputError.

    Only a body with `geometry.symmetric: false` has rows.
    """
    if (given := pressure_lists(document, "rows")) is None:
        return None
    rows = [_row(document, k, entry) for k, entry in enumerate(given)]
    highest = sorted({max(row) for row in rows})
    values = [(_KEY, [f"{pressure!r} kPa" for pressure in highest])]
    made = document.with_values(values, lambda key: f"{document.path}: {key}" if key == _KEY else document.naming(key))
    config = read(Config, made)
    cavities = config.design.cavities
    if not config.design.halves_differ:
        sentence = "rows of pressures are for a body with geometry.symmetric: false; list one pressure in each entry"
        raise document.wrong((_KEY,), sentence)
    for k, row in enumerate(rows):
        if len(row) != len(cavities):
            names = ", ".join(cavities)
            raise document.wrong((_KEY, k), f"has {len(row)} pressures; give one for each of the cavities {names}")
    return RowSpec(config, tuple(rows))


def rows_of(config: Config) -> RowSpec:
    """The rows of an arm whose pressures keep the ratio of its cavities' fractions."""
    cavities = config.effects.pressure.cavities
    fractions = [cavities[name].fraction for name in config.design.cavities]
    return RowSpec(config, tuple(tuple(p * part for part in fractions) for p in config.pressures_kPa))


def _row(document: Document, k: int, entry: object) -> Pressures:
    example = "[20 kPa, 5 kPa, 0 kPa]"
    if not isinstance(entry, Sequence) or isinstance(entry, str) or len(entry) < 2:
        raise document.wrong((_KEY, k), f"is no row of pressures; for example {example}")
    try:
        row = tuple(convert(value, PRESSURE) for value in entry)
    except ValueError as failure:
        raise document.wrong((_KEY, k), str(failure).rstrip(".")) from None
    if min(row) < 0.0 or not max(row):
        raise document.wrong((_KEY, k), "must have no pressure below 0 kPa, and one above")
    return row
