"""The cell of an arm at the pressures of a law, and at pressures between where the interpolation misses it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fem.cell.piece import PieceFailed
from geometry import Reason
from pipeline.law.piece.point import Measured, failure_of, reason_of
from pipeline.law.tasks import ArmTasks, Log, PieceCurves
from pipeline.values.errors import RunFailed
from pipeline.values.reasons import render, render_all
from rod import RodError
from rod.arm_law.curves import CellCurve

#: largest error of the curvature between two pressures, over the largest curvature of the law
BETWEEN = 3e-3
#: how many pressures are added at most
MOST_ADDED = 12
#: An interval is not divided further where two halvings in a row have left more than the first part of the error, which
#: is at most the second number times the allowed one. As a rule such an error comes from curves of neighbouring
#: pressures that end at different moments, and not from the interpolation in the pressure.
NOT_REDUCED, NEARLY_ALLOWED = 0.8, 2.0

Cells = list[Measured[CellCurve]]
Interval = tuple[float, float]  #: two pressures, kPa


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
    for pressure, pending in [(p, tasks.submit(PieceCurves.bend, p)) for p in pressures]:
        try:
            measured = pending.result()
        except PieceFailed as failure:
            log.failures.append(failure_of(failure))
            break
        log.count("cell", measured)
        bends[pressure] = measured.curve
    return bends


@dataclass(frozen=True)
class CellMeasurer:
    """Measures the cell at any pressures, for arms that bend as far as its own cells do without moment."""

    tasks: ArmTasks
    log: Log
    bends: Mapping[float, float]  #: 1/mm, by pressure in kPa

    def measure(self, pressures: Sequence[float]) -> Iterator[Measured[CellCurve] | Reason]:
        """Cells at rising pressures; why for one that is not borne."""
        progress = self.tasks.context.progress
        progress.experiment("cell", pressures)
        submitted = [(p, self.tasks.submit(PieceCurves.cell, p, self._largest_bend(p))) for p in pressures]
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

    def _largest_bend(self, pressure: float) -> float:
        """At the highest pressure for which a curve is used: the next one of the configuration."""
        return self.bends[min((p for p in self.bends if p > pressure), default=max(self.bends))]

    def measure_up_to_failure(self, pressures: Sequence[float]) -> Cells:
        """Cells by rising pressure, up to the last one that is borne. Raises RunFailed for fewer than two."""
        cells: Cells = []
        for cell in self.measure(pressures):
            if isinstance(cell, Reason):
                self.log.failures.append(failure_of(cell))
                break
            cells.append(cell)
        check_two(cells, self.log)
        return cells

    def measure_also(self, pressures: Sequence[float]) -> Cells:
        """The cells at those pressures that are borne; the others are limits."""
        cells = list(self.measure(pressures))
        self.log.limits.extend(reason for reason in cells if isinstance(reason, Reason))
        return [cell for cell in cells if isinstance(cell, Measured)]

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
        errors: dict[Interval, float | None] = {}
        above: dict[Interval, tuple[float, ...]] = {}  # errors of the intervals that one is a part of, largest first
        tried: set[float] = set()
        given = len(cells)
        while True:
            known = self._errors_between(cells, errors)
            middles = []
            for low, high in sorted((pair for pair in known if known[pair] > allowed), key=lambda pair: -known[pair]):
                halved = (*above.get((low, high), ()), known[low, high])
                if not is_not_reduced(halved, allowed):
                    middles.append(middle := 0.5 * (low + high))
                    above[low, middle] = above[middle, high] = halved
            more = sorted(set(middles[: MOST_ADDED - len(cells) + given]) - tried)
            if not more:
                break
            tried.update(more)
            cells = sorted([*cells, *self.measure_also(more)], key=lambda cell: cell.curve.pressure)
        if not known:
            return cells, None
        left = max(known.values()) / allowed * BETWEEN
        if left > BETWEEN:
            self.log.limits.append(Reason("law_between", {"percent": 100.0 * left, "added": MOST_ADDED}))
        return cells, left

    def _errors_between(self, cells: Cells, errors: dict[Interval, float | None]) -> dict[Interval, float]:
        """Largest error of the curvature in the middle between two neighbours, 1/mm, by their pressures in kPa.

        errors: those that are known, to which new ones are added; None where one cannot be found, which is a limit.
        """
        neighbours = {(a.curve.pressure, b.curve.pressure): (a.curve, b.curve) for a, b in pairwise(cells)}
        submit = self.tasks.submit
        new = {p: submit(PieceCurves.between, *both) for p, both in neighbours.items() if p not in errors}
        for pair, pending in new.items():
            errors[pair] = None
            try:
                deviation = pending.result()
            except (PieceFailed, RodError) as failure:
                why = str(failure).rstrip(".")
                self.log.limits.append(Reason("between_unchecked", {"pressure_kPa": 0.5 * sum(pair), "why": why}))
                continue
            self.log.count("between", deviation)
            errors[pair] = deviation.curve
        return {pair: error for pair in neighbours if (error := errors[pair]) is not None}


def check_two(cells: Sequence[object], log: Log) -> None:
    """Raise RunFailed for fewer than two pressures."""
    if len(cells) < 2:
        raise RunFailed(f"the arm's own law has fewer than two pressures: {render_all(log.failures)}")


def is_not_reduced(errors: Sequence[float], allowed: float) -> bool:
    """Whether dividing has not reduced the error of the last of these intervals, each a half of the one before."""
    if len(errors) < 3 or errors[-1] > NEARLY_ALLOWED * allowed:
        return False
    return all(part > NOT_REDUCED * whole for whole, part in pairwise(errors[-3:]))
