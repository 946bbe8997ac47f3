"""The tips that an arm reaches over its pressures, as a page."""

from collections.abc import Sequence
from dataclasses import replace

from pipeline.answers.rods.pressures import PressureFor, Wish, branches_of
from pipeline.answers.rods.rods import Rods
from pipeline.values.page import figure_page
from pipeline.values.plots import Line, Panel, ordered_colour

#: payloads of the picture besides none
PAYLOADS = 5


def tips_page(rods: Rods, wish: Wish, found: Sequence[PressureFor]) -> str:
    """A page with the tips that the arm reaches over its pressures, with a payload from none to that of the wish."""
    mass = wish.loading.tip_mass
    loads = [replace(wish.loading, tip_mass=part * mass / PAYLOADS) for part in range(PAYLOADS + 1)] if mass else []
    lines = []
    for k, loading in enumerate(loads or [wish.loading]):
        name = f"{loading.tip_mass:.3g} g" if mass else "tip"
        for branch in branches_of(rods, replace(wish, loading=loading)):
            texts = [f"{name}, {pressure:.4g} kPa" for pressure in branch.pressures]
            colour = ordered_colour(k, max(len(loads), 2))
            x, y = branch.states[:, :2].T
            lines.append(Line(x, y, name, colour, marker="circle", marker_size=4, texts=texts))
    if wish.tip_mm is not None:
        lines.append(Line([wish.tip_mm[0]], [wish.tip_mm[1]], "wanted", dash="", marker="x", marker_size=11))
    for at in found:
        lines.append(
            Line(
                [at.tip_mm[0]],
                [at.tip_mm[1]],
                f"{at.pressure_kPa:.4g} kPa",
                dash="",
                marker="circle-open",
                marker_size=12,
            )
        )
    low, high = rods.pressures_kPa
    panel = Panel(f"Tips from {low:g} to {high:g} kPa", "x (mm)", "y (mm)", tuple(lines), lengths=True)
    return figure_page("Reachable tips", [panel])
