"""The axes of a sweep: lists and ranges of the values of a key, keys that change together, a Latin hypercube."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import isfinite, prod

import numpy as np
from scipy.stats import qmc

from geometry.arrays import Array
from pipeline.config import units
from pipeline.config.section import read_each
from pipeline.study.sweep.points import Setting
from pipeline.values.errors import quoted
from pipeline.values.json_values import Written

#: more points than this are refused: a mistyped range is more likely than so many designs
MOST_POINTS = 100_000
#: significant digits of the values of a range
DIGITS = 6


@dataclass(frozen=True)
class Axis:
    """Keys that change together, with the values that they take one after the other."""

    settings: tuple[Setting, ...]  #: not empty; all have the same keys
    is_drawn: bool = False  #: whether its values are drawn at random

    @staticmethod
    def of(columns: Mapping[str, Sequence[Written]], *, is_drawn: bool = False) -> "Axis":
        """From equally many values of each key."""
        rows = zip(*columns.values(), strict=True)
        return Axis(tuple(dict(zip(columns, row, strict=True)) for row in rows), is_drawn)

    @property
    def keys(self) -> tuple[str, ...]:
        """The dotted keys."""
        return tuple(self.settings[0])


def check_value(value: Written) -> None:
    """Raise ValueError for what no configuration can hold: a date or a set, and a number that is not finite."""
    if isinstance(value, float) and not isfinite(value):
        raise ValueError(f"{quoted(value)} is not a finite number; give one, with its unit")
    if value is not None and not isinstance(value, str | int | float | list | Mapping):
        raise ValueError(f"'{value}' is no value of a configuration, but a date or a set; write it in quotes")
    for entry in value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ():
        check_value(entry)


def axis_of(content: Mapping[str, Written]) -> Axis:
    """One entry of `axes`: the keys in it change together. Raises ValueError, for each key that is wrong."""
    if not content:
        raise ValueError("holds no key; for example 'geometry.wall: [1 mm, 1.5 mm]'")
    columns = read_each(content, lambda _, entry: _values(entry))
    lengths = {key: len(values) for key, values in columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} has {number}" for key, number in lengths.items())
        raise ValueError(f"keys of one entry change together and need equally many values; {listed}")
    return Axis.of(columns)


def latin_hypercube(points: int, seed: int, ranges: Mapping[str, Written]) -> Axis:
    """Values of all keys drawn together: each range is divided into as many equal parts as there are points, and each
    part has one value. Raises ValueError, for each key that is wrong."""
    fractions = qmc.LatinHypercube(len(ranges), rng=np.random.default_rng(seed)).random(points)
    columns = dict(zip(ranges, fractions.T, strict=True))

    def drawn(key: str, entry: Written) -> list[Written]:
        if not isinstance(entry, Mapping) or set(entry) != {"from", "to"}:
            raise ValueError(f"{quoted(entry)} is not a range; for example {{from: 8 mm, to: 16 mm}}")
        return _between(entry, columns[key], is_drawn=True)

    return Axis.of(read_each(ranges, drawn, ("axes",)), is_drawn=True)


def _values(entry: Written) -> list[Written]:
    """The values of a list or of a range {from, to, number}."""
    if isinstance(entry, list):
        if not entry:
            raise ValueError("is an empty list, and the product of the axes has no points; give at least one value")
        check_value(entry)
        return entry
    if not isinstance(entry, Mapping) or set(entry) != {"from", "to", "number"}:
        allowed = "a list such as [1 mm, 1.5 mm] nor a range such as {from: 8 mm, to: 16 mm, number: 5}"
        raise ValueError(f"{quoted(entry)} is neither {allowed}")
    number = entry["number"]
    if isinstance(number, bool) or not isinstance(number, int) or not 2 <= number <= MOST_POINTS:
        raise ValueError(f"number: {quoted(number)} is not allowed; allowed: a whole number from 2 to {MOST_POINTS}")
    return _between(entry, np.linspace(0.0, 1.0, number))


def _between(entry: Mapping[str, Written], fractions: Array, *, is_drawn: bool = False) -> list[Written]:
    """The values at fractions (n,) of a range, in the unit of its first end, as they stand in YAML.

    Drawn whole numbers between two whole ends are equally probable.
    """
    ends = [entry["from"], entry["to"]]
    check_value(ends)
    if measured := units.number_and_unit(ends[0]):
        unit = measured[1]
        first, last = (units.in_unit_of(end, unit) for end in ends)
        return [f"{value:.{DIGITS}g} {unit}" for value in first + fractions * (last - first)]
    low, high = map(_number, ends)
    is_whole = isinstance(low, int) and isinstance(high, int)
    if is_whole and is_drawn:
        low, high = sorted((low, high))
        return [min(high, low + int(fraction * (high - low + 1))) for fraction in fractions]
    numbers = [float(f"{value:.{DIGITS}g}") for value in low + fractions * (high - low)]
    return [int(number) if is_whole and number.is_integer() else number for number in numbers]


def _number(end: Written) -> int | float:
    """An end of a range without unit. Raises ValueError."""
    if isinstance(end, bool) or not isinstance(end, int | float):
        raise ValueError(f"{quoted(end)} is no end of a range; for example {{from: 8 mm, to: 16 mm}}")
    return end


def combined(axes: Sequence[Axis]) -> list[Setting]:
    """The product of the axes, the last one fastest. Raises ValueError for a key on two axes and for too many."""
    keys = [key for axis in axes for key in axis.keys]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        raise ValueError(f"{min(twice)} is on two axes; give it once")
    number = prod(len(axis.settings) for axis in axes)
    if number > MOST_POINTS:
        raise ValueError(f"the product of the axes has {number} points; allowed: at most {MOST_POINTS}")
    products = product(*(axis.settings for axis in axes))
    return [{key: value for part in parts for key, value in part.items()} for parts in products]
