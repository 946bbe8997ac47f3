"""The figures on loads that the numbers were not fitted to (paper, Figs 10 and 16 in this form)."""

from typing import Any

import plotly.graph_objects as go
from plotly.colors import qualitative

from pipeline.report.figures import legend_only, line, scaled_alike, shade, side_by_side, styled
from pipeline.report.results import Results


def validation_shapes(results: Results) -> Any:
    """The material curve under each load, finite elements against the rod: the end held elsewhere, and dead forces."""
    figure = side_by_side(("end held elsewhere, or another pressure", "dead force on the end"), "x (mm)", "y (mm)")
    named: set[float] = set()
    for curve in sorted(results.validation_curves, key=lambda curve: curve.pressure_kPa):
        column = 2 if curve.experiment == "dead" else 1
        colour, label = shade(results, curve.pressure_kPa), f"{curve.pressure_kPa:g} kPa"
        line(figure, curve["x_mm"], curve["y_mm"], colour, label, column, legend=curve.pressure_kPa not in named)
        named.add(curve.pressure_kPa)
        if curve.has("rod_x_mm"):
            title = f"rod, {curve.load or curve.experiment}, {label}"
            line(figure, curve["rod_x_mm"], curve["rod_y_mm"], "#1f2933", title, column, dash="dash")
    legend_only(figure, "finite elements", "#7b8794", "solid")
    legend_only(figure, "rod", "#1f2933", "dash")
    return scaled_alike(figure, results.validation_curves)


def end_forces(results: Results) -> Any:
    """The end force over the pressure, finite elements and rod, for every height at which the end is held."""
    figure = go.Figure()
    rows = [row for row in results.validation if row.get("force_N") is not None]
    for place, load in enumerate(sorted({row.get("load", "") for row in rows})):
        mine = sorted((row for row in rows if row.get("load", "") == load), key=lambda row: row["pressure_kPa"])
        colour, label = qualitative.Safe[place % len(qualitative.Safe)], load or "as identified"
        pressures = [row["pressure_kPa"] for row in mine]
        figure.add_scatter(
            x=pressures, y=[row["force_N"] for row in mine], mode="markers", name=label, legendgroup=label,
            marker={"color": colour, "size": 9},
        )  # fmt: skip
        figure.add_scatter(
            x=pressures, y=[row["rod_force_N"] for row in mine], mode="markers", name=f"rod, {label}",
            legendgroup=label, showlegend=False,
            marker={"color": colour, "size": 15, "symbol": "circle-open", "line": {"width": 1.5}},
        )  # fmt: skip
    figure.update_layout(title={"text": "end force: finite elements (dots) and rod (rings)", "font": {"size": 14}})
    figure.update_xaxes(title="p (kPa)")
    figure.update_yaxes(title="F_y (N)", rangemode="tozero")
    return styled(figure, 380)
