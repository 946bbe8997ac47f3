"""Measured numbers that cannot be of an arm, and fits that are no calibrations."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from benchmarks.experiments.cases import cases_in
from pipeline.answers.measured.calibration import OF_RUBBER, calibrated
from pipeline.answers.measured.compare import compare_files
from pipeline.answers.measured.doubtful import MISSED, SCATTERS, check_numbers, failure_of
from pipeline.answers.measured.fit import usual_scatter
from pipeline.answers.measured.predicted import LawRods, Numbers
from pipeline.answers.measured.rows import State
from pipeline.answers.measured.table import read_measurements
from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from pipeline.values.errors import InputError, RunFailed
from rod import ArmLaw
from tests.commands import refused
from tests.measured_arm import LENGTH, arm_law, measured, result_folder

CASES = Path(__file__).resolve().parents[4] / "benchmarks" / "experiments"


def read(file: Path, text: str) -> Numbers:
    file.write_text(text, encoding="utf-8")
    return Numbers.of(read_measurements(file))


def refusals(numbers: Numbers) -> tuple[str, ...]:
    """What is wrong with numbers, beside those of the arm as drawn; empty where they may be of such an arm."""
    try:
        check_numbers(numbers, numbers.predicted(LawRods(arm_law())), LENGTH)
    except InputError as refused:
        return refused.sentences
    return ()


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])  # of all moduli
@pytest.mark.parametrize(
    ("columns", "sentences"),
    [
        ((1.0, 1.0, 1.0), ()),
        ((1.0, -1.0, 1.0), ("tip_y_mm is ", "towards -y: write the column with a minus sign")),
        ((1.0, 1.0, -1.0), ("end_angle_deg is ", "towards -y: write the column with a minus sign")),
        ((-1.0, 1.0, 1.0), ("tip_x_mm is -", "towards +x: write the column with a plus sign")),
        ((1.0, -1.0, -1.0), ("tip_y_mm", "end_angle_deg")),
    ],
)
def test_columns_of_the_mirrored_arm(
    tmp_path: Path, factor: float, columns: tuple[float, ...], sentences: tuple[str, ...]
) -> None:
    rods, rows = LawRods(arm_law(80.0).scaled(factor)), ["pressure_kPa,tip_x_mm,tip_y_mm,end_angle_deg,force_y_N"]
    for pressure in (0.0, 8.0, 16.0):
        shape = rods(pressure).solve()
        read_there = np.array([*shape.end, np.degrees(shape.end_angle)]) * columns + 0.2
        rows.append(f"{pressure:g},{','.join(f'{value:.3f}' for value in read_there)},")
    rows.append("16,60,20,20,0.05")  # under a force it may bend the other way
    numbers = read(tmp_path / "arm.csv", "\n".join(rows))
    found = refusals(numbers)
    first = 2 if columns[0] < 0.0 else 3  # the end is in front of the clamp at rest, too
    assert all(sentence.startswith(f"{tmp_path / 'arm.csv'}: line {first}: ") for sentence in found)
    assert [word for word in sentences if word not in "".join(found)] == []
    assert len(found) == sum(column < 0.0 for column in columns)


def test_small_or_mixed_motions_have_no_sign_to_check(tmp_path: Path) -> None:
    for text in (
        "pressure_kPa,end_angle_deg,tip_y_mm\n1,3,2\n",  # the rod has -3.1 and -3
        "pressure_kPa,end_angle_deg\n8,25\n16,-50\n",
        "pressure_kPa,end_angle_deg\n8,5\n16,10\n",  # it hardly bends, and the rod does
    ):
        assert refusals(read(tmp_path / "arm.csv", text)) == ()


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("pressure_kPa,tip_x_mm,tip_y_mm\n0,109,1\n8,128,-60", ("line 3", "tip_x_mm, tip_y_mm is 141.4 mm")),
        ("pressure_kPa,tip_y_mm\n8,-140", ("line 2", "tip_y_mm is 140 mm", "an arm of 110 mm")),
        ("pressure_kPa,s_mm,x_mm,y_mm\n8,50,400,-20", ("line 2", "the place in x_mm, y_mm")),
        ("pressure_kPa,tip_x_mm\n0,119", ()),
        ("pressure_kPa,s_mm,x_mm,y_mm\n0,1,99,0", ("line 2", "a point at s = 1 mm")),
        ("pressure_kPa,tip_x_mm,tip_y_mm\n0,0.11,0\n8,0.107,-0.02", ("0.001 times as far from the clamp",)),
        ("pressure_kPa,tip_x_mm,tip_y_mm\n0,4.3,0\n8,4.2,-0.9", ("as far from the clamp", "check the unit")),
        ("pressure_kPa,end_angle_deg\n16,307", ("line 2", "end_angle_deg is a turn off; write it as -53")),
        ("pressure_kPa,end_angle_deg\n24,76\n36,114", ("line 2", "write the column with a minus sign")),
        ("pressure_kPa,end_angle_deg\n36,246", ("line 2", "write it as -114")),
        ("pressure_kPa,s_mm,x_mm,y_mm\n4,55,-1,-4\n8,55,-2,-9", ("line 2", "every x_mm", "zero_kPa")),
    ],
)
def test_numbers_that_no_such_arm_has(tmp_path: Path, row: str, words: tuple[str, ...]) -> None:
    numbers = read(tmp_path / "arm.csv", f"{row}\n")
    found = refusals(numbers)
    assert [word for word in words if word not in "".join(found)] == []
    assert len(found) == bool(words)


def test_a_rod_that_stretches_reaches_farther(tmp_path: Path) -> None:
    numbers = read(tmp_path / "arm.csv", "pressure_kPa,tip_x_mm\n8,160\n")
    check_numbers(numbers, np.array([1.2 * LENGTH]), LENGTH)


def test_both_commands_refuse_the_mirrored_arm(tmp_path: Path) -> None:
    folder, file = result_folder(tmp_path / "arm"), tmp_path / "angles.csv"
    file.write_text("pressure_kPa,end_angle_deg\n8,20\n16,40\n", encoding="utf-8")
    for command in ("compare", "calibrate"):
        assert "write the column with a minus sign" in refused(command, str(folder), str(file))
    assert not (tmp_path / "arm_calibrated" / "law.json").exists()


@pytest.mark.slow
def test_a_fit_that_misses_the_motion_is_no_calibration(tmp_path: Path, few_proposals: None) -> None:
    """One tip of four was read as 3 in place of -66 mm: shown and kept with the reason, and the command has failed."""
    folder, file = result_folder(tmp_path / "arm"), tmp_path / "arm.csv"
    text = measured(file, arm_law(), [State(p) for p in (5.0, 10.0, 15.0, 25.0)]).read_text(encoding="utf-8")
    lines = text.splitlines()
    lines[4] = ";".join([*lines[4].split(";")[:2], "3", *lines[4].split(";")[3:]])
    file.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(RunFailed, match=r"line 5: tip_y_mm is 3, the rod has -\d") as failed:
        pneurod.calibrate(folder, file, tmp_path / "c")
    report = failed.value.reached
    assert failed.value.directory == tmp_path / "c"
    verdict = verdict_of(read_results(tmp_path / "c"))
    assert (verdict.usable, verdict.refusal and verdict.refusal.code) == (False, "not_calibrated")
    assert report.verdict.lines == verdict.lines  # type: ignore[attr-defined]
    assert compare_files(tmp_path / "c", file).is_calibrated  # for a look at the rows


def test_a_fit_that_stays_where_it_began_is_no_calibration(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, few_proposals: None
) -> None:
    monkeypatch.setattr("pipeline.answers.measured.fit._improved", lambda arm, numbers, fitted, *_: fitted.changes)
    file = measured(tmp_path / "arm.csv", arm_law(60.0).scaled(0.75), [State(p) for p in (5.0, 10.0, 15.0, 20.0)])
    with pytest.raises(RunFailed, match=r"did not end, and \d of 8 numbers are outside, in line \d: tip_"):
        pneurod.calibrate(result_folder(tmp_path / "arm"), file, tmp_path / "c")
    verdict = verdict_of(read_results(tmp_path / "c"))
    assert (verdict.usable, verdict.refusal and verdict.refusal.code) == (False, "unsettled")


@pytest.mark.parametrize(("part", "times", "expected"), [(0.5, 10.0, True), (0.5, 1.0, False), (0.1, 10.0, False)])
def test_missed_is_a_large_part_of_a_motion_that_can_be_read(
    tmp_path: Path, part: float, times: float, expected: bool
) -> None:
    size = times * usual_scatter(LENGTH, read(tmp_path / "a.csv", "pressure_kPa,tip_y_mm\n8,1\n"))["mm"]
    numbers = read(tmp_path / "arm.csv", f"pressure_kPa,tip_y_mm\n8,{-size / part}\n16,{-size / part}\n")
    rows = numbers.beside(numbers.values - size, np.ones(2))
    reason = failure_of(numbers, rows, usual_scatter(LENGTH, numbers), LENGTH, 0.0)
    assert (reason is not None) == expected


def test_measured_bodies_are_calibrations() -> None:
    """Of every case that was measured, a fit that misses as much as its repetitions and loads differ."""
    cases = [case for case in cases_in(CASES) if case.calibrate_on]
    assert cases
    for case in cases:
        numbers = Numbers.of(case.measured)
        worst = 0.08 * (numbers.values - numbers.straight(100.0))  # docs/experiments.md
        rows = numbers.beside(numbers.values - worst, np.ones(len(worst)))
        assert failure_of(numbers, rows, usual_scatter(100.0, numbers), 100.0, 0.0) is None
    assert MISSED > 3.0 * 0.08
    assert SCATTERS >= 3.0


def test_a_poisson_ratio_of_no_rubber_is_named(tmp_path: Path) -> None:
    law = arm_law()
    nu = replace(law.rates["geometry.wall"], value=0.49, unit="1")
    soft: ArmLaw = replace(law, rates={"material.nu": nu})
    amounts = {"material.nu": 0.3, "material.stiffness": 0.01}
    given = {"process": "cast", "given": {key: {"amount": v, "is_relative": v < 0.1} for key, v in amounts.items()}}
    file = measured(tmp_path / "arm.csv", soft.with_changes({"material.nu": -0.3}), [State(8.0), State(16.0)])
    found = calibrated(soft, {"tolerances": given}, read_measurements(file), ("material.nu",))
    assert found["material.nu"].mean < OF_RUBBER[0]
    assert any("material.nu comes out as" in note and "no rubber has" in note for note in found.notes)


def test_results_are_taken_as_their_folder_is(tmp_path: Path) -> None:
    folder = result_folder(tmp_path / "arm")
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    file, results = measured(tmp_path / "arm.csv", arm_law(), [State(8.0)]), pneurod.read_results(folder)
    assert run["config"]["name"] == results.run.design
    assert pneurod.compare(results, file).rows == pneurod.compare(folder, file).rows
    assert pneurod.solve(results, angle="20 deg").solutions == pneurod.solve(folder, angle="20 deg").solutions
    assert pneurod.export(results, "csv", out=tmp_path / "table").files
