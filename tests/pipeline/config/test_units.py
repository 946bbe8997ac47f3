"""The factors of the usual units, which are converted without pint, against those of pint."""

import pint
import pytest

from geometry.units import USUAL
from pipeline.config.units import MOMENT, PRESSURE, convert


def test_usual_units_have_the_factors_of_pint() -> None:
    registry = pint.UnitRegistry()
    checked = 0
    for internal, units in USUAL.items():
        for unit, factor in units.items():
            if unit in ("Nm", "Nmm"):  # nanometres
                continue
            assert registry.Quantity(1.0, unit).to(internal).magnitude == pytest.approx(factor, rel=1e-12), unit
            checked += 1
    assert checked > 15


@pytest.mark.parametrize("text", ["1500 N*mm", "1500 N mm", "1500 Nmm", "1.5 N*m", "1.5 N m", "1.5 Nm", "1.5e6 mN*mm"])
def test_equal_moments_are_equal_numbers(text: str) -> None:
    assert convert(text, MOMENT) == 1500.0


@pytest.mark.parametrize("text", ["17 kPa", "0.017 MPa", "17000 Pa", "0.17 bar", "17 kilopascal", "17 kN/m^2"])
def test_equal_pressures_are_equal_numbers(text: str) -> None:
    assert convert(text, PRESSURE) == 17.0
