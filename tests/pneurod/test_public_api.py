"""The package `pneurod`: its names, what it imports, runs from Python, and results read from folders."""

import copy
import json
import pickle
import shutil
import subprocess
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import pneurod
from pipeline.store.store import locked
from tests.coarse import COARSE
from tests.shared import SharedFolders
from tests.short_arm import short_run, write_short
from tests.test_rooms import HEAVY, loaded_after, loaded_by_command

HERE = Path(__file__).resolve().parent.parent.parent


@pytest.fixture(scope="module")
def design(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_short(tmp_path_factory.mktemp("design"))


@pytest.fixture(scope="module")
def results(design: Path, shared: SharedFolders) -> pneurod.Results:
    return pneurod.read_results(short_run(shared, design))


@pytest.fixture
def own(results: pneurod.Results, tmp_path: Path) -> Path:
    """A copy of the folder, in which a test may run the arm again."""
    return Path(shutil.copytree(results.directory, tmp_path / "own"))


def quiet(results: pneurod.Results, pressure: float, kind: str = "five", **options: bool) -> pneurod.Rod:
    """A rod of the run without its warnings, which `tests/pipeline/answers/rods/test_choice.py` has."""
    with warnings.catch_warnings(action="ignore", category=pneurod.RodWarning):
        return results.rod(pressure, kind, **options)


def frames(results: pneurod.Results) -> Iterator[tuple[str, pd.DataFrame]]:
    for name in dir(type(results)):
        if name.startswith("_") or name == "hand":  # no frame, and refused where there is no rod
            continue
        if isinstance(value := getattr(results, name), pd.DataFrame):
            yield name, value


def test_every_public_name_is_there_and_no_other() -> None:
    assert len(pneurod.__all__) > 10
    for name in pneurod.__all__:
        assert getattr(pneurod, name) is not None
    assert set(dir(pneurod)) == set(pneurod.__all__)
    with pytest.raises(AttributeError, match=r"no attribute 'Mesh'; it has .*Rod"):
        _ = pneurod.Mesh


def test_import_loads_nothing_heavy() -> None:
    loaded = loaded_after("import pneurod")
    assert "pneurod" in loaded
    assert loaded & (HEAVY | {"pandas"}) == set()


def test_a_rod_is_solved_without_what_is_slow_to_import() -> None:
    """From the command to the answer: numba would double its time, scipy.optimize more than that."""
    load = ("--pressure", "31 kPa", "--force", "[0 N, 0.01 N]")
    loaded = loaded_by_command("rod", str(COARSE / "parameters.json"), *load, says="bends by")
    assert {"rod", "numpy"} <= loaded
    assert loaded & (HEAVY - {"numpy", "pydantic", "pydantic_core", "pint"}) == set()


def test_a_run_gives_what_its_folder_gives(design: Path, own: Path) -> None:
    results, again = pneurod.characterize(design, out=own, jobs=1), pneurod.read_results(own)
    names = [name for name, _ in frames(results)]
    assert len(names) > 8
    for name in names:
        pd.testing.assert_frame_equal(getattr(results, name), getattr(again, name))
    assert again.run.record == results.run.record
    assert again.verdict == results.verdict


def test_parameters_carry_units_and_errors(results: pneurod.Results) -> None:
    content = json.loads((results.directory / "parameters.json").read_text(encoding="utf-8"))
    assert results.pressures_kPa == (8.0, 16.0)
    assert results.length_mm == 72.0
    assert results.parameters["alpha2_N_mm2"].tolist() == content["alpha2_N_mm2"]
    assert results.parameters["alpha2_N_mm2_std"].tolist() == content["alpha2_N_mm2_std"]
    spread = results.interval("alpha2", 16.0)
    assert [spread.low, spread.high] == content["alpha2_N_mm2_95"][1]
    assert spread.low <= spread.value <= spread.high
    assert results.law(16.0).alpha2 == content["alpha2_N_mm2"][1]
    assert results.law(16.00005) == results.law(16.0)  # the same pressure with six digits
    assert results.interval("alpha2", 16.00005) == spread
    assert quiet(results, 16.00005).law == results.law(16.0)
    assert np.isfinite(results.kappa_0["kappa_0_per_mm"]).all()
    assert results.kappa_0.groupby("pressure_kPa")["s_mm"].max().tolist() == [72.0, 72.0]


def test_experiments_and_curves_are_complete(results: pneurod.Results) -> None:
    rows = results.experiments.set_index(["experiment", "pressure_kPa"])
    assert set(rows.index) == {(name, p) for name in ("I", "II", "III") for p in (8.0, 16.0)}
    assert (rows["status"] == "converged").all()
    assert rows.loc[("III", 16.0), "reaction_y_N"] > 0.0
    assert set(results.curves["experiment"]) == {"I", "II", "III"}
    assert results.curves["kappa_per_mm"].notna().all()
    assert (results.validation["sample"] == "in").all()
    assert results.validation["distance_over_length"].max() < 0.05
    assert set(results.effects["state"]) == {"on", "off"}


def test_rods_moved_to_the_start_of_the_curve_lie_on_the_curves(results: pneurod.Results) -> None:
    free = results.curves.query("experiment == 'II' and pressure_kPa == 16.0")
    assert results.curve_start_mm == (0.0, 1.0)  # the material curve of this arm is 1 mm above its lower face
    curve = quiet(results, 16.0).solve().positions(free["s_mm"].to_numpy()) + results.curve_start_mm
    np.testing.assert_allclose(curve, free[["rod_x_mm", "rod_y_mm"]], atol=1e-6)


def test_results_can_be_pickled_and_copied(results: pneurod.Results) -> None:
    for again in (pickle.loads(pickle.dumps(results)), copy.deepcopy(results)):
        assert again.run.record == results.run.record
        assert again.pictures == results.pictures
        pd.testing.assert_frame_equal(again.curves, results.curves)
        assert quiet(again, 12.0).solve().end == quiet(results, 12.0).solve().end


def test_a_pressure_that_is_no_number_is_refused(results: pneurod.Results) -> None:
    nothing: Any = None
    for method in (results.rod, results.law, lambda p: results.interval("d", p)):
        with pytest.raises(pneurod.InputError, match="pressure_kPa: None is not a pressure"):
            method(nothing)
        with pytest.raises(pneurod.InputError, match=r"^pressure_kPa: '16 mm' is not a pressure"):
            method("16 mm")
    assert results.law("16 kPa") == results.law(16.0)


def test_the_record_of_the_run_is_there(results: pneurod.Results) -> None:
    run = results.run
    assert run.finished
    assert run.failure == ""
    assert run.design == "short"
    assert run.record.packages["numpy"] == np.__version__
    assert run.record.seconds["experiments"] > 0.0
    assert run.record.factorizations.keys() == {"I", "II", "III"}
    assert results.report.is_file()
    assert results.pictures["body"].is_file()


def test_the_rod_of_results_is_the_rod_of_the_validation(results: pneurod.Results) -> None:
    """In III the rod must need the force that validation.json says."""
    curve = results.curves.query("experiment == 'III' and pressure_kPa == 16.0")
    row = results.validation.query("experiment == 'III' and pressure_kPa == 16.0").iloc[0]
    clamped = replace(quiet(results, 16.0, "five"), start=(0.0, float(curve["y_mm"].iloc[0])))
    held = clamped.solve(end_y=float(curve["y_mm"].iloc[-1]))
    assert held.force[1] == pytest.approx(row["rod_force_N"], rel=0.05)  # without the couple of the held edge
    with pytest.raises(pneurod.InputError, match=r"outside the identified range"):
        results.rod(18.0, "five")


@pytest.mark.slow
def test_a_run_is_silent_unless_progress_is_requested(
    design: Path, own: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    pneurod.characterize(design, out=own, jobs=1)
    assert capfd.readouterr() == ("", "")
    pneurod.characterize(design, out=own, jobs=1, progress=True)
    out, err = capfd.readouterr()
    assert "III: 16 kPa (" in out
    assert err == ""


def test_numbers_of_numpy_are_settings(design: Path, own: Path, results: pneurod.Results) -> None:
    same: Any = {"geometry.chambers": np.int64(7), "pressures": np.array(["8 kPa", "16 kPa"])}
    same["material.nu"] = np.float64(0.495)
    again = pneurod.characterize(design, out=own, settings=same, jobs=1)
    assert again.run.record.config_hash == results.run.record.config_hash


def test_a_folder_that_cannot_be_used_is_named_as_it_was_given(design: Path, own: Path, tmp_path: Path) -> None:
    out = own
    with pytest.raises(pneurod.InputError) as refusal:
        pneurod.characterize(design, out=out, settings={"mesh.size": "7 mm"})
    assert str(refusal.value) == (
        f"out={out}: holds the results of a run with another configuration; "
        "give another out, or fresh=True to replace them"
    )
    with locked(tmp_path), pytest.raises(pneurod.InputError) as refusal:
        pneurod.characterize(design, out=tmp_path)
    assert str(refusal.value) == f"out={tmp_path}: another run is at work in it; wait for it or give another out"


def test_a_failed_run_says_where_its_results_are(design: Path, tmp_path: Path) -> None:
    """Three chambers are too few for five parameters, but their experiments are there."""
    settings: dict[str, str | int | list[str]] = {"geometry.chambers": 3, "pressures": ["5 kPa"]}
    with pytest.raises(pneurod.RunFailed, match="Five parameters need") as failure:
        pneurod.characterize(design, out=tmp_path, settings=settings, jobs=1)
    assert failure.value.directory == tmp_path
    partial = pneurod.read_results(tmp_path)
    assert partial.run.finished
    assert [failure.code for failure in partial.run.failures] == ["too_short"]
    assert len(partial.experiments) == 3
    assert partial.parameters.empty
    with pytest.raises(pneurod.InputError, match="holds no parameters of a rod: Five parameters need"):
        partial.rod(5.0)


def test_every_name_is_documented() -> None:
    """In the section on Python of docs/results.md."""
    section = (HERE / "docs" / "results.md").read_text(encoding="utf-8").partition("## From Python")[2]
    names = {name for name in dir(pneurod.Results) if not name.startswith("_")}
    assert {name for name in names if f"`{name}`" not in section} == set()


def test_numbers_of_curves_are_read_exactly() -> None:
    text = (COARSE / "curves.csv").read_text(encoding="utf-8").splitlines()
    column = text[0].split(",").index("kappa_per_mm")
    assert pneurod.read_results(COARSE).curves["kappa_per_mm"].tolist() == [
        float(line.split(",")[column]) for line in text[1:]
    ]


@pytest.mark.slow
def test_a_program_without_a_guard_may_use_several_processes(design: Path, own: Path) -> None:
    """The workers must not run the program once more."""
    program = design.parent / "program.py"
    program.write_text(
        "import pneurod\n"
        "print('program')\n"
        f"results = pneurod.characterize({str(design)!r}, out={str(own)!r}, jobs=2)\n"
        "print(len(results.parameters))\n"
    )
    command = [sys.executable, str(program)]
    environment = {"PYTHONPATH": str(HERE), "PATH": "/usr/bin:/bin"}
    ended = subprocess.run(command, capture_output=True, text=True, check=False, cwd=design.parent, env=environment)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "program\n2\n", "")


def test_half_finished_folders_give_what_is_there(tmp_path: Path) -> None:
    shutil.copy(COARSE / "experiments.json", tmp_path)
    results = pneurod.read_results(tmp_path)
    assert len(results.experiments) == 6
    assert {name for name, frame in frames(results) if len(frame)} == {"experiments"}
    assert np.isnan(results.mass_g)
    with pytest.raises(pneurod.InputError, match="the run has not come to the identification"):
        results.rod(17.0)


def test_a_stored_run_has_all_frames() -> None:
    results = pneurod.read_results(COARSE)
    assert results.pressures_kPa == (17.0, 37.0)
    assert results.parameters["moment_range_high_N_mm"].tolist() == pytest.approx([4.0991325, 10.8961063])
    assert not results.parameters["single_line_suffices"].any()
    assert set(results.validation["rod"]) == {"five", "arm_law"}
    assert results.experiments["reaction_y_N"].notna().all()
    assert results.experiments["max_stretch_at_z_mm"].notna().all()
    assert results.arm_law is not None
    assert results.verdict.rod == "arm_law"
