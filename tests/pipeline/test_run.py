"""A whole run on a short arm: the result files, resumption, and a pressure that cannot be reached."""

import csv
import json
import re
import shlex
import shutil
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from pipeline.config.load import load_config
from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from pipeline.run import run
from pipeline.stages import Stages, stage_names
from pipeline.store.progress import Silent
from pipeline.values.errors import RunFailed
from tests.commands import done, refused
from tests.shared import SharedFolders
from tests.short_arm import short_run, write_short


@pytest.fixture(scope="module")
def config_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_short(tmp_path_factory.mktemp("config"))


@pytest.fixture(scope="module")
def results(config_file: Path, shared: SharedFolders) -> Path:
    return short_run(shared, config_file)


def read(results: Path, name: str):
    return json.loads((results / name).read_text())


def test_every_file_of_the_contract_is_there(results: Path) -> None:
    named = [*(f"{name}.json" for name in ("parameters", "experiments", "validation", "effects", "run"))]
    named += ["curves.csv", "mesh.vtu", "I.pvd", "II.pvd", "III.pvd", "report.html", "fields/III_8kPa.vtu"]
    named += [f"pictures/{name}.png" for name in ("body", "body_open", "II_16kPa")]
    missing = [name for name in named if not (results / name).is_file()]
    assert not missing


@pytest.mark.parametrize(
    ("settings", "counted"),
    [(("mesh.coarser=1.5",), True), (("mesh.coarser=off",), False), (("mesh.coarser=1.5", "law=cell"), False)],
)
def test_a_second_mesh_is_a_stage_where_there_is_one(
    config_file: Path, settings: tuple[str, ...], counted: bool
) -> None:
    config = load_config(config_file, settings)
    listener = Mock()
    names = stage_names(config)
    stages = Stages(listener, names)
    for name in ("mesh", "coarser mesh", "report"):
        with stages.timed(name):
            pass
    count = 5 if config.law == "cell" else 9 if counted else 8  # law: five
    of_second = [f"coarser mesh (5 of {count})"] if counted else []
    assert [call.args[0] for call in listener.stage.mock_calls] == [
        f"mesh (1 of {count})",
        *of_second,
        f"report ({count} of {count})",
    ]
    assert ("coarser mesh" in stages.seconds) is counted


def test_parameters_are_those_of_a_rod(results: Path) -> None:
    parameters = read(results, "parameters.json")
    assert parameters["pressures_kPa"] == [8.0, 16.0]
    assert parameters["length_mm"] == 72.0
    for name in ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm"):
        assert min(parameters[name]) > 0
        assert min(parameters[f"{name}_std"]) >= 0
    assert {"m01_N_mm", "m02_N_mm", "beta1_N_mm2_per_kPa", "beta2_N_mm2_per_kPa", "linear_range_kPa"} <= set(parameters)
    profile = parameters["kappa_0"]
    assert np.shape(profile["kappa_0_per_mm"]) == (2, len(profile["s_mm"]))
    assert (
        np.mean(profile["cell_averaged_per_mm"][1]) < np.mean(profile["cell_averaged_per_mm"][0]) < 0
    )  # it curls down


def test_the_command_that_the_verdict_suggests_holds_the_end_as_experiment_III(results: Path) -> None:
    verdict = verdict_of(read_results(results))
    program, *arguments = shlex.split(verdict.command.split(": ", 1)[1])
    assert program == "pneurod"
    answer = done(*arguments)
    (row,) = (
        row
        for row in read(results, "validation.json")
        if (row["rod"], row["experiment"], row["pressure_kPa"]) == (verdict.rod, "III", 16.0)
    )
    (force,) = re.findall(r"end force +\[[^,]*, ([^]]*)\] N", answer)
    assert float(force) == pytest.approx(row["rod_force_N"], rel=0.05)  # without the couple of the held edge
    assert ", y = 0.000 mm from the clamped end" in answer


