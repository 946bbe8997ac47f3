"""The figures of the report: the rod beside the finite elements, and shapes in a suitable scale."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.chart import Chart, Marks, ticks
from pipeline.report.figures import of_experiment, validation_shapes
from pipeline.report.law_figure import arm_law
from pipeline.report.results import Results, read_results
from pipeline.store.formats import CURVE_COLUMNS

S = np.linspace(0.0, 100.0, 21)


def results(folder: Path, droop: float) -> Results:
    """II, III and one load out of sample, whose end hangs `droop` mm below the clamp."""
    table = dict.fromkeys(CURVE_COLUMNS[2:], 0.0 * S) | {"s_mm": S, "x_mm": S, "y_mm": -droop * (S / 100.0) ** 2}
    table |= {
        "rod_x_mm": S,
        "rod_y_mm": table["y_mm"],
        "kappa_per_mm": 0.01 + 0.0 * S,
        "rod_kappa_per_mm": 0.02 + 0 * S,
    }
    for name, load in (("curves.csv", None), ("validation_curves.csv", "end at +5 mm")):
        with (folder / name).open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([*([] if load is None else ["load"]), *CURVE_COLUMNS])
            for experiment in ("II", "III") if load is None else ("III",):
                for cells in zip(*table.values(), strict=True):
                    writer.writerow([*([] if load is None else [load]), experiment, 20.0, *cells])
    return read_results(folder)


@pytest.mark.parametrize(("droop", "alike"), [(60.0, True), (4.0, False)])
def test_nearly_straight_arms_get_a_larger_scale_for_y(tmp_path: Path, droop: float, alike: bool) -> None:
    stored = results(tmp_path, droop)
    for figure in (of_experiment(stored, "III"), validation_shapes(stored)):
        assert figure is not None
        shape = figure.charts[0]
        assert shape.to_scale == alike
        assert ("not to scale" in shape.svg()) != alike
        left, right, low, high = map(float, re.findall(r'data-range="([^"]*)"', shape.svg())[0].split())
        _, _, width, height = map(float, re.findall(r'data-plot="([^"]*)"', shape.svg())[0].split())
        assert ((right - left) / width == pytest.approx((high - low) / height, rel=1e-4)) == alike


def test_the_curvature_of_the_rod_stands_beside_that_of_the_loaded_arm(tmp_path: Path) -> None:
    figure = of_experiment(results(tmp_path, 4.0), "III")
    assert figure is not None
    drawn = [marks for marks in figure.charts[1].marks if marks.name == "rod, 20 kPa"]
    assert len(drawn) == 1
    assert np.allclose(drawn[0].y, 0.02)
    assert (drawn[0].style, drawn[0].pressure) == ("rod", 20.0)
    assert of_experiment(results(tmp_path, 4.0), "I") is None


def test_the_figures_show_the_rod_that_stretches_where_that_is_to_be_taken(tmp_path: Path) -> None:
    stored = results(tmp_path, 4.0)
    figure = of_experiment(stored, "III")
    assert figure is not None
    assert not any(marks.name.startswith("rod that stretches") for marks in figure.charts[0].marks)
    rows = [
        {"experiment": "III", "pressure_kPa": 20.0, "rod": rod, "distance_over_length": distance}
        for rod, distance in (("five", 0.05), ("five_extensible", 0.002))
    ]
    (tmp_path / "validation.json").write_text(json.dumps(rows), encoding="utf-8")
    path = tmp_path / "curves.csv"
    table = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, CURVE_COLUMNS)
        writer.writeheader()
        writer.writerows(row | {"five_extensible_x_mm": row["x_mm"], "five_extensible_y_mm": 7.0} for row in table)
    figure = of_experiment(read_results(tmp_path), "III")
    assert figure is not None
    (drawn,) = (marks for marks in figure.charts[0].marks if marks.style == "rod")
    assert drawn.name == "rod that stretches, 20 kPa"
    assert np.allclose(drawn.y, 7.0)
    assert [entry.text for entry in figure.legend if entry.style == "rod"] == ["rod that stretches, five parameters"]


@pytest.mark.parametrize(("averaging", "zone"), [(None, 0.0), (10.0, 15.0), (20.0, 30.0)])
def test_the_figure_of_the_law_leaves_out_the_ends_of_the_arm(
    tmp_path: Path, averaging: float | None, zone: float
) -> None:
    results(tmp_path, 4.0)
    law = {"pressure_kPa": 20.0, "kappa_per_mm": [0.0, 0.01], "moment_N_mm": [0.0, 3.0], "contact": [0, 0]}
    contents = {"law": {"curves": [law]}, "run": {"mesh": {"averaging_mm": averaging}}}
    for name, content in contents.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    figure = arm_law(read_results(tmp_path))
    assert figure is not None
    (dots,) = (marks for marks in figure.charts[0].marks if marks.style == "dots")
    assert len(dots.x) == np.count_nonzero((zone < S) & (zone < 100.0 - S))
    assert np.allclose(dots.x, 0.01)  # kappa_0 in the middle: III has the curvature of II here


def points(svg: str, name: str) -> list[tuple[float, float]]:
    """The points of the path with this name, in the units of the axes."""
    left, right, low, high = map(float, re.findall(r'data-range="([^"]*)"', svg)[0].split())
    x0, y0, width, height = map(float, re.findall(r'data-plot="([^"]*)"', svg)[0].split())
    path = re.findall(rf'data-name="{name}" d="([^"]*)"', svg)[0]
    pairs = [tuple(map(float, pair.split())) for pair in re.split(r"[ML]", path.replace("h0", ""))[1:]]
    return [(left + (x - x0) / width * (right - left), high - (y - y0) / height * (high - low)) for x, y in pairs]


def test_a_chart_draws_its_numbers() -> None:
    x, y = np.linspace(0.0, 10.0, 11), np.linspace(-3.0, 4.0, 11)
    y[4] = np.nan
    svg = Chart("t", "x", "y", (Marks(x, y, "a line"), Marks(x, y, "dots", "dots"))).svg()
    finite = np.isfinite(y)
    for name in ("a line", "dots"):
        assert np.allclose(points(svg, name), np.column_stack([x, y])[finite], atol=0.02)
    assert svg.count("M") > svg.count("nan")
    assert re.findall(r'data-name="a line" d="([^"]*)"', svg)[0].count("M") == 2  # interrupted at the gap


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (-1.0, 111.0, ["0", "25", "50", "75", "100"]),
        (0.1, 0.9, ["0.2", "0.4", "0.6", "0.8"]),
        (-0.03, 0.01, ["-0.03", "-0.02", "-0.01", "0.00", "0.01"]),
        (0.0, 12.0, ["0.0", "2.5", "5.0", "7.5", "10.0"]),
    ],
)
def test_ticks_are_round_numbers(low: float, high: float, texts: list[str]) -> None:
    assert [text for _, text in ticks(low, high)] == texts


def test_a_chart_without_a_finite_number_is_empty() -> None:
    assert '<path class="line"' not in Chart("t", "x", "y", (Marks(S, S * np.nan, "nothing"),)).svg()
