"""The pictures of the measured arms: angle over pressure."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from benchmarks.markdown import ROOT
from geometry.arrays import Array
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.values.plots import COLOURS


def draw(name: str, pressures: Array, measured: Array, lines: Mapping[str, Array], band: Array | None) -> None:
    """Readings as points, what was foretold as lines, and a band (2, n) about the first of them.

    pressures (n,) in kPa; angles (n,) in degrees; none are drawn where all are zero.
    """
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    if band is not None:
        axes.fill_between(pressures, *band, color=COLOURS[0], alpha=0.2, linewidth=0, label="90 %")
    for (label, angles), colour in zip(lines.items(), COLOURS, strict=False):
        axes.plot(pressures, angles, color=colour, label=label, linewidth=1.5)
    if measured.any():
        axes.plot(pressures, measured, "o", color="black", markersize=3.5, label="measured")
    axes.set_xlabel("pressure (kPa)")
    axes.set_ylabel("direction of the tip, less that at 10 kPa (degrees)")
    axes.set_ylim(bottom=min(0.0, float(np.nanmin(measured))))
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(ROOT / "docs" / "pictures" / f"{name}.png", dpi=130)


def draw_foretold(name: str, rows: Measurements, intervals: Array, second: Mapping[float, float]) -> None:
    """Rows of directions beside what was foretold; intervals (3, n) as of `Foretelling`.

    second: readings of another test in degrees, by kPa.
    """
    numbers = Numbers.of(rows)
    lines = {"predicted": -intervals[0]}
    if second:
        lines["second test"] = np.interp(numbers.pressures, list(second), list(second.values()), np.nan, np.nan)
    draw(name, numbers.pressures, -numbers.values, lines, np.sort(-intervals[1:], axis=0))
