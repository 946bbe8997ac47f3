"""Values of axes that are switches, words or sections: in the table, below a panel and in the name of a folder."""

import json
import warnings
from pathlib import Path

from pipeline.sweep.axes import Axis
from pipeline.sweep.labels import Labels
from pipeline.sweep.picture import svg_picture
from pipeline.sweep.points import points_of
from pipeline.sweep.spec import read_sweep
from pipeline.sweep.table import Column

BASE = """
name: short
geometry: {family: pneunet, chambers: 4}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
pressures: [5 kPa]
mesh: {size: 8 mm, formulation: p2p0, grading: off}
"""
SVK, NEO_HOOKE = {"law": "svk", "E": "1.2 MPa", "nu": 0.495}, {"law": "neo_hooke", "mu": "0.4 MPa", "nu": 0.49}
CAVITIES = [{"cavities": {"cavity": part}} for part in (1, 0.5)]


def test_switches_are_written_as_in_the_file(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text(BASE, encoding="utf-8")
    file = tmp_path / "sweep.yaml"
    file.write_text("name: some\nbase: base.yaml\naxes: [effects.self_contact: [auto, off, on]]", encoding="utf-8")
    points = points_of(read_sweep(file))
    assert [point.name.partition("_contact=")[2].partition("_")[0] for point in points] == ["auto", "off", "on"]
    column = Column.of("effects.self_contact", [point.setting for point in points])
    assert [column.cell(point.setting) for point in points] == ["auto", "off", "on"]


def test_labels_are_words_laws_or_numbers_with_a_legend() -> None:
    assert Labels.of([1.0, 1.5, 1.0]) is None
    assert Labels.of([1.5, "off", 1.5]) == Labels((1.5, "off"), ("1.5", "off"), ())
    assert Labels.of([json.dumps(SVK), json.dumps(NEO_HOOKE)]).short == ("svk", "neo_hooke")
    numbered = Labels.of([json.dumps(value) for value in CAVITIES])
    assert numbered.short == ("1", "2")
    assert numbered.legend == ('1: {"cavities": {"cavity": 1}}', '2: {"cavities": {"cavity": 0.5}}')


def test_the_picture_has_short_labels_and_draws_without_a_warning() -> None:
    settings = [
        {"material": material, "mesh.coarser": coarser} for material in (SVK, NEO_HOOKE) for coarser in (2, "off")
    ]
    columns = [Column.of(key, settings) for key in ("material", "mesh.coarser")]
    axes = [Axis(tuple({key: setting[key]} for setting in settings)) for key in ("material", "mesh.coarser")]
    rows = [
        {**{column.name: column.cell(setting) for column in columns}, "pressure_kPa": 5.0, "II_end_y_mm": -0.1 * number}
        for number, setting in enumerate(settings)
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = svg_picture("laws", ("II",), axes, columns, rows)
    assert "<!-- svk -->" in picture
    assert "<!-- neo_hooke -->" in picture
    assert "1.2 MPa" not in picture
