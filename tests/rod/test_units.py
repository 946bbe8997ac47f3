"""Numbers and texts with their unit are the same in every call of a rod."""

from typing import Any

import numpy as np
import pytest

from rod import FiveParameters, LineLoad, Load, PointLoad, Rod, Support
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
