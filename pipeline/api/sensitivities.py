"""The derivatives of an arm's own law as a pandas frame."""

import math

import pandas as pd

from rod import ArmLaw
from rod.arm_law.curves import ACROSS
from rod.arm_law.derivative import NUMBERS

#: unit of each number of a derivative
UNITS = {"kappa_0": "1/mm", "rigidity": "N mm2", "moment": "N mm", "stretch": "1", "end_angle": "rad"}
#: of a law that has rigidities out of the plane
IN_SPACE = dict.fromkeys(ACROSS, "N mm2")
#: of those that have no value beside them in the law
OTHERS = {"contact_onset": "1/mm", "largest_stretch": "1"}
COLUMNS = ("parameter", "number", "pressure_kPa", "derivative", "unit", "relative")


def sensitivities_frame(law: ArmLaw | None) -> pd.DataFrame:
    """One row per parameter, number and pressure above zero.

    relative: by how many % a number changes by 1 % of the parameter; NaN of a number that is zero, or not
    in the law.
    """
    rows = []
    values = {} if law is None else {pressure: _values(law, pressure) for pressure in law.pressures if pressure}
    units = UNITS | OTHERS | (IN_SPACE if law and law.is_in_space else {})
    for name in law.rates if law else ():
        derivative = law.derivative(name)  # type: ignore[union-attr]
        for number, of_number in units.items():
            unit = of_number if derivative.unit == "1" else f"{of_number} per {derivative.unit}"
            for pressure, rate in zip(derivative.pressures.tolist(), getattr(derivative, number).tolist(), strict=True):
                if pressure:
                    value = values[pressure].get(number, 0.0)
                    relative = rate * derivative.value / value if value else math.nan
                    rows.append((name, number, pressure, rate, unit, relative))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _values(law: ArmLaw, pressure: float) -> dict[str, float]:
    rod = law.at(pressure)
    return {number: function(rod, rod) for number, function in NUMBERS.items()}
