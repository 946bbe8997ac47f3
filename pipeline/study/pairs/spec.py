"""A configuration whose `pressures` are pairs, as configurations with one pressure: one for each ratio of both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.config.section import read
from pipeline.config.units import PRESSURE, convert
from pipeline.law.in_space.pressure_lists import pressure_lists
from rod.arm_law.pairs import direction_of, fractions_of
from rod.errors import RodError
from rod.same_pressure import as_known, is_among

_KEY, _CAVITIES = "pressures", "effects.pressure.cavities"
_ROWS = "`pneurod cell` takes rows for three chambers"
_EXAMPLE = "[[10 kPa, 0 kPa], [20 kPa, 5 kPa]]"


def folder_of(direction: float) -> str:
    """What the folder of a ratio is called: 1_to_0.25."""
    one, other = fractions_of(direction)
    return f"{one:.6g}_to_{other:.6g}"


@dataclass(frozen=True)
class PairSpec:
    """A design with two cavities and the pairs of pressures at which it is solved."""

    document: Document
    name: str  #: of the design
    cavities: tuple[str, str]
    rays: Mapping[float, tuple[float, ...]]  #: the larger pressures (kPa, rising) by direction, rising

    def config(self, direction: float, pressures_kPa: Sequence[float]) -> Config:
        """The configuration in which the cavity of the lower pressure has a fraction of the other. Raises InputError.

        pressures_kPa: the larger ones.
        """
        fractions = dict(zip(self.cavities, fractions_of(direction), strict=True))
        values = [(_CAVITIES, fractions), ("law_by_cavity", True)]
        return _read(self.document, [(_KEY, _texts(pressures_kPa)), *values])


def read_pairs(document: Document) -> PairSpec | None:
    """The pairs of a configuration; None where its pressures are no pairs. Raises InputError."""
    if (given := pressure_lists(document, "pairs")) is None:
        return None
    rays: dict[float, list[float]] = {}
    for k, entry in enumerate(given):
        larger, direction = _place(document, k, entry)
        direction = as_known([*rays], direction) if rays else direction
        if is_among(rays.setdefault(direction, []), larger):
            raise document.wrong((_KEY, k), "is there twice; list it once")
        rays[direction].append(larger)
    known = {direction: tuple(sorted(rays[direction])) for direction in sorted(rays)}
    config = _read(document, [(_KEY, _texts(next(iter(known.values()))))])
    if len(names := config.design.cavities) != 2:
        count = f"pairs need a body with two cavities; this one has {', '.join(names)}"
        raise document.wrong((_KEY,), f"{count}; list one pressure in each entry, for example [10 kPa, 20 kPa]")
    return PairSpec(document, config.name, (names[0], names[1]), known)


def _place(document: Document, k: int, entry: Any) -> tuple[float, float]:
    """The larger pressure (kPa) and the direction of an entry."""
    if not isinstance(entry, list) or len(entry) != 2:
        raise document.wrong((_KEY, k), f"is not a pair of pressures; for example {_EXAMPLE}. {_ROWS}")
    try:
        first, second = (convert(value, PRESSURE) for value in entry)
        larger, direction = direction_of((first, second))
    except (RodError, ValueError) as failure:
        raise document.wrong((_KEY, k), str(failure).rstrip(".")) from None
    if not larger:
        raise document.wrong((_KEY, k), "is a body at rest; give one of both pressures above 0 kPa")
    return larger, direction


def _texts(pressures_kPa: Sequence[float]) -> list[str]:
    return [f"{pressure!r} kPa" for pressure in pressures_kPa]


def _read(document: Document, values: Sequence[tuple[str, Any]]) -> Config:
    """A configuration with values that stand for the pairs; messages name the file, and what the user has set."""
    own = {key for key, _ in values}
    made = document.with_values(values, lambda key: f"{document.path}: {key}" if key in own else document.naming(key))
    return read(Config, made)
