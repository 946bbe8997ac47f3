"""Values of axes that are switches, words or sections: in the table, on the page and in the name of a folder."""

from pathlib import Path

from pipeline.study.sweep.axes import Axis
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
