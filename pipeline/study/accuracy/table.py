"""The convergence study as tables for the terminal, and as a figure on an HTML page."""

from collections.abc import Sequence

import numpy as np

from pipeline.study.accuracy.ladder import CONTACT, TOLERANCE
from pipeline.study.accuracy.measure import HEADLINE, STAGES
from pipeline.study.accuracy.reference import NUMBERS
from pipeline.study.accuracy.study import ConvergenceStudy, StudyRow
from pipeline.values.page import figure_page
from pipeline.values.plots import COLOURS, GREY, INK, Line, Panel
from pipeline.values.table import Table

_COST = ("dofs", "CPU s", "mesh / set-up / assembly / factors / contact / fit s", "MB", "factors")
#: what varies along the series that are none of meshes, with its unit
_VARIED = {TOLERANCE: "{:g}", CONTACT: "{:g} mm"}


def study_table(study: ConvergenceStudy) -> Table:
    """Cost of every configuration, and its errors, the largest over the pressures; dashes where it failed."""
    heads = ("series", "", *_COST, *(f"{symbol} %" for symbol, _ in NUMBERS.values()))
    caption = "*: no other configuration is both cheaper and more accurate"
    if study.left_out_kPa:
        pressures = ", ".join(f"{pressure:g} kPa" for pressure in study.left_out_kPa)
        caption += f"; left out: {pressures}, which too few meshes reached to extrapolate from"
    return Table(heads, tuple(map(_cells, study.rows)), caption)


def _cells(row: StudyRow) -> tuple[str, ...]:
    cost, series = row.result.cost, f"{row.series}{' *' if row.on_front else ''}"
    if cost is None or not row.errors:
        return series, _varied(row), *("-" for _ in (*_COST, *NUMBERS))
    cpu_per_wall = cost.cpu_seconds / cost.wall_seconds  # below 1 where other work shared the processor
    return (
        *(series, _varied(row)),
        f"{cost.degrees_of_freedom}",
        f"{cost.cpu_seconds:.1f}",
        " / ".join(f"{cpu_per_wall * cost.seconds[name]:.1f}" for name in STAGES),
        f"{cost.peak_memory_MB:.0f}",
        f"{cost.factorizations}",
        *(_largest(row, name) for name in NUMBERS),
    )


def _varied(row: StudyRow) -> str:
    return _VARIED.get(row.series, "{:g} mm").format(row.value)


def _largest(row: StudyRow, name: str) -> str:
    present = [error for errors in row.errors.values() if (error := errors[name]) is not None]
    return f"{100 * max(present, key=abs):+.1f}" if present else ""


def references_table(study: ConvergenceStudy) -> Table:
    """The references at every pressure, with two standard deviations."""
    rows = [
        (
            f"{references.pressure_kPa:g}",
            *("\n".join(f"{part.value:.4g} ± {2 * part.std:.2g}" for part in references.of(name)) for name in NUMBERS),
        )
        for references in study.references
    ]
    heads = ("p (kPa)", *(f"{symbol} ({unit})" for symbol, unit in NUMBERS.values()))
    return Table(heads, tuple(rows), "references; ± two standard deviations")


def orders_table(study: ConvergenceStudy) -> Table:
    """The orders of convergence by series and pressure."""
    rows = [
        (
            series,
            f"{pressure:g}",
            *(f"{o.value:.1f} ± {o.std:.1f}" if (o := along.get(name)) else "" for name in HEADLINE),
        )
        for (series, pressure), along in study.orders.items()
    ]
    return Table(("series", "p (kPa)", *(NUMBERS[name][0] for name in HEADLINE)), tuple(rows), "orders of convergence")


def study_page(study: ConvergenceStudy) -> str:
    """Error over CPU seconds, one line per series, and the Pareto front, on a page that opens offline."""
    rows = sorted((row for row in study.rows if row.point), key=lambda row: row.value)
    lines = []
    for number, name in enumerate(dict.fromkeys(row.series for row in study.rows if row.point)):
        members = [row for row in rows if row.series == name]
        costs = [row.result.cost for row in members]
        freedom = [f", {cost.degrees_of_freedom} degrees of freedom" if cost else "" for cost in costs]
        texts = [f"{name}: {_varied(row)}{more}" for row, more in zip(members, freedom, strict=True)]
        dash, colour = "dot" if name in _VARIED else "solid", COLOURS[number % len(COLOURS)]
        lines.append(Line(*_points(members), name, colour, dash, "circle", texts=texts))
    seconds, front = _points(rows)[0], sorted((row for row in rows if row.on_front), key=lambda row: row.point or ())
    lines.append(Line(*_points(front), "Pareto front", INK, width=6.0, opacity=0.2))
    ends = [min(seconds), max(seconds)] if seconds else []
    uncertainty = [100 * study.reference_error] * len(ends)
    lines.append(Line(ends, uncertainty, "standard deviation of the reference", GREY, "dash"))
    x, y = "CPU seconds of II and III, one thread", "largest error of κ₀(l/2), α₂ and F (%)"
    panel = Panel("Error over time", x, y, tuple(lines), log_x=True, log_y=True)
    return figure_page(f"{study.config.name}: error over CPU seconds", [panel])


def _points(rows: Sequence[StudyRow]) -> tuple[list[float], list[float]]:
    """CPU seconds, and errors in per cent."""
    points = np.array([row.point for row in rows if row.point]).reshape(-1, 2)
    return points[:, 0].tolist(), (100 * points[:, 1]).tolist()
