"""What all figures share: panels, colours, names of estimators, laws and arms."""

from typing import Any

from matplotlib.colors import TABLEAU_COLORS
from matplotlib.figure import Figure

from benchmarks.paper.estimates import CELLS, DEFAULT, LENGTH_SCALE, PROCESS
from geometry.arrays import Array

#: text; what stands for all pressures; grid lines
INK, GREY, GRID = "#1f2933", "#7b8794", "#eceff2"
#: of series
COLOURS: tuple[str, ...] = tuple(map(str, TABLEAU_COLORS.values()))
#: d/l that the paper prints for the pneu-net, its five trials in Fig. 11 (a), its two in Fig. 10, and those of Fig. 16
PRINTED_D, TRIED_D, TWO_D = (0.126, 0.134), (0.05, 0.1, 0.125, 0.15, 0.175), (0.1, 0.125)
D_OF_ARMS = {"pneunet": 0.14, "semicircular": 0.048, "semicircular_single": 0.048, "bisected_circle": 0.048}
#: force on the end in Fig. 5 (b), N, and the pressure, kPa
END_FORCE, FORCE_PRESSURE = (0.175, 0.07), 31.0
#: ratios of lengths that the paper prints
PRINTED_LENGTHS = (0.64, 1.0, 1.8)
#: how estimators are drawn
MARKERS = {CELLS: "o", PROCESS: "s", DEFAULT: "^"}
NAMES = {
    CELLS: "paper_cells: means over a pitch",
    PROCESS: f"paper_process: Gaussian process, L = {LENGTH_SCALE:g} mm",
    DEFAULT: "default of pneurod",
}
ARM_NAMES = {
    "pneunet": "(a) pneunet",
    "semicircular": "(b) semicircular",
    "semicircular_single": "(c) semicircular_single",
    "bisected_circle": "(d) bisected_circle",
}
#: lines of the material laws
LAW_LINES = {"svk": "-", "hencky": "--"}
#: lines of the rods beside the finite elements
FIVE_ROD: dict[str, Any] = {"color": INK, "linestyle": "--", "linewidth": 1.0}
OWN_ROD: dict[str, Any] = {"color": INK, "linestyle": ":", "linewidth": 1.6}


class NotThere(Exception):
    """A sweep or a state without which a figure cannot be drawn; the message names it."""


def figure_of(rows: int, columns: int, title: str, *, wide: float = 4.2) -> tuple[Figure, Any]:
    """A figure with its panels (rows, columns)."""
    figure = Figure(figsize=(1.0 + wide * columns, 0.8 + 3.2 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False)
    figure.suptitle(title, fontsize=11)
    for panel in panels.ravel():
        panel.grid(True, color=GRID)
        panel.tick_params(labelsize=8)
    return figure, panels


def legend(panel: Any, position: str = "best") -> None:
    """A small legend without frame, if anything has a name."""
    if panel.get_legend_handles_labels()[0]:
        panel.legend(frameon=False, fontsize=7, loc=position)


def titled(panel: Any, title: str, x: str, y: str) -> None:
    """A small title, and names of the axes."""
    panel.set(xlabel=x, ylabel=y)
    panel.set_title(title, fontsize=9)


def shape_axes(panel: Any, title: str, *, flat: bool = False) -> None:
    """Axes of a shape: the same scale along x and y, but for flat shapes, whose y is enlarged."""
    titled(panel, f"{title}; y enlarged" if flat else title, "x (mm)", "y (mm)")
    if flat:
        panel.margins(y=0.35)
    else:
        panel.set_aspect("equal", adjustable="datalim")


def colour_of(number: int) -> str:
    """The colour of a series."""
    return COLOURS[number % len(COLOURS)]


def printed_d(panel: Any) -> None:
    """The band of d/l that the paper prints for the pneu-net."""
    panel.axhspan(*PRINTED_D, color=GREY, alpha=0.3, label="printed in the paper: 0.126 to 0.134")


def xy(points: Array) -> tuple[Array, Array]:
    """Columns of points (n, 2)."""
    return points[:, 0], points[:, 1]
