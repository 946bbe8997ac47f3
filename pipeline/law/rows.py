"""`pressures` whose entries are rows, with a pressure for each cavity, instead of one pressure for all of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from geometry import Reason
from pipeline.config import units
from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.load import checked, for_command
from pipeline.config.section import in_sentences, read, read_each
from pipeline.values.json_values import Written
from rod.arm_law.pairs import direction_of, fractions_of
from rod.same_pressure import Pressures, as_known, is_among

_KEY, _CAVITIES = "pressures", "effects.pressure.cavities"
_OTHERWISE = {
    "rows": "is no row of pressures; for example [20 kPa, 5 kPa, 0 kPa]",
    "pairs": "is not a pair of pressures; for example [[10 kPa, 0 kPa], [20 kPa, 5 kPa]]. `pneurod cell` takes rows "
    "for three chambers",
}


@dataclass(frozen=True)
class RowSpec:
    """An arm and the rows of pressures between which its law is measured."""

    config: Config  #: with the largest pressure of each row
    rows: tuple[Pressures, ...]


@dataclass(frozen=True)
class PairSpec:
    """A design with two cavities and the pairs of pressures at which it is solved."""

    document: Document
    name: str  #: of the design
    cavities: tuple[str, ...]
    rays: Mapping[float, tuple[float, ...]]  #: the larger pressures (kPa, rising) by direction, rising

    def config(self, direction: float, pressures_kPa: Sequence[float]) -> Config:
        """The configuration in which the cavity of the lower pressure has a fraction of the other. Raises InputError.

        pressures_kPa: the larger ones.
        """
        fractions = dict(zip(self.cavities, fractions_of(direction), strict=True))
        return _config(self.document, pressures_kPa, {_CAVITIES: fractions, "law_by_cavity": True})


def read_rows(document: Document) -> RowSpec | None:
    """The rows of a configuration whose pressures are lists; None for others. Raises InputError.

    Only a body with `geometry.symmetric: false` has rows.
    """
    if not document.has_rows:
        return None
    rows = _rows(document, "rows")
    config = _config(document, sorted({max(row) for row in rows}))
    cavities = config.design.cavities
    if not config.design.halves_differ:
        sentence = "rows of pressures are for a body with geometry.symmetric: false; list one pressure in each entry"
        raise document.wrong((_KEY,), sentence)
    for k, row in enumerate(rows):
        if len(row) != len(cavities):
            names = ", ".join(cavities)
            raise document.wrong((_KEY, k), f"has {len(row)} pressures; give one for each of the cavities {names}")
    return RowSpec(config, rows)


def for_cell(document: Document) -> tuple[RowSpec | Config, tuple[Reason, ...]]:
    """The rows or the configuration for `pneurod cell`, and notes on keys that it does not use. Raises InputError."""
    return for_command("cell", document, lambda one: read_rows(one) or checked(one))


def rows_of(config: Config) -> RowSpec:
    """The rows of an arm whose pressures keep the ratio of its cavities' fractions."""
    cavities = config.effects.pressure.cavities
    fractions = [cavities[name].fraction for name in config.design.cavities]
    return RowSpec(config, tuple(tuple(p * part for part in fractions) for p in config.pressures_kPa))


def read_pairs(document: Document) -> PairSpec | None:
    """The pairs of a configuration; None where its pressures are no pairs. Raises InputError."""
    if not document.has_rows:
        return None
    rays: dict[float, list[float]] = {}
    for k, row in enumerate(_rows(document, "pairs")):
        larger, direction = direction_of(row)
        direction = as_known([*rays], direction) if rays else direction
        if is_among(rays.setdefault(direction, []), larger):
            raise document.wrong((_KEY, k), "is there twice; list it once")
        rays[direction].append(larger)
    known = {direction: tuple(sorted(rays[direction])) for direction in sorted(rays)}
    config = _config(document, next(iter(known.values())))
    if len(names := config.design.cavities) != 2:
        count = f"pairs need a body with two cavities; this one has {', '.join(names)}"
        raise document.wrong((_KEY,), f"{count}; list one pressure in each entry, for example [10 kPa, 20 kPa]")
    return PairSpec(document, config.name, names, known)


def _rows(document: Document, name: str) -> tuple[Pressures, ...]:
    """The rows of a document; name: rows, or pairs. Raises InputError for wrong ones, and beside fractions."""
    effects = document.content.get("effects")
    pressure = effects.get("pressure") if isinstance(effects, Mapping) else None
    if isinstance(pressure, Mapping) and "cavities" in pressure:
        sentence = f"contradicts {name} of pressures, which say it already; leave it out"
        raise document.wrong(tuple(_CAVITIES.split(".")), sentence)
    if document.content.get("draft"):
        raise document.wrong(("draft",), f"is for one pressure in all cavities, not for {name}; leave it out")

    def row(_: int, entry: Any) -> Pressures:
        if not isinstance(entry, list) or len(entry) < 2 or (name == "pairs" and len(entry) > 2):
            raise ValueError(_OTHERWISE[name])
        values = tuple(units.convert(value, units.PRESSURE) for value in entry)
        if name == "rows" and (min(values) < 0.0 or not max(values)):
            raise ValueError("must have no pressure below 0 kPa, and one above")
        if name == "pairs" and not direction_of(values)[0]:
            raise ValueError("is a body at rest; give one of both pressures above 0 kPa")
        return values

    given = document.content[_KEY]
    with in_sentences(document):
        return tuple(read_each(dict(enumerate(given if isinstance(given, list) else ())), row, (_KEY,)).values())


def _config(document: Document, pressures_kPa: Sequence[float], values: Mapping[str, Written] | None = None) -> Config:
    """The configuration at these pressures instead of the rows, with other values by their keys.

    Messages name the file, and what the user has set. Raises InputError.
    """
    given = {_KEY: [f"{pressure!r} kPa" for pressure in pressures_kPa], **(values or {})}
    naming = document.naming
    made = document.with_values(
        list(given.items()), lambda key: f"{document.path}: {key}" if key in given else naming(key)
    )
    return read(Config, made)
