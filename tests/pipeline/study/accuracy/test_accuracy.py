"""The convergence study: its configurations, errors on made-up numbers, and a small study that is solved."""

import json
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from fem.elements import ELEMENTS
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.show.progress import Lines
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.study.accuracy import ladder as rungs
from pipeline.study.accuracy import run as run_module
from pipeline.study.accuracy.ladder import CONTACT, Rung, ladder
from pipeline.study.accuracy.measure import HEADLINE, Cost, RodNumbers, RungResult
from pipeline.study.accuracy.reference import (
    COORDINATES,
    References,
    limit,
    orders_along,
    without_contact_distance,
)
from pipeline.study.accuracy.run import measured, run_study
from pipeline.study.accuracy.study import ConvergenceStudy, convergence_study, largest_error, pareto_front
from pipeline.study.accuracy.table import orders_table, references_table, study_page, study_table
from pipeline.values.errors import RunFailed
from pipeline.values.richardson import Limit

CONTACT_MM = 0.04
EXACT = {"kappa_0_per_mm": -0.016, "alpha1_N_mm2": 50.0, "alpha2_N_mm2": 400.0, "d_mm": 12.0, "force_N": 0.03}


@pytest.fixture
def config(configs: Path) -> Config:
    return load_config(configs / "pneunet_coarse.yaml")


def test_pareto_front() -> None:
    points = [(1.0, 9.0), (2.0, 4.0), (2.0, 5.0), (3.0, 4.0), (4.0, 1.0), (5.0, 2.0)]
    assert pareto_front(points) == [0, 1, 4]
    assert pareto_front([]) == []
    assert pareto_front([(1.0, 1.0), (1.0, 1.0)]) == [0]


def test_the_limit_is_that_of_infinitely_many_degrees_of_freedom() -> None:
    sizes = [20_000, 40_000, 80_000, 160_000]
    steady = [(n, 10.0 + 50.0 * n ** (-2 / 3)) for n in sizes]
    single = limit([dict(steady)])
    assert single.value == pytest.approx(10.0, abs=2 * single.std)
    assert single.std < 0.2 * (steady[-1][1] - 10.0) + 0.02
    other = [(n, value + 0.3) for n, value in steady]
    both = limit([dict(steady), dict(other)])
    assert both.std > single.std
    assert both.std >= 0.15 * 0.99
    assert limit([dict(steady[:1])]) is None
    assert limit([]) is None


def test_the_reference_is_extrapolated_to_zero_contact_distance() -> None:
    distances = {mm: 7.0 + 2.0 * mm for mm in (0.2, 0.1, 0.05, 0.025)}
    reference = without_contact_distance(Limit(7.4, 0.01), distances, 0.2)
    assert reference.value == pytest.approx(7.0, abs=0.02)
    assert reference.std >= 0.01


def test_errors_are_relative_and_that_of_the_end_is_over_the_length() -> None:
    end = dict(zip(COORDINATES, (100.0, -60.0), strict=True))
    references = References(17.0, {name: Limit(value, 0.0) for name, value in {**EXACT, **end}.items()})
    numbers = replace(rod_numbers(17.0, 0.0), alpha2_N_mm2=408.0, d_mm=None, end_mm=(103.0, -64.0))
    errors = references.errors(numbers, 100.0)
    assert errors["alpha2_N_mm2"] == pytest.approx(0.02)
    assert errors["end_mm"] == pytest.approx(0.05)
    assert errors["kappa_0_per_mm"] == 0.0
    assert errors["d_mm"] is None
    assert largest_error([errors, {**errors, "force_N": -0.03}]) == pytest.approx(0.03)
    assert largest_error([{**errors, "force_N": None}]) is None
    without = References(17.0, {**references.numbers, "force_N": None})
    assert without.errors(numbers, 100.0)["force_N"] is None
    record = references.record()
    assert record["end_mm"] == [{"value": 100.0, "std": 0.0}, {"value": -60.0, "std": 0.0}]
    assert record["force_N"] == {"value": 0.03, "std": 0.0}


def rod_numbers(pressure: float, error: float) -> RodNumbers:
    """The exact numbers, all off by the same relative error."""
    return RodNumbers(
        pressure_kPa=pressure,
        **{name: value * (1.0 + error) for name, value in EXACT.items()},
        end_mm=(100.0, -60.0 * (1.0 + error)),
        alpha2_std_N_mm2=0.5,
        stress_error=0.1,
    )


def made_up(rung: Rung) -> RungResult:
    """The result of a rung whose error is 1000 / n, twice that with elements that lock, and 50 % per mm of contact
    distance."""
    size, formulation = rung.config.mesh.size_mm, rung.config.mesh.formulation
    n = 500_000 / size**2 * (1.3 if rung.config.mesh.grading == "walls" else 1.0)
    n = round(n / 6 if formulation == "p1" else n)
    error = 1000.0 / n * (2.0 if ELEMENTS[formulation].fully_integrated else 1.0)
    error += 0.5 * (rung.config.effects.self_contact.dhat_mm or CONTACT_MM)
    numbers = [rod_numbers(pressure, error) for pressure in rung.config.pressures_kPa]
    stages = dict.fromkeys(("mesh", "set_up", "assembly", "factorization", "contact", "fit"), n / 1e4)
    cost = Cost(n / 1e3, n / 1e3, stages, n / 100.0, n, n, 0.3, 60)
    return RungResult("", tuple(numbers), cost)


