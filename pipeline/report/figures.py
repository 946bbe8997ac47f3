"""The figures of the report, each a plotly figure made from the result files.

Figs 8, 10 and 16 of the paper (K. M. de Payrebrune, O. M. O'Reilly) have the same form.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.plots import (
    GREY,
    INK,
    Figure,
    Panel,
    Stroke,
    legend_only,
    ramp_colour,
    series_colour,
    single_panel,
    styled,
    two_panels,
)
from pipeline.report.results import Curve, Results
from pipeline.validation.rods import ARM_LAW, FIVE

_DASHES = {"I": "dot", "II": "solid", "III": "solid"}
#: height over width of the curves below which y gets a larger scale than x
_FLAT = 0.25
_ROD = Stroke(INK, "dash")
_FINITE_ELEMENTS = Stroke(GREY)


def shapes(results: Results) -> Figure:
    """The material curve of II and III: finite elements and rod."""
    panels = two_panels(("II: clamped", "III: clamped, height of the end prescribed"), "x (mm)", "y (mm)")
    for panel, experiment in zip(panels, ("II", "III"), strict=True):
        for curve in _of(results, experiment):
            _shape(panel, curve, results, f"rod, {curve.pressure_kPa:g} kPa", legend=experiment == "II")
    return _scaled_shapes(panels, results.curves)


def validation_shapes(results: Results) -> Figure:
    """The material curve under each load that the parameters were not fitted to: finite elements and rod."""
    panels = two_panels(("other heights of the end, other pressures", "dead force on the end"), "x (mm)", "y (mm)")
    named: set[float] = set()
    for curve in sorted(results.validation_curves, key=lambda curve: curve.pressure_kPa):
        rod_name = f"rod, {curve.load or curve.experiment}, {curve.pressure_kPa:g} kPa"
        panel = panels[1 if curve.experiment == "dead" else 0]
        _shape(panel, curve, results, rod_name, legend=curve.pressure_kPa not in named)
        named.add(curve.pressure_kPa)
    return _scaled_shapes(panels, results.validation_curves)


def _shape(panel: Panel, curve: Curve, results: Results, rod_name: str, *, legend: bool) -> None:
    """The curve of the finite elements, and that of the rod where there is one."""
    stroke = Stroke(shade(results, curve.pressure_kPa))
    panel.line(curve["x_mm"], curve["y_mm"], stroke, f"{curve.pressure_kPa:g} kPa", legend=legend)
    if curve.has("rod_x_mm"):
        panel.line(curve["rod_x_mm"], curve["rod_y_mm"], _ROD, rod_name)


def _scaled_shapes(panels: tuple[Panel, Panel], curves: Sequence[Curve]) -> Figure:
    """Panels of shapes with one scale for x and y; arms that are nearly straight get a larger one for y."""
    figure = panels[0].figure
    legend_only(figure, "finite elements", _FINITE_ELEMENTS)
    legend_only(figure, "rod", _ROD)
    width, height = (max((float(np.ptp(curve[name])) for curve in curves), default=0.0) for name in ("x_mm", "y_mm"))
    if height < _FLAT * width:
        panels[0].title_y("y (mm), not to scale")
        figure.update_yaxes(matches="y")
        return figure
    for panel, x_axis in zip(panels, ("x", "x2"), strict=True):
        figure.update_yaxes(scaleanchor=x_axis, scaleratio=1, row=1, col=panel.column)
    return figure


def curvatures(results: Results) -> Figure:
    """Curvature along the material curve in I, II and III, and in III that of the rod."""
    titles = ("I dotted, II solid: pressure alone", "III: height of the end prescribed")
    without_load, with_load = two_panels(titles, "s (mm)", "curvature (1/mm)")
    for experiment, panel in (("I", without_load), ("II", without_load), ("III", with_load)):
        for curve in _of(results, experiment):
            colour, label = shade(results, curve.pressure_kPa), f"{curve.pressure_kPa:g} kPa"
            s, kappa = curve["s_mm"], curve["kappa_per_mm"]
            if curve.has("kappa_std_per_mm"):
                spread = curve["kappa_std_per_mm"]
                finite = np.isfinite(spread)
                panel.band(s[finite], kappa[finite], spread[finite], colour)
            panel.line(s, kappa, Stroke(colour, _DASHES[experiment]), label, legend=experiment == "II")
            if experiment == "III" and curve.has("rod_kappa_per_mm"):
                panel.line(s, curve["rod_kappa_per_mm"], _ROD, f"rod, {label}")
    legend_only(without_load.figure, "rod", _ROD)
    return without_load.figure


def moments(results: Results) -> Figure:
    """Bending moment in III over the change of curvature against II, with the two fitted lines and the single one."""
    figure = single_panel("κ - κ₀ (1/mm)", "M (N mm)")
    for pressure in results.pressures:
        free, loaded = results.curve("II", pressure), results.curve("III", pressure)
        if free is None or loaded is None or not loaded.has("moment_N_mm") or len(free["s_mm"]) != len(loaded["s_mm"]):
            continue
        inside = _estimated(free)
        change, moment, s = (
            values[inside]
            for values in (loaded["kappa_per_mm"] - free["kappa_per_mm"], loaded["moment_N_mm"], loaded["s_mm"])
        )
        colour, label = shade(results, pressure), f"{pressure:g} kPa"
        figure.add_scatter(
            x=change, y=moment, mode="markers", marker={"color": colour, "size": 5, "opacity": 0.7},
            name=label, legendgroup=label, customdata=s,
            hovertemplate="s = %{customdata:.1f} mm<br>%{x:.5f} 1/mm, %{y:.4g} N mm",
        )  # fmt: skip
        finite = np.isfinite(change)
        _fitted_lines(figure, results, pressure, s[finite], change[finite])
    legend_only(figure, "two lines", Stroke(INK))
    legend_only(figure, "single line", Stroke(GREY, "dot"))
    return styled(figure, 480)


def _estimated(curve: Curve) -> Array:
    """Points at which the curvature is an estimate (n,): the ends of a curve repeat the value of the nearest cell."""
    kappa = curve["kappa_per_mm"]
    changes = np.flatnonzero(np.diff(kappa))
    inside = np.ones(len(kappa), dtype=bool)
    if len(changes):
        inside[: changes[0]] = False
        inside[changes[-1] + 2 :] = False
    return inside


def _fitted_lines(figure: Figure, results: Results, pressure: float, s: Array, change: Array) -> None:
    """Both lines over the changes of curvature (n,) of their part of s (n,), and the single line over all of them."""
    stroke, d = Stroke(shade(results, pressure)), results.at("d_mm", pressure)
    pieces = [] if d is None else [("alpha1_N_mm2", "m01_N_mm", s <= d), ("alpha2_N_mm2", "m02_N_mm", s >= d)]
    drawn = [(stroke, slope, height, change[part]) for slope, height, part in pieces]
    drawn.append((Stroke(GREY, "dot", 1.2), "single_line_alpha_N_mm2", "single_line_m0_N_mm", change))
    for stroke, slope, height, part in drawn:
        alpha, m0 = results.at(slope, pressure), results.at(height, pressure)
        if alpha is not None and m0 is not None and len(part):
            ends = np.array([part.min(), part.max()])
            figure.add_scatter(
                x=ends, y=alpha * ends + m0, mode="lines", line=stroke.plotly,
                legendgroup=f"{pressure:g} kPa", showlegend=False, hoverinfo="skip",
            )  # fmt: skip


def alphas_over_pressure(results: Results) -> Figure:
    """α₁ and α₂ over pressure, with their standard deviations and the lines of slope β₁ and β₂."""
    figure = single_panel("p (kPa)", "α (N mm²)")
    pressures = np.array(results.parameters.get("pressures_kPa", ()), dtype=float)
    for number, colour in ((1, "#2a78b8"), (2, "#c4541b")):
        key = f"alpha{number}_N_mm2"
        values = _numbers(results.parameters.get(key))
        if len(values) != len(pressures) or not len(values):
            continue
        spread = {"array": _numbers(results.parameters.get(f"{key}_std")), "thickness": 1.2, "width": 4}
        figure.add_scatter(
            x=pressures, y=values, error_y=spread, mode="markers", marker={"color": colour, "size": 9},
            name=f"α{'₁₂'[number - 1]}", cliponaxis=False,
        )  # fmt: skip
        slope = results.parameters.get(f"beta{number}_N_mm2_per_kPa")
        if slope is not None:
            ends = pressures[[0, -1]]
            figure.add_scatter(
                x=ends, y=np.nanmean(values) + slope * (ends - pressures.mean()), mode="lines",
                line={"color": colour, "dash": "dot"}, showlegend=False, hoverinfo="skip",
            )  # fmt: skip
    figure.update_yaxes(rangemode="tozero")
    return styled(figure, 400)


def end_forces(results: Results) -> Figure:
    """The end force over the pressure, finite elements and rods, for every prescribed height of the end."""
    figure = single_panel("p (kPa)", "F_y (N)")
    rods = [rod for rod in (FIVE, ARM_LAW) if rod in results.rods]
    rows = [row for row in results.rows_of(rods[0]) if row.force_N is not None] if rods else []
    for number, load in enumerate(sorted({row.load for row in rows})):
        of_load = sorted((row for row in rows if row.load == load), key=lambda row: row.pressure_kPa)
        colour, label = series_colour(number), load or "as identified"
        pressures = [row.pressure_kPa for row in of_load]
        figure.add_scatter(
            x=pressures, y=[row.force_N for row in of_load], mode="markers", name=label, legendgroup=label,
            marker={"color": colour, "size": 9},
        )  # fmt: skip
        for rod, symbol in zip(rods, ("circle-open", "diamond-open"), strict=False):
            of_rod = [row for row in results.rows_of(rod) if row.load == load and row.force_N is not None]
            figure.add_scatter(
                x=[row.pressure_kPa for row in of_rod], y=[row.rod_force_N for row in of_rod], mode="markers",
                name=f"{rod}, {label}", legendgroup=label, showlegend=False,
                marker={"color": colour, "size": 15, "symbol": symbol, "line": {"width": 1.5}},
            )  # fmt: skip
    figure.update_layout(
        title={
            "text": "end force: finite elements (dots), five parameters (rings), the arm's own law (diamonds)",
            "font": {"size": 14},
        }
    )
    figure.update_yaxes(rangemode="tozero")
    return styled(figure, 380)


def times(parts: Sequence[tuple[str, float]]) -> Figure:
    """Seconds by part of the solver, one bar each."""
    names, seconds = [name for name, _ in parts], [value for _, value in parts]
    figure = single_panel("seconds, summed over the experiments", "")
    figure.add_bar(x=seconds, y=names, orientation="h", marker_color="#4a6fa5")
    figure.update_yaxes(autorange="reversed")
    return styled(figure, 90 + 32 * len(parts))


def _of(results: Results, experiment: str) -> list[Curve]:
    return sorted((c for c in results.curves if c.experiment == experiment), key=lambda curve: curve.pressure_kPa)


def shade(results: Results, pressure: float) -> str:
    """Light for low pressures, dark for high ones."""
    pressures = results.pressures
    at = float(np.interp(pressure, pressures, np.linspace(0.0, 1.0, len(pressures)))) if len(pressures) > 1 else 0.0
    return ramp_colour(at)


def _numbers(values: Any) -> Array:
    return np.array([np.nan if value is None else value for value in values or ()], dtype=float)
