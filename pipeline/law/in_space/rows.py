"""A configuration of an arm that bends in space, with the rows of pressures between which its law is measured."""

from dataclasses import dataclass

from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.law.in_space.pressure_lists import Row, pressure_rows
from pipeline.law.in_space.states import Pressures


@dataclass(frozen=True)
class RowSpec:
    """An arm and its rows of pressures."""

    config: Config  #: with the largest pressure of each row
    rows: tuple[Pressures, ...]  #: kPa, a pressure for each cavity


def read_rows(document: Document) -> RowSpec | None:
    """The rows of a configuration whose pressures are lists; None for others. Raises InputError.

    Only a body with `geometry.symmetric: false` has rows.
    """
    otherwise = "is no row of pressures; for example [20 kPa, 5 kPa, 0 kPa]"
    if (given := pressure_rows(document, "rows", otherwise, _check)) is None:
        return None
    config = given.config(sorted({max(row) for row in given.rows}), {})
    cavities = config.design.cavities
    if not config.design.halves_differ:
        sentence = "rows of pressures are for a body with geometry.symmetric: false; list one pressure in each entry"
        raise given.wrong(sentence)
    for k, row in enumerate(given.rows):
        if len(row) != len(cavities):
            names = ", ".join(cavities)
            raise given.wrong(f"has {len(row)} pressures; give one for each of the cavities {names}", k)
    return RowSpec(config, given.rows)


def rows_of(config: Config) -> RowSpec:
    """The rows of an arm whose pressures keep the ratio of its cavities' fractions."""
    cavities = config.effects.pressure.cavities
    fractions = [cavities[name].fraction for name in config.design.cavities]
    return RowSpec(config, tuple(tuple(p * part for part in fractions) for p in config.pressures_kPa))


def _check(row: Row) -> None:
    """Raise ValueError for a vacuum, and for a body at rest."""
    if min(row) < 0.0 or not max(row):
        raise ValueError("must have no pressure below 0 kPa, and one above")
