"""The claims of the paper: the rule of the verdicts, the measures behind the readings, and those of half cells."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.paper.__main__ import draw, provenance
from benchmarks.paper.claims import claims
from benchmarks.paper.claims.simulations import between, scaled_by_pressure
from benchmarks.paper.data import Data
from benchmarks.paper.free_lines import TestedCurves
from benchmarks.paper.measures import aligned_distance, line, sign_change
from benchmarks.paper.page import number, overview, write_page
from benchmarks.paper.random_cells import FILE, RandomCell, line_through, measure, read, write
from benchmarks.paper.reading import CONTRADICTED, MISSING, REPRODUCED, UNDECIDED, Claim, Reading
from benchmarks.paper.states import State
from benchmarks.unseen.designs import drawn
from geometry import Centreline
from pipeline.study.sweep.points import Point
from pipeline.study.sweep.spec import points_of, read_sweep
from rod import FiveParameters


def _sweep(folder: Path, name: str, **record: object) -> None:
    """A sweep without a point."""
    path = folder / f"paper_{name}"
    path.mkdir()
    (path / "sweep.csv").touch()
    (path / "sweep.json").write_text(json.dumps({"commit": None, "points": [], **record}), encoding="utf-8")


HERE = Path(__file__).resolve().parent.parent.parent
YES, NO, OPEN = (1.0, 0.9, 1.1), (3.0, 2.9, 3.1), (2.0, 1.9, 2.1)


def reading(numbers: tuple[float, float, float], **others: str) -> Reading:
    """One that is required to lie between 0 and 2."""
    return Reading("x", *numbers, required=(0.0, 2.0), **others)  # type: ignore[arg-type]


def verdict(*readings: Reading) -> str:
    return Claim("1", "x", readings, "").verdict


def test_a_reading_holds_with_its_whole_interval() -> None:
    assert [reading(numbers).status for numbers in (YES, NO, OPEN)] == ["holds", "does not hold", "open"]
    assert Reading("x", 1.0, 1.0, 1.0).status is None
    nothing = (math.nan, math.nan, math.nan)
    assert reading(nothing).status == "open"
    assert Reading("x", *nothing, required=(0.0, 1.0), denies=True).status == "does not hold"


def test_the_verdict_follows_from_the_readings_that_count() -> None:
    assert verdict(reading(YES), reading(YES)) == REPRODUCED
    assert verdict(reading(NO), Reading("beside", *YES)) == CONTRADICTED
    assert verdict(reading(YES), reading(OPEN)) == f"{REPRODUCED} in part"
    assert verdict(reading(YES), reading((math.nan,) * 3)) == REPRODUCED
    assert verdict(reading(OPEN)) == UNDECIDED
    assert verdict() == verdict(Reading("beside", *YES)) == MISSING


def test_the_fewest_factors_that_decide_are_named() -> None:
    def of(numbers: tuple[float, float, float], law: str, estimator: str) -> Reading:
        return reading(numbers, law=law, estimator=estimator)

    by_law = [of(YES, "hencky", "a"), of(NO, "svk", "a"), of(YES, "hencky", "b"), of(NO, "svk", "b")]
    assert verdict(*by_law) == "depends on the material law"
    by_both = [of(YES, "hencky", "a"), of(NO, "svk", "a"), of(NO, "hencky", "b"), of(NO, "svk", "b")]
    assert verdict(*by_both) == "depends on the material law and the estimator"
    assert verdict(of(YES, "svk", "a"), of(NO, "svk", "a")) == "depends on more than this"


def test_a_line_with_its_scatter_and_what_lies_off_it() -> None:
    exact = line([1.0, 2.0, 4.0], [3.0, 5.0, 9.0])
    assert (exact.slope, exact.off, exact.at_zero) == pytest.approx((2.0, 0.0, -0.5), abs=1e-12)
    bent = line([-1.0, 0.0, 1.0], [1.0, 0.0, 1.0])
    assert (bent.slope, bent.off) == pytest.approx((0.0, 2.0 / 3.0))
    assert bent.slope_std == pytest.approx(math.sqrt(2.0 / 3.0 / 2.0))
    assert line([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.2] * 3).slope_std == pytest.approx(0.2 / math.sqrt(2.0))
    assert line([1.0, 2.0], [1.0, 3.0], origin=True).slope == pytest.approx(1.4)


def test_curves_are_compared_after_a_rigid_motion() -> None:
    s = np.linspace(0.0, 3.0, 31)
    arc = Centreline(s, np.sin(s), 1.0 - np.cos(s))
    turned = Centreline(s, 2.0 - arc.y, 5.0 + arc.x)
    assert aligned_distance(turned, arc) == pytest.approx(0.0, abs=1e-12)
    assert aligned_distance(Centreline(s, arc.x, -arc.y), arc) > 0.1  # a mirror image is another curve
    assert sign_change(s, np.cos(s)) == pytest.approx(np.pi / 2, abs=1e-3)
    assert math.isnan(sign_change(s, np.ones(31)))


def test_without_sweeps_every_claim_says_that_it_is_not_measured_yet(tmp_path: Path) -> None:
    all_claims = claims(Data(tmp_path))
    assert len(all_claims) > 20
    assert {claim.verdict for claim in all_claims} == {MISSING}
    assert all("has not been run" in claim.missing for claim in all_claims)
    text = overview(all_claims)
    assert text.count("**not yet measured**") == len(all_claims)


@pytest.mark.parametrize("mesh", ["coarse", "fine"])
def test_every_point_of_the_sweeps_of_the_paper_is_a_configuration(mesh: str) -> None:
    files = sorted((HERE / "configs" / "paper" / mesh).glob("*.yaml"))
    assert len(files) == 7
    for file in files:
        points = points_of(read_sweep(file), Path())
        assert len(points) >= 2
        assert all(isinstance(point, Point) for point in points), file


CELL = RandomCell(151, 0, "semicircular_single", "svk", 20.0, -0.1, 100.0, 110.0, 0.001)


def test_the_shape_without_load_follows_from_that_of_another_pressure() -> None:
    """A circle of curvature 1/100 at 37 kPa is one of 1/200 at half the pressure."""
    s = np.linspace(0.0, 100.0, 2001)

    def circle(radius: float) -> Centreline:
        return Centreline(s, radius * np.sin(s / radius), radius * (1.0 - np.cos(s / radius)))

    curves = TestedCurves(circle(100.0), circle(100.0), (0.0, 0.0))
    high = State(Path(), {}, 37.0, 10.0, curves, 0.0)
    free = scaled_by_pressure(replace(high, pressure=18.5), high).curves.free
    assert np.hypot(free.x - circle(200.0).x, free.y - circle(200.0).y).max() < 1e-4


def test_numbers_between_two_pressures_lie_on_straight_lines() -> None:
    low, high = FiveParameters(100.0, 200.0, 0.0, 1.0, 6.0), FiveParameters(200.0, 400.0, 2.0, 3.0, 8.0)
    assert between(low, high, 0.25) == FiveParameters(125.0, 250.0, 0.5, 1.5, 6.5)


def test_a_line_through_a_law_and_what_lies_off_it() -> None:
    kappa = np.linspace(-0.01, 0.0, 21)
    assert line_through(kappa, 300.0 * kappa + 2.0) == (pytest.approx(300.0), pytest.approx(0.0, abs=1e-12))
    _, off = line_through(kappa, np.where(kappa < -0.005, 100.0, 300.0) * (kappa + 0.005))
    assert off > 0.1


def test_rows_are_read_as_they_were_written_and_decide_the_claims(tmp_path: Path) -> None:
    cells = [
        replace(CELL, number=k, family=family)
        for family in ("semicircular_single", "bisected_circle")
        for k in range(9)
    ]
    write(tmp_path / FILE, [*cells, replace(CELL, number=99, rigidity_low=float("nan"), reason="no equilibrium")])
    assert read(tmp_path)[:-1] == cells
    assert not read(tmp_path)[-1].is_solved
    assert _verdicts(tmp_path) == (CONTRADICTED, CONTRADICTED)
    (tmp_path / FILE).unlink()
    write(tmp_path / FILE, [replace(cell, rigidity_high=90.0, off_line=0.1) for cell in cells])
    assert _verdicts(tmp_path) == (REPRODUCED, REPRODUCED)


def _verdicts(folder: Path) -> tuple[str, str]:
    found = {claim.number: claim.verdict for claim in claims(Data(folder))}
    return found["8c"], found["12b"]


def test_a_drawn_cell_is_measured(tmp_path: Path) -> None:
    cell = measure(drawn(151, 16)[0], tmp_path)
    assert cell.is_solved
    assert cell.rigidity_high == pytest.approx(126.3, rel=0.02)
    assert cell.off_line < 0.01


def test_a_figure_without_its_state_is_not_drawn_and_does_not_stop_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The pictures of bodies and the figures over the length need single states; `make paper` goes on without them."""
    point = {"folder": "", "values": {}, "seconds": None, "status": "unfinished", "reason": "no equilibrium"}
    base = str(HERE / "configs" / "pneunet_coarse.yaml")
    _sweep(tmp_path, "pneunet", base=base, set={}, points=[point])
    _sweep(tmp_path, "lengths")
    drawn = {name for name, _ in draw(Data(tmp_path), tmp_path)}
    said = capsys.readouterr().out
    assert "not drawn: figure_03, without experiment I of pneunet with svk at 37 kPa\n" in said
    assert "not drawn: figure_12, without the arm of 11 chambers with svk at 24 kPa\n" in said
    assert {"figure_04.svg", "figure_09b.svg"} <= drawn
    assert not {"figure_03.png", "figure_12.svg"} & drawn


