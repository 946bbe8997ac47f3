"""The table of a sweep as a figure: a panel for every quantity and key, a colour for every pressure."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.errors import shortened
from pipeline.plots import Line, Panel, figure, ordered_colour, standalone_page
from pipeline.sweep.axes import Axis
from pipeline.sweep.record import Row
from pipeline.sweep.spec import CELL, WHOLE, Run
from pipeline.sweep.table import Column

#: at most so many keys have panels
MOST_COLUMNS = 6
#: columns of the table that are drawn with their titles, by what was run
_OF_RUN = {
    "kappa_0_middle_per_mm": "κ₀(l/2) (1/mm)", "alpha2_N_mm2": "α₂ (N mm²)", "III_force_y_N": "F in III (N)",
}  # fmt: skip
_OF_CELL = {
    "cell_kappa_0_per_mm": "κ₀ of a cell (1/mm)",
    "cell_rigidity_N_mm2": "dM/dκ (N mm²)",
    "cell_axial_rigidity_N": "EA (N)",
}


def quantities(run: Run) -> Mapping[str, str]:
    """The columns that are drawn of what was run, with their titles."""
    if run in ((WHOLE,), (CELL,)):
        return _OF_RUN if run == (WHOLE,) else _OF_CELL
    ends = {f"{name}_end_y_mm": f"y of the end in {name} (mm)" for name in run}
    curvatures = {f"{name}_kappa_middle_per_mm": f"κ(l/2) in {name} (1/mm)" for name in run}
    return {**ends, **curvatures, **({"III_force_y_N": "F in III (N)"} if "III" in run else {})}


def sweep_page(title: str, run: Run, axes: Sequence[Axis], columns: Sequence[Column], rows: Sequence[Row]) -> str:
    """The figure alone on a page; points that differ in one axis alone are joined, unless they are drawn at random."""
    panels = []
    for quantity, y in quantities(run).items():
        for column in columns[:MOST_COLUMNS]:
            axis = next(axis for axis in axes if column.key in axis.keys)
            fixed = [other.name for other in columns if other.key not in axis.keys]
            lines = _lines(rows, quantity, column.name, fixed, is_joined=not axis.is_drawn)
            x = f"{column.key} ({column.unit})" if column.unit else column.key
            panels.append(Panel("", x, y, lines))
    return standalone_page(title, figure(panels))


def _lines(rows: Sequence[Row], y: str, x: str, fixed: Sequence[str], *, is_joined: bool) -> tuple[Line, ...]:
    pressures = sorted({float(str(row["pressure_kPa"])) for row in rows if row["pressure_kPa"] is not None})
    groups: dict[tuple[Any, ...], list[tuple[Any, Any]]] = {}
    for row in rows:
        if row.get(y) is not None:
            groups.setdefault((row["pressure_kPa"], *(row[name] for name in fixed)), []).append((row[x], row[y]))
    lines = []
    for (pressure, *_), points in groups.items():
        if any(isinstance(value, str) for value, _ in points):
            points = [(_word(value), number) for value, number in points]
        else:
            points.sort()
        colour = ordered_colour(pressures.index(pressure), len(pressures))
        dash = "solid" if is_joined and len(points) > 1 else ""
        abscissae, values = zip(*points, strict=True)
        lines.append(Line(abscissae, values, f"{pressure:g} kPa", colour, dash, "circle", marker_size=5.0))
    return tuple(lines)


def _word(value: Any) -> str:
    """A short word for a value: the law of a material that is a section, else its beginning."""
    try:
        section = json.loads(value)
    except (TypeError, ValueError):
        section = None
    return str(section["law"]) if isinstance(section, dict) and "law" in section else shortened(str(value))
