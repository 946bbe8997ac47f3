"""Plots of a run as figures of plotly, which a notebook shows and a program can change."""

from pipeline.show import figures
from pipeline.values import plots
from pipeline.values.errors import InputError, quoted
from pipeline.values.run import Run


class Plots:
    """The plots of one run. Each raises InputError where the run has nothing to draw."""

    def __init__(self, run: Run) -> None:
        self._run = run

    def angle(self) -> "plots.Figure":
        """Bending angle over pressure and path of the tip: finite elements, and the rod to take with its error."""
        return self._drawn(figures.bending(self._run), "states of experiment II")

    def shape(self, experiment: str = "II") -> "plots.Figure":
        """Material curve and its curvature in experiment I, II or III: finite elements and rods."""
        if experiment not in figures.EXPERIMENTS:
            raise InputError(f"experiment: {quoted(experiment)} is none; allowed: I, II, III")
        return self._drawn(figures.of_experiment(self._run, experiment), f"states of experiment {experiment}")

    def force(self) -> "plots.Figure":
        """Force that holds the end at a height, the blocked force, over pressure: finite elements and rods."""
        return self._drawn(figures.end_forces(self._run), "loads of its validation with a held end")

    def law(self) -> "plots.Figure":
        """Moment of a cell over its curvature, and the finite elements of the whole arm."""
        return self._drawn(figures.arm_law(self._run), "law of its own")

    def moments(self) -> "plots.Figure":
        """Moment over change of curvature in experiment III: finite elements, and the rod with five parameters."""
        return self._drawn(figures.moments(self._run), "five parameters")

    def _drawn(self, panels: figures.Panels, what: str) -> "plots.Figure":
        if not panels:
            raise InputError(f"{self._run.directory}: this run has no {what}")
        return plots.plotly_figure(panels)
