"""The table of a sweep: a row per point and pressure, units in the names of the columns; and the table as a figure."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.config import units
from pipeline.study.sweep.axes import Axis
from pipeline.study.sweep.points import PointResult, Row, Setting, switch_as_word
from pipeline.study.sweep.spec import CELL, WHOLE, Run
from pipeline.values.errors import shortened
from pipeline.values.page import figure_page
from pipeline.values.plots import Line, Panel, ordered_colour

#: at most so many keys have panels
MOST_COLUMNS = 6
#: columns of the table that are drawn with their titles, by what was run
_OF_RUN = {
    "II_bending_deg": "bending angle (°)", "kappa_0_middle_per_mm": "κ₀(l/2) (1/mm)",
    "alpha2_N_mm2": "α₂ (N mm²)", "III_force_y_N": "F in III (N)",
}  # fmt: skip
_OF_CELL = {
    "law_bending_deg": "bending angle (°)",
    "law_tip_y_mm": "y of the tip from the clamp (mm)",
    "cell_kappa_0_per_mm": "κ₀ of a cell (1/mm)",
    "cell_rigidity_N_mm2": "dM/dκ (N mm²)",
    "cell_axial_rigidity_N": "EA (N)",
}


@dataclass(frozen=True)
class Column:
    """The values of a key of the axes, as numbers in one unit where they are."""

    key: str
    unit: str  #: that of its first value; empty without one

    @staticmethod
    def of(key: str, settings: Sequence[Setting]) -> "Column":
        """The column of a key over all points."""
        measured = units.number_and_unit(settings[0][key])
        unit = measured[1] if measured else ""
        try:
            for setting in settings if unit else ():
                units.in_unit_of(setting[key], unit)
        except ValueError:
            unit = ""
        return Column(key, unit)

    @property
    def name(self) -> str:
        """The key with the unit."""
        return f"{self.key}_{self.unit}" if self.unit else self.key

    def cell(self, setting: Setting) -> float | int | str:
        """The value at one point."""
        value = switch_as_word(setting[self.key])
        if self.unit:
            return units.in_unit_of(value, self.unit)
        return value if isinstance(value, int | float | str) else json.dumps(value)


def table_rows(columns: Sequence[Column], points: Sequence[PointResult]) -> list[Row]:
    """One row per point and pressure, and one for a point without numbers; all have the same columns."""
    rows: list[Row] = []
    for point in points:
        axes: Row = {column.name: column.cell(point.values) for column in columns}
        ended: Row = {"status": point.status, "reason": point.reason}
        head: Row = {"point": point.number, **axes, "pressure_kPa": None, **ended, "folder": point.folder}
        rows += [{**head, **numbers} for numbers in point.rows or ({},)]
    names = list(dict.fromkeys(name for row in rows for name in row))
    return [{name: row.get(name) for name in names} for row in rows]


def quantities(run: Run) -> Mapping[str, str]:
    """The columns that are drawn of what was run, with their titles."""
    if run in ((WHOLE,), (CELL,)):
        return _OF_RUN if run == (WHOLE,) else _OF_CELL
    bent = {f"{name}_bending_deg": f"bending angle in {name} (°)" for name in run}
    ends = {f"{name}_tip_y_mm": f"y of the tip from the clamp in {name} (mm)" for name in run if name != "I"}
    curvatures = {f"{name}_kappa_middle_per_mm": f"κ(l/2) in {name} (1/mm)" for name in run}
    return {**bent, **ends, **curvatures, **({"III_force_y_N": "F in III (N)"} if "III" in run else {})}


def sweep_page(title: str, run: Run, axes: Sequence[Axis], columns: Sequence[Column], rows: Sequence[Row]) -> str:
    """The figure alone on a page; points that differ in one axis alone are joined, unless they are drawn at random."""
    panels = []
    for quantity, y in quantities(run).items():
        for column in columns[:MOST_COLUMNS]:
            axis = next(axis for axis in axes if column.key in axis.keys)
            fixed = [other for other in columns if other.key not in axis.keys]
            lines = _lines(rows, quantity, column.name, fixed, is_joined=not axis.is_drawn)
            x = f"{column.key} ({column.unit})" if column.unit else column.key
            if lines:
                panels.append(Panel("", x, y, lines))
    return figure_page(title, panels)


def _lines(rows: Sequence[Row], y: str, x: str, fixed: Sequence[Column], *, is_joined: bool) -> tuple[Line, ...]:
    """A line for each pressure and each value of what is fixed, in one colour for a value, or for a pressure alone."""
    groups: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        if row.get(y) is not None:
            groups.setdefault((row["pressure_kPa"], *(row[column.name] for column in fixed)), []).append(row)
    shades = list(dict.fromkeys(key[1:] or key for key in groups))
    lines = []
    for key, points in groups.items():
        if not any(isinstance(point[x], str) for point in points):
            points.sort(key=lambda point: float(str(point[x])))
        frame = f"{key[0]:g} kPa"
        values = [
            f"{c.key.rpartition('.')[2]} {_told(v)} {c.unit}".strip() for c, v in zip(fixed, key[1:], strict=True)
        ]
        colour = ordered_colour(shades.index(key[1:] or key), len(shades))
        dash = "solid" if is_joined and len(points) > 1 else ""
        at = [_word(point[x]) if isinstance(point[x], str) else point[x] for point in points]
        numbers, spread = [float(str(point[y])) for point in points], np.array([_error(point, y) for point in points])
        name = ", ".join((*values, frame))
        entry, frame = (", ".join(values), frame) if values else (None, "")
        band = spread if spread.any() and not isinstance(at[0], str) else None
        lines.append(
            Line(at, numbers, name, colour, dash, "circle", marker_size=5.0, spread=band, entry=entry, frame=frame)
        )
    return tuple(lines)


def _error(row: Row, name: str) -> float:
    """One standard deviation of a number, of its fit and of the mesh together; 0 where neither is known."""
    of = "kappa_0" if name in ("II_bending_deg", "kappa_0_middle_per_mm") else name.partition("_N_mm2")[0]
    std, relative = (float(str(row.get(key) or 0.0)) for key in (f"{name}_std", f"{of}_mesh_error"))
    return math.hypot(std, relative * float(str(row[name])))


def _told(value: Any) -> str:
    return _word(value) if isinstance(value, str) else f"{value:g}"


def _word(value: Any) -> str:
    """A short word for a value: the law of a material that is a section, else its beginning."""
    try:
        section = json.loads(value)
    except (TypeError, ValueError):
        section = None
    named = [section[key] for key in ("name", "law") if key in section] if isinstance(section, dict) else []
    return str(named[0]) if named else shortened(str(value))
