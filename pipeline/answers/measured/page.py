"""The picture of a measured arm beside its rod, as a page that opens offline."""

from collections.abc import Sequence

import numpy as np

from pipeline.answers.measured.predicted import Compared
from pipeline.values.page import figure_page
from pipeline.values.plots import COLOURS, Line, Panel, ordered_colour
from pipeline.values.table import Table

#: titles of panels over the pressure
TITLES = {
    "tip_x_mm": "Tip along x (mm)",
    "tip_y_mm": "Tip along y (mm)",
    "end_angle_deg": "End angle (°)",
    "reaction_N": "Reaction (N)",
}


def comparison_page(design: str, rows: Sequence[Compared]) -> str:
    """Measured and predicted numbers of an arm, with the band of what is allowed."""
    panels = [_over_pressure(rows, quantity) for quantity in TITLES if _of(rows, quantity)]
    if _of(rows, "x_mm") and _of(rows, "y_mm"):
        panels.append(_along_arm(rows))
    return figure_page(f"{design}: measured and predicted", panels)


def comparison_table(compared: Sequence[Compared]) -> Table:
    """One row for each number."""
    return Table.of(
        compared,
        ("line", lambda row: str(row.line)),
        ("pressure (kPa)", lambda row: f"{row.pressure_kPa:g}"),
        ("load", lambda row: row.load),
        ("quantity", lambda row: row.quantity),
        ("measured", lambda row: f"{row.measured:.4g}"),
        ("predicted", lambda row: f"{row.predicted:.4g}"),
        ("difference", lambda row: f"{row.difference:.2g}"),
        ("allowed", lambda row: f"{row.allowed:.2g}"),
        ("", lambda row: "" if row.is_within else "outside"),
    )


def _of(rows: Sequence[Compared], quantity: str) -> list[Compared]:
    return sorted((row for row in rows if row.quantity == quantity), key=lambda row: row.pressure_kPa)


def _over_pressure(rows: Sequence[Compared], quantity: str) -> Panel:
    lines = []
    for number, load in enumerate(dict.fromkeys(row.load for row in rows)):
        of_load = [row for row in _of(rows, quantity) if row.load == load]
        if not of_load:
            continue
        pressures = [row.pressure_kPa for row in of_load]
        name, colour = load or "without load", COLOURS[number % len(COLOURS)]
        band = np.array([row.allowed for row in of_load])
        dash = "solid" if len(set(pressures)) > 1 else ""
        rod = Line(
            pressures, [row.predicted for row in of_load], f"rod, {name}", colour, dash, "circle-open", spread=band
        )
        lines += [rod, Line(pressures, [row.measured for row in of_load], f"measured, {name}", colour, "", "x")]
    return Panel(TITLES[quantity], "pressure (kPa)", TITLES[quantity], tuple(lines))


def _along_arm(rows: Sequence[Compared]) -> Panel:
    pressures, lines = sorted({row.pressure_kPa for row in rows if row.s_mm is not None}), []
    for number, pressure in enumerate(pressures):
        x, y = ([row for row in _of(rows, name) if row.pressure_kPa == pressure] for name in ("x_mm", "y_mm"))
        colour, name = ordered_colour(number, len(pressures)), f"{pressure:g} kPa"
        for value, of, marker in (("predicted", "rod", "circle-open"), ("measured", "measured", "x")):
            along, across = ([getattr(row, value) for row in of_axis] for of_axis in (x, y))
            lines.append(Line(along, across, f"{of}, {name}", colour, "", marker))
    return Panel("Points along the arm", "x (mm)", "y (mm)", tuple(lines), lengths=True)
