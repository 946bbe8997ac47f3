"""What `print` shows of shapes, rods, parameters and laws: a few plain lines."""

from dataclasses import replace

import pytest

from geometry.told import Printable
from rod import FiveParameters, Rod
from tests.rod.arm_law.test_arm_law import law_of, straight_law

LAW = law_of(straight_law(0.0), straight_law(20.0, -0.01))
FIVE = Rod(100.0, -0.01, FiveParameters(400.0, 500.0, 1.0, 1.0, 30.0))
SHAPE = Rod(110.0, law=LAW.at(20.0)).solve(force="0.01 N")


@pytest.mark.parametrize("value", [FIVE, SHAPE, FIVE.solve()])
def test_a_value_is_printed_in_a_few_short_lines(value: Printable) -> None:
    lines = str(value).splitlines()
    assert 2 <= len(lines) <= 7
    assert max(map(len, lines)) <= 100
    assert "array" not in str(value)


def test_a_shape_tells_its_end_and_its_notes() -> None:
    x, y = SHAPE.end
    lines = str(replace(SHAPE, notes=("Beware.",))).splitlines()
    assert lines[0] == f"end                  x = {x:.3f} mm, y = {y:.3f} mm from the clamped end of the curve"
    assert "end force            [0, 0.01] N" in lines
    assert lines[-1] == "Beware."


def test_parameters_and_laws_are_printed_in_one_line() -> None:
    assert str(FIVE.five) == "FiveParameters(alpha1=400.0, alpha2=500.0, m01=1.0, m02=1.0, d=30.0)"
    assert str(LAW) == "ArmLaw(2 pressures from 0 to 20 kPa, cells of 10 mm)"
    assert str(FIVE).splitlines() == ["length  100 mm", f"law     {FIVE.five}"]
