"""The pictures of the measured arms: angle over pressure."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from benchmarks.markdown import ROOT
from geometry.arrays import Array
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.values.plots import COLOURS


def draw_foretold(name: str, rows: Measurements, intervals: Array, second: Mapping[float, float]) -> None:
    """Rows of directions as points, and what was predicted; intervals (3, n) as of `Foretelling`.

    second: readings of another test in degrees, by kPa.
    """
    numbers = Numbers.of(rows)
    predicted, *band = -intervals
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    axes.fill_between(numbers.pressures, *band, color=COLOURS[0], alpha=0.2, linewidth=0, label="90 %")
    axes.plot(numbers.pressures, predicted, color=COLOURS[0], label="predicted", linewidth=1.5)
    if second:
        other = np.interp(numbers.pressures, list(second), list(second.values()), np.nan, np.nan)
        axes.plot(numbers.pressures, other, color=COLOURS[1], label="second test", linewidth=1.5)
    axes.plot(numbers.pressures, -numbers.values, "o", color="black", markersize=3.5, label="measured")
    axes.set_xlabel("pressure (kPa)")
    axes.set_ylabel("direction of the tip, less that at 10 kPa (degrees)")
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(ROOT / "docs" / "pictures" / f"{name}.png", dpi=130)
