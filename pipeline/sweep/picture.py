"""Small multiples of a sweep: a row of panels per quantity, a column per key of the axes, a colour per pressure."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from pipeline.plots import COLOURS
from pipeline.sweep.axes import Axis
from pipeline.sweep.labels import Labels
from pipeline.sweep.numbers import Row
from pipeline.sweep.spec import CELL, WHOLE, Run
from pipeline.sweep.table import Column

#: at most so many keys have a column of panels, and so many pressures a colour
MOST_COLUMNS = 6


@dataclass(frozen=True)
class Quantity:
    """A column of the table as it is drawn, in its own unit."""

    column: str
    title: str


_OF_RUN = (
    Quantity("kappa_0_middle_per_mm", "κ₀(l/2) (1/mm)"),
    Quantity("alpha2_N_mm2", "α₂ (N mm²)"),
    Quantity("III_force_y_N", "F in III (N)"),
)
_OF_CELL = (
    Quantity("cell_kappa_0_per_mm", "κ₀ of a cell (1/mm)"),
    Quantity("cell_rigidity_N_mm2", "dM/dκ (N mm²)"),
    Quantity("cell_axial_rigidity_N", "EA (N)"),
)


def quantities(run: Run) -> tuple[Quantity, ...]:
    """What is drawn of what was run."""
    if run in ((WHOLE,), (CELL,)):
        return _OF_RUN if run == (WHOLE,) else _OF_CELL
    drawn = [Quantity(f"{name}_end_y_mm", f"y of the end in {name} (mm)") for name in run]
    drawn += [Quantity(f"{name}_kappa_middle_per_mm", f"κ(l/2) in {name} (1/mm)") for name in run]
    return (*drawn, *([Quantity("III_force_y_N", "F in III (N)")] if "III" in run else []))


def svg_picture(title: str, run: Run, axes: Sequence[Axis], columns: Sequence[Column], rows: Sequence[Row]) -> str:
    """The picture; points that differ in one axis alone are joined, unless their values are drawn at random."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    shown, drawn = columns[:MOST_COLUMNS], quantities(run)
    figure = Figure(figsize=(1.2 + 3.1 * len(shown), 0.8 + 2.4 * len(drawn)), layout="constrained")
    panels = figure.subplots(len(drawn), len(shown), squeeze=False, sharex="col", sharey="row")
    there: set[Any] = {row["pressure_kPa"] for row in rows} - {None}
    pressures = sorted(there)
    colours = {pressure: COLOURS[number % len(COLOURS)] for number, pressure in enumerate(pressures)}
    labels = {column.name: Labels.of([row[column.name] for row in rows]) for column in shown}
    for i, quantity in enumerate(drawn):
        panels[i, 0].set_ylabel(quantity.title, fontsize=9)
        for j, column in enumerate(shown):
            axis = next(axis for axis in axes if column.key in axis.keys)
            fixed = [other.name for other in columns if other.key not in axis.keys]
            words = labels[column.name]
            for line in _lines(rows, quantity, column.name, fixed):
                style = "o" if axis.is_drawn or len(line.x) < 2 else "o-"
                x = line.x if words is None else [words.place(value) for value in line.x]
                panels[i, j].plot(x, line.y, style, color=colours[line.pressure], markersize=3.5, linewidth=1.0)
            panels[i, j].grid(True, color="#eceff2")
            panels[i, j].tick_params(labelsize=8)
            if i == len(drawn) - 1:
                name = f"{column.key} ({column.unit})" if column.unit else column.key
                legend = words.legend if words else ()
                panels[i, j].set_xlabel("\n".join((name, *legend)), fontsize=6 if legend else 9)
                if words:
                    panels[i, j].set_xticks(range(len(words.values)), words.short)
                    panels[i, j].set_xlim(-0.5, len(words.values) - 0.5)
    for pressure, colour in colours.items():
        panels[0, 0].plot([], [], "o", color=colour, label=f"{pressure:g} kPa")
    if colours:
        figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=8)
    figure.suptitle(title, fontsize=11)
    text = io.StringIO()
    with rc_context({"svg.hashsalt": title}):  # the same file for the same table
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


@dataclass(frozen=True)
class _Line:
    """Points that differ in one axis alone."""

    pressure: float  #: kPa
    x: list[Any]
    y: list[float]


def _lines(rows: Sequence[Row], quantity: Quantity, x: str, fixed: Sequence[str]) -> list[_Line]:
    there: list[Any] = [row for row in rows if row.get(quantity.column) is not None]

    def group(row: Any) -> tuple[Any, ...]:
        return (row["pressure_kPa"], *(row[name] for name in fixed))

    order = {key: number for number, key in enumerate(dict.fromkeys(map(group, there)))}
    there.sort(key=lambda row: order[group(row)])
    lines = []
    for key, members in groupby(there, group):
        points = [(row[x], row[quantity.column]) for row in members]
        if not any(isinstance(value, str) for value, _ in points):
            points.sort()
        lines.append(_Line(key[0], [value for value, _ in points], [y for _, y in points]))
    return lines
