"""Steps of the search by its model, for numbers that are products of powers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.wishes.descent import Correction
from pipeline.wishes.measured import Numbers
from pipeline.wishes.search import starts
from pipeline.wishes.step import Model, exact_objective, merit_of, missing_slopes, propose
from pipeline.wishes.wish_file import WishFile
from tests.pipeline.wishes.test_measured import CONFIGS, SMALL, small

TWO = f"""
name: two
base: {CONFIGS}/semicircular_coarse.yaml
free:
  geometry.wall: {{from: 0.5 mm, to: 2 mm}}
  geometry.base: {{from: 1 mm, to: 4 mm}}
wishes:
  - {{kappa_0: -0.6 1/m, at: 20 kPa, within: 2 %}}
  - {{stiffness: 2 N/m, at: 20 kPa, within: 2 %}}
"""
#: exponents of the numbers
POWERS = np.array([[-1.7, 0.5], [0.6, 1.3]])
START = np.array([1.0, 2.0])


def numbers(point: Array, powers: Array = POWERS, lacking: float = 0.0) -> Numbers:
    """Of an arm that has what is wished at wall 1.1 mm and base 1.9 mm; lacking: by the wall, of the derivatives."""
    values = np.array([-6e-4, 2e-3]) * np.exp(powers @ np.log(point / [1.1, 1.9]))
    rates = values[:, None] * (powers - lacking * np.array([1.0, 0.0])) / point
    stretch = 1.2 / point[0]
    return Numbers(values, rates, stretch, np.array([-stretch / point[0], 0.0]), np.zeros((2, 2)))


def model(file: WishFile, point: Array = START) -> Model:
    return Model(file, point, numbers(point), (0.0, np.zeros(2)), np.zeros((2, 2)))


def test_products_of_powers_are_met_in_one_step(tmp_path: Path) -> None:
    found = propose(model(small(tmp_path, TWO)), 0.2)
    assert found.point == pytest.approx([1.1, 1.9], rel=1e-3)
    assert found.misses.max() < 0.05
    assert np.isnan(found.objective)


def test_a_step_ends_at_its_radius(tmp_path: Path) -> None:
    found = propose(model(small(tmp_path, TWO)), 0.04)
    assert np.abs(np.log(found.point / START)).max() == pytest.approx(0.04)
    before = np.sqrt(model(small(tmp_path, TWO)).misses(np.log(START))[0])
    assert np.sum(found.misses**2) < np.sum(before**2)


def test_what_is_made_small_stays_within_the_tolerances(tmp_path: Path) -> None:
    wide = TWO.replace("within: 2 %", "within: 20 %")
    heavy, light = (propose(model(small(tmp_path, text)), 0.4) for text in (wide, wide + "minimize: mass\n"))
    assert light.objective < 0.99
    assert light.misses.max() <= 0.71
    assert max(heavy.misses) < max(light.misses)


def test_limits_are_kept_where_wishes_would_exceed_them(tmp_path: Path) -> None:
    file = small(tmp_path, TWO + "limits: {largest_stretch: 1.05, smallest_wall: 1 mm}\n")
    found = propose(model(file), 0.4)
    assert found.limits.max() <= 1.0
    assert 1.2 / found.point[0] <= 1.065  # the model of the stretch is a straight line
    assert found.misses.max() > 0.05


def test_derivatives_of_the_model_are_those_of_its_numbers(tmp_path: Path) -> None:
    own, u = model(small(tmp_path, TWO)), np.log([1.07, 2.1])
    squares, rates = own.misses(u)
    for k, step in enumerate(1e-6 * np.eye(2)):
        difference = (own.misses(u + step)[0] - own.misses(u - step)[0]) / 2e-6
        assert rates[:, k] == pytest.approx(difference, rel=1e-6)
    assert squares == pytest.approx(model(small(tmp_path, TWO), np.exp(u)).misses(u)[0], rel=1e-9)


def test_a_step_shows_what_derivatives_lack(tmp_path: Path) -> None:
    """Exact ones lack nothing, however far the step; others lack what they lack along it."""
    wishes, end = small(tmp_path, TWO).wishes, np.array([1.2, 2.0])
    nothing = np.zeros((2, 2))
    exact = missing_slopes(wishes, (START, numbers(START)), (end, numbers(end)), nothing)
    assert np.abs(exact).max() < 1e-12
    pair = [(point, numbers(point, lacking=0.3)) for point in (START, end)]
    assert missing_slopes(wishes, *pair, nothing) == pytest.approx(np.array([[0.3, 0.0], [0.3, 0.0]]))


def test_coarse_numbers_are_corrected_by_factors_and_differences(tmp_path: Path) -> None:
    wishes, coarse = small(tmp_path, TWO).wishes, numbers(START)
    fine = replace(coarse, values=coarse.values * [1.1, 0.9])
    applied = Correction.of(wishes, coarse, fine).applied(coarse)
    assert applied.values == pytest.approx(fine.values)
    assert applied.rates == pytest.approx(coarse.rates * [[1.1], [0.9]])


def test_an_exceeded_limit_costs_more_than_a_wish() -> None:
    met, over = merit_of(np.array([1.0, 1.0]), np.array([1.0]), np.nan), merit_of(np.zeros(2), np.array([1.1]), np.nan)
    assert met == pytest.approx(2.0)
    assert over > met
    assert merit_of(np.array([0.9]), np.zeros(0), 0.5) == 0.5


def test_the_least_pressure_is_over_that_at_the_start(tmp_path: Path) -> None:
    file = small(tmp_path, SMALL + "minimize: pressure\n")
    u = np.log(file.wishes.start)
    assert exact_objective(file, u) == pytest.approx(1.0)
    assert exact_objective(file, u + np.log([1.3, 1.0, 0.8])) == pytest.approx(0.8)


def test_starts_are_the_given_one_and_others_within_the_bounds(tmp_path: Path) -> None:
    file = small(tmp_path, TWO + "starts: 4\n")
    points = list(starts(file))
    assert len(points) == 4
    assert points[0].tolist() == START.tolist()
    low, high = file.wishes.bounds.T
    assert all(np.all((low <= point) & (point <= high)) for point in points)
    assert np.array_equal(points[2], list(starts(file))[2])
