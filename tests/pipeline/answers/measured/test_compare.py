"""Measured arms beside a rod in closed form."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.answers.measured.compare import compare_files
from pipeline.answers.measured.page import comparison_page, comparison_table
from pipeline.answers.measured.rows import State
from pipeline.values.errors import InputError
from tests.coarse import COARSE
from tests.measured_arm import LENGTH, arm_law, measured, result_folder
from tests.pipeline.values.test_plots import panels_of


def test_differences_and_what_is_allowed(tmp_path: Path) -> None:
    """A gauge that shows 2 % too little lies within the tolerances; an arm of half the modulus does not."""
    folder = result_folder(tmp_path / "arm")
    states = [State(10.0), State(20.0), State(20.0, held_y_mm=0.0)]
    same = compare_files(folder, measured(tmp_path / "same.csv", arm_law(), states))
    assert same.rms("mm") < 1e-3
    assert same.within == 1.0
    assert same.largest == "tolerances"
    assert len(same.unknown) == 2  # neither the error of the rod nor that of the mesh
    soft = compare_files(folder, measured(tmp_path / "soft.csv", arm_law(80.0).scaled(0.5), states[:2]))
    assert soft.rms("mm") > 0.1 * LENGTH
    assert soft.within < 0.5
    assert len(comparison_table(soft.rows).rows) == len(soft.rows) == 4
    (arm,) = panels_of(comparison_page(soft.design, soft.rows, soft.curves))[:1]
    rods = [trace for trace in arm["data"] if trace["mode"] == "lines"]
    tips = [trace for trace in arm["data"] if trace["meta"]["entry"] == "measured"]
    assert [trace["meta"]["frame"] for trace in tips] == ["10 kPa", "20 kPa"]
    assert [trace["line"]["color"] for trace in rods] == [trace["marker"]["color"] for trace in tips]
    for rod, tip, pressure in zip(rods, tips, (10.0, 20.0), strict=True):
        x, y = (row for row in soft.rows if row.pressure_kPa == pressure)
        assert (rod["x"][-1], rod["y"][-1]) == pytest.approx((x.predicted, y.predicted), rel=1e-5)
        assert (*tip["x"], *tip["y"]) == pytest.approx((x.measured, y.measured), rel=1e-5)


def test_rod_and_mesh_of_a_run_are_counted(tmp_path: Path) -> None:
    text = "pressure_kPa,tip_x_mm,tip_y_mm,end_angle_deg,s_mm,x_mm,y_mm\n17,84.2,-61.6,-77,56,53,-12\n"
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    found = compare_files(COARSE, tmp_path / "arm.csv", kind="law")
    assert set(found.shares) == {"rod", "mesh"}
    assert all(row.allowed > 0.0 for row in found.rows)
    assert found.rms("deg") > 0.0


def test_a_frame_that_is_turned_and_shifted_is_found_from_rows_at_rest(tmp_path: Path) -> None:
    turn, shift = np.radians(7.0), np.array([12.0, -5.0])
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    rod = {s: np.array([s, 0.0]) for s in (0.0, 50.0, LENGTH)}
    rows = ["pressure_kPa,s_mm,x_mm,y_mm"]
    rows += [f"0,{s:g},{x:.6f},{y:.6f}" for s, (x, y) in ((s, matrix @ r + shift) for s, r in rod.items())]
    angle = -5e-4 * 20.0 * 50.0  # of the arc from the clamp to s = 50 mm
    bent = np.array([np.sin(angle), 1.0 - np.cos(angle)]) * 50.0 / angle
    x, y = matrix @ bent + shift
    rows.append(f"20,50,{x:.6f},{y:.6f}")
    (tmp_path / "arm.csv").write_text("\n".join(rows), encoding="utf-8")
    folder = result_folder(tmp_path / "arm")
    assert compare_files(folder, tmp_path / "arm.csv").rms("mm") > 5.0
    assert compare_files(folder, tmp_path / "arm.csv", align=True).rms("mm") < 1e-3


@pytest.mark.parametrize(
    ("text", "align", "words"),
    [
        ("pressure_kPa,tip_x_mm\n8,100\n55,50\n", False, ("line 3", "55 kPa", "40 kPa")),
        ("pressure_kPa,tip_x_mm,tip_y_mm\n0,100,3\n", True, ("align=True",)),
        ("pressure_kPa,end_angle_deg\n20,-1.1\n", False, ("line 2", "end_angle_rad")),
        ("pressure_kPa,s_mm,x_mm,y_mm\n20,150,90,-3\n", False, ("line 2", "150")),
    ],
)
def test_bad_input(tmp_path: Path, text: str, align: bool, words: tuple[str, ...]) -> None:
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        compare_files(result_folder(tmp_path / "arm"), tmp_path / "arm.csv", align)
    assert [word for word in words if word not in str(refused.value)] == []
