"""Files of measured arms: what is read, and the sentence for what cannot be."""

from pathlib import Path

import pytest

from pipeline.answers.measured.rows import State
from pipeline.answers.measured.table import read_measurements


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
