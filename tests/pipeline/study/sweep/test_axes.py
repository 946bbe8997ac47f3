"""The axes of a sweep and the file that they stand in; their values in tables, on pages and in names of folders."""

from pathlib import Path

import pytest

from pipeline.study.sweep.axes import Axis
from pipeline.study.sweep.points import Point, PointResult
from pipeline.study.sweep.spec import points_of, read_sweep
from pipeline.study.sweep.table import Column, sweep_page
from tests.pipeline.values.test_plots import panels_of

BASE = """
name: short
geometry: {family: pneunet, chambers: 4}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [5 kPa]
mesh: {size: 8 mm, formulation: p2p0, grading: off}
"""


def with_base(folder: Path) -> Path:
    """A sweep.yaml, not yet written, beside its base."""
    (folder / "base.yaml").write_text(BASE, encoding="utf-8")
    return folder / "sweep.yaml"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return with_base(tmp_path)


def sweep_of(file: Path, text: str):
    file.write_text(f"name: some\nbase: base.yaml\n{text}", encoding="utf-8")
    return read_sweep(file)


def test_axes_are_multiplied_the_last_one_fastest(file: Path) -> None:
    sweep = sweep_of(file, "axes: [geometry.wall: [1 mm, 2 mm], geometry.chambers: {from: 7, to: 9, number: 3}]")
    pairs = [tuple(setting.values()) for setting in sweep.settings]
    assert pairs == [("1 mm", 7), ("1 mm", 8), ("1 mm", 9), ("2 mm", 7), ("2 mm", 8), ("2 mm", 9)]
    assert sweep.run == ("whole",)


def test_keys_of_one_entry_change_together(file: Path) -> None:
    sweep = sweep_of(file, "axes: [{geometry.wall: [1 mm, 2 mm], mesh.size: [8 mm, 9 mm]}]")
    assert sweep.settings == (
        {"geometry.wall": "1 mm", "mesh.size": "8 mm"},
        {"geometry.wall": "2 mm", "mesh.size": "9 mm"},
    )


def test_a_range_is_in_the_unit_of_its_first_end(file: Path) -> None:
    sweep = sweep_of(file, "axes: [geometry.chamber_height: {from: 8 mm, to: 1.2 cm, number: 3}]")
    assert [setting["geometry.chamber_height"] for setting in sweep.settings] == ["8 mm", "10 mm", "12 mm"]


def test_a_latin_hypercube_has_one_value_in_every_part_and_follows_its_seed(file: Path) -> None:
    text = "latin_hypercube: {points: 20, seed: %d, axes: {geometry.wall: {from: 1 mm, to: 3 mm}, "
    text += "geometry.chambers: {from: 3, to: 7}}}"
    first, again, other = (sweep_of(file, text % seed).settings for seed in (1, 1, 2))
    assert first == again
    assert first != other
    walls = sorted(float(setting["geometry.wall"].removesuffix(" mm")) for setting in first)
    assert [int((wall - 1.0) / 2.0 * 20) for wall in walls] == list(range(20))
    chambers = [setting["geometry.chambers"] for setting in first]
    assert {type(number) for number in chambers} == {int}
    assert sorted(chambers) == [number for number in range(3, 8) for _ in range(4)]


def test_a_folder_depends_on_the_design_and_not_on_the_other_points(file: Path) -> None:
    few = points_of(sweep_of(file, "axes: [geometry.wall: [1 mm, 1.5 mm]]"), file.parent)
    many = points_of(sweep_of(file, "axes: [geometry.wall: [0.8 mm, 1 mm, 1.5 mm]]"), file.parent)
    assert [point.name for point in few] == [point.name for point in many[1:]]
    assert few[0].name.startswith("wall=1mm_")


def test_points_that_cannot_be_built_are_kept_with_their_reason(file: Path) -> None:
    axes = "axes: [geometry.wall: [1 mm, 4.5 mm], geometry.chamber_length: [8 mm, 12 mm]]"
    points = points_of(sweep_of(file, axes), file.parent)
    assert [type(point) for point in points] == [Point, Point, PointResult, Point]
    assert "wall" in points[2].reason


def test_a_point_whose_only_experiment_is_not_simulated_is_refused(file: Path) -> None:
    points = points_of(sweep_of(file, "run: I\naxes: [effects.gravity: [on, off]]"), file.parent)
    assert [type(point) for point in points] == [PointResult, Point]
    assert "nothing holds the weight" in points[0].reason


SVK, NEO_HOOKE = {"law": "svk", "E": "1.2 MPa", "nu": 0.495}, {"law": "neo_hooke", "mu": "0.4 MPa", "nu": 0.49}


def test_switches_are_written_as_in_the_file(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text(BASE, encoding="utf-8")
    file = tmp_path / "sweep.yaml"
    file.write_text("name: some\nbase: base.yaml\naxes: [effects.self_contact: [auto, off, on]]", encoding="utf-8")
    points = points_of(read_sweep(file), tmp_path)
    assert [point.name.partition("_contact=")[2].partition("_")[0] for point in points] == ["auto", "off", "on"]
    column = Column.of("effects.self_contact", [point.setting for point in points])
    assert [column.cell(point.setting) for point in points] == ["auto", "off", "on"]


def test_the_page_has_short_words_and_joins_points_that_differ_in_one_axis() -> None:
    settings = [{"material": material, "mesh.size": size} for material in (SVK, NEO_HOOKE) for size in ("2 mm", "1 mm")]
    columns = [Column.of(key, settings) for key in ("material", "mesh.size")]
    axes = [Axis(tuple({key: setting[key]} for setting in settings)) for key in ("material", "mesh.size")]
    rows = [
        {**{column.name: column.cell(setting) for column in columns}, "pressure_kPa": 5.0, "II_tip_y_mm": -0.1 * number}
        for number, setting in enumerate(settings)
    ]
    page = sweep_page("laws", ("II",), axes, columns, rows)
    by_law, by_size = (panel["data"] for panel in panels_of(page))
    assert [trace["x"] for trace in by_law] == [["svk", "neo_hooke"]] * 2
    assert [trace["y"] for trace in by_size] == [[-0.1, 0.0], [-0.3, -0.2]]
    assert [trace["x"] for trace in by_size] == [[1.0, 2.0]] * 2
    assert [trace["meta"] for trace in by_law] == [{"entry": f"size {size} mm", "frame": "5 kPa"} for size in (2, 1)]
    assert len({trace["line"]["color"] for trace in by_size}) == 2
    drawn = sweep_page("laws", ("II",), [Axis(axis.settings, is_drawn=True) for axis in axes], columns, rows)
    assert {trace["mode"] for panel in panels_of(drawn) for trace in panel["data"]} == {"markers"}
