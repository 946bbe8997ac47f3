"""The figures of the report, each a plotly figure made from the result files."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.colors import sample_colorscale
from plotly.subplots import make_subplots

from geometry.arrays import Array
from pipeline.report.results import Curve, Results

_DASHES = {"I": "dot", "II": "solid", "III": "solid"}
#: height over width of a shape that is drawn with a larger scale for y
_FLAT = 0.25
_INK, _GREY = "#1f2933", "#7b8794"


def shapes(results: Results) -> Any:
    """The material curve of II and III: finite elements against the rod."""
    figure = side_by_side(("II: inflated, clamped", "III: end held as well"), "x (mm)", "y (mm)")
    for column, experiment in enumerate(("II", "III"), start=1):
        for curve in _of(results, experiment):
            colour = shade(results, curve.pressure_kPa)
            label = f"{curve.pressure_kPa:g} kPa"
            line(figure, curve["x_mm"], curve["y_mm"], colour, label, column, legend=column == 1)
            if curve.has("rod_x_mm"):
                line(figure, curve["rod_x_mm"], curve["rod_y_mm"], _INK, f"rod, {label}", column, dash="dash")
    legend_only(figure, "finite elements", _GREY, "solid")
    legend_only(figure, "rod", _INK, "dash")
    return scaled_alike(figure, results.curves)


def scaled_alike(figure: Any, curves: Sequence[Curve]) -> Any:
    """The two axes of shapes with one scale for x and y; arms that are nearly straight get a larger one for y."""
    width, height = (max((float(np.ptp(curve[name])) for curve in curves), default=0.0) for name in ("x_mm", "y_mm"))
    if height < _FLAT * width:
        figure.update_yaxes(title="y (mm), not to scale", col=1)
        figure.update_yaxes(matches="y")
        return figure
    for column in (1, 2):
        figure.update_yaxes(scaleanchor="x" if column == 1 else "x2", scaleratio=1, row=1, col=column)
    return figure


def curvatures(results: Results) -> Any:
    """Curvature along the material curve in I, II and III, and in III that of the rod (paper, Figs 8 and 16b)."""
    titles = ("I dotted, II solid: nothing but pressure", "III: end held as well")
    figure = side_by_side(titles, "s (mm)", "curvature (1/mm)")
    for experiment, column in (("I", 1), ("II", 1), ("III", 2)):
        for curve in _of(results, experiment):
            colour = shade(results, curve.pressure_kPa)
            label = f"{curve.pressure_kPa:g} kPa"
            if curve.has("kappa_std_per_mm"):
                _band(figure, curve, colour, column)
            line(
                figure,
                curve["s_mm"],
                curve["kappa_per_mm"],
                colour,
                label,
                column,
                dash=_DASHES[experiment],
                legend=experiment == "II",
            )
            if experiment == "III" and curve.has("rod_kappa_per_mm"):
                line(figure, curve["s_mm"], curve["rod_kappa_per_mm"], _INK, f"rod, {label}", column, dash="dash")
    legend_only(figure, "rod", _INK, "dash")
    return figure


def moments(results: Results) -> Any:
    """Bending moment in III over the change of curvature against II, with the two lines and the single one."""
    figure = go.Figure()
    for pressure in results.pressures:
        free, held = results.curve("II", pressure), results.curve("III", pressure)
        if free is None or held is None or not held.has("moment_N_mm") or len(free["s_mm"]) != len(held["s_mm"]):
            continue
        inside = _estimated(free)
        change, moment, s = (
            values[inside]
            for values in (held["kappa_per_mm"] - free["kappa_per_mm"], held["moment_N_mm"], held["s_mm"])
        )
        colour, label = shade(results, pressure), f"{pressure:g} kPa"
        marker = {"color": colour, "size": 5, "opacity": 0.7}
        hover = "s = %{customdata:.1f} mm<br>%{x:.5f} 1/mm, %{y:.4g} N mm"
        figure.add_scatter(
            x=change, y=moment, mode="markers", marker=marker, name=label, legendgroup=label,
            customdata=s, hovertemplate=hover,
        )  # fmt: skip
        _fitted_lines(figure, results, pressure, s, change, colour)
    legend_only(figure, "two lines", _INK, "solid")
    legend_only(figure, "one line", _GREY, "dot")
    figure.update_xaxes(title="κ - κ₀ (1/mm)")
    figure.update_yaxes(title="M (N mm)")
    return styled(figure, 480)


def _estimated(curve: Curve) -> Array:
    """Where the curvature is an estimate of its own (n,): the ends of a curve repeat the value of the nearest cell."""
    kappa = curve["kappa_per_mm"]
    moves = np.flatnonzero(np.diff(kappa))
    inside = np.ones(len(kappa), dtype=bool)
    if len(moves):
        inside[: moves[0]] = False
        inside[moves[-1] + 2 :] = False
    return inside


def alphas_over_pressure(results: Results) -> Any:
    """The two slopes over pressure, with their standard deviations and the lines of slope beta1 and beta2."""
    figure = go.Figure()
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
            on_line = np.nanmean(values) + slope * (ends - pressures.mean())
            figure.add_scatter(
                x=ends,
                y=on_line,
                mode="lines",
                line={"color": colour, "dash": "dot"},
                showlegend=False,
                hoverinfo="skip",
            )
    figure.update_xaxes(title="p (kPa)")
    figure.update_yaxes(title="α (N mm²)", rangemode="tozero")
    return styled(figure, 400)


def times(parts: Sequence[tuple[str, float]]) -> Any:
    """Seconds by part of the solver, one bar each."""
    names, seconds = [name for name, _ in parts], [value for _, value in parts]
    figure = go.Figure(go.Bar(x=seconds, y=names, orientation="h", marker_color="#4a6fa5"))
    figure.update_xaxes(title="seconds, summed over the experiments")
    figure.update_yaxes(autorange="reversed")
    return styled(figure, 90 + 32 * len(parts))


def _of(results: Results, experiment: str) -> list[Curve]:
    return sorted((c for c in results.curves if c.experiment == experiment), key=lambda curve: curve.pressure_kPa)


def shade(results: Results, pressure: float) -> str:
    """Light for low pressures, dark for high ones."""
    pressures = results.pressures
    place = float(np.interp(pressure, pressures, np.linspace(0.0, 1.0, len(pressures)))) if len(pressures) > 1 else 0.0
    return str(sample_colorscale("Viridis", 0.85 - 0.75 * place)[0])


def side_by_side(titles: tuple[str, str], x: str, y: str) -> Any:
    """An empty figure of two axes beside each other."""
    figure = make_subplots(cols=2, subplot_titles=titles, horizontal_spacing=0.09)
    figure.update_xaxes(title=x)
    figure.update_yaxes(title=y, col=1)
    return styled(figure, 430)


def line(
    figure: Any, x: Array, y: Array, colour: str, name: str, column: int, *, dash: str = "solid", legend: bool = False
) -> None:
    """Add a line to the axes of `column`."""
    stroke = {"color": colour, "dash": dash, "width": 2}
    figure.add_scatter(
        x=x, y=y, mode="lines", line=stroke, name=name, legendgroup=name, showlegend=legend, row=1, col=column
    )


def _band(figure: Any, curve: Curve, colour: str, column: int) -> None:
    """One standard deviation to either side."""
    known = np.isfinite(curve["kappa_std_per_mm"])
    s, kappa, spread = (curve[name][known] for name in ("s_mm", "kappa_per_mm", "kappa_std_per_mm"))
    outline_x, outline_y = np.concatenate([s, s[::-1]]), np.concatenate([kappa + spread, (kappa - spread)[::-1]])
    figure.add_scatter(
        x=outline_x, y=outline_y, fill="toself", fillcolor=colour, opacity=0.15, line={"width": 0},
        hoverinfo="skip", showlegend=False, row=1, col=column,
    )  # fmt: skip


def _fitted_lines(figure: Any, results: Results, pressure: float, s: Array, change: Array, colour: str) -> None:
    label = f"{pressure:g} kPa"
    known = np.isfinite(change)
    s, change = s[known], change[known]
    if not len(s):
        return
    cut = results.at("d_mm", pressure)
    bounds = () if cut is None else ((s <= cut, 1), (s >= cut, 2))
    for side, number in bounds:
        alpha, start = results.at(f"alpha{number}_N_mm2", pressure), results.at(f"m0{number}_N_mm", pressure)
        if alpha is not None and start is not None and side.any():
            ends = np.array([change[side].min(), change[side].max()])
            figure.add_scatter(
                x=ends, y=alpha * ends + start, mode="lines", line={"color": colour, "width": 2},
                legendgroup=label, showlegend=False, hoverinfo="skip",
            )  # fmt: skip
    alpha, start = results.at("one_line_alpha_N_mm2", pressure), results.at("one_line_m0_N_mm", pressure)
    if alpha is not None and start is not None:
        ends = np.array([change.min(), change.max()])
        figure.add_scatter(
            x=ends, y=alpha * ends + start, mode="lines", line={"color": _GREY, "width": 1.2, "dash": "dot"},
            legendgroup=label, showlegend=False, hoverinfo="skip",
        )  # fmt: skip


def legend_only(figure: Any, name: str, colour: str, dash: str) -> None:
    """Add an entry to the legend that stands for no single line."""
    figure.add_scatter(x=[None], y=[None], mode="lines", line={"color": colour, "dash": dash}, name=name)


def _numbers(values: Any) -> Array:
    return np.array([np.nan if value is None else value for value in values or ()], dtype=float)


def styled(figure: Any, height: int) -> Any:
    """The figure in the report's style."""
    figure.update_layout(
        template="simple_white",
        height=height,
        margin={"l": 64, "r": 16, "t": 36, "b": 52},
        font={"family": "system-ui, sans-serif", "size": 13, "color": _INK},
        legend={"orientation": "v"},
        hoverlabel={"font_size": 12},
    )
    figure.update_xaxes(showgrid=True, gridcolor="#eceff2", zeroline=False)
    figure.update_yaxes(showgrid=True, gridcolor="#eceff2", zeroline=False)
    return figure
