"""The arm of a stored run in time: motion.csv, its refusals, vibrations, and what verdict and report say."""

import json
import math
import runpy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import pneurod
from pipeline.answers.rods import motion
from pipeline.answers.rods.choice import rod_of_path
from pipeline.answers.rods.in_time import body_of, rubber_of, with_remark
from pipeline.answers.rods.motion import _read_air
from pipeline.api.results import Results
from pipeline.results.files import read_results as read_run
from pipeline.results.verdict import verdict_of
from pipeline.show.tables import in_time as in_time_table
from pipeline.values.errors import InputError, RunFailed
from rod import Air, Body
from tests.coarse import COARSE, coarse_run, copy_with
from tests.commands import call, done
from tests.rod.test_in_time import with_base

SLOW = {"loss_factor": 0.12, "loss_between_Hz": [0.5, 50.0], "relaxation_g": [0.08], "relaxation_tau_s": [3.0]}


def with_rubber(folder: Path, **material: Any) -> Path:
    """A copy of the stored run whose material has these keys besides."""
    return copy_with(folder, "parameters.json", lambda content: content["material"].update(material))


def test_the_command_writes_the_motion_from_rest_to_a_pressure(tmp_path: Path) -> None:
    out = done("move", str(COARSE), "--pressure", "10 kPa", "--seconds", "0.1", "--out", str(tmp_path))
    frame = pd.read_csv(tmp_path / "motion.csv")
    columns = ["t_s", "pressure_kPa", "volume_mm3", "tip_x_mm", "tip_y_mm", "end_angle_deg", "beyond_law_per_mm"]
    assert list(frame.columns) == columns
    assert (frame.t_s.iloc[0], frame.t_s.iloc[-1]) == (0.0, pytest.approx(0.1))
    assert frame.pressure_kPa.iloc[1:].tolist() == pytest.approx([10.0] * (len(frame) - 1))
    straight = rod_of_path(COARSE, None).at(0.0).solve()
    assert (frame.tip_x_mm.iloc[0], frame.tip_y_mm.iloc[0]) == pytest.approx(straight.end, abs=1e-3 * straight.s[-1])
    assert frame.tip_y_mm.iloc[-1] < -1.0
    assert frame.end_angle_deg.iloc[-1] > 1.0  # to the side to which the pressure bends it
    assert frame.beyond_law_per_mm.tolist() == [0.0] * len(frame)
    assert "Its rubber has a loss factor of 0.1 from" in out
    assert f"written: {tmp_path / 'motion.csv'}" in out
    page = (tmp_path / "motion.html").read_text(encoding="utf-8")
    assert "Shapes" in page
    assert "<h1>pneunet_coarse in time</h1>" in page
    assert "It moves: 10 kPa." in page
    assert "Its first vibration about the rest at its last pressure: 1." in page
    assert "shapes from 0 s (green) to 0.1 s (violet)" in page
    assert "pressure 1" not in page  # an arm with one pressure


def test_an_arm_that_is_released_begins_under_its_force(tmp_path: Path) -> None:
    frame = pneurod.move(COARSE, "10 kPa", seconds=0.05, force="[0 N, 0.01 N]", release=True, out=tmp_path).motion
    pulled = rod_of_path(COARSE, None).at(10.0).solve(force=(0.0, 0.01))
    assert frame.tips[0].tolist() == pytest.approx(pulled.end, abs=1e-3 * pulled.s[-1])
    assert frame.tips[-1, 1] < frame.tips[0, 1]


def test_an_arm_that_is_released_without_a_force_was_held_weightless(tmp_path: Path) -> None:
    moved = pneurod.move(
        COARSE, "10 kPa", seconds=0.05, orientation="lying", tip_mass="1 g", release=True, out=tmp_path
    ).motion
    free = rod_of_path(COARSE, None).at(10.0).solve()
    assert moved.tips[0].tolist() == pytest.approx(free.end, abs=1e-3 * free.s[-1])
    assert moved.tips[-1, 1] < moved.tips[0, 1] - 1.0