def single_line(result: RungResult) -> RungResult:
    """The result with a law of a single line."""
    changed = [replace(numbers, alpha1_N_mm2=250.0, alpha2_N_mm2=250.0, d_mm=None) for numbers in result.numbers]
    return replace(result, numbers=tuple(changed))


@pytest.fixture
def study(config: Config) -> ConvergenceStudy:
    return convergence_study(config, [(rung, made_up(rung)) for rung in ladder(config, CONTACT_MM)], CONTACT_MM)


def test_errors_of_a_made_up_study(study: ConvergenceStudy) -> None:
    for references in study.references:
        for name, value in EXACT.items():
            reference = references.numbers[name]
            assert reference.value == pytest.approx(value, rel=5e-3)
            assert reference.value == pytest.approx(value, abs=2 * reference.std)
    [base] = [row for row in study.rows if (row.series, row.value) == ("p2p0", 4.0)]
    expected = 1000.0 / base.result.cost.degrees_of_freedom + 0.5 * CONTACT_MM
    assert base.largest_error == pytest.approx(expected, abs=5e-3)
    by_distance = {row.value: row.largest_error for row in study.rows if row.series == CONTACT}
    assert by_distance[0.16] - by_distance[0.02] == pytest.approx(0.5 * 0.14, rel=0.05)
    assert 0.0 < study.reference_error < 0.03
    assert not any(row.on_front for row in study.rows if row.series == "p2")
    assert any(row.on_front for row in study.rows)


def test_meshes_with_a_single_line_are_left_out_of_the_reference_of_two(config: Config) -> None:
    """The rigidity of a single line, identified on the coarsest meshes, is not the second one of the finer meshes."""
    results = [
        (rung, single_line(made_up(rung)) if rung.is_mesh and rung.value == 6.0 else made_up(rung))
        for rung in ladder(config, CONTACT_MM)
    ]
    for references in convergence_study(config, results, CONTACT_MM).references:
        for name in ("alpha1_N_mm2", "alpha2_N_mm2"):
            reference = references.numbers[name]
            assert reference.value == pytest.approx(EXACT[name], rel=1e-3)
            assert reference.std < 0.011 * EXACT[name]  # of the contact distance; with the coarse meshes 0.4


@pytest.mark.parametrize(
    "single", ["mixed at 3 and 2.4 mm", "the finest of both lines", "contact at 0.02 mm"], ids=lambda text: text
)
def test_the_reference_belongs_to_the_law_of_most_meshes(config: Config, single: str) -> None:
    finest = {"mixed": (2.4,), "mixed, graded to walls": (1.3,)}
    changed: Callable[[Rung], bool] = {
        "mixed at 3 and 2.4 mm": lambda rung: rung.series == "mixed" and rung.value in (3.0, 2.4),
        "the finest of both lines": lambda rung: rung.value in finest.get(rung.series, ()),
        "contact at 0.02 mm": lambda rung: rung.series == CONTACT and rung.value == 0.02,
    }[single]
    rungs = ladder(config, CONTACT_MM)
    assert any(map(changed, rungs))
    results = [(rung, single_line(made_up(rung)) if changed(rung) else made_up(rung)) for rung in rungs]
    for references in convergence_study(config, results, CONTACT_MM).references:
        for name in ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm"):
            reference = references.numbers[name]
            assert reference.value == pytest.approx(EXACT[name], rel=5e-3)


def test_failed_rungs_have_a_reason_and_no_error(config: Config) -> None:
    results = [(rung, made_up(rung)) for rung in ladder(config, CONTACT_MM)]
    results[0] = (results[0][0], RungResult("the body could not be meshed", (), None))
    row = convergence_study(config, results, CONTACT_MM).rows[0]
    assert (row.largest_error, row.on_front, row.errors) == (None, False, {})
    assert row.result.failure == "the body could not be meshed"
    with pytest.raises(RunFailed, match="17 kPa, 37 kPa"):
        convergence_study(config, [(rung, RungResult("no", (), None)) for rung, _ in results], CONTACT_MM)


def test_a_pressure_that_too_few_meshes_reach_is_left_out(config: Config) -> None:
    def stopped(result: RungResult) -> RungResult:
        numbers = tuple(row for row in result.numbers if row.pressure_kPa == 17.0)
        return replace(result, failure="III: no equilibrium found", numbers=numbers)

    results = [(rung, made_up(rung)) for rung in ladder(config, CONTACT_MM)]
    results = [(rung, stopped(result) if "mixed" in rung.series else result) for rung, result in results]
    study = convergence_study(config, results, CONTACT_MM)
    assert [references.pressure_kPa for references in study.references] == [17.0]
    assert study.left_out_kPa == (37.0,)
    assert list(study.rows[0].errors) == [17.0]
    assert all(row.largest_error is not None for row in study.rows)  # of the pressure that is reported
    assert "left out: 37 kPa" in study_table(study).caption
    assert json.loads(json.dumps(study.record()))["left_out_kPa"] == [37.0]


