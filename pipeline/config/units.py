"""The only door to pint: a value written with its unit becomes a number in mm, N, MPa, kPa or tonne/mm3."""

import math
import re
from dataclasses import dataclass
from functools import cache
from tokenize import TokenError
from typing import Any

import pint

from pipeline.errors import quoted


@dataclass(frozen=True)
class Dimension:
    """What a value measures."""

    name: str  #: with its article, for sentences
    unit: str  #: the unit numbers have inside the program, as pint writes it
    example: str  #: how a user may write it


LENGTH = Dimension("a length", "mm", "4 mm")
STRESS = Dimension("a stress", "MPa", "1.2 MPa")
PRESSURE = Dimension("a pressure", "kPa", "37 kPa")
ACCELERATION = Dimension("an acceleration", "mm/s**2", "-9.81 m/s^2")
FORCE = Dimension("a force", "N", "0.05 N")
MOMENT = Dimension("a moment", "N*mm", "1 N*mm")
STRAIN = Dimension("a strain", "dimensionless", "150 %")
DENSITY = Dimension("a density", "tonne/mm**3", "1130 kg/m^3")

_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
#: The power of one unit: kg/m^3, s**-2.
_EXPONENT = re.compile(r"(?:\^|\*\*)\s*[+-]?\d(?!\d|\s*(?:\^|\*\*))")
#: Any other number in a unit. Pint would evaluate it, and 9**9**9**9 never ends.
_CALCULATION = re.compile(r"(?<![\w.])\.?\d")
#: What pint raises for texts that are no units.
_NO_UNIT = (
    *(pint.PintError, ValueError, TypeError, AttributeError, AssertionError),
    *(ArithmeticError, RecursionError, MemoryError, TokenError, SyntaxError),
)


@cache
def _registry() -> pint.UnitRegistry:
    return pint.UnitRegistry()


def convert(value: Any, dimension: Dimension) -> float:
    """The number behind `value` in the unit of `dimension`.

    Twelve significant digits are kept, so that 0.017 MPa and 17 kPa are the same number.
    Raises ValueError with what is wrong and an example of what is right.
    """
    example = f"write {dimension.name} with its unit, for example '{dimension.example}'"
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{quoted(value)} is not {dimension.name}; {example}")
    if not isinstance(value, str):
        raise ValueError(f"{quoted(value)} has no unit; {example}")
    matched = _NUMBER_AND_UNIT.fullmatch(value)
    if matched is None:
        raise ValueError(f"{quoted(value)} is not a number followed by a unit; {example}")
    number, unit = matched.groups()
    if not unit:
        raise ValueError(f"{quoted(value)} has no unit; {example}")
    return _in_unit(float(number), unit, value, dimension, example)


def _in_unit(number: float, unit: str, value: str, dimension: Dimension, example: str) -> float:
    registry = _registry()
    try:
        if _CALCULATION.search(_EXPONENT.sub("", unit)):
            raise ValueError
        given = registry.parse_units(unit)
        factor = registry.Quantity(1.0, given).to(dimension.unit).magnitude
    except pint.DimensionalityError:
        raise ValueError(f"{quoted(value)} is not {dimension.name}; {example}") from None
    except _NO_UNIT:
        raise ValueError(f"{quoted(unit)} in {quoted(value)} is not a known unit; {example}") from None
    result = float(f"{number * factor:.12g}")
    if not math.isfinite(result):
        raise ValueError(f"{quoted(value)} is not finite; {example}")
    return result