def test_pressures_of_a_file_are_joined_by_straight_lines(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("time (ms);pressure (mbar)\n0;50\n40;90\n80;60\n")
    moved = pneurod.move(COARSE, tmp_path / "p.csv", seconds=0.08, out=tmp_path).motion
    expected = np.interp(moved.times_s, [0.0, 0.04, 0.08], [5.0, 9.0, 6.0])
    assert moved.pressures_kPa[:, 0] == pytest.approx(expected)


def test_python_has_the_same_columns_as_a_frame(tmp_path: Path) -> None:
    folder = with_rubber(tmp_path / "arm")
    frame = pneurod.read_results(folder).move(pressure="5 kPa", seconds=0.03, held_at=["1 l: y -1 mm"])
    read = pd.read_csv(folder / "motion.csv")
    pd.testing.assert_frame_equal(frame, read, check_exact=False)
    assert frame.tip_y_mm.to_numpy() == pytest.approx(np.full(len(frame), -1.0), abs=0.01)
    assert frame.reaction_N.abs().max() > 1e-4


def test_air_is_read_from_a_text() -> None:
    supply = _read_air("supply 40 kPa, conductance 20 mm^3/s/kPa, dead volume 5 cm^3, exponent 1.2")
    assert repr(supply) == repr(Air(supply=40.0, conductance=20.0, dead_volume=5000.0, exponent=1.2))
    assert repr(_read_air("flow 0.6 l/min")) == repr(Air(flow=1e4))
    assert repr(_read_air("closed")) == repr(Air())


def test_what_was_computed_stays_up_to_the_last_good_time(tmp_path: Path) -> None:
    """The pressure of the table leaves the law."""
    (tmp_path / "p.csv").write_text("t_s,pressure_kPa\n0,5\n0.05,5\n0.1,90\n")
    with pytest.raises(RunFailed, match="37 kPa") as caught:
        pneurod.move(COARSE, tmp_path / "p.csv", seconds=0.2, out=tmp_path)
    times = pd.read_csv(tmp_path / "motion.csv").t_s
    assert 0.05 < times.iloc[-1] < 0.1
    assert getattr(caught.value.reached, "motion", None) is not None


def test_an_interrupt_keeps_what_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_: object, __: object, ___: str, part: float) -> None:
        if part > 0.03:
            raise KeyboardInterrupt

    monkeypatch.setattr(motion.TimeLeft, "tell", interrupt)
    ended = call("move", str(COARSE), "--pressure", "9 kPa", "--seconds", "1", "--out", str(tmp_path))
    assert (ended.exit_code, "The motion was interrupted at t = 0.03" in ended.stderr) == (1, True)
    assert 0.03 < pd.read_csv(tmp_path / "motion.csv").t_s.iloc[-1] < 0.05
    assert f"written: {tmp_path / 'motion.csv'}" in ended.stdout


def test_results_move_in_a_loop() -> None:
    moving = pneurod.read_results(COARSE).moving(pressure="5 kPa")
    still = rod_of_path(COARSE, None).at(5.0).solve()
    for _ in range(4):
        seen = moving.step(0.005, pressure_kPa=6.0)
    assert seen.tip == pytest.approx(still.end, abs=0.1 * still.s[-1])
    assert math.degrees(abs(still.theta[-1])) < seen.angle < 90.0  # positive to the side to which pressure bends it
    with pytest.raises(InputError, match="90 kPa"):
        pneurod.read_results(COARSE).moving(pressure="90 kPa")


