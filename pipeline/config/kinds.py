"""Kinds of values in a configuration: what may be written for each, with its unit, and how it is refused."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Annotated, Any

from pipeline.config.document import Document, read_document
from pipeline.config.section import Kind, ReadContext, not_known
from pipeline.config.units import ACCELERATION, DENSITY, FORCE, LENGTH, PRESSURE, STRESS, TIME, Dimension, convert
from pipeline.values.errors import InputError, quoted
from rod.same_pressure import SAME, is_same


def in_unit(dimension: Dimension) -> Callable[[Any], float]:
    """Reads a number with a unit."""
    return lambda value: convert(value, dimension)


def number(value: Any) -> float:
    """Reads a number without a unit."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{quoted(value)} is not a plain number; write it without a unit, for example 0.495")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{quoted(value)} is too large") from None


def of_type(kind: type, otherwise: str) -> Callable[[Any], Any]:
    """Reads a value of this type, which is not empty."""

    def read(value: Any) -> Any:
        if type(value) is not kind or value == "":
            raise ValueError(f"{quoted(value)} {otherwise}")
        return value

    return read


def text(example: str) -> Callable[[Any], str]:
    """Reads a text that is not empty."""
    return of_type(str, f"is not a text; for example '{example}'")


def one_of(names: Sequence[str], **more: Any) -> Kind:
    """One of these names. YAML 1.1 reads a bare on or off as a truth value."""

    def read(value: Any) -> Any:
        name = ("off", "on")[value] if isinstance(value, bool) else value
        if name not in names:
            raise ValueError(not_known(name, names))
        return name

    return Kind(", ".join(f"`{name}`" for name in names), str(names[0]), read=read, **more)


def list_of(
    allowed: str, example: str, unit: str = "", test: Callable[[Any], bool] | None = None, count: int | None = None
) -> Kind:
    """A list, of `count` entries where that is given."""

    def read(value: Any) -> Any:
        if not isinstance(value, list):
            raise ValueError(f"must be a list, for example {example}")
        if count not in (None, len(value)):
            raise ValueError(f"has {len(value)} entries instead of {count}; for example {example}")
        return value

    return Kind(allowed, example, unit, read, test)


def one_or_more(kind: Kind) -> Kind:
    """A list whose brackets can be left out if it has one entry."""
    return replace(kind, read=lambda value: value if isinstance(value, list) and value else [value])


def not_empty(example: str) -> Kind:
    """Entries, at least one."""

    def test(value: Any) -> bool:
        if not value:
            raise ValueError(f"is empty; for example {example}")
        return True

    return Kind("", example, test=test)


def above_zero(value: float) -> bool:
    """Whether a number is above zero."""
    return value > 0.0


def distinct(values: tuple[Any, ...]) -> bool:
    """Whether no entry is there twice. Raises ValueError otherwise."""
    if len(set(values)) < len(values):
        raise ValueError("has an entry twice; list every load once")
    return True


def _name(value: Any) -> str:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", text("pneunet")(value)):
        raise ValueError(f"{quoted(value)} is not a name; allowed: letters, digits, '_', '-' and '.'")
    return str(value)


def _ascending(values: tuple[float, ...]) -> bool:
    if not values:
        raise ValueError("is empty; give at least one pressure, for example [17 kPa, 37 kPa]")
    if min(values) <= 0.0:
        vacuum = "for a vacuum give a cavity a negative fraction of them: effects.pressure: {cavities: {cavity: -1}}"
        raise ValueError(f"{min(values):g} kPa is not above zero; give pressures above 0 kPa; {vacuum}")
    for earlier, later in pairwise(values):
        if is_same(earlier, later):
            equal = f"which differ by less than {SAME:g} of themselves and count as one pressure"
            raise ValueError(f"has {earlier:.12g} kPa and {later:.12g} kPa, {equal}; list it once")
        if later < earlier:
            raise ValueError(f"{later:g} kPa after {earlier:g} kPa is not in ascending order; list the lowest first")
    return True


