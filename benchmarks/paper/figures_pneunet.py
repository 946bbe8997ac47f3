"""Figs 2 (b), 6, 7, 8 and 9: shapes, curvatures, moments and slopes of the pneu-net."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.drawing import (
    COLOURS,
    FORCE_PRESSURE,
    INK,
    MARKERS,
    NAMES,
    OWN_ROD,
    PRINTED_D,
    colour_of,
    figure_of,
    legend,
    printed_d,
    shape_axes,
    titled,
)
from benchmarks.paper.estimates import CELLS, PROCESS, Estimate
from benchmarks.paper.measures import aligned
from benchmarks.paper.rods import own
from benchmarks.paper.states import State, weight_of
from geometry.arrays import Array
from rod import ArmLaw, RodError, cell_averaged

#: pressures of Figs 6, 8 and 10, kPa; 45 kPa of II and III only where III reaches it
PRESSURES = (5.0, 17.0, 31.0, 45.0)


def _shown(data: Data, law: str) -> list[State]:
    """The states at the pressures of Figs 6 and 8, with 37 kPa where 45 kPa is not reached."""
    states = data.states("pneunet", law, ARMS[0])
    reached = {s.pressure for s in states}
    pressures = {*PRESSURES, *({37.0} if 45.0 not in reached else set())}
    return [s for s in states if s.pressure in pressures]


def two_lines(data: Data) -> Figure:
    """Fig. 2 (b): M over kappa - kappa_0 with two lines, by three estimators, and the arm's own law."""
    title = f"Fig. 2 (b): moment over change of curvature of the pneu-net, {FORCE_PRESSURE:g} kPa, svk"
    figure, panels = figure_of(1, 3, title)
    for panel, name in zip(panels[0], MARKERS, strict=True):
        for e in data.arm(ARMS[0], "svk", name):
            if e.state.pressure == FORCE_PRESSURE:
                _lines(panel, e, COLOURS[0], "means over a pitch" if name != PROCESS else "Gaussian process")
                if law := data.laws.get((ARMS[0], "svk")):
                    _own_line(panel, e.state, law)
                assert e.law is not None
                text = f"α₁ = {e.alpha1:.0f}, α₂ = {e.alpha2:.0f} N mm²\nd/l = {e.d_over_length:.3f}, R² = {e.r2:.3f}"
                panel.text(0.97, 0.2, text, transform=panel.transAxes, ha="right", fontsize=8)
        titled(panel, NAMES[name], "(κ - κ₀) l", "M/(m g l)")
        legend(panel, "lower right")
    return figure


def _own_line(panel: Any, state: State, law: ArmLaw) -> None:
    try:
        loaded, free = own(state, law).solution, own(state, law, loaded=False).solution
    except RodError:
        return
    s = np.linspace(0.0, state.length, 300)
    delta = np.interp(s, loaded.s, loaded.kappa) - np.interp(s, free.s, free.kappa)
    moment = np.interp(s, loaded.s, loaded.moment)
    unit = weight_of(state) * state.length
    panel.plot(delta * state.length, moment / unit, label="the arm's own law", **OWN_ROD)


def shapes(data: Data) -> Figure:
    """Fig. 6: the material line in II and III."""
    figure, panels = figure_of(2, len(LAWS), "Fig. 6: the material line of the pneu-net")
    for column, law in enumerate(LAWS):
        for number, state in enumerate(_shown(data, law)):
            for row, curve in enumerate((state.curves.free, state.curves.loaded)):
                label = f"{state.pressure:g} kPa"
                panels[row, column].plot(curve.x, curve.y, color=colour_of(number), label=label)
        for row, name in enumerate(("(a) Test II", "(b) Test III")):
            shape_axes(panels[row, column], f"{name}, {law}", flat=row == 1)
        legend(panels[0, column])
    return figure


def unclamped(data: Data) -> Figure:
    """Fig. 7: shapes of I and II, brought together by a rigid motion, and their curvatures."""
    figure, panels = figure_of(2, len(LAWS), "Fig. 7: Test I (solid, blue) and Test II (dashed, red)")
    for column, law in enumerate(LAWS):
        for state in data.states("pneunet", law, ARMS[0]):
            if state.unclamped is None or state.pressure > 37.0:
                continue
            free = aligned(state.unclamped, state.curves.free)
            panels[0, column].plot(*free.T, color="#1f77b4", linewidth=1.6)
            panels[0, column].plot(
                state.curves.free.x, state.curves.free.y, color="#d62728", linestyle="--", linewidth=1.2
            )
            panels[0, column].annotate(f"{state.pressure:g}", free[-1], fontsize=7)
            for curve, style in ((state.unclamped, ("#1f77b4", "-")), (state.curves.free, ("#d62728", "--"))):
                curvature = cell_averaged(curve, state.pitch)
                panels[1, column].plot(
                    curvature.s / state.length, 1000.0 * curvature.kappa, color=style[0], linestyle=style[1]
                )
        shape_axes(panels[0, column], f"(a) {law}; the numbers are pressures in kPa")
        titled(panels[1, column], f"(b) means over a pitch, {law}", "s/l", "κ₀ (1/m)")
    return figure


