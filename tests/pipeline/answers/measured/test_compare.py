"""Files of measured arms, and measured arms beside a rod in closed form."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.answers.measured.compare import compare_files
from pipeline.answers.measured.predicted import LawRods, Numbers, Setup
from pipeline.answers.measured.rows import State
from pipeline.answers.measured.table import read_measurements
from pipeline.values.errors import InputError
from tests.coarse import COARSE
from tests.measured_arm import BENDING, LENGTH, arm_law, measured, result_folder
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
    assert len(soft.table.rows) == len(soft.rows) == 4
    heads, *numbers = str(soft).splitlines()[:5]
    assert heads.split("  ")[0] == "line"
    assert len({len(line.rstrip().removesuffix("outside").rstrip()) for line in numbers}) <= 2
    (arm,) = panels_of(soft.page)[:1]
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
    found = compare_files(COARSE, tmp_path / "arm.csv")
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


def test_rows_without_pressure_alone(tmp_path: Path) -> None:
    """The tolerance of a gauge is a part of the pressure, here of nothing."""
    file = measured(tmp_path / "arm.csv", arm_law(), [State(0.0, (0.0, force)) for force in (0.002, 0.005, -0.005)])
    found = compare_files(result_folder(tmp_path / "arm"), file)
    assert (found.within, len(found.rows)) == (1.0, 6)
    assert all(np.isfinite([row.predicted, row.allowed]).all() for row in found.rows)


def test_what_is_not_known_is_no_result(tmp_path: Path) -> None:
    (tmp_path / "arm.csv").write_text("pressure_kPa,tip_x_mm\n8,100\n9,99\n", encoding="utf-8")
    numbers = Numbers.of(read_measurements(tmp_path / "arm.csv"))
    with pytest.raises(InputError, match="line 3: what the rod has of tip_x_mm is not known"):
        numbers.beside(np.array([100.0, 99.0]), np.array([1.0, np.nan]))


def test_an_origin_that_may_be_off_is_said_where_numbers_are_outside(tmp_path: Path) -> None:
    rows = {
        "tips": "pressure_kPa,tip_x_mm,tip_y_mm\n8,120,-15\n",
        "rest": "0,110,0\n",
        "moved": "pressure_kPa,tip_x_mm,zero_kPa\n8,-30,0\n",
    }
    for text, is_said in ((rows["tips"], True), (rows["tips"] + rows["rest"], False), (rows["moved"], False)):
        (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
        found = compare_files(result_folder(tmp_path / "arm"), tmp_path / "arm.csv")
        assert any("origin of the places" in line for line in found.lines) == is_said


def tip(pressure: float, beside: float = 0.0) -> complex:
    """Of an arc, and of a point beside its end: x + iy in mm."""
    kappa = BENDING * pressure
    end = 1j * (1.0 - np.exp(1j * kappa * LENGTH)) / kappa if kappa else LENGTH
    return complex(end + 1j * beside * np.exp(1j * kappa * LENGTH))


def test_columns_of_arcs(tmp_path: Path) -> None:
    """Directions of the tip, what is counted from another pressure, and points beside the end of the curve."""
    (tmp_path / "arm.csv").write_text(
        "pressure_kPa,tip_direction_deg,zero_kPa,at_y_mm,tip_x_mm,tip_y_mm,tip_distance_mm,end_angle_deg,s_mm,x_mm,y_mm\n"
        "20,-1,,,,,,,,,\n40,-1,,-6,1,1,,,,,\n20,-1,5,-6,1,1,1,-1,55,1,1\n0,-1,,-6,,,,,,,\n20,,,8,,,1,,,,\n110,-1,,,,,,,,,\n",
        "utf-8",
    )
    turn = np.degrees(BENDING * LENGTH)  # per kPa
    moved, middle = (
        tip(20.0, -6.0) - tip(5.0, -6.0),
        (tip(10.0) - tip(2.5)) / 2.0,
    )  # half an arm is one at half the turn
    angle = {p: np.degrees(np.angle(tip(p, -6.0))) for p in (40.0, 20.0, 5.0, 0.0)}
    expected = {
        (2, "tip_direction"): 10.0 * turn,
        (3, "tip_x"): tip(40.0, -6.0).real,
        (3, "tip_y"): tip(40.0, -6.0).imag,
        (3, "tip_direction"): angle[40.0],
        (4, "tip_x"): moved.real,
        (4, "tip_y"): moved.imag,
        (4, "tip_distance"): abs(moved),
        (4, "tip_direction"): angle[20.0] - angle[5.0],
        (4, "end_angle"): 15.0 * 0.99 * turn,  # of a chord over the last 2 %
        (4, "x"): middle.real,
        (4, "y"): middle.imag,
        (5, "tip_direction"): angle[0.0],
        (6, "tip_distance"): abs(tip(20.0, 8.0) - tip(0.0, 8.0)),
        (7, "tip_direction"): 55.0 * turn,  # nearly a whole circle
    }
    numbers = Numbers.of(read_measurements(tmp_path / "arm.csv"))
    found = numbers.predicted(LawRods(arm_law(120.0))).tolist()
    keys = [(row.line, name) for row, name in zip(numbers.rows, numbers.names, strict=True)]
    assert dict(zip(keys, found, strict=True)) == pytest.approx(expected, rel=1e-6)


def test_a_held_force_counted_from_another_pressure(tmp_path: Path) -> None:
    text = "pressure_kPa,held_y_mm,reaction_N,zero_kPa\n20,0,1,\n8,0,1,\n20,0,1,8\n"
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    numbers = Numbers.of(read_measurements(tmp_path / "arm.csv"))
    there, before, less = numbers.predicted(LawRods(arm_law()))
    assert there > 1.5 * before > 0.0
    assert less == pytest.approx(there - before, rel=1e-9)


def test_a_clamp_that_is_turned_turns_the_direction_and_no_difference_of_directions(tmp_path: Path) -> None:
    text = "pressure_kPa,tip_direction_deg,zero_kPa,at_y_mm\n20,-1,,-6\n20,-1,10,-6\n"
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    numbers, rods = Numbers.of(read_measurements(tmp_path / "arm.csv")), LawRods(arm_law())
    turned = numbers.predicted(rods, Setup(clamp_deg=2.0)) - numbers.predicted(rods)
    assert turned == pytest.approx([2.0, 0.0], abs=1e-9)


def test_states_and_what_was_read_in_them(tmp_path: Path) -> None:
    text = (
        "# a photograph each\n"
        "pressure_kPa,tip_x_mm,tip_y_mm,force_y_N,tip_mass_g,orientation,repeat\n"
        "12,101.5,-33,,,,a\n\n12,101.9,-33.4,,,,b\n24,80,-60,0.02,,,\n24,,-61,,3,hanging,\n"
    )
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    found = read_measurements(tmp_path / "arm.csv")
    assert [row.line for row in found.rows] == [3, 5, 6, 7]
    assert [row.repeat for row in found.rows] == ["a", "b", "", ""]
    assert tuple(dict.fromkeys(row.state for row in found.rows)) == (
        State(12.0),
        State(24.0, (0.0, 0.02)),
        State(24.0, tip_mass_g=3.0, orientation="hanging"),
    )
    assert found.rows[0].values == {"tip_x": 101.5, "tip_y": -33.0}
    assert found.rows[3].values == {"tip_y": -61.0}
    assert (sum(len(row.values) for row in found.rows), found.pressures_kPa) == (7, (12.0, 24.0))


def test_points_held_ends_units_and_decimal_commas(tmp_path: Path) -> None:
    """The same arm as a German spreadsheet has it, and with units on a line of their own."""
    points = "Arm 7\npressure [mbar];s [cm];x [cm];y [cm]\n120;2,5;2,4;-0,1\n120;5;4,6;-0,9\n"
    (tmp_path / "points.csv").write_text(points, encoding="cp1252")
    found = read_measurements(tmp_path / "points.csv")
    assert [(row.state.pressure_kPa, row.s_mm, dict(row.values)) for row in found.rows] == [
        (12.0, 25.0, {"x": 24.0, "y": -1.0}),
        (12.0, 50.0, {"x": 46.0, "y": -9.0}),
    ]
    held = "pressure,held_y,reaction,end angle\nbar,mm,mN,rad\n0.2,0,45,-0.5\n"
    (tmp_path / "held.csv").write_text(held, encoding="utf-8")
    (row,) = read_measurements(tmp_path / "held.csv").rows
    assert row.state == State(20.0, held_y_mm=0.0)
    assert row.values == pytest.approx({"reaction": 0.045, "end_angle": -28.6478897565})


def test_zeros_a_point_of_the_tip_and_titles_with_a_minus_sign(tmp_path: Path) -> None:
    """Angles counted downwards from 10 kPa, and a load cell that shows 60 mN when nothing touches it."""
    angles = "pressure_kPa,-tip_direction_deg,zero_kPa,at_y_mm\n12,1.1,10,-5\n14,-1.41,10,\n"
    (tmp_path / "angles.csv").write_text(angles, encoding="utf-8")
    rows = read_measurements(tmp_path / "angles.csv").rows
    assert [row.values for row in rows] == [{"tip_direction": -1.1}, {"tip_direction": 1.41}]
    assert [(row.zero_kPa, row.at_y_mm) for row in rows] == [(10.0, -5.0), (10.0, 0.0)]
    (tmp_path / "force.csv").write_text(
        "pressure_kPa,held_y_mm,reaction_N,reaction zero (mN)\n10,0,0.0725,60.4\n", "utf-8"
    )
    (row,) = read_measurements(tmp_path / "force.csv").rows
    assert row.values == pytest.approx({"reaction": 0.0121})


def test_one_who_waits_is_told_the_time_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pipeline.store.time_left.WAIT", 0.0)
    told, folder = list[str](), result_folder(tmp_path / "arm")
    compare_files(folder, measured(tmp_path / "arm.csv", arm_law(), [State(8.0)]), tell=told.append)
    parts = [int(words.partition(" % of the numbers by the rod are found; about ")[0]) for words in told]
    assert (parts == sorted(parts), parts[-1]) == (True, 95)
