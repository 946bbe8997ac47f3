"""The cell of an arm at the pressures of a law, and at pressures between where the interpolation misses it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import nan

import numpy as np

from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece, PieceFailed
from geometry import Reason
from geometry.arrays import Index
from pipeline.law.piece.adaptive import AdaptiveCurve, Interval
from pipeline.law.piece.in_space import cell_in_space
from pipeline.law.piece.measure import cell_near, cell_without_moment, sweep_cell
from pipeline.law.piece.point import KeptCurve, failure_of, reason_of
from pipeline.law.piece.rates import cell_rates
from pipeline.law.piece.reach import Reach
from pipeline.law.piece.tasks import ArmTasks, Log, PieceCurves
from pipeline.store.parallel import Pending
from pipeline.values.errors import RunFailed
from pipeline.values.pressure import in_MPa, name_of_state
from pipeline.values.reasons import render
from rod import RodError
from rod.arm_law.between import measure_disagreement
from rod.arm_law.curves import CellCurve
from rod.arm_law.section import SectionLaw, section_at

#: largest error of the curvature between two pressures, over the largest curvature of the law
BETWEEN = 3e-3
#: how many pressures are added at most
MOST_ADDED = 12
#: An interval is not divided further where two halvings in a row have left more than the first part of the error, which
#: is at most the second number times the allowed one. As a rule such an error comes from curves of neighbouring
#: pressures that end at different moments, and not from the interpolation in the pressure.
NOT_REDUCED, NEARLY_ALLOWED = 0.8, 2.0
#: states of the cell that are solved halfway between two pressures
CHECKS = 5
#: part of what the slopes of both curves predict differently halfway between two pressures that the error is at least;
#: on four arms it was 0.04 to 0.7 of it
LEAST_ERROR = 1 / 16

Cell = KeptCurve[CellCurve]
Cells = list[Cell]


def measure_bends(
    tasks: ArmTasks, log: Log, pressures: Sequence[float], highest_kPa: Callable[[], float] | None
) -> dict[float, float]:
    """How the cell bends without moment (1/mm) at rising pressures, up to the last one that it bears.

    Where it bears none of them, at the highest pressure that is of use, if that is lower. Raises RunFailed where it
    bears none.
    """
    bends = _bends(tasks, log, pressures)
    if not bends and highest_kPa and (highest := highest_kPa()) < pressures[0]:
        bends = _bends(tasks, log, [highest])
    if not bends:
        raise RunFailed(f"the cell of the arm has no equilibrium at any of the pressures: {render(log.failures[0])}")
    return bends


def _bends(tasks: ArmTasks, log: Log, pressures: Sequence[float]) -> dict[float, float]:
    bends: dict[float, float] = {}
    for pressure, pending in [(p, tasks.submit(bend_of, p)) for p in pressures]:
        try:
            measured = pending.result()
        except PieceFailed as failure:
            log.failures.append(failure_of(failure))
            log.swelling.extend([pressure] if failure.reasons[0].code == "beyond_limit_pressure" else [])
            break
        log.count("cell", measured)
        log.swelling.extend([pressure] if measured.limits else [])
        bends[pressure] = measured.curve
    return bends


@dataclass(frozen=True)
class CellMeasurer:
    """Measures the cell at any pressures, for arms that bend as far as its own cells do without moment."""

    tasks: ArmTasks
    log: Log
    bends: Mapping[float, float]  #: 1/mm, by pressure in kPa

    @property
    def pressures(self) -> list[float]:
        """Pressures of the law, kPa: with rest, unless it is that of the form after a snap."""
        return sorted({*self.bends} if self.tasks.pieces.after_snap else {0.0, *self.bends})

    def measure(self, pressures: Sequence[float]) -> Iterator[KeptCurve[CellCurve] | Reason]:
        """Cells at rising pressures; why for one that is not borne."""
        progress = self.tasks.context.progress
        progress.experiment("cell", pressures)
        # each bends as at the highest pressure for which its curve is used: the next one of the configuration
        bends = [self.bends[min((p for p in self.bends if p > one), default=max(self.bends))] for one in pressures]
        submitted = [(p, self.tasks.submit(cell_at, p, bend)) for p, bend in zip(pressures, bends, strict=True)]
        for pressure, pending in submitted:
            try:
                cell = pending.result()
            except (PieceFailed, RodError) as failure:
                reason = reason_of(failure)
                progress.stopped("cell", [pressure], render(reason))
                yield reason
                continue
            self.log.count("cell", cell)
            yield cell

    def measure_up_to_failure(self, pressures: Sequence[float]) -> Cells:
        """Cells by rising pressure, up to the last one that is borne. Raises RunFailed for fewer than two."""
        cells: Cells = []
        for cell in self.measure(pressures):
            if isinstance(cell, Reason):
                self.log.failures.append(failure_of(cell))
                break
            cells.append(cell)
        self.log.check_two(cells)
        return cells

    def measure_also(self, pressures: Sequence[float]) -> Cells:
        """The cells at those pressures that are borne; the others are limits."""
        cells = list(self.measure(pressures))
        self.log.limits.extend(reason for reason in cells if isinstance(reason, Reason))
        return [cell for cell in cells if isinstance(cell, KeptCurve)]

    def end_at(self, cells: Cells, highest: float) -> Cells:
        """The cells up to a pressure in kPa, and one at this pressure, which is measured where there is none."""
        if cells[-1].curve.pressure <= highest:
            return cells
        borne = [cell for cell in cells if cell.curve.pressure <= highest]
        if borne[-1].curve.pressure < highest:
            borne += self.measure_also([highest])
        if len(borne) < 2:
            return cells
        self.log.limits.append(Reason("law_up_to", {"pressure_kPa": borne[-1].curve.pressure}))
        return borne

    def add_between(self, cells: Cells) -> tuple[Cells, float | None]:
        """The cells with those at pressures between, where the interpolation was wrong by more than BETWEEN.

        The error of the curvature that is left, over the largest curvature; None where it was not checked anywhere.
        """
        allowed = BETWEEN * max(float(np.abs(cell.curve.kappa).max()) for cell in cells)
        curve = AdaptiveCurve(
            partial(self._errors_between, allowed),
            self._solve_between,
            allowed,
            MOST_ADDED,
            ends=lambda one: is_not_reduced(one.errors, allowed),
            order=lambda pending: sorted(pending, key=lambda one: -(one.error or 0.0)),
        )
        cells = [*cells]
        known = [one.error for one in curve.refine(cells) if one.error is not None]
        if not known:
            return cells, None
        left = max(known) / allowed * BETWEEN
        if left > BETWEEN:
            self.log.limits.append(Reason("law_between", {"percent": 100.0 * left, "added": MOST_ADDED}))
        return cells, left

    def _solve_between(self, intervals: Sequence[Interval[Cell]]) -> list[Cell | None]:
        """Cells in the middle between two pressures; None where one is not borne, which is a limit."""
        middles = [0.5 * (one.first.curve.pressure + one.second.curve.pressure) for one in intervals]
        found = {cell.curve.pressure: cell for cell in self.measure_also(middles)}
        return [found.get(pressure) for pressure in middles]

    def _errors_between(self, allowed: float, intervals: Sequence[Interval[Cell]]) -> Iterator[float | None]:
        """Largest error of the curvature in the middle between two pressures, 1/mm; None where it cannot be found,
        which is a limit.

        What the slopes of both curves predict differently there is larger. It stands for the error where it is no more
        than the allowed one, or so much larger that the error is too large; elsewhere states are solved.
        """
        begun: list[tuple[Interval[Cell], Pending[KeptCurve[float]]]] = []
        for one in intervals:
            lower, upper, differs = one.first.curve, one.second.curve, nan
            with suppress(RodError):  # the task says so
                differs = float(measure_disagreement(lower.placed, upper.placed)[1].max())
            is_known = differs <= allowed or LEAST_ERROR * differs > allowed
            begun.append(
                (one, Pending.done(KeptCurve(differs)) if is_known else self.tasks.submit(miss_between, lower, upper))
            )
        for one, pending in begun:
            try:
                deviation = pending.result()
            except (PieceFailed, RodError) as failure:
                middle, why = 0.5 * (one.first.curve.pressure + one.second.curve.pressure), str(failure).rstrip(".")
                self.log.limits.append(Reason("between_unchecked", {"pressure_kPa": middle, "why": why}))
                yield None
                continue
            self.log.count("between", deviation)
            yield deviation.curve


def is_not_reduced(errors: Sequence[float], allowed: float) -> bool:
    """Whether dividing has not reduced the error of the last of these intervals, each a half of the one before."""
    if len(errors) < 3 or errors[-1] > NEARLY_ALLOWED * allowed:
        return False
    return all(part > NOT_REDUCED * whole for whole, part in pairwise(errors[-3:]))


def largest_deviation(piece: BendingPiece, lower: CellCurve, upper: CellCurve) -> float:
    """Largest deviation of the curvature at equal moments, 1/mm, at CHECKS states halfway between two pressures.

    From the state of the smallest moment the cell is bent to one side and then to the other: a change of the sides at
    once may lead to equilibria in which a wall has buckled, which the law does not describe. Raises `PieceFailed` where
    the cell does not reach a curvature of the law, and `RodError` where there is no law.
    """
    halfway = 0.5 * (lower.pressure + upper.pressure)
    section = section_at((lower.placed, upper.placed), halfway, halfway)
    pressure, rows = in_MPa(section.pressure), _doubtful(section, lower, upper)
    angles = section.kappa * piece.body.length
    first, largest = rows[np.argmin(np.abs(section.moment[rows]))], 0.0
    middle = inflated(piece, pressure, float(angles[first]))
    for side in (rows[rows >= first], rows[rows < first][::-1]):
        state = middle
        for row in side:
            state = piece.solve(pressure, float(angles[row]), state)
            difference = (state.moment - section.moment[row]) * section.kappa_slope[row]
            largest = max(largest, abs(float(difference)))
    return largest


def _doubtful(section: SectionLaw, lower: CellCurve, upper: CellCurve) -> Index:
    """Rows (CHECKS,) of the law, rising: one in each of as many equal ranges of the moment, where what the slopes of
    both curves predict differs most."""
    difference = np.interp(section.kappa, *measure_disagreement(lower.placed, upper.placed))
    ranges = np.array_split(np.arange(len(section.moment)), CHECKS)
    return np.array([own[int(np.argmax(difference[own]))] for own in ranges])


def bend_of(curves: PieceCurves, pressure: float) -> KeptCurve[float]:
    """The curvature of the cell without moment at a pressure in kPa, 1/mm; a task.

    As all curves of the cell it begins with the piece at rest, so that it does not depend on what was measured before.
    Raises `PieceFailed`, as the tasks below, for a piece that does not bear the pressure.
    """

    def measure(cell: BendingPiece) -> KeptCurve[float]:
        state = cell_without_moment(cell, in_MPa(pressure)).state
        limits = (Reason("cell_swells"),) if cell.is_swollen(cell.volume(state.state)) else ()
        return KeptCurve(state.angle / cell.body.length, limits)

    return curves.of_cell(float, name_of_state("bend", pressure), measure)


def cell_at(curves: PieceCurves, pressure: float, bend: float) -> KeptCurve[CellCurve]:
    """The cell at a pressure in kPa, for arms whose cells bend up to a curvature `bend` (1/mm) without moment; a task.

    Raises `RodError` too.
    """
    config = curves.pieces.config

    def measure(cell: BendingPiece) -> KeptCurve[CellCurve]:
        sweep = sweep_cell(cell, pressure, Reach.of(config, bend))
        curve, limits = sweep.curve(cell.body.length), sweep.limits
        if config.law_in_space:
            curve, unstable = cell_in_space(cell, curve, [point.state for point in sweep.points])
            limits = (*limits, *unstable)
        return KeptCurve(curve, limits, sweep.error, rates=cell_rates(cell, sweep.points, curve))

    measured = curves.of_cell(CellCurve, name_of_state("cell", pressure), measure)
    curves.progress.step_done("cell", pressure, 0.0 if measured.is_stored else measured.seconds)
    return measured


def near_cell(curves: PieceCurves, pressure: float, bend: float) -> KeptCurve[CellCurve]:
    """The cell at a pressure in kPa without moment, and bent by `bend` (1/mm) more and less; a task."""

    def measure(cell: BendingPiece) -> KeptCurve[CellCurve]:
        sweep = cell_near(cell, pressure, bend)
        return KeptCurve(sweep.curve(cell.body.length), rates=cell_rates(cell, sweep.points))

    return curves.of_cell(CellCurve, name_of_state("cell_near", pressure), measure)


def miss_between(curves: PieceCurves, lower: CellCurve, upper: CellCurve) -> KeptCurve[float]:
    """How far the law halfway between two pressures is from the cell there, 1/mm at equal moments; a task."""
    name = name_of_state(name_of_state("between", lower.pressure), upper.pressure)
    return curves.of_cell(float, name, lambda cell: KeptCurve(largest_deviation(cell, lower, upper)))