def test_experiments_hold_what_the_contract_names(results: Path) -> None:
    rows = read(results, "experiments.json")
    assert [(row["experiment"], row["pressure_kPa"]) for row in rows] == [
        (name, pressure) for name in ("I", "II", "III") for pressure in (8.0, 16.0)
    ]
    for row in rows:
        assert row["status"] == "converged"
        assert row["negative_pivots"] == 0
        assert 0 < row["min_J"] < 1 < row["max_stretch"]
        area_times_pressure = 1e-3 * row["pressure_kPa"] * 7 * (11 * 13 * 2)
        if row["experiment"] != "III":
            assert np.hypot(*row["clamp_reaction_N"]) < 1e-6 * area_times_pressure
        else:
            assert row["end_y_mm"] == pytest.approx(1.0, abs=1e-9)
            assert np.add(row["clamp_reaction_N"], row["reaction_N"]) == pytest.approx(
                0, abs=1e-6 * area_times_pressure
            )


def test_the_error_indicator_of_every_state_and_the_largest_one(results: Path) -> None:
    rows = read(results, "experiments.json")
    errors = [row["stress_error"] for row in rows]
    assert 0.01 < min(errors) <= max(errors) < 0.5
    indicator = read(results, "run.json")["indicator"]
    worst = rows[int(np.argmax(errors))]
    assert indicator["stress_error"] == max(errors)
    assert (indicator["experiment"], indicator["pressure_kPa"]) == (worst["experiment"], worst["pressure_kPa"])
    assert indicator["at_mm"] == worst["stress_error_at_mm"]


def test_moment_by_equation_seven_balances_the_clamp(results: Path) -> None:
    with (results / "curves.csv").open() as file:
        curves = [row for row in csv.DictReader(file) if row["experiment"] == "III"]
    for row in read(results, "experiments.json"):
        if row["experiment"] == "III":
            start = next(c for c in curves if float(c["pressure_kPa"]) == row["pressure_kPa"])
            assert float(start["moment_N_mm"]) == pytest.approx(-row["clamp_moment_N_mm"], rel=1e-4)


def test_the_rod_follows_the_finite_elements(results: Path) -> None:
    rows = read(results, "validation.json")
    assert [row["rod"] for row in rows] == ["five"] * 4
    for row in rows:
        assert row["distance_over_length"] < 0.02
        assert row["experiment"] == "II" or abs(row["force_error"]) < 0.1  # measured on this coarse mesh: 0.03


def test_the_end_is_pulled_and_the_break_is_given(config_file: Path, tmp_path: Path) -> None:
    changes = [
        *("pressures=[16 kPa]", "experiments=[II, III]", "end={x: 0.1 N, y: 0.05 N}"),
        "identification={d: 12 mm}",
    ]
    run(load_config(config_file, changes), tmp_path, 1, False, Silent())
    loaded = next(row for row in read(tmp_path, "experiments.json") if row["experiment"] == "III")
    assert loaded["reaction_N"] == pytest.approx([0.1, 0.05], abs=1e-8)
    assert loaded["clamp_reaction_N"] == pytest.approx([-0.1, -0.05], rel=1e-4)
    parameters = read(tmp_path, "parameters.json")
    assert (parameters["d_mm"], parameters["d_mm_std"], parameters["d_given_mm"]) == ([12.0], [0.0], 12.0)
    assert all(of["d_mm"] == [pytest.approx(12.0)] for of in parameters["estimators"].values())
    held, pulled = (
        next(row for row in read(tmp_path, "validation.json") if row["experiment"] == n) for n in ("II", "III")
    )
    assert held["distance_over_length"] < 0.02
    assert pulled["distance_over_length"] < 0.05
    assert pulled["force_error"] is None  # the force is given


