"""Steps of the search by its model, and the whole search, for numbers that are products of powers."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.study.wishes import search
from pipeline.study.wishes.measured import NotBorne, Response
from pipeline.study.wishes.report import active_constraints, report_of
from pipeline.study.wishes.search import Search, SearchResult, Trial, starts
from pipeline.study.wishes.step import Model, Worth, propose
from pipeline.study.wishes.wish import WishFile
from tests.pipeline.study.wishes.test_measured import CONFIGS, SMALL, small
from tests.solved import alone

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


def numbers(point: Array, powers: Array = POWERS) -> Response:
    """Of an arm that has what is wished at wall 1.1 mm and base 1.9 mm."""
    values = np.array([-6e-4, 2e-3]) * np.exp(powers @ np.log(point / [1.1, 1.9]))
    stretch = 1.2 / point[0]
    by_stiffness = values * [-1.0, 1.0]  # less curvature, and more stiffness
    return Response(values, values[:, None] * powers, by_stiffness, stretch, np.array([-stretch, 0.0]), {})


def model(file: WishFile, point: Array = START) -> Model:
    return Model(file, point, numbers(point))


def proposed(file: WishFile, radius: float) -> tuple[Array, Worth]:
    own = model(file)
    point = propose(own, radius)
    return point, own.worth(np.log(point))


def test_products_of_powers_are_met_in_one_step(tmp_path: Path) -> None:
    point, worth = proposed(small(tmp_path, TWO), 0.2)
    assert point == pytest.approx([1.1, 1.9], rel=1e-3)
    assert worth.misses.max() < 0.05
    assert np.isnan(worth.objective)


def test_a_step_ends_at_its_radius(tmp_path: Path) -> None:
    file = small(tmp_path, TWO)
    point, worth = proposed(file, 0.04)
    assert np.abs(np.log(point / START)).max() == pytest.approx(0.04)
    assert worth.merit < model(file).worth(np.log(START)).merit


def test_what_is_made_small_stays_within_the_tolerances(tmp_path: Path) -> None:
    wide = TWO.replace("within: 2 %", "within: 20 %")
    (_, heavy), (_, light) = (proposed(small(tmp_path, text), 0.4) for text in (wide, wide + "minimize: mass\n"))
    assert light.objective < 0.99
    assert light.misses.max() <= 0.71
    assert max(heavy.misses) < max(light.misses)


def test_limits_are_kept_where_wishes_would_exceed_them(tmp_path: Path) -> None:
    file = small(tmp_path, TWO + "limits: {largest_stretch: 1.05, smallest_wall: 1 mm}\n")
    point, worth = proposed(file, 0.4)
    assert worth.limits.max() <= 1.0
    assert 1.2 / point[0] <= 1.065  # the model of the stretch is a straight line
    assert worth.misses.max() > 0.05


def test_derivatives_of_the_model_are_those_of_its_numbers(tmp_path: Path) -> None:
    own, u = model(small(tmp_path, TWO)), np.log([1.07, 2.1])
    rates = own.misses(u)[1]
    for k, step in enumerate(1e-6 * np.eye(2)):
        difference = (own.misses(u + step)[0] - own.misses(u - step)[0]) / 2e-6
        assert rates[:, k] == pytest.approx(difference, rel=1e-6)


def test_an_exceeded_limit_costs_more_than_a_wish() -> None:
    met = Worth(np.array([1.0, 1.0]), np.array([1.0]), np.nan)
    over = Worth(np.zeros(2), np.array([1.1]), np.nan)
    assert met.merit == pytest.approx(2.0)
    assert over.merit > met.merit
    assert Worth(np.array([0.9]), np.zeros(0), 0.5).merit == 0.5


def test_the_least_pressure_is_over_that_at_the_start(tmp_path: Path) -> None:
    file = small(tmp_path, SMALL + "minimize: pressure\n")
    u, own = np.log(file.wishes.start), Model(file, file.wishes.start, numbers(START))
    assert own.objective(u) == pytest.approx(1.0)
    assert own.objective(u + np.log([1.3, 1.0, 0.8])) == pytest.approx(0.8)


@dataclass
class Drawn:
    """In place of coarse cells: numbers that are products of powers, and 10 % less than those of the law."""

    limit_mm: float = 10.0
    is_fine: bool = False

    def reaches(self, point: Array) -> bool:
        return True

    def numbers(self, point: Array) -> Response:
        if point[0] > self.limit_mm:
            raise NotBorne("the cell does not bear 20 kPa")
        return numbers(point / 1.02)


def searched(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch, coarse: Drawn) -> tuple[WishFile, SearchResult]:
    monkeypatch.setattr(search.MovedMesh, "of", lambda *_, is_fine: replace(coarse, is_fine=is_fine))
    monkeypatch.setattr(search, "delivered", lambda _, point, __: (numbers(point).values, 1.0))
    file = small(folder, text)
    with alone(folder / "out", file, fresh=True) as context:
        return file, Search(file, context).run()


def test_a_search_corrects_coarse_numbers_by_the_law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, found = searched(tmp_path, TWO, monkeypatch, Drawn())
    assert found.trial.point == pytest.approx([1.1, 1.9], rel=3e-3)
    assert [one.law for one in found.history].count("delivered") == 2  # exact ratios: one correction suffices
    assert {one.start for one in found.history} == {1}


def test_the_nearest_design_tells_what_was_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounds of the wall leave one number to the base: the least sum of squares lies between both wishes."""
    file, found = searched(tmp_path, TWO.replace("to: 2 mm", "to: 1.001 mm"), monkeypatch, Drawn())
    sums = [
        np.sum(file.wishes.misses(numbers(np.array([1.001, base])).values) ** 2) for base in np.linspace(1.5, 2.5, 1001)
    ]
    assert found.trial.point[0] == pytest.approx(1.001)
    assert found.trial.worth.merit < 1.05 * min(sums)  # no step is tried that gains less
    report = report_of(file, found, tmp_path)
    assert report.given_up[0].startswith("wishes[1], kappa_0 at 20 kPa, is -0.7")
    assert report.behind[0] == "geometry.wall is at its bound, 1.001 mm; at 1.11 mm nothing would be missed"
    assert report.record()["behind"] == report.behind


