"""The figure of the arm's own law beside the lines of the five parameters."""

import numpy as np

from pipeline.plots import GREY, INK, Figure, Stroke, legend_only, single_panel, styled
from pipeline.report.figures import shade
from pipeline.report.results import Results


def arm_law(results: Results) -> Figure:
    """Moment over curvature: the curves of a cell, the lines of the five parameters, and the finite elements.

    The lines are those beyond s = d with kappa_0 in the middle of the arm, over the moments of experiment III; dots are
    cell averages of experiment III beyond d.
    """
    figure = single_panel("κ (1/mm)", "M (N mm)")
    requested = set(results.pressures)
    for curve in results.arm_law["curves"]:
        pressure = float(curve["pressure_kPa"])
        if pressure not in requested:
            continue
        label = f"{pressure:g} kPa"
        figure.add_scatter(
            x=curve["kappa_per_mm"], y=curve["moment_N_mm"], mode="lines",
            line=Stroke(shade(results, pressure)).plotly, name=label, legendgroup=label,
        )  # fmt: skip
        _contact(figure, curve, label)
        _five_parameters(figure, results, pressure)
        _finite_elements(figure, results, pressure)
    legend_only(figure, "law of a cell", Stroke(INK))
    legend_only(figure, "five parameters", Stroke(GREY, "dash"))
    return styled(figure, 480)


def _contact(figure: Figure, curve: dict[str, list[float]], label: str) -> None:
    """Rings where walls touch."""
    rows = [k for k, touches in enumerate(curve["contact"]) if touches]
    figure.add_scatter(
        x=[curve["kappa_per_mm"][k] for k in rows], y=[curve["moment_N_mm"][k] for k in rows], mode="markers",
        marker={"color": INK, "size": 6, "symbol": "circle-open"}, name="walls touch", legendgroup=label,
        showlegend=False,
    )  # fmt: skip


def _five_parameters(figure: Figure, results: Results, pressure: float) -> None:
    alpha, m0 = results.at("alpha2_N_mm2", pressure), results.at("m02_N_mm", pressure)
    middles = results.parameters.get("kappa_0", {}).get("middle_per_mm")
    ranges = results.parameters.get("moment_range_N_mm")
    if alpha is None or m0 is None or middles is None or ranges is None:
        return
    row = results.identified_pressures.index(pressure)
    moment = np.array(ranges[row])
    figure.add_scatter(
        x=middles[row] + (moment - m0) / alpha, y=moment, mode="lines", line=Stroke(GREY, "dash").plotly,
        legendgroup=f"{pressure:g} kPa", showlegend=False, hoverinfo="skip",
    )  # fmt: skip


def _finite_elements(figure: Figure, results: Results, pressure: float) -> None:
    loaded = results.curve("III", pressure)
    if loaded is None or not loaded.has("moment_N_mm"):
        return
    d = results.at("d_mm", pressure) or 0.0
    inner = (loaded["s_mm"] > d) & np.isfinite(loaded["kappa_per_mm"])
    figure.add_scatter(
        x=loaded["kappa_per_mm"][inner], y=loaded["moment_N_mm"][inner], mode="markers",
        marker={"color": shade(results, pressure), "size": 4, "opacity": 0.5}, legendgroup=f"{pressure:g} kPa",
        showlegend=False, customdata=loaded["s_mm"][inner], hovertemplate="s = %{customdata:.1f} mm",
    )  # fmt: skip
