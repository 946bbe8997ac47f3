"""The figures of the paper from finite elements; printed numbers of the paper are marks, its curves are unknown."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from benchmarks.paper import figures_pneunet, figures_rods, figures_studies, rendered
from benchmarks.paper.data import Data


@dataclass(frozen=True)
class PaperFigure:
    """A figure, the sweeps without which it cannot be drawn, and the suffix of its file."""

    title: str
    needs: tuple[str, ...]
    draw: Callable[[Data], Figure]
    suffix: str = "svg"


#: name of the file without suffix -> the figure
FIGURES: dict[str, PaperFigure] = {
    "figure_02b": PaperFigure("Fig. 2 (b), the law with two slopes", ("pneunet",), figures_pneunet.two_lines),
    "figure_03": PaperFigure("Fig. 3, the pneu-net in I, II and III", ("pneunet",), rendered.tests, "png"),
    "figure_04": PaperFigure("Fig. 4, material laws without measurement", (), figures_studies.materials),
    "figure_05b": PaperFigure("Fig. 5 (b), the end force", ("pneunet", "forces"), figures_rods.end_force),
    "figure_06": PaperFigure("Fig. 6, shapes in II and III", ("pneunet",), figures_pneunet.shapes),
    "figure_07": PaperFigure("Fig. 7, I and II", ("pneunet",), figures_pneunet.unclamped),
    "figure_08": PaperFigure("Fig. 8, curvatures in II and III", ("pneunet",), figures_pneunet.curvatures),
    "figure_09a": PaperFigure("Fig. 9 (a), moment over curvature", ("pneunet",), figures_pneunet.moments),
    "figure_09b": PaperFigure("Fig. 9 (b), numbers over the pressure", ("pneunet",), figures_pneunet.rigidities),
    "figure_10": PaperFigure("Fig. 10, finite elements and rods", ("pneunet",), figures_rods.rods),
    "figure_11a": PaperFigure("Fig. 11 (a), five values of d", ("pneunet",), figures_rods.breaks),
    "figure_11b": PaperFigure("Fig. 11 (b), d over pressure and height", ("pneunet", "heights"), figures_studies.zones),
    "figure_12": PaperFigure("Fig. 12, three lengths", ("pneunet", "lengths"), figures_studies.lengths),
    "figure_13": PaperFigure(
        "Fig. 13, rigidity over the length", ("pneunet", "lengths"), figures_studies.rigidity_of_lengths
    ),
    "figure_14": PaperFigure("Fig. 14, the four arms in III", ("pneunet", "arms"), rendered.bodies, "png"),
    "figure_15": PaperFigure("Fig. 15, numbers of the four arms", ("pneunet", "arms"), figures_studies.arms),
    "figure_16": PaperFigure("Fig. 16, rods of the four arms", ("pneunet", "arms"), figures_rods.arms_loaded),
}
