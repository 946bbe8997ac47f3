"""The only door to pint: a value written with its unit becomes a number in mm, N, MPa, kPa or tonne/mm3."""

import math
import re
from dataclasses import dataclass
from functools import cache
from tokenize import TokenError
from typing import TYPE_CHECKING, Any

from pipeline.errors import quoted

if TYPE_CHECKING:
    import pint


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

#: The usual units by the unit of their dimension, which need no pint: its import takes longer than `pneurod rod`.
#: `tests/pipeline/config/test_units.py` compares the factors with those of pint.
_USUAL: dict[str, dict[str, float]] = {
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1000.0},
    "MPa": {"MPa": 1.0, "kPa": 1e-3, "GPa": 1e3},
    "kPa": {"kPa": 1.0, "MPa": 1e3, "Pa": 1e-3, "bar": 100.0, "mbar": 0.1},
    "N": {"N": 1.0, "mN": 1e-3},
    "N*mm": {"N*mm": 1.0, "N*m": 1e3, "N mm": 1.0, "N m": 1e3},
    "mm/s**2": {"m/s^2": 1e3, "mm/s^2": 1.0},
    "dimensionless": {"%": 0.01},
    "tonne/mm**3": {"kg/m^3": 1e-12, "g/cm^3": 1e-9},
}

#: moments as engineers write them; pint takes Nm for nanometres and does not know the other
_TORQUE = {"Nm": 1e3, "Nmm": 1.0}

_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
#: the digits around a decimal comma at the beginning of a value
_COMMA = re.compile(r"^(\s*[+-]?\d{1,12}),(\d{1,12})(?![\d,])")
#: The power of one unit: kg/m^3, s**-2.
_EXPONENT = re.compile(r"(?:\^|\*\*)\s*[+-]?\d(?!\d|\s*(?:\^|\*\*))")
#: Any other number in a unit. Pint would evaluate it, and 9**9**9**9 never ends.
_CALCULATION = re.compile(r"(?<![\w.])\.?\d")


@cache
def _registry() -> "pint.UnitRegistry":
    import pint

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
    if meant := with_point(value):
        raise ValueError(f"{quoted(value)} has a decimal comma; did you mean '{meant}'? Write decimals with a point")
    matched = _NUMBER_AND_UNIT.fullmatch(value)
    if matched is None:
        raise ValueError(f"{quoted(value)} is not a number followed by a unit; {example}")
    number, unit = matched.groups()
    if not unit:
        raise ValueError(f"{quoted(value)} has no unit; {example}")
    return _in_unit(float(number), unit, value, dimension, example)


def number_and_unit(value: Any) -> tuple[float, str] | None:
    """The number and the unit of a text such as '4 mm'; None for anything else."""
    matched = _NUMBER_AND_UNIT.fullmatch(value) if isinstance(value, str) else None
    return (float(matched[1]), matched[2]) if matched and matched[2] else None


def in_unit_of(value: str, unit: str) -> float:
    """The number behind `value` in another unit of the same dimension. Raises ValueError."""
    return convert(value, Dimension("a value in this unit", unit, f"1 {unit}"))


def with_point(text: str) -> str:
    """A text that begins with a number with a decimal comma, with a point instead; empty for other texts."""
    return _COMMA.sub(r"\1.\2", text, count=1).strip() if _COMMA.match(text) else ""


def _in_unit(number: float, unit: str, value: str, dimension: Dimension, example: str) -> float:
    torque = _TORQUE if dimension is MOMENT else {}
    factor = torque.get(unit, _USUAL.get(dimension.unit, {}).get(unit))
    if factor is None:
        factor = _factor_of_pint(unit, value, dimension, example)
    result = float(f"{number * factor:.12g}")
    if not math.isfinite(result):
        raise ValueError(f"{quoted(value)} is not finite; {example}")
    return result


def _factor_of_pint(unit: str, value: str, dimension: Dimension, example: str) -> float:
    """The unit of a value in that of its dimension. Raises ValueError."""
    import pint

    no_unit = (
        *(pint.PintError, ValueError, TypeError, AttributeError, AssertionError),
        *(ArithmeticError, RecursionError, MemoryError, TokenError, SyntaxError),
    )
    registry = _registry()
    try:
        if _CALCULATION.search(_EXPONENT.sub("", unit)):
            raise ValueError
        return float(registry.Quantity(1.0, registry.parse_units(unit)).to(dimension.unit).magnitude)
    except pint.DimensionalityError:
        raise ValueError(f"{quoted(value)} is not {dimension.name}; {example}") from None
    except no_unit:
        raise ValueError(f"{quoted(unit)} in {quoted(value)} is not a known unit; {example}") from None
