"""What acts on an arm as one value: of rods of any length and law, from numbers and texts, at rest and in motion."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rod import Body, FiveParameters, Loading, PointLoad, Rod, Support, frequencies
from rod.weight import Mass

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
