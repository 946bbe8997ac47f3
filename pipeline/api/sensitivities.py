"""The derivatives of an arm's own law as a pandas frame."""

import math
from collections.abc import Iterator

import pandas as pd

from rod import ArmLaw
from rod.arm_law.quantities import OF_CELLS, UNITS, Asked

COLUMNS = ("parameter", "number", "pressure_kPa", "derivative", "unit", "relative")


def sensitivities_frame(law: ArmLaw | None) -> pd.DataFrame:
    """One row per parameter, number and pressure above zero.

    relative: by how many % a number changes by 1 % of the parameter; NaN of a number that is zero, or not
    in the law.
    """
    return pd.DataFrame([] if law is None else list(_rows(law)), columns=list(COLUMNS))


def _rows(law: ArmLaw) -> Iterator[tuple[object, ...]]:
    rods = {pressure: law.at(pressure) for pressure in law.pressures if pressure}
    values = {
        (name, p): float(Asked(name, p, rod).of(rods.__getitem__)[0]) for name in UNITS for p, rod in rods.items()
    }
    for name, parameter in law.rates.items():
        for number, rates in law.derivative(name).items():
            unit = (UNITS | OF_CELLS)[number]
            unit = unit if parameter.unit == "1" else f"{unit} per {parameter.unit}"
            for pressure, rate in zip(law.pressures, rates.tolist(), strict=True):
                value = values.get((number, pressure), 0.0)
                if pressure:
                    yield name, number, pressure, rate, unit, rate * parameter.value / value if value else math.nan
