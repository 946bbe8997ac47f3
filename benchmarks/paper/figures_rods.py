"""Figs 5 (b), 10, 11 (a) and 16: rods with five numbers and with the arm's own law beside the finite elements."""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.paper.data import ARMS, LAWS, Data
from benchmarks.paper.drawing import (
    ARM_NAMES,
    COLOURS,
    D_OF_ARMS,
    END_FORCE,
    FIVE_ROD,
    FORCE_PRESSURE,
    INK,
    OWN_ROD,
    TRIED_D,
    TWO_D,
    colour_of,
    figure_of,
    legend,
    shape_axes,
    titled,
)
from benchmarks.paper.estimates import CELLS, DEFAULT, PROCESS, Estimate, with_break
from benchmarks.paper.figures_pneunet import PRESSURES
from benchmarks.paper.rods import RodShape, fitted, own, under_force
from geometry import Centreline
from rod import RodError, cell_averaged


def end_force(data: Data) -> Figure:
    """Fig. 5 (b): the pneu-net at 31 kPa with the printed force on its end."""
    title = f"Fig. 5 (b): {END_FORCE[0]:g} N along x and {END_FORCE[1]:g} N along y on the end, {FORCE_PRESSURE:g} kPa"
    figure, panels = figure_of(1, len(LAWS), title)
    for panel, law in zip(panels[0], LAWS, strict=True):
        for end in (e for e in data.ends if e.law == law):
            curve, height = end.curve, end.held[1]
            if height is None:
                label = f"force alone: end at ({end.position[0]:.2f}, {end.position[1]:.2f}) mm"
                panel.plot(curve.x, curve.y, color=COLOURS[0], linewidth=2.0, label=label)
            else:
                label = f"F_x, end at rest height: F_y = {end.force[1]:.4f} N (printed: {END_FORCE[1]:g} N)"
                panel.plot(curve.x, curve.y, color=COLOURS[1], linewidth=1.2, label=label)
        for e in data.arm(ARMS[0], law, DEFAULT):
            if e.state.pressure == FORCE_PRESSURE and e.law is not None:
                rods = {"rod, five numbers": (e.law, FIVE_ROD)}  # type: dict[str, Any]
                if own_law := data.laws.get((ARMS[0], law)):
                    rods["rod, the arm's own law"] = (own_law, OWN_ROD)
                for name, (of_rod, style) in rods.items():
                    try:
                        shape = under_force(e.state, of_rod, END_FORCE)
                    except RodError:
                        panel.plot([], [], label=f"{name}: no equilibrium", **style)
                        continue
                    at = f"({shape[-1, 0]:.2f}, {shape[-1, 1]:.2f}) mm"
                    panel.plot(*shape.T, label=f"{name}: end at {at}", **style)
        panel.plot([112.0], [1.0], "x", color=INK, label="end at rest")
        shape_axes(panel, law, flat=True)
        legend(panel, "lower center")
    return figure


def rods(data: Data) -> Figure:
    """Fig. 10: finite elements and rods in II and III: d = 0.1 l and 0.125 l, five numbers, the arm's own law."""
    figure, panels = figure_of(2, 4, "Fig. 10: finite elements (coloured) and rods (black) of the pneu-net")
    for half, law in enumerate(LAWS):
        states = [e for e in data.arm(ARMS[0], law, DEFAULT) if e.state.pressure in (*PRESSURES, 37.0)]
        if any(e.state.pressure == 45.0 for e in states):
            states = [e for e in states if e.state.pressure != 37.0]
        for row, loaded in enumerate((False, True)):
            for number, e in enumerate(states):
                curve = e.state.curves.loaded if loaded else e.state.curves.free
                for panel in panels[row, 2 * half : 2 * half + 2]:
                    panel.plot(curve.x, curve.y, color=colour_of(number), label=f"{e.state.pressure:g} kPa")
                _given_breaks(panels[row, 2 * half], e, loaded, last=number == len(states) - 1)
                _five_and_own(panels[row, 2 * half + 1], data, e, loaded, last=number == len(states) - 1)
            test = "III" if loaded else "II"
            shape_axes(panels[row, 2 * half], f"{test}, {law}: paper_cells with given d", flat=loaded)
            shape_axes(panels[row, 2 * half + 1], f"{test}, {law}: default, own law", flat=loaded)
        for column in (2 * half, 2 * half + 1):
            legend(panels[0, column])
    return figure


def _given_breaks(panel: Any, e: Estimate, loaded: bool, *, last: bool) -> None:
    for name, fraction, style in zip(("m₁", "m₂"), TWO_D, ("--", ":"), strict=True):
        try:
            law = with_break(e.state, CELLS, fraction).law
            assert law is not None
            shape = fitted(e.state, law, loaded=loaded)
        except RodError:
            continue
        label = f"{name}: d = {fraction:g} l" if last else None
        panel.plot(*shape.points.T, color=INK, linestyle=style, linewidth=1.1, label=label)


def _five_and_own(panel: Any, data: Data, e: Estimate, loaded: bool, *, last: bool) -> None:
    for label, style, shape in _rods_of(data, e, loaded):
        if shape is not None:
            panel.plot(*shape.points.T, label=label if last else None, **style)


def _rods_of(data: Data, e: Estimate, loaded: bool) -> list[tuple[str, dict[str, Any], RodShape | None]]:
    """Name, line and shape of the rod with the numbers of an estimate and of that with the arm's own law."""
    shapes: list[tuple[str, dict[str, Any], RodShape | None]] = []
    assert e.law is not None
    try:
        shapes.append(("rod, five numbers", FIVE_ROD, fitted(e.state, e.law, loaded=loaded)))
    except RodError:
        shapes.append(("rod, five numbers", FIVE_ROD, None))
    law = data.laws.get((e.state.family, e.state.law))
    if law is not None:
        try:
            shapes.append(("rod, the arm's own law", OWN_ROD, own(e.state, law, loaded=loaded)))
        except RodError:
            shapes.append(("rod, the arm's own law", OWN_ROD, None))
    return shapes


