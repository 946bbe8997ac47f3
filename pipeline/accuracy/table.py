"""The convergence study as a table and sentences for the terminal, and as a figure on an HTML page."""

from collections.abc import Sequence

import numpy as np

from pipeline.accuracy.ladder import CONTACT, TOLERANCE
from pipeline.accuracy.measure import STAGES
from pipeline.accuracy.reference import NUMBERS, REFERENCE_ELEMENT
from pipeline.accuracy.study import ConvergenceStudy, StudyRow
from pipeline.plots import COLOURS, GREY, INK, Line, Panel, figure, standalone_page

COLUMNS = (
    *("series", "", "dofs", "CPU s", "mesh / set-up / assembly / factors / contact / fit s", "MB", "factors"),
    *(f"{name} %" for name in NUMBERS.values()),
)
#: what varies along the series that are none of meshes, with its unit
_VARIED = {TOLERANCE: "{:g}", CONTACT: "{:g} mm"}


def cells(row: StudyRow) -> list[str]:
    """One configuration; errors are the largest over the pressures, in per cent. Dashes where it failed."""
    cost = row.result.cost
    if cost is None or not row.errors:
        return [row.series, _varied(row), *["-"] * (len(COLUMNS) - 2)]
    cpu_per_wall = cost.cpu_seconds / cost.wall_seconds  # below 1 where other work shared the processor
    return [
        row.series,
        _varied(row),
        f"{cost.degrees_of_freedom}",
        f"{cost.cpu_seconds:.1f}",
        " / ".join(f"{cpu_per_wall * cost.seconds[name]:.1f}" for name in STAGES),
        f"{cost.peak_memory_MB:.0f}",
        f"{cost.factorizations}",
        *(_largest(row, name) for name in NUMBERS),
    ]


def _varied(row: StudyRow) -> str:
    return _VARIED.get(row.series, "{:g} mm").format(row.value)


def _largest(row: StudyRow, name: str) -> str:
    present = [error for errors in row.errors.values() if (error := errors[name]) is not None]
    return f"{100 * max(present, key=abs):+.1f}" if present else ""


def reference_sentences(study: ConvergenceStudy) -> list[str]:
    """The references at every pressure, with two standard deviations."""
    sentences = []
    for references in study.references:
        parts = [
            f"{NUMBERS[name]} = {', '.join(f'{part.value:.4g} ± {2 * part.std:.2g}' for part in values)}"
            for name, values in references.by_name.items()
        ]
        units = "(1/mm, N mm², mm, N; ± two standard deviations)"
        sentences.append(f"{references.pressure_kPa:g} kPa: {'; '.join(parts)} {units}")
    return sentences


def left_out_sentences(study: ConvergenceStudy) -> list[str]:
    """A note on the pressures without a reference; none where every pressure has one."""
    pressures = ", ".join(f"{pressure:g} kPa" for pressure in study.left_out_kPa)
    return [f"Note: {pressures} left out: too few meshes reached that to extrapolate from."] if pressures else []


def order_sentences(study: ConvergenceStudy) -> list[str]:
    """The orders of convergence of the series with the most accurate elements, one sentence per series."""
    by_series: dict[str, list[str]] = {}
    for (series, pressure), along in study.orders.items():
        if series.split(",")[0] == REFERENCE_ELEMENT:
            orders = ", ".join(
                f"{NUMBERS[name]} {order.value:.1f} ± {order.std:.1f} ({order.meshes} meshes)"
                for name, order in along.items()
            )
            by_series.setdefault(series, []).append(f"{pressure:g} kPa: {orders}")
    return [f"orders of convergence, {series}: {'; '.join(parts)}" for series, parts in by_series.items()]


def study_page(study: ConvergenceStudy) -> str:
    """Error over CPU seconds, one line per series, and the Pareto front, on a page that opens offline."""
    rows = sorted((row for row in study.rows if row.point), key=lambda row: row.value)
    lines = []
    for number, name in enumerate(dict.fromkeys(row.series for row in study.rows if row.point)):
        members = [row for row in rows if row.series == name]
        dash, colour = "dot" if name in _VARIED else "solid", COLOURS[number % len(COLOURS)]
        lines.append(Line(*_points(members), name, colour, dash, "circle", texts=[_label(row) for row in members]))
    seconds, front = _points(rows)[0], sorted((row for row in rows if row.on_front), key=lambda row: row.point or ())
    lines.append(Line(*_points(front), "Pareto front", INK, width=6.0, opacity=0.2))
    ends = [min(seconds), max(seconds)] if seconds else []
    uncertainty = [100 * study.reference_error] * len(ends)
    lines.append(Line(ends, uncertainty, "standard deviation of the reference", GREY, "dash"))
    x, y = "CPU seconds of II and III, one thread", "largest error of κ₀(l/2), α₂ and F (%)"
    panel = Panel("Error over time", x, y, tuple(lines), log_x=True, log_y=True)
    return standalone_page(f"{study.name}: error over CPU seconds", figure([panel]))


def _points(rows: Sequence[StudyRow]) -> tuple[list[float], list[float]]:
    """CPU seconds, and errors in per cent."""
    points = np.array([row.point for row in rows if row.point]).reshape(-1, 2)
    return points[:, 0].tolist(), (100 * points[:, 1]).tolist()


def _label(row: StudyRow) -> str:
    freedom = f", {row.result.cost.degrees_of_freedom} degrees of freedom" if row.result.cost else ""
    return f"{row.series}: {_varied(row)}{freedom}"
