"""The figures of the report: the rod beside the finite elements, and shapes in a suitable scale."""

import csv
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.figures import curvatures, shapes, validation_shapes
from pipeline.report.results import Results, read_results
from pipeline.validation.compare import CURVE_COLUMNS

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
    found = results(tmp_path, droop)
    for figure in (shapes(found), validation_shapes(found)):
        assert (figure.layout.yaxis.scaleanchor == "x") == alike
        assert figure.layout.yaxis.title.text.endswith("not to scale") != alike


def test_the_curvature_of_the_rod_stands_beside_that_of_the_loaded_arm(tmp_path: Path) -> None:
    drawn = [trace for trace in curvatures(results(tmp_path, 4.0)).data if trace.name == "rod, 20 kPa"]
    assert len(drawn) == 1
    assert np.allclose(np.asarray(drawn[0].y, dtype=float), 0.02)
    assert drawn[0].line.dash == "dash"
