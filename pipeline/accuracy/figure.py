"""Error over CPU seconds on an HTML page, one line per series, and the Pareto front."""

from collections.abc import Sequence

import numpy as np

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE
from pipeline.accuracy.record import ConvergenceStudy, StudyRow
from pipeline.plots import COLOURS, GREY, INK, Line, Panel, figure, standalone_page

#: what varies along a series that is none of meshes, with its unit
_VARIED = {TOLERANCE: "tolerance {:g}", CONTACT: "distance {:g} mm", POINTS: "{:g} points"}
#: titles of the axes
SECONDS, ERROR = "CPU seconds of II and III, one thread", "largest error of κ₀(l/2), α₂ and F (%)"


def study_page(study: ConvergenceStudy) -> str:
    """The figure alone on a page that opens offline."""
    rows = [row for row in study.rows if row.point]
    lines = [
        Line(*points_of(members), name, COLOURS[number % len(COLOURS)], "dot" if name in _VARIED else "solid", "circle",
             texts=[_label(row) for row in members])
        for number, (name, members) in enumerate(series_of(rows).items())
    ]  # fmt: skip
    front = front_of(rows)
    ends = np.array(sorted(points_of(rows)[0]))[[0, -1]] if rows else np.zeros(0)
    lines.append(Line(*points_of(front), "Pareto front", INK, width=6.0, opacity=0.2))
    reference = np.full(len(ends), 100 * study.reference_error)
    lines.append(Line(ends, reference, "standard deviation of the reference", GREY, "dash"))
    panel = Panel("Error over time", SECONDS, ERROR, tuple(lines), log_x=True, log_y=True)
    return standalone_page(f"{study.name}: error over CPU seconds", figure([panel]))


def series_of(rows: Sequence[StudyRow]) -> dict[str, list[StudyRow]]:
    """Rows by series, each in the order of what varies along it."""
    series: dict[str, list[StudyRow]] = {}
    for row in sorted(rows, key=lambda row: row.value or 0.0):
        series.setdefault(row.series, []).append(row)
    return {name: series[name] for name in dict.fromkeys(row.series for row in rows)}


def front_of(rows: Sequence[StudyRow]) -> list[StudyRow]:
    """The rows of the Pareto front by seconds."""
    return sorted((row for row in rows if row.on_front), key=lambda row: row.point or (0.0, 0.0))


def points_of(rows: Sequence[StudyRow]) -> tuple[list[float], list[float]]:
    """CPU seconds and errors in per cent."""
    points = [row.point for row in rows if row.point]
    return [seconds for seconds, _ in points], [100 * error for _, error in points]


def _label(row: StudyRow) -> str:
    varied = _VARIED.get(row.series, "mesh {:g} mm").format(row.value)
    freedom = "" if row.result.cost is None else f", {row.result.cost.degrees_of_freedom} degrees of freedom"
    return f"{row.series}: {varied}{freedom}"