def breaks(data: Data) -> Figure:
    """Fig. 11 (a): III at 24 kPa, and rods whose numbers are kept while d is moved."""
    figure, panels = figure_of(2, 3, "Fig. 11 (a): Test III at 24 kPa, svk, rods with five values of d")
    for column, name in enumerate((CELLS, PROCESS, DEFAULT)):
        for e in data.arm(ARMS[0], "svk", name):
            if e.state.pressure != 24.0 or e.law is None:
                continue
            curve = e.state.curves.loaded
            for panel in panels[:, column]:
                panel.plot(curve.x, curve.y, color=COLOURS[3], linewidth=2.5, label="finite elements")
            for number, fraction in enumerate(TRIED_D):
                law = replace(e.law, d=fraction * e.state.length)
                _moved(panels[0, column], e, law, fraction, number)
                try:
                    _moved(panels[1, column], e, with_break(e.state, name, fraction).law, fraction, number)
                except RodError:
                    panels[1, column].plot([], [], label=f"d/l = {fraction:g}: no numbers", color="0.5")
            for label, style, shape in _rods_of(data, e, loaded=True)[1:]:
                if shape is not None:
                    of_own = f"{label}: rms {100 * shape.rms:.2f} % of l"
                    panels[0, column].plot(*shape.points.T, label=of_own, **style)
        shape_axes(panels[0, column], f"{name}: numbers kept, d moved", flat=True)
        shape_axes(panels[1, column], f"{name}: numbers fitted with this d", flat=True)
        for panel in panels[:, column]:
            legend(panel)
    return figure


def _moved(panel: Any, e: Estimate, law: Any, fraction: float, number: int) -> None:
    label, shade = f"d/l = {fraction:g}", str(0.15 + 0.15 * number)
    try:
        shape = fitted(e.state, law)
    except RodError:
        panel.plot([], [], color=shade, label=f"{label}: no equilibrium")
        return
    text = f"{label}: rms {100 * shape.rms:.2f} % of l"
    panel.plot(*shape.points.T, color=shade, linewidth=1.0, label=text)


def arms_loaded(data: Data) -> Figure:
    """Fig. 16: shape and curvature of the four arms in III at 37 kPa, and the force that holds the end."""
    figure, panels = figure_of(
        3, 4, "Fig. 16: four arms in Test III, svk: finite elements (coloured) and rods (black)", wide=3.6
    )
    for column, arm in enumerate(ARMS):
        estimates = data.arm(arm, "svk", DEFAULT)
        for e in estimates:
            if e.state.pressure != 37.0:
                continue
            curve = e.state.curves.loaded
            panels[0, column].plot(curve.x, curve.y, color=colour_of(column), linewidth=2.0)
            curvature = cell_averaged(curve, e.state.pitch)
            panels[1, column].plot(
                curvature.s / e.state.length, 1000.0 * curvature.kappa, color=colour_of(column), linewidth=2.0
            )
            for label, style, shape in [*_rods_of(data, e, loaded=True), _printed(e, arm)]:
                if shape is None:
                    panels[0, column].plot([], [], label=f"{label}: no equilibrium", **style)
                    continue
                panels[0, column].plot(*shape.points.T, label=label, **style)
                bent = cell_averaged(Centreline(e.state.curves.s, *shape.points.T), e.state.pitch)
                panels[1, column].plot(bent.s / e.state.length, 1000.0 * bent.kappa, **style)
        _forces(panels[2, column], data, arm, colour_of(column))
        shape_axes(panels[0, column], f"{ARM_NAMES[arm]}, 37 kPa", flat=True)
        titled(panels[1, column], "means over a pitch", "s/l", "κ (1/m)")
        titled(panels[2, column], "force that holds the end", "p (kPa)", "F_y (N)")
        legend(panels[0, column])
        legend(panels[2, column])
    return figure


def _printed(e: Estimate, arm: str) -> tuple[str, dict[str, Any], RodShape | None]:
    """The rod with the d that the paper prints for this arm."""
    style = {"color": "0.55", "linestyle": "-.", "linewidth": 1.0}
    label = f"rod, d = {D_OF_ARMS[arm]:g} l (printed)"
    try:
        law = with_break(e.state, DEFAULT, D_OF_ARMS[arm]).law
        return label, style, None if law is None else fitted(e.state, law)
    except RodError:
        return f"{label}: no numbers", style, None


def _forces(panel: Any, data: Data, arm: str, colour: str) -> None:
    for law in LAWS:
        estimates = data.arm(arm, law, DEFAULT)
        pressures = [e.state.pressure for e in estimates]
        forces = [e.state.curves.force[1] for e in estimates]
        style = {"linestyle": "-" if law == "svk" else "--", "marker": "o", "markersize": 4}
        panel.plot(pressures, forces, color=colour, label=f"finite elements, {law}", **style)
    for k, marker, name in ((0, "x", "rod, five numbers"), (1, "+", "rod, the arm's own law")):
        points = []
        for e in data.arm(arm, "svk", DEFAULT):
            rods_here = _rods_of(data, e, loaded=True)
            if k < len(rods_here) and (shape := rods_here[k][2]) is not None:
                points.append((e.state.pressure, float(shape.solution.force[1])))
        if points:
            panel.plot(*np.array(points).T, marker, color=INK, label=f"{name}, svk")
