"""Calibration to motions, with noise, of an arm whose modulus and rubber in time are known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.answers.measured.calibrate import CalibrationReport, calibrate_files
from pipeline.answers.measured.compare import compare_files
from pipeline.answers.measured.doubtful import doubts_of
from pipeline.answers.measured.predicted import LawRods, Numbers
from pipeline.answers.measured.rows import Measurements, Row, State
from pipeline.answers.measured.table import read_measurements
from pipeline.answers.rods.in_time import rubber_of
from pipeline.values.errors import InputError
from rod import Body, Loading, Relaxation, Start, Steps, move
from tests.measured_arm import arm_law, result_folder

#: stiff, so that the weight of the arm, with which it is let go, does not bend it far
DRAWN = replace(arm_law().scaled(5.0), rates={})
SOFTER, LOSS, SLOW, TAU = 0.9, 0.15, 0.08, 1.5
FAST = Relaxation.from_loss_factor(LOSS, 1.76, 17.6)
BUILT = Body(DRAWN.scaled(SOFTER), Relaxation((*FAST.shares, SLOW), (*FAST.times_s, TAU)))
TITLES = "t_s,pressure_kPa,orientation,tip_x_mm,tip_y_mm"


def motion(file: Path, pressure: float, orientation: str, noise: float) -> Path:
    """By steps in time, of the arm that is let go at 0 kPa, or under a pressure that comes; noise: mm."""
    weight = Loading(direction=orientation or None)
    moved = move(BUILT, pressure, 6.0, weight, Start(0.0, Loading()), Steps(0.004))
    times, random = 0.02 * np.arange(1, 300), np.random.default_rng(2)
    tips = [np.interp(times, moved.times_s, tip) + noise * random.standard_normal(299) for tip in moved.tips.T]
    rows = [f"{t:.2f},{pressure:g},{orientation},{x:.4f},{y:.4f}" for t, x, y in zip(times, *tips, strict=True)]
    file.write_text("\n".join([TITLES, *rows]), encoding="utf-8")
    return file


@pytest.mark.parametrize(("pressure", "orientation"), [(0.0, "lying"), (80.0, "")])
def test_what_a_motion_tells_is_that_of_the_arm(tmp_path: Path, pressure: float, orientation: str) -> None:
    numbers = Numbers.of(read_measurements(motion(tmp_path / "arm.csv", pressure, orientation, 0.0)))
    fast = {"loss_factor": LOSS, "loss_between_Hz": (1.76, 17.6)}
    rods = LawRods(BUILT.law, {**fast, "relaxation_g": (SLOW,), "relaxation_tau_s": (TAU,)})
    found = numbers.predicted(rods)
    assert numbers.names[:2] == ("frequency_Hz", "damping_ratio")
    assert found[0] == pytest.approx(numbers.values[0], rel=0.01)
    assert found[1] == pytest.approx(numbers.values[1], rel=0.03)
    assert found[2:] == pytest.approx(numbers.values[2:], abs=0.03)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, few_proposals: None) -> CalibrationReport:
    folder = tmp_path_factory.mktemp("in_time")
    file = motion(folder / "arm.csv", 80.0, "", 0.05)
    return calibrate_files(result_folder(folder / "arm", DRAWN), file)


def test_modulus_and_branches_are_found_within_their_intervals(report: CalibrationReport) -> None:
    known = {"modulus_factor": SOFTER, "loss_factor": LOSS, "relaxation_g": SLOW, "relaxation_tau_s": TAU}
    for name, value in known.items():
        estimate = report.found[name]
        assert abs(np.log(estimate.mean / value)) < 2.0 * estimate.std / estimate.mean, name
    assert report.found["loss_factor"].mean == pytest.approx(LOSS, rel=0.1)
    assert report.found["modulus_factor"].std < 0.15
    assert report.found["relaxation_g"].std < 0.5 * report.found["relaxation_g"].mean


def test_the_folder_and_its_verdict_have_the_rubber_in_time(report: CalibrationReport) -> None:
    run = json.loads((report.directory / "run.json").read_text(encoding="utf-8"))
    rubber, told = rubber_of(run["config"]["material"], lambda: 1.0)
    assert len(rubber.shares) == 3
    assert "and the branches of material.relaxation (a held stretch keeps " in told
    assert {remark["code"] for remark in run["remarks"]} == {"calibrated_alone", "in_time"}
    frequency = {row.quantity: row for row in report.found.predictions}["frequency_Hz"]
    assert frequency.predicted == pytest.approx(frequency.measured, rel=0.01)
    compared = compare_files(report.directory, Path(report.file))
    assert compared.is_calibrated
    assert compared.within == 1.0
    assert compared.lines[0].endswith(" of the damping ratio.")
    assert " Hz, " in compared.lines[0]


def test_a_force_that_lets_go_tells_a_vibration_alone(tmp_path: Path) -> None:
    time = 0.02 * np.arange(1, 100)
    tip = 5.0 * np.exp(-0.3 * time) * np.cos(2.0 * np.pi * 2.0 * time)
    rows = [f"{t:.2f},20,0.01,{y:.4f}" for t, y in zip(time, tip, strict=True)]
    file = tmp_path / "arm.csv"
    file.write_text("\n".join(["t_s,pressure_kPa,force_y_N,tip_y_mm", *rows]), encoding="utf-8")
    (row,) = read_measurements(file).rows
    assert row.state.force_N == (0.0, 0.0)
    assert row.values["frequency_Hz"] == pytest.approx(2.0, rel=1e-3)
    assert row.values["damping_ratio"] == pytest.approx(0.3 / (4.0 * np.pi), rel=0.02)
    file.write_text("\n".join(["t_s,pressure_kPa,force_y_N,tip_y_mm", *rows[:25]]), encoding="utf-8")
    with pytest.raises(InputError, match="line 2: this motion tells nothing"):
        read_measurements(file)


def test_frequencies_that_need_another_density_are_named(tmp_path: Path) -> None:
    row = Row(2, State(20.0), {"frequency_Hz": 5.0, "damping_ratio": 0.05})
    numbers = Numbers.of(Measurements("", (row,)))
    assert doubts_of(numbers.measurements, numbers, np.array([0.2, 0.0])) == []
    (sentence,) = doubts_of(numbers.measurements, numbers, np.array([-0.5, 0.0]))
    assert sentence.startswith("The frequencies would need 1.21 times the density")


def test_an_arm_without_density_is_refused(tmp_path: Path, report: CalibrationReport) -> None:
    folder = result_folder(tmp_path / "arm", replace(DRAWN, mass=None))
    with pytest.raises(InputError, match=r"line 2: .*needs material.density"):
        calibrate_files(folder, report.file)
