"""The only door to pint: a value written with its unit becomes a number in mm, N, MPa, kPa or tonne/mm3."""

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from geometry.units import NUMBER_AND_UNIT, USUAL
from pipeline.values.errors import quoted, shortened

if TYPE_CHECKING:
    import pint


@dataclass(frozen=True)
class Dimension:
    """What a value measures."""

    name: str  #: with its article, for sentences
    unit: str  #: the unit numbers have inside the program, as pint writes it
    example: str  #: how a user may write it


LENGTH = Dimension("a length", "mm", "4 mm")
AREA = Dimension("an area", "mm**2", "16 mm^2")
STRESS = Dimension("a stress", "MPa", "1.2 MPa")
PRESSURE = Dimension("a pressure", "kPa", "37 kPa")
ACCELERATION = Dimension("an acceleration", "mm/s**2", "-9.81 m/s^2")
FORCE = Dimension("a force", "N", "0.05 N")
MOMENT = Dimension("a moment", "N*mm", "1 N*mm")
ANGLE = Dimension("an angle", "deg", "90 deg")
MASS = Dimension("a mass", "g", "20 g")
STRAIN = Dimension("a strain", "dimensionless", "150 %")
CURVATURE = Dimension("a curvature", "1/mm", "-12 1/m")
STIFFNESS = Dimension("a stiffness", "N/mm", "5 N/m")
DENSITY = Dimension("a density", "tonne/mm**3", "1130 kg/m^3")
TIME = Dimension("a time", "s", "0.9 s")
FREQUENCY = Dimension("a frequency", "Hz", "1 Hz")

#: what pint reads as a unit without evaluating other numbers than a power of one digit (9**9**9**9 never ends)
_NAME = r"[^\W\d]+(?:\s*(?:\^|\*\*)\s*[+-]?\d)?"
_UNIT = re.compile(rf"(?:{_NAME}|%)(?:\s*[*/ ]\s*{_NAME})*")


def convert(value: Any, dimension: Dimension) -> float:
    """The number behind `value` in the unit of `dimension`.

    Twelve significant digits are kept, so that 0.017 MPa and 17 kPa are the same number.
    Raises ValueError with what is wrong and an example of what is right.
    """

    def refused(what: str) -> ValueError:
        return ValueError(f"{what}; write {dimension.name} with its unit, for example '{dimension.example}'")

    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refused(f"{quoted(value)} is not {dimension.name}")
    matched = NUMBER_AND_UNIT.fullmatch(str(value))
    if isinstance(value, str) and matched is None:
        raise refused(f"{quoted(value)} is not a number followed by a unit")
    if matched is None or not matched[2]:
        raise refused(f"{quoted(value)} has no unit")
    try:
        result = float(f"{float(matched[1]) * _factor(matched[2], dimension):.12g}")
    except TypeError:
        raise refused(f"{quoted(value)} is not {dimension.name}") from None
    except ValueError:
        raise refused(f"{quoted(matched[2])} in {quoted(value)} is not a known unit") from None
    if not math.isfinite(result):
        raise refused(f"{quoted(value)} is not finite")
    return result


def number_and_unit(value: Any) -> tuple[float, str] | None:
    """The number and the unit of a text such as '4 mm'; None for anything else."""
    matched = NUMBER_AND_UNIT.fullmatch(value) if isinstance(value, str) else None
    return (float(matched[1]), matched[2]) if matched and matched[2] else None


def in_unit_of(value: Any, unit: str) -> float:
    """The number behind `value` in another unit of the same dimension. Raises ValueError."""
    return convert(value, Dimension("a value in this unit", unit, f"1 {unit}"))


@cache
def _registry() -> "pint.UnitRegistry":
    return _pint().UnitRegistry()


def _pint() -> Any:
    import pint

    return pint


def _factor(unit: str, dimension: Dimension) -> float:
    """A unit in that of a dimension. Raises ValueError for no unit, and TypeError for one of another dimension."""
    usual = USUAL.get(dimension.unit, {})
    if unit in usual:
        return usual[unit]
    if not _UNIT.fullmatch(unit) or shortened(unit) != unit:
        raise ValueError
    try:
        return float(_registry().Quantity(1.0, _registry().parse_units(unit)).to(dimension.unit).magnitude)
    except _pint().DimensionalityError:
        raise TypeError from None
    except (_pint().PintError, ArithmeticError, AttributeError, AssertionError):
        raise ValueError from None
