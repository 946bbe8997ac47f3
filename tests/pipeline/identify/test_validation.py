"""Loads out of sample in a whole run on a short arm of seven cells: files, figures, report."""

import csv
import json
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fem
from geometry import Centreline, Reason
from pipeline.config.config import Config, End
from pipeline.config.load import load_config
from pipeline.config.validation import Validation
from pipeline.identify.validate import find_loads_beyond_II, keep_reached_loads
from pipeline.results.files import read_results
from pipeline.run import run
from pipeline.simulate.loadcase import validation_cases
from pipeline.simulate.outcome import Failure, Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.progress import Silent
from rod import Load
from tests.pipeline.simulate.test_outcome import outcome, record
from tests.shared import SharedFolders
from tests.solved import alone

SHORT = """
name: seven
geometry: {family: pneunet, chambers: 7}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [6 kPa, 12 kPa, 24 kPa]
law: five
validation: {pressures: [12 kPa, 15 kPa], end_y: [3 mm], forces: [[0 N, 0.01 N]]}
mesh: {size: 8 mm, formulation: p2p0, grading: off, coarser: off}
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    path = tmp_path_factory.mktemp("config") / "seven.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return load_config(path)


@pytest.fixture(scope="module")
def results(config: Config, shared: SharedFolders, undrawn: None) -> Path:
    return shared.folder("seven", lambda out: run(config, out, 1, False, Silent()))


def read(results: Path, name: str):
    return json.loads((results / name).read_text(encoding="utf-8"))


def test_cases_are_named_by_their_load_and_go_on_from_the_run(config: Config) -> None:
    cases = {case.name: case for case in validation_cases(config)}
    assert list(cases) == ["dead_0_0.01N", "III_end_3mm", "III", "II"]
    assert cases["III_end_3mm"].load == "end at +3 mm"
    assert cases["dead_0_0.01N"].load == "dead force 0, 0.01 N"
    assert cases["II"].load == ""
    assert cases["II"].schedule.pressures_kPa == (24.0, 12.0, 15.0)  # between two states
    reached = {case.name: case for case in validation_cases(config, (6.0,))}
    assert list(reached) == list(cases)
    assert reached["II"].schedule.pressures_kPa == (6.0, 15.0)  # nothing is solved at a pressure that was not reached


def test_a_requested_load_beyond_the_end_of_II_is_named(config: Config) -> None:
    limit = Failure(12.0, (), 0, 0, limit_kPa=11.46)
    ended = Outcomes({"II": outcome("II", record(6.0), failure=limit)})
    left_out = (("dead force 0, 0.01 N", [12.0, 15.0]), ("end at +3 mm", [12.0, 15.0]), ("III", [15.0]), ("II", [15.0]))
    assert find_loads_beyond_II(config, ended) == tuple(
        Reason("load_left_out", {"load": load, "pressures_kPa": pressures, "end_kPa": 11.46})
        for load, pressures in left_out
    )
    bears_all = Outcomes({"II": outcome("II", record(6.0), record(12.0), record(24.0))})
    assert find_loads_beyond_II(config, bears_all) == ()
    of_program = replace(config, validation=replace(config.validation, with_experiments=False))
    assert find_loads_beyond_II(of_program, ended) == ()


def test_rows_out_of_sample_stand_behind_those_in_sample(results: Path) -> None:
    rows = read(results, "validation.json")
    count = 2 * len(read(results, "parameters.json")["pressures_kPa"])
    assert sum(row["sample"] == "in" for row in rows if row["rod"] == "five") == count
    out = [(row["experiment"], row["load"], row["pressure_kPa"]) for row in rows if row["sample"] == "out"]
    assert set(out) >= {
        ("dead", "dead force 0, 0.01 N", 12.0),
        ("dead", "dead force 0, 0.01 N", 15.0),
        ("III", "end at +3 mm", 12.0),
        ("III", "end at +3 mm", 15.0),
    }
    for row in rows:
        assert row["reason"] == ""
        assert row["distance_over_length"] < 0.05
        assert 0.0 <= row["distance_at_s_mm"] <= 72.0
        assert 0.0 <= row["curvature_error_at_s_mm"] <= 72.0
        assert (row["force_error"] is not None) == (row["experiment"] == "III")


def test_curves_of_the_loads_are_kept(results: Path) -> None:
    with (results / "validation_curves.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["experiment"] for row in rows} == {"II", "III", "dead"}
    assert all(row["rod_x_mm"] for row in rows)
    for row in filter(lambda row: row["load"], rows):
        force = row["force_x_N"], row["force_y_N"]
        told = f"dead force {float(force[0]):g}, {float(force[1]):g} N" if all(force) else ""
        assert told == (row["load"] if row["experiment"] == "dead" else "")
    forces = {curve.load: curve.force_N for curve in read_results(results).validation_curves}
    assert forces["dead force 0, 0.01 N"] == (0.0, 0.01)
    assert forces[""] == forces["end at +3 mm"] == ()


def test_parameters_have_intervals(results: Path) -> None:
    parameters = read(results, "parameters.json")
    assert set(parameters["estimators"]) == {"cell_averaged"}
    count = len(parameters["pressures_kPa"])
    for columns in parameters["estimators"].values():
        for value, (low, high) in zip(columns["alpha2_N_mm2"], columns["alpha2_N_mm2_95"], strict=True):
            assert low <= value <= high
        assert len(columns["d_is_at_most"]) == count
        assert columns["reason"] == [""] * count
    assert len(parameters["observations"]) == count
    for index, suffices in enumerate(parameters["single_line_suffices"]):
        if suffices:
            assert parameters["alpha1_N_mm2"][index] == parameters["alpha2_N_mm2"][index]


@pytest.mark.parametrize(
    ("name", "near", "others", "begins"),
    [
        ("III_end_3mm", "III", (), [[None] * 3, [0.5, 0.5], [None] * 2]),
        ("dead_0_0.01N", "II", ("II",), [[None] * 3, [None] * 3, [0.5, 0.625], [None] * 2]),
    ],
)
def test_a_load_begins_at_an_experiment_of_the_run(
    name: str,
    near: str,
    others: tuple[str, ...],
    begins: list[list[float | None]],
    config: Config,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """12 and 15 kPa from III at 12 kPa, or from II, which is solved at 15 kPa before; states as on the path from
    rest."""
    cases = {case.name: case for case in validation_cases(config, config.pressures_kPa)}
    scene, followed, begun = Scene.meshed(config), fem.follow, []

    def follow(*given: Any, begin: Sequence[fem.Step | None], **named: Any) -> fem.Solution:
        begun.append([step and step.factor for step in begin])
        return followed(*given, begin=begin, **named)

    monkeypatch.setattr(fem, "follow", follow)
    with alone(tmp_path / "near", config) as context:
        simulate(scene, context, [near])
        moved = simulate(scene, context, [cases[case] for case in (name, *others)])[name]
    with alone(tmp_path / "rest", config) as context:
        (rest,) = simulate(scene, context, [cases[name]])
    assert begun == begins
    for first, other in zip(moved.records, rest.records, strict=True):
        np.testing.assert_allclose(first.displacement, other.displacement, atol=1e-5)


def test_a_load_begins_at_the_next_lower_state_below_the_highest_one(config: Config) -> None:
    """Above it III may have ended at a limit. II is solved at 15 kPa too."""
    cases = {case.name: case for case in validation_cases(config, (6.0, 12.0))}
    begins = {name: [case.begin_kPa(p) for p in (3.0, 6.0, 9.0, 12.0, 15.0)] for name, case in cases.items()}
    assert begins["III_end_3mm"] == [None, 6.0, 6.0, 12.0, None]
    assert begins["dead_0_0.01N"] == [None, 6.0, 6.0, 12.0, 15.0]
    held = validation_cases(replace(config, end=End(x_mm=1.0, y_mm=0.0)), (6.0, 12.0))
    assert [case.name for case in held if case.near_kPa] == ["dead_0_0.01N"]
    assert not any(case.near_kPa for case in validation_cases(config))


@pytest.mark.parametrize(("rise", "height"), [(0.002, -7.2), (-0.002, 7.2)])
def test_the_chosen_end_of_an_arm_that_III_holds_down_is_below(tmp_path: Path, rise: float, height: float) -> None:
    path = tmp_path / "seven.yaml"
    path.write_text("\n".join(line for line in SHORT.splitlines() if "validation" not in line), encoding="utf-8")
    s = np.linspace(0.0, 72.0, 20)
    bent = Centreline(s, s, rise * s**2)
    states = [replace(record(pressure), centreline=bent) for pressure in (6.0, 12.0, 24.0)]
    outcomes = Outcomes({name: outcome(name, *states) for name in ("II", "III")})
    config = load_config(path)
    tested = keep_reached_loads(Scene(config, *(None,) * (len(fields(Scene)) - 1)), outcomes)  # type: ignore[arg-type]
    assert config.validation.end_y_mm == (pytest.approx(7.2),)
    assert tested.config.validation.end_y_mm == (pytest.approx(height),)


def test_the_small_forces_are_parts_of_EI_over_l2(tmp_path: Path) -> None:
    """The end of a cantilever with EI = 300 N mm2 and l = 72 mm, which a force F moves by F l^3 / (3 EI)."""
    path = tmp_path / "seven.yaml"
    path.write_text("\n".join(line for line in SHORT.splitlines() if "validation" not in line), encoding="utf-8")
    config = load_config(path)
    force, rigidity, length = 0.01, 300.0, 72.0
    s = np.linspace(0.0, length, 20)
    free = Centreline(s, s, 0.0 * s)
    moved = Centreline(s, s, force * length**3 / (3.0 * rigidity) * (s / length) ** 2)
    held = [replace(record(p), centreline=moved, load=Load(force=(0.0, force))) for p in (6.0, 12.0, 24.0)]
    outcomes = Outcomes(
        {
            "II": outcome("II", *(replace(record(p), centreline=free) for p in (6.0, 12.0, 24.0))),
            "III": outcome("III", *held),
        }
    )
    scene = Scene(config, *(None,) * (len(fields(Scene)) - 1))  # type: ignore[arg-type]
    small = keep_reached_loads(scene, outcomes).config.validation.forces_N
    unit = rigidity / length**2
    assert small == ((0.0, pytest.approx(-0.1 * unit, rel=0.05)), (0.0, pytest.approx(0.02 * unit, rel=0.05)))
    given = replace(scene, config=replace(config, validation=Validation((12.0,), (), ((0.0, 0.01),))))
    assert keep_reached_loads(given, outcomes).config.validation.forces_N == ((0.0, 0.01), *small)
    off = replace(scene, config=replace(config, validation=Validation()))
    assert keep_reached_loads(off, outcomes).config.validation.forces_N == ()


def test_the_report_shows_the_loads_of_the_validation(results: Path) -> None:
    html = (results / "report.html").read_text(encoding="utf-8")
    for text in ("end at +3 mm", "Dead force on the end", "Force that holds the end"):
        assert text in html