def test_the_example_holds_an_angle_against_a_force(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    example = Path("examples/control_loop.py").resolve()
    monkeypatch.setattr(pneurod, "read_results", lambda _: Results(read_run(COARSE)))
    monkeypatch.chdir(tmp_path)
    runs = runpy.run_path(str(example))["runs"]
    assert runs["closed"][-1][1] == pytest.approx(60.0, abs=1.0)
    assert abs(runs["open"][-1][1] - 60.0) > 3.0
    assert (tmp_path / "results" / "recipes" / "control_loop.png").stat().st_size > 1000


def test_the_rubber_of_a_material() -> None:
    given, told = rubber_of(SLOW, lambda: 9.0)
    assert given.loss_factor(5.0) == pytest.approx(0.12, rel=0.06)
    assert given.modulus(1e9) == 1.0
    branches = "the branches of material.relaxation (a held stretch keeps 92.6 %)"
    assert told == f"Its rubber has a loss factor of 0.12 from 0.5 to 50 Hz, and {branches}."
    branch = {"relaxation_g": [0.3], "relaxation_tau_s": [0.5]}
    assert rubber_of(branch, lambda: 9.0)[0].shares == (0.3,)
    assert rubber_of({}, lambda: 9.0)[0].loss_factor(9.0) == pytest.approx(0.1, rel=0.05)
    assert len(rubber_of(branch | {"loss_factor": 0.2}, lambda: 9.0)[0].shares) > 1


def test_vibrations_settling_and_creep(tmp_path: Path) -> None:
    frame = pneurod.read_results(with_rubber(tmp_path / "arm", **SLOW)).frequencies
    assert frame.pressure_kPa.tolist() == [17.0, 37.0]
    rods = rod_of_path(COARSE, None)
    body = Body(rods.law)
    for row in frame.to_dict("records"):
        assert 0.0 < row["frequency_1_Hz"] < row["frequency_2_Hz"] < row["frequency_3_Hz"]
        rubber = body.relaxing(body.at(np.array([row["pressure_kPa"]])))
        # half of the loss factor of the rubber, less by the branch
        assert row["damping_ratio_1"] == pytest.approx(0.06 * rubber, rel=0.12)
        expected = np.log(50.0) / (2.0 * np.pi * row["frequency_1_Hz"] * row["damping_ratio_1"])
        assert row["settles_s"] == pytest.approx(expected)
        assert row["creep_after_1_s_mm"] > row["creep_after_10_s_mm"] > row["creep_after_100_s_mm"] >= 0.0
    creep = rubber_of(SLOW, lambda: 1.0)[0].creep.compliance(1.0)
    late = np.subtract(rods.at(37.0 * float(creep)).solve().end, rods.at(37.0).solve().end)
    assert frame.creep_after_1_s_mm[1] == pytest.approx(np.linalg.norm(late))


def test_verdict_and_report_have_a_line_and_a_table_only_where_the_material_asks(tmp_path: Path) -> None:
    plain = coarse_run(0.02)
    assert with_remark(plain) is plain
    assert verdict_of(plain).in_time is None
    assert not in_time_table(plain)
    material = {**(plain.parameters.material or {}), **SLOW}
    run = with_remark(replace(plain, parameters=replace(plain.parameters, material=material)))
    lines = verdict_of(run).lines
    assert len(lines) <= 8
    assert any(line.startswith("It vibrates with") for line in lines)
    table = in_time_table(run)
    assert table.heads == ("", "17 kPa", "37 kPa")
    assert table.rows[0][0] == "frequency 1 Hz"
    assert json.dumps(dict(run.remarks[-1].values))


def test_a_region_of_another_rubber_relaxes_by_its_share() -> None:
    plain = coarse_run()
    run = replace(plain, parameters=replace(plain.parameters, materials={"base": {"loss_factor": 0.3}}))
    body, told = body_of(run, replace(rod_of_path(COARSE, None), law=with_base(0.5)))
    assert "That of materials.base, 50 % of the rigidity, has a loss factor of 0.3" in told
    alone, _ = body_of(plain, rod_of_path(COARSE, None))
    assert sum(body.relaxation.shares) > 1.5 * sum(alone.relaxation.shares)
    assert body.felt is not None


def test_a_region_of_another_rubber_without_a_share_is_named(tmp_path: Path) -> None:
    folder = copy_with(
        tmp_path / "arm", "parameters.json", lambda content: content.update(materials={"base": {"loss_factor": 0.3}})
    )
    moved = pneurod.move(folder, "5 kPa", seconds=0.01)
    assert any(
        "Loss and relaxation of materials.base differ; those of the arm are taken" in note for note in moved.notes
    )