def test_the_same_command_goes_on_from_what_is_finished(config_file: Path, results: Path, tmp_path: Path) -> None:
    shutil.copytree(results, tmp_path, dirs_exist_ok=True)
    for name in ("III_16kPa", "I_8kPa", "I_16kPa"):
        (tmp_path / "states" / f"{name}.npz").unlink()
    (tmp_path / "parameters.json").unlink()
    for name, difference in (("II_8kPa", 0.081), ("II_16kPa", np.inf)):  # as if contact depended on the load increments
        state = tmp_path / "states" / f"{name}.npz"
        with np.load(state, allow_pickle=False) as stored:
            others = json.loads(str(stored["others"])) | {"path_dependence": difference}
            arrays = {**stored, "others": np.array(json.dumps(others))}
        np.savez(state, **arrays)
    report = run(load_config(config_file), tmp_path, 1, False, Silent())
    assert [reason.code for reason in report.results.remarks if reason.code == "folded_contact_open"]
    reasons = {(row["experiment"], row["pressure_kPa"]): row["reason"] for row in read(tmp_path, "experiments.json")}
    assert "depends by 8.1 % on the load steps" in reasons.pop(("II", 8.0))
    assert "may depend on the load steps" in reasons.pop(("II", 16.0))
    assert not any("load steps" in reason for reason in reasons.values())
    for name in ("end_x_mm", "end_y_mm", "cavity_volume_mm3"):
        first = [row[name] for row in read(results, "experiments.json")]
        again = [row[name] for row in read(tmp_path, "experiments.json")]
        assert again == pytest.approx(first, rel=1e-9)
    # a repeated run changes nothing: pictures are not drawn again, and the report and its times stay
    shown = [tmp_path / "report.html", tmp_path / "run.json", *tmp_path.glob("pictures/*"), *tmp_path.glob("fields/*")]
    written = {path: path.stat().st_mtime_ns for path in shown}
    assert len(written) > 15
    run(load_config(config_file), tmp_path, 1, False, Silent())
    assert {path: path.stat().st_mtime_ns for path in written} == written


REFUSED = r"Experiment I+ stopped before 1000 kPa: no equilibrium found beyond [\d.]+ kPa on the way to 1000 kPa; "


def test_a_pressure_that_cannot_be_borne_ends_in_a_sentence_and_keeps_the_rest(
    config_file: Path, tmp_path: Path
) -> None:
    changes = ["pressures=[8 kPa, 1 MPa]", "geometry.chambers=2"]
    settings = [word for change in changes for word in ("--set", change)]
    command = ("run", str(config_file), "--out", str(tmp_path), "--jobs", "1", "-q", *settings)
    assert refused(*command, status=1).startswith("Experiment")
    report = run(load_config(config_file, changes), tmp_path, 1, False, Silent())
    with pytest.raises(RunFailed, match=REFUSED) as failure:
        report.results.raise_if_failed()
    assert "\n" not in str(failure.value)
    assert failure.value.brief.startswith("Experiment")
    assert {outcome.failure and outcome.failure.pressure_kPa for outcome in report.outcomes} == {1000.0}
    rows = read(tmp_path, "experiments.json")
    assert {row["status"] for row in rows if row["pressure_kPa"] == 8.0} == {"converged"}
    assert all(row["reason"] for row in rows if row["pressure_kPa"] == 1000.0)
    assert "1000 kPa" in (tmp_path / "report.html").read_text()
    remarks = {remark["code"]: remark["values"] for remark in read(tmp_path, "run.json")["remarks"]}
    assert remarks["strong_pressure"]["bearable_kPa"] < 1000.0
    assert read(tmp_path, "run.json")["end_kPa"] == report.outcomes.lowest_end_kPa() < 1000.0


def test_a_second_mesh_is_counted_from_when_it_is_needed(config_file: Path) -> None:
    config = load_config(config_file, ("mesh.coarser=1.5", "law=both", "accuracy=1%"))
    listener = Mock()
    stages = Stages(listener, stage_names(config))  # the law on two meshes tells the error of the arm's
    stages.add("coarser mesh", before="rod")
    for name in ("coarser mesh", "rod"):
        with stages.timed(name):
            pass
    assert [call.args[0] for call in listener.stage.mock_calls] == ["coarser mesh (7 of 11)", "rod (8 of 11)"]
