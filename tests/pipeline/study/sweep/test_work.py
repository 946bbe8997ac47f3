"""The work on one point of a sweep in this process: its rows, what is kept, and what stops it."""

import errno
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.config.load import load_config
from pipeline.store.store import locked
from pipeline.study.sweep import work
from pipeline.study.sweep.points import Point
from pipeline.study.sweep.work import work_on

pytestmark = pytest.mark.usefixtures("undrawn", "coarse_limit")

BASE = """
name: short
geometry: {family: pneunet, chambers: 7}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [8 kPa]
validation: off
mesh: {size: 8 mm, formulation: p2p0, grading: off}
"""


def task_of(tmp_path: Path, run: tuple[str, ...], *settings: str) -> Point:
    path = tmp_path / "base.yaml"
    path.write_text(BASE, encoding="utf-8")
    config = load_config(path, settings)
    return Point(1, {}, config, run, tmp_path)


def test_a_whole_run_has_states_parameters_and_errors_of_the_rod_in_its_row(tmp_path: Path) -> None:
    task = task_of(tmp_path, ("whole",), "law=five", "experiments=[III, II]")
    record = work_on(task)
    assert (record.status, record.reason, len(record.rows)) == ("finished", "", 1)
    row = record.rows[0]
    assert row["length_mm"] == 72.0
    assert row["II_end_y_mm"] < 0.0
    assert not [name for name in row if name.startswith("I_")]  # the configuration leaves it out
    assert row["III_force_y_N"] > 0.0
    tip = row["II_end_x_mm"], row["II_end_y_mm"] - 1.0  # the material curve is 1 mm above the base
    assert row["II_bending_deg"] == pytest.approx(np.degrees(2 * np.arctan2(-tip[1], tip[0])), rel=0.1)
    assert row["II_bending_deg"] == pytest.approx(-np.degrees(row["II_end_angle_rad"]), rel=0.1)
    assert row["III_bending_deg"] > 0.1 * row["II_bending_deg"]  # its chord does not turn
    assert row["kappa_0_middle_per_mm"] == pytest.approx(row["II_kappa_middle_per_mm"], rel=1e-9)
    assert row["alpha2_N_mm2"] > row["alpha2_N_mm2_std"] > 0.0
    assert all(0.001 < row[f"{name}_mesh_error"] < 0.2 for name in ("kappa_0", "alpha2", "force"))
    assert "1 pressures cannot show" in row["notes"]
    assert 0.0 < row["II_five_distance_over_length"] < 0.02
    assert abs(row["III_five_force_error"]) < 0.1
    assert (task.folder / "report.html").is_file()


def test_a_free_body_with_weight_is_left_out_and_the_notes_say_so(tmp_path: Path) -> None:
    task = task_of(tmp_path, ("I", "II"), "geometry.chambers=1", "pressures=[2 kPa]", "effects.gravity=on")
    record = work_on(task)
    assert (record.status, record.reason, len(record.rows)) == ("finished", "", 1)
    row = record.rows[0]
    assert not [name for name in row if name.startswith("I_")]
    assert "II_end_y_mm" in row
    assert row["notes"] == "experiment I is not simulated, because nothing holds the weight of a free body"
    assert {path.name for path in (task.folder / "states").glob("*.npz")} == {"II_2kPa.npz"}


def test_the_law_of_a_cell_has_its_numbers_without_moment(tmp_path: Path) -> None:
    task = task_of(tmp_path, ("cell",), "accuracy=off")
    record = work_on(task)
    assert record.status == "finished"
    assert record.rows[0]["cell_kappa_0_per_mm"] < 0.0
    assert 50.0 < record.rows[0]["cell_rigidity_N_mm2"] < 1000.0
    assert (task.folder / "law.json").is_file()


def test_a_record_is_kept_for_the_same_work_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    task = task_of(tmp_path, ("II",), "geometry.chambers=3")
    first = work_on(task)

    def no_more(_: object) -> tuple[Sequence[dict], Sequence[str]]:
        raise AssertionError("solved again")

    monkeypatch.setattr(work, "_experiments", no_more)
    assert work_on(task) == first
    assert replace(task, program="another key").kept.read() is None


def test_a_pressure_that_is_not_reached_leaves_an_incomplete_point(tmp_path: Path) -> None:
    record = work_on(task_of(tmp_path, ("II",), "geometry.chambers=1", "pressures=[2 kPa, 1 MPa]"))
    assert record.status == "incomplete"
    assert record.reason.startswith("experiment II stopped before 1000 kPa: ")
    assert [row["pressure_kPa"] for row in record.rows] == [2.0, 1000.0]
    assert "II_end_y_mm" in record.rows[0]
    assert "II_end_y_mm" not in record.rows[1]


def failing(error: Exception):
    def fails(_: object) -> None:
        raise error

    return fails


def test_an_error_of_the_program_is_a_row_and_a_full_disk_ends_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = task_of(tmp_path, ("III",))
    monkeypatch.setattr(work, "_experiments", failing(ZeroDivisionError("by zero")))
    record = work_on(task)
    assert record.status == "failed"
    assert record.reason == "an error of the program (ZeroDivisionError: by zero); error.txt says where"
    assert "ZeroDivisionError" in (task.folder / "error.txt").read_text()
    (task.folder / "sweep_point.json").unlink()
    monkeypatch.setattr(work, "_experiments", failing(OSError(errno.ENOSPC, "No space left on device", "file")))
    with pytest.raises(OSError, match="No space left"):
        work_on(task)
    assert task.kept.read() is None


def test_a_folder_in_use_and_memory_that_runs_out_are_tried_again_by_the_next_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = task_of(tmp_path, ("III",))
    task.folder.mkdir(parents=True)
    monkeypatch.setattr(work, "PATIENCE", 0.3)
    with locked(task.folder):
        assert "another run is at work in it" in work_on(task).reason
    monkeypatch.setattr(work, "_experiments", failing(MemoryError()))
    assert work_on(task).status == "waiting"
    assert task.kept.read() is None


def test_a_worker_with_other_sources_does_no_work(tmp_path: Path) -> None:
    task = task_of(tmp_path, ("III",))
    assert work_on(replace(task, program="0" * 64)).status == "waiting"