def test_rungs_are_told_and_kept_as_soon_as_they_are_measured(
    config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_module, "Processes", lambda jobs, is_fresh: ThreadPoolExecutor(jobs))
    by_hash = {rung.config.hash: rung for rung in ladder(config, CONTACT_MM)}
    monkeypatch.setattr(run_module, "measure", lambda config: made_up(by_hash[config.hash]))
    told = StringIO()
    rungs = ladder(config, CONTACT_MM)[:3]
    with open_store(tmp_path, config) as store:
        results = measured(rungs, store, 1, Lines(Console(file=told)))
        assert measured(rungs[:2], store, 1, Silent()) == results[:2]  # kept
    assert results == [(rung, made_up(rung)) for rung in rungs]
    assert len(told.getvalue().splitlines()) == 1 + len(rungs)


def test_orders_are_those_of_the_errors(study: ConvergenceStudy) -> None:
    """Errors of 1000/n fall with the third power of the mesh size n^(-1/3)."""
    by_series = study.orders
    for pressure in (17.0, 37.0):
        for name in HEADLINE:
            order = by_series["mixed, graded to walls", pressure][name]
            assert order.meshes == 7
            assert order.std < 0.5
            assert order.value == pytest.approx(3.0, abs=2.0 * order.std)
    assert by_series["mixed", 17.0][HEADLINE[0]].meshes == 5


def test_orders_belong_to_the_law_of_the_finest_mesh(config: Config) -> None:
    rungs = [rung for rung in ladder(config, CONTACT_MM) if rung.series == "mixed"]
    coarsest = max(rung.value for rung in rungs)
    meshes = []
    for rung in rungs:
        result = single_line(made_up(rung)) if rung.value == coarsest else made_up(rung)
        meshes.append((result.cost.degrees_of_freedom, result.numbers[0]))
    orders = orders_along(meshes)
    assert {name: order.meshes for name, order in orders.items()} == dict(zip(HEADLINE, (5, 4, 5), strict=True))
    assert orders_along(meshes[:2]) == {}


def test_table_and_pictures(study: ConvergenceStudy) -> None:
    for table in (study_table(study), references_table(study), orders_table(study)):
        assert {len(row) for row in table.rows} == {len(table.heads)}
    assert [row[0] for row in references_table(study).rows] == ["17", "37"]
    assert references_table(study).rows[0][1].startswith("-0.016 ")
    assert ("mixed", "17") in {row[:2] for row in orders_table(study).rows}
    assert "Pareto front" in study_page(study)


@pytest.mark.slow
def test_a_small_study_is_solved_and_resumed(configs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rungs, "SIZES", {"off": (1.0, 0.75)})
    monkeypatch.setattr(rungs, "LOCKING", {1: (0.5,)})
    monkeypatch.setattr(rungs, "ELEMENTS", {name: ELEMENTS[name] for name in ("mixed", "p1")})
    monkeypatch.setattr(rungs, "TOLERANCES", ())
    monkeypatch.setattr(rungs, "DISTANCES", ())
    overrides = ["geometry.chambers=8", "mesh={size: 8 mm, formulation: mixed}", "pressures=[5 kPa]"]
    config = load_config(configs / "pneunet_coarse.yaml", [*overrides, "effects.self_contact=off"])
    study = run_study(config, tmp_path, 1, False, Silent())
    written = json.loads((tmp_path / "accuracy.json").read_text())
    assert [row["headline"] for row in written["rungs"]] == [row.largest_error for row in study.rows]
    assert (tmp_path / "accuracy.html").is_file()
    coarse, fine, linear = (row.result.cost for row in study.rows)
    assert coarse.degrees_of_freedom < fine.degrees_of_freedom
    assert 2 * linear.degrees_of_freedom < coarse.degrees_of_freedom
    errors = [row.largest_error for row in study.rows]
    assert None not in errors
    assert errors[0] > errors[1] > 0.0  # type: ignore[operator]
    mixed, p1 = study.rows[0].result, study.rows[2].result
    assert p1.numbers[0].alpha1_N_mm2 > 2 * mixed.numbers[0].alpha1_N_mm2  # linear elements lock
    for row, cost in zip(study.rows, (coarse, fine, linear), strict=True):
        assert row.result.failure == ""
        assert 100.0 < cost.peak_memory_MB < 4000.0
        assert 0.0 < cost.seconds["factorization"] < cost.wall_seconds
        assert cost.cpu_seconds > 0.0

    def refuse(config: Config) -> RungResult:
        raise AssertionError("nothing is left to be measured")

    monkeypatch.setattr(run_module, "measure", refuse)
    assert run_study(config, tmp_path, 1, False, Silent()).rows == study.rows