def test_a_limit_in_the_way_is_named(tmp_path: Path) -> None:
    """The wished arm has a wall of 1.1 mm; the limit asks for 1.3 mm."""
    file = small(tmp_path, TWO + "limits: {smallest_wall: 1.3 mm}\n")
    own = model(file, np.array([1.3, 1.5]))
    assert "limits.smallest_wall, 1.3 mm, is in the way; at 1.09 mm nothing would be missed" in active_constraints(own)


@pytest.mark.parametrize(("factor", "word"), [(0.8, "stiff"), (1.25, "soft")])
def test_the_material_is_a_reason(tmp_path: Path, factor: float, word: str) -> None:
    """An arm that would have both wishes with other moduli, which change its curvature and its stiffness alike."""
    own = model(small(tmp_path, TWO), np.array([1.1, 1.9]))
    stiff = own.numbers.by_stiffness / own.numbers.values
    values = own.numbers.values * factor**-stiff
    changed = replace(own.numbers, values=values, rates=0.0 * own.numbers.rates, by_stiffness=stiff * values)
    (told,) = active_constraints(replace(own, numbers=changed))
    assert told.startswith(f"the material is too {word}; with ")
    assert float(told.split("with ")[1].split(" ")[0]) == pytest.approx(factor, rel=0.05)
    assert told.endswith("times its moduli nothing would be missed")


def test_nothing_is_told_where_no_bound_helps(tmp_path: Path) -> None:
    own = model(small(tmp_path, TWO), np.array([1.1, 1.9]))
    off = replace(own.numbers, values=2.0 * own.numbers.values, rates=0.0 * own.numbers.rates)
    assert active_constraints(replace(own, numbers=replace(off, by_stiffness=0.0 * off.by_stiffness))) == ()


def test_a_design_that_is_not_borne_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NotBorne, match="does not bear 20 kPa"):
        searched(tmp_path, TWO, monkeypatch, Drawn(limit_mm=0.1))
    _, found = searched(tmp_path, TWO, monkeypatch, Drawn(limit_mm=1.05))
    assert found.trial.point[0] <= 1.05
    assert any(not isinstance(one, Trial) for one in found.history)


def test_starts_are_the_given_one_and_others_within_the_bounds(tmp_path: Path) -> None:
    file = small(tmp_path, TWO + "starts: 4\n")
    points = list(starts(file))
    assert len(points) == 4
    assert points[0].tolist() == START.tolist()
    low, high = file.wishes.bounds.T
    assert all(np.all((low <= point) & (point <= high)) for point in points)
    assert np.array_equal(points[2], list(starts(file))[2])
