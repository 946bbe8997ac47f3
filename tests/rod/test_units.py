"""Numbers, texts with their unit and loadings are the same in every call of a rod; what `print` shows of values."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from geometry.told import Printable
from rod import Body, FiveParameters, LineLoad, Load, Loading, PointLoad, Rod, Support, frequencies
from rod.weight import Mass
from tests.rod.arm_law.test_arm_law import law_of, straight_law

FIVE = Rod(100.0, -0.01, FiveParameters(400.0, 500.0, 1.0, 1.0, 30.0))
PAIRS: list[tuple[dict[str, Any], dict[str, Any]]] = [
    ({"force": "50 mN"}, {"force": (0.0, 0.05)}),
    ({"force": 0.05}, {"force": (0.0, 0.05)}),
    ({"force": ("0.01 N", 0.02)}, {"force": (0.01, 0.02)}),
    ({"end_y": "-3 cm"}, {"end_y": -30.0}),
    ({"end": ("80 mm", "-0.03 m")}, {"end": (80.0, -30.0)}),
    ({"moment": "0.001 Nm"}, {"moment": 1.0}),
    ({"along": [PointLoad("5 cm", ("0 N", "10 mN"))]}, {"along": [PointLoad(50.0, (0.0, 0.01))]}),
    ({"along": [LineLoad("20 mm", "6 cm", ("0 N/m", "0.5 N/m"))]}, {"along": [LineLoad(20.0, 60.0, (0.0, 5e-4))]}),
    ({"along": [Support("50 mm", angle="-10 deg")]}, {"along": [Support(50.0, angle=np.radians(-10.0))]}),
]


@pytest.mark.parametrize(("texts", "numbers"), PAIRS)
def test_texts_with_a_unit_are_numbers(texts: dict[str, Any], numbers: dict[str, Any]) -> None:
    np.testing.assert_allclose(FIVE.solve(**texts).curve, FIVE.solve(**numbers).curve, rtol=0.0, atol=1e-11)


def test_a_force_in_space_and_a_rod_take_texts() -> None:
    rod = Rod("10 cm", "-10 1/m", FIVE.five, theta0="3 deg", start=("1 mm", "0 mm"))
    assert (rod.length, rod.theta0, rod.start) == (100.0, pytest.approx(np.radians(3.0)), (1.0, 0.0))
    assert rod.solve().end == Rod(100.0, -0.01, FIVE.five, np.radians(3.0), (1.0, 0.0)).solve().end


def test_a_load_takes_texts() -> None:
    texts = Load(("1 mN", "0 N"), "0.002 Nm", ("0 N/m", "-0.5 N/m"))
    assert (texts.force, texts.couple, texts.weight) == ((0.001, 0.0, 0.0), (0.0, 0.0, 2.0), (0.0, -0.0005, 0.0))


def test_a_law_takes_pressures_and_lengths_with_a_unit() -> None:
    law = law_of(straight_law(0.0), straight_law(20.0))
    assert law.at("0.1 bar", "12 cm").solve().end == law.at(10.0, 120.0).solve().end


LAW = law_of(straight_law(0.0), straight_law(20.0, -0.01))
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


ARM = Rod(112.0, 0.01, FiveParameters(180.0, 400.0, 0.5, -0.2, 12.0), mass=Mass.even(112.0, 20.0))


@pytest.mark.parametrize(
    "given",
    [
        {"force": (0.01, -0.02), "moment": 0.5},
        {"force": "20 mN", "along": [PointLoad("56 mm", (0.0, 0.01)), Support(80.0, y=-3.0)]},
        {"end": (None, "12 mm")},
        {"direction": "hanging", "tip_mass": "5 g", "hung": [("0.5 l", "3 g")]},
        {},
    ],
)
def test_a_rod_bears_what_it_is_solved_under(given: dict[str, Any]) -> None:
    shape = ARM.bear(Loading(**given))
    np.testing.assert_array_equal(shape.curve, ARM.solve(**given).curve)


def test_equal_loadings_are_one_key_however_they_are_written() -> None:
    written = Loading("20 mN", "1 N*mm", None, (), [0.0, -1.0], "5 g", [("0.5 l", "3 g")])
    assert {written: 1}[Loading((0.0, 0.02), 1.0, None, [], (0.0, -1.0), 5.0, (("0.5 l", 3.0),))] == 1
    assert replace(written, tip_mass=5.1) != written


def test_a_place_along_the_arm_is_one_of_its_length() -> None:
    loading = Loading(direction=(0.0, -1.0), hung=[("0.5 l", "100 g")])
    for length in (80.0, 112.0):
        (mass,) = loading.on(length, Mass.even(length, 1.0), (0.0, 0.0)).along
        assert (mass.breaks, mass.force[1]) == ((0.5 * length,), pytest.approx(-0.981))


def test_masses_without_gravity_have_inertia_and_no_weight() -> None:
    """Only a motion takes them: to a rod at rest they are a mistake."""
    body, light = Body(ARM), Loading(tip_mass=10.0)
    assert not any(body.loaded(light, ARM.arm).force)
    assert frequencies(body, 0.0, light, 1)[0].frequency_hz < 0.8 * frequencies(body, 0.0, count=1)[0].frequency_hz
