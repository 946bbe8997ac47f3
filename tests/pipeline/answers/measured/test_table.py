"""Files of measured arms: what is read, and the sentence for what cannot be."""

from pathlib import Path

import pytest

from pipeline.answers.measured.rows import State
from pipeline.answers.measured.table import read_measurements
from pipeline.values.errors import InputError


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


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pressure,tip_x_mm\n12,100\n", ("pressure", "unit", "pressure_kPa")),
        ("pressure_N,tip_x_mm\n12,100\n", ("pressure_N", "pressure_kPa")),
        ("pressure_kPa,tip_z_mm\n12,100\n", ("tip_z_mm", "tip_x_mm")),
        ("pressure_kPa,tip_x_mm,tip x (cm)\n12,100,10\n", ("tip_x_mm", "tip x (cm)")),
        ("tip_x_mm,tip_y_mm\n12,100\n", ("pressure_kPa",)),
        ("pressure_kPa,force_x_N\n12,0.1\n", ("tip_x_mm",)),
        ("pressure_kPa,tip_x_mm\n12,100\n,101\n", ("line 3", "pressure")),
        ("pressure_kPa,tip_x_mm\n12,100\n13,about 98\n", ("line 3", "about 98", "tip_x_mm")),
        ("pressure_kPa,tip_x_mm,force_y_N\n12,100,0\n13,,1\n", ("line 3",)),
        ("pressure_kPa,x_mm,y_mm\n12,100,3\n", ("s_mm",)),
        ("pressure_kPa,s_mm,x_mm,y_mm\n12,50,49,3\n12,60,57,\n", ("line 3", "y_mm")),
        ("pressure_kPa,reaction_N\n12,0.1\n", ("held_y_mm",)),
        ("pressure_kPa,tip_x_mm,held_y_mm,force_y_N\n12,100,0,1\n", ("line 2", "held_y_mm")),
        ("pressure_kPa,tip_x_mm,tip_mass_g\n12,100,3\n", ("orientation",)),
        ("pressure_kPa,tip_x_mm,tip_mass_g,orientation\n12,100,3,sideways\n", ("line 2", "sideways", "hanging")),
        ("pressure_kPa,tip_x_mm,tip_mass_g,orientation\n12,100,-3,lying\n", ("line 2", "tip_mass_g")),
        ("pressure_kPa,held_y_mm,tip_x_mm,reaction_zero_N\n12,0,90,0.1\n", ("line 2", "reaction_N")),
        ("pressure_kPa,held_y_mm,reaction_N,at_y_mm\n12,0,0.1,-5\n", ("line 2", "at_y_mm", "tip_direction_deg")),
        ("t_s,pressure_kPa,tip_x_mm,zero_kPa\n1,12,90,0\n", ("line 2", "zero_kPa")),
        ("pressure_kPa,tip_x_mm\n", ("arm.csv",)),
        ("pressure_kPa,tip_x_px\n12,100\n", ("tip_x_px", "mm per px")),
        ("pressure_kPa,tip_x [pixel],tip_y [pixel]\n12,100,3\n", ("tip_x [pixel]", "mm per px")),
        ("pressure,tip_x,tip_y\nkPa,px,px\n12,100,3\n", ("tip_x", "mm per px")),
        ("absolute pressure (kPa),tip_x_mm\n110,80\n", ("absolute pressure (kPa)", "subtract")),
        ("p abs (bar),tip_x_mm\n1.1,80\n", ("p abs (bar)", "subtract")),
        ("pressure_kPa,pressure_2_kPa,tip_x_mm\n1,2,80\n", ("pressure_2_kPa", "the largest one", "1:0.5")),
        ("frame,pressure_kPa,tip_x_mm\n1,2,80\n", ("frame", "per second", "t_s")),
        ("pressure_kPa,dx_mm,dy_mm\n1,2,80\n", ("dx_mm", "displacements", "zero_kPa")),
        ("pressure_kPa,displacement x (mm)\n1,2\n", ("displacement x (mm)", "zero_kPa")),
        ("Format Version,1.23,Take Name,take1\n\nFrame,Time (Seconds),X,Y\n0,0,0.1,0.2\n", ("Motive", "pressure_kPa")),
        ("nothing\n", ("arm.csv", "pressure_kPa")),
        ("pressure_kPa,tip_x_mm\n12,100\n12,100\n12,100\n", ("every row is there 3 times",)),
        ("pressure_kPa,tip_x_mm\n12,100\n13,99\n\npressure_kPa,tip_x_mm\n14,98\n", ("titles again", "line 6")),
    ],
)
def test_bad_files_are_told_with_line_and_column(tmp_path: Path, text: str, words: tuple[str, ...]) -> None:
    (tmp_path / "arm.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read_measurements(tmp_path / "arm.csv")
    (sentence,) = refused.value.sentences
    assert str(tmp_path / "arm.csv") in sentence
    assert [word for word in words if word not in sentence] == []


def test_no_such_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="measured arm"):
        read_measurements(tmp_path / "none.csv")
