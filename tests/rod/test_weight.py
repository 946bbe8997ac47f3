"""Weight on rods: the arm's own law beside the rod with two lines, orientations, masses on the end."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rod import FiveParameters, Rod
from rod.weight import WEIGHT_OF_GRAM, Mass, gravity_direction, in_grams
from tests.rod.arm_law.test_arm_law import EI, LENGTH, law_of, straight_law

KAPPA_0, GRAMS, HEIGHT = -0.01, 15.0, 5.0
LINES = Rod(LENGTH, KAPPA_0, FiveParameters(EI, EI, 0.0, 0.0, 50.0), mass=Mass.even(LENGTH, GRAMS, HEIGHT))


def by_law(mass: Mass | None = LINES.mass) -> Rod:
    law = law_of(straight_law(0.0, KAPPA_0))
    return Rod(LENGTH, law=law.at(0.0), mass=mass)


@pytest.mark.parametrize("direction", ["hanging", "lying", "standing", "30 deg", (0.3, 1.0)])
@pytest.mark.parametrize("load", [{}, {"tip_mass": "3 g"}, {"end_y": -30.0}, {"force": (0.01, 0.02), "moment": 1.0}])
def test_the_arms_own_law_carries_its_weight_as_the_rod_with_two_lines_does(direction: Any, load: Any) -> None:
    ours, lines = by_law().solve(direction=direction, **load), LINES.solve(direction=direction, **load)
    assert ours.end == pytest.approx(lines.end, abs=2e-4)
    assert ours.force == pytest.approx(lines.force, abs=1e-7)
    assert ours.weight == pytest.approx(lines.weight)
    assert ours.clamp_moment == pytest.approx(lines.clamp_moment, rel=1e-5)
    assert np.interp(50.0, ours.s, ours.moment) == pytest.approx(np.interp(50.0, lines.s, lines.moment), rel=1e-3)
    without = by_law().solve(**{key: value for key, value in load.items() if key != "tip_mass"})
    assert abs(ours.clamp_moment - without.clamp_moment) > 0.05


def test_a_mass_on_the_end_is_a_force_there() -> None:
    hung = by_law().solve(direction="lying", tip_mass="20 g", weight=False)
    pulled = by_law().solve(force=(0.0, -20.0 * WEIGHT_OF_GRAM))
    assert hung.end == pytest.approx(pulled.end, abs=1e-9)
    assert not hung.weight.any()


def test_orientations_are_directions_of_gravity_in_the_frame_of_the_arm() -> None:
    assert gravity_direction("hanging") == pytest.approx((1.0, 0.0))
    assert gravity_direction("standing") == pytest.approx((-1.0, 0.0))
    assert gravity_direction("lying") == gravity_direction("0 deg") == pytest.approx((0.0, -1.0))
    assert gravity_direction("30 deg") == pytest.approx((-0.5, -np.sqrt(0.75)))
    assert gravity_direction((0.0, 3.0)) == (0.0, 1.0)
    assert in_grams("0.02 kg") == in_grams(20) == in_grams("20 g") == pytest.approx(20.0)


def test_the_weight_of_a_run_with_gravity_acts_always_and_another_direction_replaces_it() -> None:
    x, y = (GRAMS * WEIGHT_OF_GRAM / LENGTH * component for component in gravity_direction("lying"))
    law = replace(law_of(straight_law(0.0, KAPPA_0)), mass=LINES.mass, weight=(x, y))
    carrying = Rod(LENGTH, law=law.at(0.0))
    assert carrying.solve().end == pytest.approx(by_law().solve(direction="lying").end)
    assert carrying.solve(direction="standing").end == pytest.approx(by_law().solve(direction="standing").end)
    assert carrying.solve(direction="lying", weight=False).end == pytest.approx(by_law().solve().end)
    assert replace(carrying, notes=("other",)).weight == (x, y)


def test_the_distribution_of_the_mass_counts() -> None:
    """A heavy end wall weighs more on the clamp than the same mass spread evenly."""
    heavy_end = Mass(np.array([0.0, 2.0, LENGTH]), np.array([0.0, 5.0, GRAMS]), np.zeros(3))
    even = Mass.even(LENGTH, GRAMS)
    small = {"direction": (0.0, 1e-6)}
    moments = [by_law(mass).solve(**small).clamp_moment for mass in (heavy_end, even)]
    assert by_law(heavy_end).solve(**small).weight == pytest.approx([0.0, GRAMS * WEIGHT_OF_GRAM])
    assert moments[0] > 1.1 * moments[1]


def test_a_longer_arm_of_the_same_cells_has_more_mass() -> None:
    within, heights = Mass.even(LENGTH, GRAMS, HEIGHT).within(np.array([0.0, 0.5 * LENGTH, 2.0 * LENGTH]))
    assert within == pytest.approx([0.0, 0.5 * GRAMS, 2.0 * GRAMS])
    assert heights == pytest.approx(HEIGHT * within)