def test_sources_that_differ_from_their_commit_are_marked_on_the_page(tmp_path: Path) -> None:
    commits = {"pneunet": "a" * 40 + "+", "lengths": "b" * 40, "arms": None}
    for name, commit in commits.items():
        _sweep(tmp_path, name, commit=commit)
    assert "commit aaaaaaaaa+, bbbbbbbbb, unknown, on" in provenance(Data(tmp_path))


def test_the_page_has_every_claim_with_its_numbers(tmp_path: Path) -> None:
    claims_ = [Claim("1", "x", (reading(YES),), "because"), Claim("2", "y", (), "", "not run")]
    write_page(tmp_path, "Made today.", claims_, {"arms": ["a | b"]}, [("figure.svg", "Fig. 1")])
    text = (tmp_path / "paper.md").read_text(encoding="utf-8")
    for part in ("| 1 | x | **reproduced** | because |", "1.00 (0.90 to 1.10)", "| arms | a / b |", "`figure.svg`"):
        assert part in text, part
    stored = json.loads((tmp_path / "paper.json").read_text(encoding="utf-8"))
    assert [entry["verdict"] for entry in stored["claims"]] == [claim.verdict for claim in claims_]


def test_numbers_are_written_with_the_digits_of_their_interval() -> None:
    assert number(Reading("x", 1.2345, 1.2, 1.3, "mm")) == "1.234 (1.200 to 1.300) mm"
    assert number(Reading("x", -2.5, -2.8, -2.2)) == "-2.50 (-2.80 to -2.20)"
    assert number(Reading("x", 100.0, 100.0, 100.0, "%")) == "100.000 %"
    assert number(Reading("x", math.nan, math.nan, math.nan, without="no break")) == "no break"