Length = Annotated[float, Kind("any", LENGTH.example, "mm", in_unit(LENGTH))]
PositiveLength = Annotated[Length, Kind("above 0", LENGTH.example, "mm", test=above_zero)]
Stress = Annotated[float, Kind("any", STRESS.example, "MPa", in_unit(STRESS))]
PositiveStress = Annotated[Stress, Kind("above 0", STRESS.example, "MPa", test=above_zero)]
Density = Annotated[float, Kind("above 0", DENSITY.example, "kg/m³", in_unit(DENSITY), above_zero)]
PositiveForce = Annotated[float, Kind("above 0", "0.4 N", "N", in_unit(FORCE), above_zero)]
PositiveTime = Annotated[float, Kind("above 0", TIME.example, "s", in_unit(TIME), above_zero)]


def _pressure(value: Any) -> float:
    if isinstance(value, list):
        raise ValueError(
            "is a list, which only `run` (two cavities) and `cell` (three) take; give one pressure, for example 17 kPa"
        )
    return convert(value, PRESSURE)


_Pressure = Annotated[float, Kind("any", PRESSURE.example, "kPa", _pressure)]
Pressures = Annotated[tuple[_Pressure, ...], list_of("above 0, ascending", "[17 kPa, 37 kPa]", "kPa", _ascending)]
Number = Annotated[float, Kind("any", "1", "1", number)]
PositiveNumber = Annotated[Number, Kind("above 0", "1", "1", test=above_zero)]
PoissonRatio = Annotated[Number, Kind("above -1 and below 0.5", "0.495", "1", test=lambda value: -1.0 < value < 0.5)]
LossFactor = Annotated[Number, Kind("above 0, at most 2", "0.1", "1", test=lambda value: 0.0 < value <= 2.0)]
Stretches = Annotated[
    tuple[Number, Number],
    list_of(
        "two stretches, 1 between them", "[0.7, 1.9]", "1", lambda s: 0.0 < s[0] <= 1.0 <= s[1] and s[0] != s[1], 2
    ),
]
_Acceleration = Annotated[float, Kind("any", ACCELERATION.example, "m/s²", in_unit(ACCELERATION))]
Acceleration = Annotated[
    tuple[_Acceleration, _Acceleration, _Acceleration],
    list_of("x, y and z", "[0 m/s^2, -9.81 m/s^2, 0 m/s^2]", "m/s²", count=3),
]
Count = Annotated[
    int, Kind("1 to 10000", "11", "", of_type(int, "is not a whole number; write it without a unit, for example 11"))
]
CountFromZero = Annotated[Count, Kind("0 or more", "0", test=lambda value: value >= 0)]
YesNo = Annotated[bool, Kind("`true` or `false`", "true", read=of_type(bool, "is neither true nor false"))]
Name = Annotated[str, Kind("letters, digits, `_`, `-` and `.`", "pneunet", read=_name)]
Text = Annotated[str, Kind("a text", "pneunet", read=text("pneunet"))]


def _base(value: Any, beside: ReadContext) -> Document:
    try:
        return read_document(beside.document.path.parent / text(_BASE)(value))
    except InputError as failure:
        raise ValueError(str(failure)) from None


_BASE = "pneunet_coarse.yaml"
#: the configuration with which a study begins, by its file
Base = Annotated[Document, Kind("a file", _BASE, complete=_base)]

#: the largest relative error that can be requested
MOST_ACCURACY = 0.2
_ACCURACY = Dimension("an accuracy", "dimensionless", "2 %")
Percentage = Annotated[
    float | None,
    Kind(
        "above 0, at most 20, or `off`",
        _ACCURACY.example,
        "%",
        read=lambda value: None if value in (False, "off") else in_unit(_ACCURACY)(value),
        test=lambda error: error is None or 0.0 < error <= MOST_ACCURACY,
    ),
]
