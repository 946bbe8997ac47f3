"""The picture of a measured arm beside its rod, as a page that opens offline."""

import math
from collections.abc import Sequence

import numpy as np

from pipeline.answers.measured.predicted import Compared, Curves, Setup, turned
from pipeline.answers.rods.poses import Hand, Point
from pipeline.values.json_values import JsonObject
from pipeline.values.page import Section, page
from pipeline.values.plots import COLOURS, Line, Panel, ordered_colour
from pipeline.values.run import Run

#: titles of panels over the pressure
TITLES = {
    "tip_x_mm": "Tip along x (mm)",
    "tip_y_mm": "Tip along y (mm)",
    "tip_distance_mm": "Distance of the tip (mm)",
    "end_angle_deg": "End angle (°)",
    "tip_direction_deg": "Direction of the tip (°)",
    "reaction_N": "Reaction (N)",
    "frequency_Hz": "Frequency (Hz)",
    "damping_ratio": "Damping ratio",
}


def comparison_page(design: str, rows: Sequence[Compared], curves: Curves, arm: JsonObject | None = None) -> str:
    """The measured arm and its rod in the plane, and their numbers with the band of what is allowed.

    arm: that bends under the hand, of `Hand`.
    """
    title, over = f"{design}: measured and predicted", [name for name in TITLES if _of(rows, name)]
    numbers = Section(panels=[_over_pressure(rows, quantity) for quantity in over])
    return page(title, Section(panels=[_in_plane(rows, curves)], arm=arm or {}), numbers)


def calibration_page(made: Run, rows: Sequence[Compared], curves: Curves, setup: Setup, error_mm: float) -> str:
    """The page of a calibrated arm, that bends under the hand beside what was measured without another load.

    made: its results. error_mm: of its tip.
    """
    points = []
    for pressure in sorted({row.pressure_kPa for row in rows}):
        at = [row for row in rows if row.pressure_kPa == pressure and not row.load]
        for place in np.transpose(_points(at, "measured")):
            x, y = turned(place - setup.origin_mm, -math.radians(setup.clamp_deg)).tolist()
            points.append(Point(x, y, pressure + setup.gauge_kPa, f"measured, {pressure:g} kPa"))
    return comparison_page(made.design, rows, curves, Hand.of(made, points, error_mm).arm)


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


def _in_plane(rows: Sequence[Compared], curves: Curves) -> Panel:
    """The rod in every state, and the measured points beside those of the rod; a colour and a frame per pressure."""
    pressures, lines = sorted({pressure for pressure, _ in curves}), []
    for number, pressure in enumerate(pressures):
        colour, name = ordered_colour(number, len(pressures)), f"{pressure:g} kPa"
        for (_, load), curve in ((key, curve) for key, curve in curves.items() if key[0] == pressure):
            told = ", ".join(filter(None, ("rod", name, load)))
            lines.append(Line(curve[:, 0], curve[:, 1], told, colour, entry="rod", frame=name))
        at = [row for row in rows if row.pressure_kPa == pressure]
        for value, of, marker in (("predicted", "rod", "circle-open"), ("measured", "measured", "x")):
            x, y = _points(at, value)
            lines.append(Line(x, y, f"{of}, {name}", colour, "", marker, entry=of, frame=name))
    return Panel("The arm in its plane", "x (mm)", "y (mm)", tuple(lines), lengths=True)


def _points(rows: Sequence[Compared], value: str) -> tuple[list[float], list[float]]:
    """x and y in mm of the tips and of points along the arm of which both were measured."""
    ends = [f"{axis}_mm" for axis in "xy"]
    x, y = (
        {(r.line, r.quantity[:-4]): getattr(r, value) for r in rows if r.zero_kPa is None and r.quantity.endswith(end)}
        for end in ends
    )
    both = [key for key in x if key in y]
    return [x[key] for key in both], [y[key] for key in both]
