"""The numbers of a state by the estimators of a reader of the paper and by the default of pneurod, as rows."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.paper.free_lines import (
    BREAKS,
    CELL_BREAKS,
    PROCESS_BREAKS,
    FreeLines,
    Subtracted,
    paper_cells,
    paper_process,
    single_rigidity_control,
)
from benchmarks.paper.states import State
from pipeline.identify.parameters import numbers_of_curves
from rod import FiveParameters, RodError, TwoSlopes, shortest_break

#: length scale (mm) at which paper_process prints the paper's d/l, and those of the scan
LENGTH_SCALE, SCALES = 20.0, (14.0, 16.0, 17.0, 18.0, 19.0, 20.0, 22.0, 25.0, 28.0, 32.0, 36.0, 40.0)
CELLS, PROCESS, DEFAULT = "paper_cells", "paper_process", "default"


@dataclass(frozen=True)
class Estimate:
    """Numbers of one state by one estimator."""

    state: State
    estimator: str
    alpha1: float  #: N mm2
    alpha2: float  #: N mm2
    d_over_length: float
    r2: float
    single_alpha: float  #: N mm2
    single_r2: float
    two_lines: bool | None  #: whether two lines are worth their parameters; None where that is not tested
    length_scale: float | None = None  #: mm
    deviations: tuple[float, float] | None = None  #: of alpha1 and alpha2, N mm2
    lines: FreeLines | None = None
    law: TwoSlopes | None = None  #: of the rod with these numbers
    d_deviation: float = 0.0  #: of d over the length; half the distance of the breaks that are tried, where d has none

    @property
    def is_usable(self) -> bool:
        """Whether d was found inside the range in which it is sought; the slopes say nothing otherwise."""
        return self.lines is None or bool(1.01 * BREAKS[0] < self.d_over_length < 0.99 * BREAKS[1])


def estimates_of(state: State) -> Iterator[Estimate]:
    """By the three estimators; one that gives no numbers is left out."""
    for estimate in (_cells, process, _default):
        try:
            yield estimate(state)
        except RodError:
            continue


def _cells(state: State) -> Estimate:
    return _of_lines(state, CELLS, paper_cells(state.curves, state.pitch))


def process(state: State, length_scale: float = LENGTH_SCALE, subtracted: Subtracted = "chord") -> Estimate:
    """By the Gaussian process of this length scale, mm, of the coordinates without what is subtracted."""
    return _of_lines(state, PROCESS, paper_process(state.curves, length_scale, subtracted=subtracted))


def control(state: State, alpha: float) -> Estimate:
    """What the process makes of a rod with one rigidity alpha (N mm2) and the kappa_0(l/2) of the state."""
    lines = single_rigidity_control(state.curves, LENGTH_SCALE, alpha, state.kappa_0_middle)
    return _of_lines(state, "control", lines)


def _of_lines(state: State, name: str, lines: FreeLines) -> Estimate:
    return Estimate(
        state,
        name,
        lines.law.alpha1,
        lines.law.alpha2,
        lines.law.d / state.length,
        lines.r2,
        lines.single_alpha,
        lines.single_r2,
        None,
        lines.length_scale,
        lines=lines,
        law=lines.law,
        d_deviation=0.5 * (CELL_BREAKS if lines.length_scale is None else PROCESS_BREAKS),
    )


def _default(state: State, d: float | None = None) -> Estimate:
    numbers = numbers_of_curves(state.curves.free, state.curves.loaded, state.load, state.pitch, d)
    line = numbers.single_line
    law, fraction, deviations = numbers.law, numbers.d.value / state.length, (numbers.alpha1.std, numbers.alpha2.std)
    if not numbers.two_lines:
        at_most = shortest_break(state.length, state.pitch)
        law = FiveParameters(line.alpha.value, line.alpha.value, line.m0.value, line.m0.value, at_most)
        fraction, deviations = float("nan"), (line.alpha.std, line.alpha.std)
    return Estimate(
        state,
        DEFAULT,
        law.alpha1,
        law.alpha2,
        fraction,
        numbers.r2,
        line.alpha.value,
        line.r2,
        bool(numbers.two_lines),
        deviations=deviations,
        law=law,
        d_deviation=numbers.d.std / state.length,
    )


def with_break(state: State, estimator: str, fraction: float) -> Estimate:
    """By an estimator with a given d over the length. Raises RodError where it gives no numbers."""
    d = fraction * state.length
    if estimator == DEFAULT:
        return _default(state, d)
    cells = estimator == CELLS
    lines = paper_cells(state.curves, state.pitch, d) if cells else paper_process(state.curves, LENGTH_SCALE, d)
    return _of_lines(state, estimator, lines)


COLUMNS = (
    *("family", "law", "chambers", "chamber_height_mm", "pressure_kPa", "kappa_0_middle_per_mm", "force_y_N"),
    *("estimator", "length_scale_mm", "alpha1_N_mm2", "alpha2_N_mm2", "d_over_length", "r2", "single_alpha_N_mm2"),
    *("r2_single_line", "two_lines"),
)


def rows(estimates: Sequence[Estimate]) -> list[list[object]]:
    """Rows in the order of `COLUMNS`."""
    table = []
    for e in estimates:
        geometry = e.state.config["geometry"]
        head = [e.state.family, e.state.law, geometry.get("chambers"), geometry.get("chamber_height")]
        head += [e.state.pressure, e.state.kappa_0_middle, e.state.curves.force[1]]
        numbers = [e.length_scale, e.alpha1, e.alpha2, e.d_over_length, e.r2, e.single_alpha, e.single_r2, e.two_lines]
        table.append([*head, e.estimator, *numbers])
    return [
        ["" if value is None or (isinstance(value, float) and np.isnan(value)) else value for value in row]
        for row in table
    ]
