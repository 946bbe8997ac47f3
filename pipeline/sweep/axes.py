"""The axes of a sweep: lists and ranges of the values of a key, keys that change together, a Latin hypercube."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import isfinite
from typing import Any, TypeAlias

import numpy as np

from geometry.arrays import Array
from pipeline.config.units import in_unit_of, number_and_unit
from pipeline.errors import quoted

#: a value as it stands in YAML: a text with its unit, a number, a word, a list
Value: TypeAlias = Any
#: the values of some keys at one point, by dotted key
Setting: TypeAlias = Mapping[str, Value]

#: more points than this are refused: a mistyped range is more likely than so many designs
MOST_POINTS = 100_000
#: significant digits of the values of a range
DIGITS = 6


@dataclass(frozen=True)
class Axis:
    """Keys that change together, with the values that they take one after the other."""

    settings: tuple[Setting, ...]  #: not empty; all have the same keys
    is_drawn: bool = False  #: whether its values are drawn at random

    @property
    def keys(self) -> tuple[str, ...]:
        """The dotted keys."""
        return tuple(self.settings[0])


@dataclass(frozen=True)
class _Ends:
    """The two ends of a range, in the unit of the first."""

    low: float
    high: float
    unit: str  #: empty for plain numbers
    whole: bool  #: whether both ends are whole numbers without a unit

    @staticmethod
    def of(content: Mapping[str, Value]) -> "_Ends":
        """Raises ValueError."""
        low, high = content["from"], content["to"]
        check_value([low, high])
        measured = number_and_unit(low)
        if measured:
            number, unit = in_unit_of(low, measured[1]), measured[1]
            return _Ends(number, in_unit_of(high, unit), unit, whole=False)
        for end in (low, high):
            if isinstance(end, bool) or not isinstance(end, int | float):
                raise ValueError(f"{quoted(end)} is no end of a range; for example {{from: 8 mm, to: 16 mm}}")
        return _Ends(float(low), float(high), "", whole=isinstance(low, int) and isinstance(high, int))

    def values(self, fractions: Array) -> list[Value]:
        """The values at fractions (n,) of the range, as they stand in YAML."""
        numbers = [float(f"{value:.{DIGITS}g}") for value in self.low + fractions * (self.high - self.low)]
        if self.unit:
            return [f"{number:g} {self.unit}" for number in numbers]
        return [int(number) if self.whole and number.is_integer() else number for number in numbers]

    def drawn(self, fractions: Array) -> list[Value]:
        """The same for a Latin hypercube, where whole numbers between the ends are equally probable."""
        if not self.whole:
            return self.values(fractions)
        low, high = sorted((int(self.low), int(self.high)))
        return [min(high, low + int(fraction * (high - low + 1))) for fraction in fractions]


def switch_as_word(value: Value) -> Value:
    """on or off for a switch, as it is written in a file, which YAML reads as true or false; else the value itself."""
    return {True: "on", False: "off"}[value] if isinstance(value, bool) else value


def check_value(value: Value) -> None:
    """Raise ValueError for what no configuration can hold: a date or a set, and a number that is not finite."""
    if isinstance(value, float) and not isfinite(value):
        raise ValueError(f"{quoted(value)} is not a finite number; give one, with its unit")
    if value is not None and not isinstance(value, str | int | float | list | Mapping):
        raise ValueError(f"'{value}' is no value of a configuration, but a date or a set; write it in quotes")
    inside = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    for entry in inside:
        check_value(entry)


def axis_of(content: Mapping[str, Value]) -> Axis:
    """One entry of `axes`: the keys in it change together. Raises ValueError, which names the key."""
    columns = {str(key): _named(key, _values, entry) for key, entry in content.items()}
    lengths = {key: len(values) for key, values in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} has {number}" for key, number in lengths.items())
        raise ValueError(f"keys of one entry change together and need equally many values; {listed}")
    return Axis(tuple(dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)))


def _values(entry: Value) -> list[Value]:
    """The values of a list or of a range {from, to, number}."""
    if isinstance(entry, list):
        if not entry:
            raise ValueError("is an empty list, and the product of the axes has no points; give at least one value")
        check_value(entry)
        return entry
    if not isinstance(entry, Mapping) or set(entry) != {"from", "to", "number"}:
        raise ValueError(
            f"{quoted(entry)} is neither a list, for example [1 mm, 1.5 mm], nor a range, for example "
            "{from: 8 mm, to: 16 mm, number: 5}"
        )
    number = entry["number"]
    if isinstance(number, bool) or not isinstance(number, int) or not 2 <= number <= MOST_POINTS:
        raise ValueError(f"number: {quoted(number)} is not allowed; allowed: a whole number from 2 to {MOST_POINTS}")
    return _Ends.of(entry).values(np.linspace(0.0, 1.0, number))


def latin_hypercube(points: int, seed: int, ranges: Mapping[str, Value]) -> Axis:
    """Values of all keys drawn together: each range is divided into as many equal parts as there are points, and each
    part has one value. Raises ValueError, which names the key."""
    generator = np.random.default_rng(seed)
    columns: dict[str, list[Value]] = {}
    for key, entry in ranges.items():
        ends = _named(key, _ends_only, entry)
        fractions = (generator.permutation(points) + generator.random(points)) / points
        columns[str(key)] = ends.drawn(fractions)
    return Axis(
        tuple(dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)), is_drawn=True
    )


def _ends_only(entry: Value) -> _Ends:
    if not isinstance(entry, Mapping) or set(entry) != {"from", "to"}:
        raise ValueError(f"{quoted(entry)} is not a range; for example {{from: 8 mm, to: 16 mm}}")
    return _Ends.of(entry)


def _named(key: Value, read: Any, entry: Value) -> Any:
    try:
        return read(entry)
    except ValueError as refused:
        raise ValueError(f"{key}: {refused}") from None


def combined(axes: Sequence[Axis]) -> list[Setting]:
    """The product of the axes, the last one fastest. Raises ValueError for a key on two axes and for too many."""
    keys = [key for axis in axes for key in axis.keys]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        raise ValueError(f"{min(twice)} is on two axes; give it once")
    number = int(np.prod([len(axis.settings) for axis in axes], dtype=object))
    if number > MOST_POINTS:
        raise ValueError(f"the product of the axes has {number} points; allowed: at most {MOST_POINTS}")
    products = product(*(axis.settings for axis in axes))
    return [{key: value for part in parts for key, value in part.items()} for parts in products]
