"""A configuration whose `pressures` are pairs, as configurations with one pressure: one for each ratio of both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pipeline.config.config import Config
from pipeline.config.document import Document
from pipeline.law.in_space.pressure_lists import PressureRows, Row, pressure_rows
from rod.arm_law.pairs import direction_of, fractions_of
from rod.same_pressure import as_known, is_among

_CAVITIES = "effects.pressure.cavities"
_OTHERWISE = (
    "is not a pair of pressures; for example [[10 kPa, 0 kPa], [20 kPa, 5 kPa]]. `pneurod cell` takes rows for three "
    "chambers"
)


@dataclass(frozen=True)
class PairSpec:
    """A design with two cavities and the pairs of pressures at which it is solved."""

    given: PressureRows
    name: str  #: of the design
    cavities: tuple[str, str]
    rays: Mapping[float, tuple[float, ...]]  #: the larger pressures (kPa, rising) by direction, rising

    def config(self, direction: float, pressures_kPa: Sequence[float]) -> Config:
        """The configuration in which the cavity of the lower pressure has a fraction of the other. Raises InputError.

        pressures_kPa: the larger ones.
        """
        fractions = dict(zip(self.cavities, fractions_of(direction), strict=True))
        return self.given.config(pressures_kPa, {_CAVITIES: fractions, "law_by_cavity": True})


def read_pairs(document: Document) -> PairSpec | None:
    """The pairs of a configuration; None where its pressures are no pairs. Raises InputError."""
    if (given := pressure_rows(document, "pairs", _OTHERWISE, _check)) is None:
        return None
    rays: dict[float, list[float]] = {}
    for k, row in enumerate(given.rows):
        larger, direction = direction_of((row[0], row[1]))
        direction = as_known([*rays], direction) if rays else direction
        if is_among(rays.setdefault(direction, []), larger):
            raise given.wrong("is there twice; list it once", k)
        rays[direction].append(larger)
    known = {direction: tuple(sorted(rays[direction])) for direction in sorted(rays)}
    config = given.config(next(iter(known.values())), {})
    if len(names := config.design.cavities) != 2:
        count = f"pairs need a body with two cavities; this one has {', '.join(names)}"
        raise given.wrong(f"{count}; list one pressure in each entry, for example [10 kPa, 20 kPa]")
    return PairSpec(given, config.name, (names[0], names[1]), known)


def _check(row: Row) -> None:
    """Raise ValueError for what is no pair, and for a body at rest."""
    if len(row) != 2:
        raise ValueError(_OTHERWISE)
    if not direction_of((row[0], row[1]))[0]:
        raise ValueError("is a body at rest; give one of both pressures above 0 kPa")