def curvatures(data: Data) -> Figure:
    """Fig. 8: curvature in II and III, means over a pitch."""
    figure, panels = figure_of(2, len(LAWS), "Fig. 8: curvature of the pneu-net, means over one pitch")
    for column, law in enumerate(LAWS):
        for number, state in enumerate(_shown(data, law)):
            for row, curve in enumerate((state.curves.free, state.curves.loaded)):
                curvature = cell_averaged(curve, state.pitch)
                style = {"color": colour_of(number), "label": f"{state.pressure:g} kPa"}
                panels[row, column].plot(curvature.s / state.length, 1000.0 * curvature.kappa, **style)
        for row, name in enumerate(("(a) κ₀, Test II", "(b) κ, Test III")):
            titled(panels[row, column], f"{name}, {law}", "s/l", "1/m")
        panels[1, column].axvspan(*PRINTED_D, color="0.8", label="d/l printed in the paper")
        legend(panels[1, column])
    return figure


def moments(data: Data) -> Figure:
    """Fig. 9 (a): M/(m g l) over (kappa - kappa_0) l with the lines of both estimators of a reader."""
    figure, panels = figure_of(2, len(LAWS), "Fig. 9 (a): moment over change of curvature, and two free lines")
    for column, law in enumerate(LAWS):
        for row, name in enumerate((CELLS, PROCESS)):
            panel = panels[row, column]
            for number, e in enumerate(data.arm(ARMS[0], law, name)):
                if e.state.pressure >= 5.0:
                    _lines(panel, e, colour_of(number), f"{e.state.pressure:g} kPa")
            titled(panel, f"{NAMES[name]}, {law}", "(κ - κ₀) l", "M/(m g l)")
            legend(panel)
    return figure


def _lines(panel: Any, e: Estimate, colour: str, label: str) -> None:
    """Data and both lines of an estimate; the default's are over the means over a pitch."""
    length, unit = e.state.length, weight_of(e.state) * e.state.length
    points = _points(e)
    s, delta, moment = points.T
    panel.plot(delta * length, moment / unit, ".", color=colour, markersize=2, label=label)
    law = e.law
    assert law is not None
    for part, alpha, m0 in ((s < law.d, law.alpha1, law.m01), (s >= law.d, law.alpha2, law.m02)):
        if e.lines is not None:
            ends = np.array([delta[part].min(), delta[part].max()])
        else:  # the means over a pitch begin where the zone at the clamp ends
            between = (0.0, law.d) if alpha == law.alpha1 and m0 == law.m01 else (law.d, e.state.length)
            ends = (e.state.curves.moment(np.array(between)) - m0) / alpha
        panel.plot(ends * length, (alpha * ends + m0) / unit, color=colour, linewidth=1.0)


def _points(e: Estimate) -> Array:
    """(n, 3) s, Delta and M of an estimate."""
    if e.lines is not None:
        return e.lines.points
    free, loaded = (cell_averaged(curve, e.state.pitch) for curve in (e.state.curves.free, e.state.curves.loaded))
    return np.column_stack([loaded.s, loaded.kappa - free.kappa, e.state.curves.moment(loaded.s)])


def rigidities(data: Data) -> Figure:
    """Fig. 9 (b): kappa_0(l/2), both slopes and d over the pressure by all estimators."""
    figure, panels = figure_of(4, len(LAWS), "Fig. 9 (b): numbers of the pneu-net over the pressure, by estimator")
    for column, law in enumerate(LAWS):
        states = data.states("pneunet", law, ARMS[0])
        values = [1000.0 * s.kappa_0_middle for s in states]
        panels[0, column].plot([s.pressure for s in states], values, "o-", color=INK, markersize=4)
        for number, (name, marker) in enumerate(MARKERS.items()):
            chosen = [e for e in data.arm(ARMS[0], law, name) if e.state.pressure >= 5.0 and e.is_usable]
            style = {"marker": marker, "color": colour_of(number), "label": NAMES[name]}
            _over_pressure(panels[1:, column], chosen, style)
        printed_d(panels[3, column])
        for row, label in enumerate(("κ₀(l/2) (1/m)", "α₁ (N mm²)", "α₂ (N mm²)", "d/l")):
            titled(panels[row, column], law if row == 0 else "", "p (kPa)", label)
        panels[1, column].axhline(0.0, color=INK, linewidth=0.6)
        panels[3, column].set_ylim(0.0, 0.3)
        legend(panels[3, column])
    return figure


def _over_pressure(panels: Any, chosen: Sequence[Estimate], style: dict[str, Any]) -> None:
    pressures = [e.state.pressure for e in chosen]
    first = [float("nan") if e.two_lines is False else e.alpha1 for e in chosen]
    columns = (first, [e.alpha2 for e in chosen], [e.d_over_length for e in chosen])
    for panel, values in zip(panels, columns, strict=True):
        panel.plot(pressures, values, markersize=4, linewidth=1.0, **style)
