"""Figs 4, 11 (b), 12, 13 and 15: material laws, and numbers over pressure, height, length and arm."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import fem
from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.drawing import (
    ARM_NAMES,
    COLOURS,
    GREY,
    INK,
    LAW_LINES,
    MARKERS,
    NAMES,
    PRINTED_LENGTHS,
    NotThere,
    colour_of,
    figure_of,
    legend,
    printed_d,
    titled,
)
from benchmarks.paper.estimates import CELLS, Estimate
from benchmarks.paper.states import State, weight_of
from rod import cell_averaged

#: moduli (MPa), the strain between them, and Poisson's ratio of the paper
E_LOW, E_HIGH, BREAK_STRAIN, NU = 0.65, 1.2, 1.5, 0.495
#: the pressure of Fig. 12 and 13 (a), which the paper does not print, kPa
OF_LENGTHS = 24.0


def materials(_: Data) -> Figure:
    """Fig. 4: the five material laws in tension with the moduli of the paper; there is no measurement here."""
    figure, panels = figure_of(1, 2, "Fig. 4: no measurement: material laws in tension and the moduli of the paper")
    mu = E_HIGH / (2.0 * (1.0 + NU))
    kappa = 2.0 * mu * (1.0 + NU) / (3.0 * (1.0 - 2.0 * NU))
    yeoh = 2.0 * 0.11 * 2.0 * (1.0 + NU) / (3.0 * (1.0 - 2.0 * NU))
    bars = {
        "svk, E = E_H (no bar beyond 72 %)": fem.StVenantKirchhoff(E=E_HIGH, nu=NU),
        "hencky, E = E_H": fem.Hencky(E=E_HIGH, nu=NU),
        "neo_hooke, E = E_H at small strain": fem.NeoHooke(mu=mu, kappa=kappa),
        "mooney_rivlin, the same, c10 = c01 (choice)": fem.MooneyRivlin(c10=mu / 4, c01=mu / 4, kappa=kappa),
        "yeoh, published for Elastosil M4601": fem.Yeoh(c10=0.11, c20=0.02, c30=0.0, kappa=yeoh),
    }
    for panel, largest, top in zip(panels[0], (3.0, 0.5), (6.0, 0.7), strict=True):
        strain = np.linspace(0.0, largest, 200)
        for number, (name, law) in enumerate(bars.items()):
            panel.plot(strain, law.uniaxial(1.0 + strain).nominal, color=colour_of(number), label=name)
        low, high = np.array([0.0, min(BREAK_STRAIN, largest)]), np.array([BREAK_STRAIN, largest])
        panel.plot(low, E_LOW * low, color=INK, linewidth=2.0, label=f"E_L = {E_LOW:g} MPa (paper)")
        if largest > BREAK_STRAIN:
            from_break = E_LOW * BREAK_STRAIN + E_HIGH * (high - BREAK_STRAIN)
            panel.plot(
                high, from_break, color=INK, linestyle="--", linewidth=2.0, label=f"E_H = {E_HIGH:g} MPa (paper)"
            )
            panel.axvline(BREAK_STRAIN, color=GREY, linewidth=0.8)
        panel.set(xlim=(0.0, largest), ylim=(0.0, top))
        titled(panel, "no measurement", "nominal strain", "nominal stress (MPa)")
    legend(panels[0, 0], "upper left")
    return figure


def zones(data: Data) -> Figure:
    """Fig. 11 (b): d over the pressure and over the height of the chambers."""
    figure, panels = figure_of(1, 2, "Fig. 11 (b): d/l of the pneu-net over the pressure and over the height H")
    for number, (name, marker) in enumerate(MARKERS.items()):
        for law in LAWS:
            style = {"marker": marker, "color": colour_of(number), "linestyle": LAW_LINES[law], "markersize": 4}
            over_p = [e for e in data.arm(ARMS[0], law, name) if 5.0 <= e.state.pressure <= 40.0 and e.is_usable]
            panels[0, 0].plot([e.state.pressure for e in over_p], [e.d_over_length for e in over_p], **style)
            at = [
                e
                for e in [*over_p, *data.of("heights", law, ARMS[0], name)]
                if e.state.pressure == 24.0 and e.is_usable
            ]
            at = sorted(at, key=_height)
            label = f"{name}, {law}"
            panels[0, 1].plot([_height(e) for e in at], [e.d_over_length for e in at], label=label, **style)
    for panel, title, x in ((panels[0, 0], "H = 12 mm", "p (kPa)"), (panels[0, 1], "24 kPa", "H (mm)")):
        printed_d(panel)
        panel.set_ylim(0.0, 0.3)
        titled(panel, title, x, "d/l")
    panels[0, 1].axvline(12.0, color=GREY, linewidth=0.8)
    legend(panels[0, 1], "upper left")
    return figure


def _height(e: Estimate) -> float:
    return float(e.state.config["geometry"]["chamber_height"])


def _by_length(data: Data, law: str, estimator: str, pressure: float) -> list[Estimate]:
    estimates = [*data.of("pneunet", law, ARMS[0], estimator), *data.of("lengths", law, ARMS[0], estimator)]
    return sorted((e for e in estimates if e.state.pressure == pressure), key=lambda e: e.state.length)


def _reference(chosen: Sequence[Estimate]) -> State:
    """The state of the arm of 11 chambers; raises `NotThere`."""
    state = next((e.state for e in chosen if e.state.config["geometry"]["chambers"] == 11), None)
    if state is None:
        raise NotThere(f"the arm of 11 chambers with svk at {OF_LENGTHS:g} kPa")
    return state


def lengths(data: Data) -> Figure:
    """Fig. 12: change of curvature and moment for three lengths; scaled by l/l0 they coincide."""
    title = f"Fig. 12: arms of 7 (u), 11 (v) and 20 (w) chambers in Test III, {OF_LENGTHS:g} kPa, svk; dashed: scaled"
    figure, panels = figure_of(1, 3, title)
    chosen = _by_length(data, "svk", CELLS, OF_LENGTHS)
    reference = _reference(chosen)
    unit = weight_of(reference)
    for number, e in enumerate(chosen):
        state, ratio = e.state, e.state.length / reference.length
        free, loaded = (cell_averaged(curve, state.pitch) for curve in (state.curves.free, state.curves.loaded))
        delta = (loaded.kappa - free.kappa) * state.length
        moment = state.curves.moment(loaded.s) / (unit * state.length)
        style = {"color": colour_of(number)}
        name = f"{'uvw'[number]}: l = {ratio:.2f} l₀"
        position = loaded.s / state.length
        panels[0, 0].plot(position, delta, label=name, **style)
        panels[0, 0].plot(position, delta / ratio, linestyle="--", **style)
        panels[0, 1].plot(position, moment, label=name, **style)
        panels[0, 1].plot(position, moment * ratio, linestyle="--", **style)
        panels[0, 2].plot(delta, moment, ".", markersize=3, label=name, **style)
        panels[0, 2].plot(delta / ratio, moment * ratio, linestyle="--", **style)
    titled(panels[0, 0], "(a) dashed: times l₀/l", "s/l", "(κ - κ₀) l")
    titled(panels[0, 1], "(b) dashed: times l/l₀", "s/l", "M/(m g l), weight of 11 chambers")
    titled(panels[0, 2], "(c) dashed: both scaled", "(κ - κ₀) l", "M/(m g l), weight of 11 chambers")
    for panel in panels[0]:
        legend(panel)
    return figure


def rigidity_of_lengths(data: Data) -> Figure:
    """Fig. 13: moment over change of curvature for three lengths, and the rigidities over the length."""
    title = "Fig. 13: arms of 7, 11 and 20 chambers, svk, weight of the arm of 11 chambers"
    figure, panels = figure_of(1, 3, title)
    at = _by_length(data, "svk", CELLS, OF_LENGTHS)
    reference = _reference(at)
    weight = weight_of(reference)
    for number, e in enumerate(at):
        assert e.lines is not None
        s, delta, moment = e.lines.points.T
        unit, law = weight * e.state.length, e.lines.law
        name = f"{e.state.length / reference.length:.2f} l₀"
        panels[0, 0].plot(delta * e.state.length, moment / unit, ".", color=colour_of(number), markersize=2, label=name)
        for part, alpha, m0 in ((s < law.d, law.alpha1, law.m01), (s >= law.d, law.alpha2, law.m02)):
            ends = np.array([delta[part].min(), delta[part].max()])
            panels[0, 0].plot(ends * e.state.length, (alpha * ends + m0) / unit, color=colour_of(number), linewidth=1.0)
    titled(panels[0, 0], f"(a) paper_cells, {OF_LENGTHS:g} kPa", "(κ - κ₀) l", "M/(m g l)")
    legend(panels[0, 0])
    for panel, name, symbol in ((panels[0, 1], "alpha1", "α₁"), (panels[0, 2], "alpha2", "α₂")):
        for number, (estimator, marker) in enumerate(MARKERS.items()):
            arms = [e for e in _by_length(data, "svk", estimator, OF_LENGTHS) if e.is_usable]
            ratios = np.array([e.state.length / reference.length for e in arms])
            values = [getattr(e, name) / (weight * e.state.length**2) for e in arms]
            panel.plot(ratios, values, marker, color=colour_of(number), markersize=5, label=NAMES[estimator])
            base = [getattr(e, name) for e in arms if e.state.length == reference.length]
            if base:
                fine = np.linspace(0.6, 1.9, 60)
                panel.plot(fine, base[0] / (weight * reference.length**2) / fine**2, ":", color=colour_of(number))
        for ratio in PRINTED_LENGTHS:
            panel.axvline(ratio, color=GREY, linewidth=0.8)
        panel.axhline(0.0, color=INK, linewidth=0.6)
        titled(panel, "(b) dotted: (l₀/l)²; grey: lengths of the paper", "l/l₀", f"{symbol}/(m g l²)")
    legend(panels[0, 1])
    return figure


def arms(data: Data) -> Figure:
    """Fig. 15: kappa_0(l/2) and both slopes over the pressure for the four arms, svk solid and hencky dashed."""
    figure, panels = figure_of(3, len(MARKERS), "Fig. 15: the four arms by estimator, svk solid, hencky dashed")
    quantities: tuple[Callable[[Estimate], float], ...] = (
        lambda e: 1000.0 * e.state.kappa_0_middle,
        lambda e: e.alpha1,
        lambda e: e.alpha2,
    )
    for column, name in enumerate(MARKERS):
        for number, arm in enumerate(ARMS):
            for law in LAWS:
                estimates = [e for e in data.arm(arm, law, name) if e.state.pressure <= 37.0]
                for row, quantity in enumerate(quantities):
                    shown = [e for e in estimates if row == 0 or (e.is_usable and e.state.pressure >= 5.0)]
                    if row == 0 and column == 1 and arm == ARMS[0]:
                        continue
                    if row == 1 and name == "default":
                        shown = [e for e in shown if e.two_lines]
                    label = ARM_NAMES[arm] if law == "svk" else None
                    style: dict[str, Any] = {"color": COLOURS[number], "linestyle": LAW_LINES[law], "marker": "o"}
                    pressures, values = [e.state.pressure for e in shown], [quantity(e) for e in shown]
                    if row == 0 and column == 2:
                        values = [value / values[-1] for value in values]
                    panels[row, column].plot(pressures, values, markersize=3, linewidth=1.1, label=label, **style)
        for row, label in enumerate(("(a) κ₀(l/2) (1/m)", "(b) α₁ (N mm²)", "(c) α₂ (N mm²)")):
            titled(panels[row, column], NAMES[name] if row else "", "p (kPa)", label)
        panels[0, column].axvline(20.0, color=GREY, linewidth=0.8)
        panels[1, column].axhline(0.0, color=INK, linewidth=0.6)
    titled(panels[0, 1], "without the pneu-net", "p (kPa)", "(a) κ₀(l/2) (1/m)")
    titled(panels[0, 2], "over the value at the highest pressure", "p (kPa)", "κ₀(l/2), 1 at the highest p")
    panels[1, 2].text(0.04, 0.05, "only where two lines are needed", transform=panels[1, 2].transAxes, fontsize=8)
    legend(panels[0, 0])
    return figure
