"""Usual units, and texts such as "20 mm" as numbers in those inside."""

import math
import re
from collections.abc import Mapping

#: units by that of the numbers inside. `tests/pipeline/config/test_units.py` compares the factors with those of pint,
#: whose import takes longer than `pneurod rod`, and which takes Nm for nanometres.
USUAL: dict[str, dict[str, float]] = {
    "mm": {"mm": 1.0, "cm": 10.0, "m": 1000.0},
    "mm**2": {"mm^2": 1.0, "cm^2": 100.0},
    "MPa": {"MPa": 1.0, "kPa": 1e-3, "GPa": 1e3},
    "kPa": {"kPa": 1.0, "MPa": 1e3, "Pa": 1e-3, "bar": 100.0, "mbar": 0.1},
    "N": {"N": 1.0, "mN": 1e-3},
    "N*mm": {"N*mm": 1.0, "N*m": 1e3, "N mm": 1.0, "N m": 1e3, "Nmm": 1.0, "Nm": 1e3},
    "mm/s**2": {"m/s^2": 1e3, "mm/s^2": 1.0},
    "dimensionless": {"%": 0.01},
    "deg": {"deg": 1.0, "°": 1.0, "rad": math.degrees(1.0)},
    "rad": {"rad": 1.0, "deg": math.radians(1.0), "°": math.radians(1.0)},
    "g": {"g": 1.0, "kg": 1e3, "mg": 1e-3},
    "1/mm": {"1/mm": 1.0, "1/m": 1e-3, "1/cm": 0.1},
    "N/mm": {"N/mm": 1.0, "N/m": 1e-3, "mN/mm": 1e-3},
    "tonne/mm**3": {"kg/m^3": 1e-12, "g/cm^3": 1e-9},
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0},
    "Hz": {"Hz": 1.0},
}
NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


def with_unit(text: str, units: Mapping[str, float]) -> float | None:
    """The number of a text such as "20 mm" times the factor of its unit; None for anything else."""
    matched = NUMBER_AND_UNIT.fullmatch(text)
    return float(matched[1]) * units[matched[2]] if matched and matched[2] in units else None
