"""The figures of the paper from finite elements; printed numbers of the paper are marks, its curves are unknown."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.estimates import CELLS, DEFAULT, PROCESS, Estimate
from benchmarks.paper.states import State
from pipeline.drawing.plots import COLOURS, GREY, GRID, INK
from rod import Rod, RodError, TwoSlopes, cell_averaged, rest_curvature, without_stretch

#: d/l that the paper prints for the pneu-net, and its five trials in Fig. 11 (a)
PRINTED_D, TRIED_D = (0.126, 0.134), (0.05, 0.1, 0.125, 0.15, 0.175)
#: how estimators are drawn
MARKERS = {CELLS: "o", PROCESS: "s", DEFAULT: "^"}
NAMES = {
    CELLS: "paper_cells: means over a pitch",
    PROCESS: "paper_process: Gaussian process, L = 20 mm",
    DEFAULT: "default of pneurod",
}
#: standard acceleration of gravity, mm/s2
GRAVITY = 9806.65


def _figure(rows: int, columns: int, title: str) -> tuple[Figure, Any]:
    figure = Figure(figsize=(1.0 + 4.2 * columns, 0.8 + 3.2 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False)
    figure.suptitle(title, fontsize=11)
    for panel in panels.ravel():
        panel.grid(True, color=GRID)
        panel.tick_params(labelsize=8)
    return figure, panels


def _states(estimates: Sequence[Estimate], law: str) -> list[State]:
    """The states of one material law, each once, by pressure."""
    found = {e.state.pressure: e.state for e in estimates if e.state.law == law}
    return [found[pressure] for pressure in sorted(found)]


def _laws(estimates: Sequence[Estimate]) -> list[str]:
    return sorted({e.state.law for e in estimates}, reverse=True)


def shapes(estimates: Sequence[Estimate]) -> Figure:
    """Fig. 6: the material line in II and III."""
    laws = _laws(estimates)
    figure, panels = _figure(2, len(laws), "Fig. 6: the material line of the pneu-net, finite elements")
    for column, law in enumerate(laws):
        for number, state in enumerate(_states(estimates, law)):
            for row, curve in enumerate((state.curves.free, state.curves.loaded)):
                label = f"{state.pressure:g} kPa" if row == 0 else None
                panels[row, column].plot(curve.x, curve.y, color=COLOURS[number % len(COLOURS)], label=label)
        for row, name in enumerate(("II", "III")):
            panels[row, column].set(title=f"Test {name}, {law}", xlabel="x (mm)", ylabel="y (mm)")
            panels[row, column].set_aspect("equal", adjustable="datalim")
        panels[0, column].legend(frameon=False, fontsize=7)
    return figure


def curvatures(estimates: Sequence[Estimate]) -> Figure:
    """Fig. 8: curvature in II and III, means over a pitch."""
    laws = _laws(estimates)
    figure, panels = _figure(2, len(laws), "Fig. 8: curvature of the pneu-net, means over one pitch")
    for column, law in enumerate(laws):
        for number, state in enumerate(_states(estimates, law)):
            for row, curve in enumerate((state.curves.free, state.curves.loaded)):
                curvature = cell_averaged(curve, state.pitch)
                style = {"color": COLOURS[number % len(COLOURS)], "label": f"{state.pressure:g} kPa"}
                panels[row, column].plot(curvature.s / state.length, 1000.0 * curvature.kappa, **style)
        for row, name in enumerate(("κ₀, Test II", "κ, Test III")):
            panels[row, column].set(title=f"{name}, {law}", xlabel="s/l", ylabel="1/m")
        panels[0, column].legend(frameon=False, fontsize=7)
    return figure


def moments(estimates: Sequence[Estimate]) -> Figure:
    """Fig. 9 (a): M/(m g l) over (kappa - kappa_0) l with the lines of both estimators."""
    laws = _laws(estimates)
    figure, panels = _figure(2, len(laws), "Fig. 9 (a): moment over change of curvature, and two free lines")
    for column, law in enumerate(laws):
        for row, name in enumerate((CELLS, PROCESS)):
            panel = panels[row, column]
            chosen = [e for e in estimates if e.state.law == law and e.estimator == name]
            for number, e in enumerate(chosen):
                _moment_lines(panel, e, COLOURS[number % len(COLOURS)])
            panel.set(title=f"{NAMES[name]}, {law}", xlabel="(κ - κ₀) l", ylabel="M/(m g l)")
            panel.title.set_fontsize(9)
            panel.legend(frameon=False, fontsize=7)
    return figure


def _moment_lines(panel: Any, e: Estimate, colour: str) -> None:
    assert e.lines is not None
    length, unit = e.state.length, _weight(e.state) * e.state.length
    s, delta, moment = e.lines.points.T
    panel.plot(delta * length, moment / unit, ".", color=colour, markersize=2, label=f"{e.state.pressure:g} kPa")
    law = e.lines.law
    for part, alpha, m0 in ((s < law.d, law.alpha1, law.m01), (s >= law.d, law.alpha2, law.m02)):
        ends = np.array([delta[part].min(), delta[part].max()])
        panel.plot(ends * length, (alpha * ends + m0) / unit, color=colour, linewidth=1.0)


def _weight(state: State) -> float:
    """m g of the arm, N."""
    from geometry.families import FAMILIES

    geometry = dict(state.config["geometry"])
    volume = FAMILIES[geometry.pop("family")](**geometry).solid_volume
    return float(volume * state.config["material"]["density_tonne_mm3"] * GRAVITY)


def rigidities(estimates: Sequence[Estimate]) -> Figure:
    """Fig. 9 (b) with Fig. 15: kappa_0(l/2), both slopes and d over the pressure by all estimators."""
    laws = _laws(estimates)
    figure, panels = _figure(4, len(laws), "Figs 9 (b), 11 (b): numbers over the pressure, by estimator")
    for column, law in enumerate(laws):
        states = _states(estimates, law)
        panels[0, column].plot(
            [s.pressure for s in states], [1000.0 * s.kappa_0_middle for s in states], "o-", color=INK, markersize=4
        )
        for name, marker in MARKERS.items():
            chosen = [e for e in estimates if e.state.law == law and e.estimator == name]
            _over_pressure(panels[1:, column], chosen, marker, COLOURS[list(MARKERS).index(name)], NAMES[name])
        panels[3, column].axhspan(*PRINTED_D, color=GREY, alpha=0.3, label="printed in the paper")
        for row, label in enumerate(("κ₀(l/2) (1/m)", "α₁ (N mm²)", "α₂ (N mm²)", "d/l")):
            panels[row, column].set(xlabel="p (kPa)", ylabel=label)
        panels[0, column].set_title(law)
        panels[3, column].legend(frameon=False, fontsize=7)
    return figure


def _over_pressure(panels: Any, chosen: Sequence[Estimate], marker: str, colour: str, label: str) -> None:
    pressures = [e.state.pressure for e in chosen]
    columns = ([e.alpha1 for e in chosen], [e.alpha2 for e in chosen], [e.d_over_length for e in chosen])
    for panel, values in zip(panels, columns, strict=True):
        panel.plot(pressures, values, marker=marker, color=colour, label=label, markersize=4, linewidth=1.0)


def breaks(estimates: Sequence[Estimate]) -> Figure:
    """Fig. 11 (a): the loaded arm at 24 kPa, and rods whose numbers are kept while d is moved."""
    chosen = [e for e in estimates if e.state.pressure == 24.0 and e.lines is not None and e.state.law == "svk"]
    figure, panels = _figure(1, max(1, len(chosen)), "Fig. 11 (a): Test III at 24 kPa, rods with five values of d")
    for panel, e in zip(panels[0], chosen, strict=False):
        assert e.lines is not None
        curve = e.state.curves.loaded
        panel.plot(curve.x, curve.y, color=COLOURS[3], linewidth=2.5, label="finite elements")
        for number, fraction in enumerate(TRIED_D):
            label, shade = f"d/l = {fraction:g}", str(0.15 + 0.15 * number)
            try:
                x, y, error = _rod(e.state, replace(e.lines.law, d=fraction * e.state.length))
                panel.plot(x, y, color=shade, linewidth=1.0, label=f"{label}: rms {100 * error:.1f} % of l")
            except RodError:
                panel.plot([], [], color=shade, label=f"{label}: no equilibrium")
        panel.set(title=NAMES[e.estimator], xlabel="x (mm)", ylabel="y (mm)")
        panel.title.set_fontsize(9)
        panel.legend(frameon=False, fontsize=7)
    return figure


def _rod(state: State, law: TwoSlopes) -> tuple[Any, Any, float]:
    """x and y of the rod with the end held as in III, and its root-mean-square distance from the curve over the length.

    The distance is that from the curve without its stretch, which the rod cannot follow.
    """
    theta0, profile = rest_curvature(state.curves.free)
    loaded = state.curves.loaded
    start = (float(loaded.x[0]), float(loaded.y[0]))
    rod = Rod(state.length, profile, law, theta0, start)
    shape = rod.solve(end_y=float(loaded.y[-1]))
    unstretched = without_stretch(loaded)
    distance = shape.positions(state.curves.s) - np.column_stack([unstretched.x, unstretched.y])
    return shape.x, shape.y, float(np.sqrt(np.mean(np.sum(distance**2, axis=1)))) / state.length


def heights(pneunet: Sequence[Estimate], others: Sequence[Estimate]) -> Figure:
    """Fig. 11 (b): d over the height of the chambers."""
    figure, panels = _figure(1, 2, "Fig. 11 (b): d/l over the height of the chambers, 24 kPa, svk")
    chosen = [e for e in (*pneunet, *others) if e.state.pressure == 24.0 and e.state.law == "svk"]
    for panel, quantity in zip(panels[0], ("d_over_length", "alpha2"), strict=True):
        for name, marker in MARKERS.items():
            of_name = sorted(
                (e.state.config["geometry"]["chamber_height"], getattr(e, quantity))
                for e in chosen
                if e.estimator == name
            )
            if of_name:
                panel.plot(*zip(*of_name, strict=True), marker=marker, label=NAMES[name], markersize=4, linewidth=1.0)
        panel.set(xlabel="H (mm)", ylabel="d/l" if quantity == "d_over_length" else "α₂ (N mm²)")
    panels[0, 0].axhspan(*PRINTED_D, color=GREY, alpha=0.3, label="printed in the paper for H = 12 mm")
    panels[0, 0].legend(frameon=False, fontsize=7)
    return figure


def arms(pneunet: Sequence[Estimate], others: Sequence[Estimate]) -> Figure:
    """Fig. 15: kappa_0(l/2) and both slopes over the pressure for the four arms."""
    figure, panels = _figure(3, len(MARKERS), "Fig. 15: the four arms, svk, by estimator")
    chosen = [e for e in (*pneunet, *others) if e.state.law == "svk"]
    for column, name in enumerate(MARKERS):
        for number, family in enumerate(dict.fromkeys(e.state.family for e in chosen)):
            of_family = [e for e in chosen if e.state.family == family and e.estimator == name]
            pressures = [e.state.pressure for e in of_family]
            quantities: tuple[Callable[[Estimate], float], ...] = (
                lambda e: 1000.0 * e.state.kappa_0_middle,
                lambda e: e.alpha1,
                lambda e: e.alpha2,
            )
            for row, quantity in enumerate(quantities):
                values = [quantity(e) for e in of_family]
                style = {"color": COLOURS[number], "label": family, "markersize": 4}
                panels[row, column].plot(pressures, values, "o-", **style)
        for row, label in enumerate(("κ₀(l/2) (1/m)", "α₁ (N mm²)", "α₂ (N mm²)")):
            panels[row, column].set(xlabel="p (kPa)", ylabel=label)
        panels[0, column].set_title(NAMES[name], fontsize=9)
    panels[0, 0].legend(frameon=False, fontsize=7)
    return figure


def lengths(pneunet: Sequence[Estimate], others: Sequence[Estimate]) -> Figure:
    """Figs 12, 13: arms of several lengths; rigidity over m g l^2 with the weight of the arm of 11 chambers."""
    figure, panels = _figure(1, 2, "Fig. 13 (b): arms of 7, 11 and 20 chambers, svk, weight of the arm of 11 chambers")
    chosen = [e for e in (*pneunet, *others) if e.state.law == "svk" and e.estimator == CELLS]
    reference = next(e.state for e in chosen if e.state.config["geometry"]["chambers"] == 11)
    weight = _weight(reference)
    for number, pressure in enumerate(sorted({e.state.pressure for e in others})):
        at = sorted((e for e in chosen if e.state.pressure == pressure), key=lambda e: e.state.length)
        ratios = np.array([e.state.length / reference.length for e in at])
        style = {"color": COLOURS[number], "label": f"{pressure:g} kPa"}
        curvature = [e.state.kappa_0_middle * e.state.length for e in at]
        panels[0, 0].plot(ratios, curvature, "o-", **style)
        panels[0, 1].plot(ratios, [e.alpha2 / (weight * e.state.length**2) for e in at], "o", **style)
        base = next(e.alpha2 for e in at if e.state.length == reference.length)
        fine = np.linspace(ratios.min(), ratios.max(), 50)
        panels[0, 1].plot(fine, base / (weight * reference.length**2) / fine**2, ":", color=COLOURS[number])
    panels[0, 0].set(xlabel="l/l₀", ylabel="κ₀(l/2) l")
    panels[0, 1].set(xlabel="l/l₀", ylabel="α₂/(m g l²), dotted: (l₀/l)²")
    panels[0, 0].legend(frameon=False, fontsize=7)
    return figure


#: name of the file -> the sweeps it needs, and how it is drawn from their estimates
FIGURES: dict[str, tuple[tuple[str, ...], Callable[..., Figure]]] = {
    "figure_06": (("pneunet",), shapes),
    "figure_08": (("pneunet",), curvatures),
    "figure_09a": (("pneunet",), moments),
    "figure_09b": (("pneunet",), rigidities),
    "figure_11a": (("pneunet",), breaks),
    "figure_11b": (("pneunet", "heights"), heights),
    "figure_13": (("pneunet", "lengths"), lengths),
    "figure_15": (("pneunet", "arms"), arms),
}
