"""The arm's own law of a configuration: a cell at every pressure, pressures between, and the two ends."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.cell.piece import PieceFailed
from pipeline.cell.curves import NAMES, ArmTasks, Measured, PieceCurves
from pipeline.cell.decay import Decay
from pipeline.cell.deviation import is_not_reduced
from pipeline.cell.mesh_error import MeshError, mesh_error
from pipeline.cell.pieces import ArmPieces
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.parallel import Pending
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw

#: largest error of the curvature between two pressures, over the largest curvature of the law
BETWEEN = 3e-3
#: how many pressures are added at most
MOST_ADDED = 12
#: pressures at which an end of the arm is measured by one worker, each from the state at the one before
IN_TURN = 4


@dataclass(frozen=True, eq=False)  # arrays inside
class MeasuredLaw:
    """The arm's own law, how it was measured, and how far it may be trusted."""

    law: ArmLaw
    half_cells: int  #: in each end piece
    added_kPa: tuple[float, ...]  #: pressures that are none of the configuration
    error_along: float  #: of the curvature between two moments of a curve, over the largest curvature of the law
    error_between: float | None  #: of the curvature between two pressures where it was checked; None: nowhere
    error_along_clamp: float  #: of the rotation of the clamped end between two moments, rad
    error_ends: float | None  #: of the arm's end by cells that the end pieces still disturb, over it; None: not known
    mesh_error: MeshError  #: of the cell
    limits: tuple[str, ...]  #: sentences: where the law ends before the loads that it was made for, and why
    failures: tuple[str, ...]  #: sentences: pressures that the pieces do not bear
    factorizations: Mapping[str, int] = field(repr=False)  #: by part of the work
    seconds: Mapping[str, float] = field(repr=False)  #: by part of the work, of earlier runs too
    seconds_of_cells: tuple[float, ...] = field(repr=False)  #: by pressure
    unknowns: Mapping[str, int] = field(repr=False)  #: displacement components by piece


def build_law(pieces: ArmPieces, context: RunContext, highest_kPa: Callable[[], float] | None = None) -> MeasuredLaw:
    """Measure the law of an arm at the pressures of its configuration, at rest, and between where that is needed.

    highest_kPa: gives the pressure that the law need not exceed, as soon as that is known. The cell may be solved above
    it, the ends of the arm, which cost most, are not.

    Curves that an earlier run has left in the store are not measured again. Raises `NoArmLaw` for an arm or effects
    that such a law does not describe, InputError for pieces that cannot be meshed, and RunFailed where not even the
    lowest pressure is borne.
    """
    return _Builder(pieces, context, highest_kPa).law()


class _Builder:
    """The law in the making."""

    def __init__(self, pieces: ArmPieces, context: RunContext, highest_kPa: Callable[[], float] | None) -> None:
        self.pieces = pieces
        self.highest_kPa = highest_kPa
        self.context = context
        self.tasks = ArmTasks.of(pieces, context)
        self.limits: list[str] = []
        self.failures: list[str] = []
        self.factorizations = dict.fromkeys(("cell", "between", "ends"), 0)
        self.seconds = dict.fromkeys(self.factorizations, 0.0)
        #: 1/mm, in the middle between two pressures in kPa; None where it could not be checked
        self.errors: dict[tuple[float, float], float | None] = {}
        #: by interval of pressures: the errors of those that it is a part of, the largest interval first
        self.errors_above: dict[tuple[float, float], tuple[float, ...]] = {}
        self.not_borne: set[float] = set()  #: kPa, between those of the configuration
        self.bends: dict[float, float] = {}  #: 1/mm, by pressure in kPa
        self.error_between: float | None = None
        self.error_along_clamp = 0.0
        self.unknowns: dict[str, Pending[int]] = {}  #: displacement components by piece

    def law(self) -> MeasuredLaw:
        """All curves, put together."""
        config = self.pieces.config
        self.pieces.repetition  # noqa: B018 - refuses an arm that is too short before anything is solved
        requested = config.pressures_kPa
        self.unknowns["cell"] = self.tasks.submit(PieceCurves.unknowns_of_cell)
        self.bends = self._bends(requested)
        cells = self._cells(sorted({0.0, *self.bends}))
        if self.highest_kPa:
            cells = self._up_to(cells, self.highest_kPa())
        decay = Decay(self.pieces, self.tasks, cells[-1].curve)
        decay.begin(1)  # is done beside the pressures between
        cells = self._with_pressures_between(cells)
        half_cells, error_ends, limit = decay.decided()
        self.limits += filter(None, [limit])
        self.unknowns["end"] = self.tasks.submit(PieceCurves.unknowns_of_end, half_cells)
        clamps, tips = self._ends(cells, half_cells)
        cells = cells[: len(clamps)]
        if len(cells) < 2:
            raise RunFailed(f"the law of a cell has fewer than two pressures: {'; '.join(self.failures)}")
        repetition = self.pieces.repetition
        law = ArmLaw(
            pitch=2.0 * repetition.half_pitch,
            first_middle=repetition.middle,
            length=self.pieces.design.length,
            cells=tuple(cell.curve for cell in cells),
            clamps=tuple(clamps),
            tips=tuple(tips),
        )
        return MeasuredLaw(
            law=law,
            half_cells=half_cells,
            added_kPa=tuple(p for p in law.pressures[1:] if p not in requested),
            error_along=_error_along(cells),
            error_between=self.error_between,
            error_along_clamp=self.error_along_clamp,
            error_ends=error_ends,
            mesh_error=mesh_error(self.pieces, law.cells, self.unknowns["cell"].result(), self.context),
            limits=tuple(dict.fromkeys(self.limits)),
            failures=tuple(self.failures),
            factorizations=MappingProxyType(self.factorizations),
            seconds=MappingProxyType(self.seconds),
            seconds_of_cells=tuple(cell.seconds for cell in cells),
            unknowns=MappingProxyType({name: number.result() for name, number in self.unknowns.items()}),
        )

    def _bends(self, pressures: Sequence[float]) -> dict[float, float]:
        """How the cell bends without moment at rising pressures, up to the last one that it bears.

        Where it bears none of them, at the highest pressure that is of use, if that is lower. Raises RunFailed where it
        bears none.
        """
        bends = self._borne_bends(pressures)
        if not bends and self.highest_kPa and (highest := self.highest_kPa()) < pressures[0]:
            bends = self._borne_bends([highest])
        if not bends:
            raise RunFailed(f"the cell of the arm has no equilibrium at any of the pressures: {self.failures[0]}")
        return bends

    def _borne_bends(self, pressures: Sequence[float]) -> dict[float, float]:
        """The same; empty where it bears none of the pressures."""
        bends: dict[float, float] = {}
        for pressure, pending in [(p, self.tasks.submit(PieceCurves.bend, p)) for p in pressures]:
            try:
                measured = pending.result()
            except PieceFailed as failure:
                self.failures.append(str(failure).rstrip("."))
                break
            self._count("cell", measured)
            bends[pressure] = measured.curve
        return bends

    def _largest_bend(self, pressure: float) -> float:
        """At the highest pressure for which a curve is used: the next one of the configuration."""
        return self.bends[min((p for p in self.bends if p > pressure), default=max(self.bends))]

    def _cells(self, pressures: Sequence[float]) -> list[Measured[CellCurve]]:
        """Cells by rising pressure, up to the last one that is borne."""
        cells: list[Measured[CellCurve]] = []
        for cell in self._measured_cells(pressures):
            if isinstance(cell, str):
                self.failures.append(cell)
                break
            cells.append(cell)
        if len(cells) < 2:
            raise RunFailed(f"the law of a cell has fewer than two pressures: {'; '.join(self.failures)}")
        return cells

    def _up_to(self, cells: list[Measured[CellCurve]], highest: float) -> list[Measured[CellCurve]]:
        """The cells up to a pressure in kPa, and one at this pressure, which is measured where there is none."""
        if cells[-1].curve.pressure <= highest:
            return cells
        borne = [cell for cell in cells if cell.curve.pressure <= highest]
        if borne[-1].curve.pressure < highest:
            for cell in self._measured_cells([highest]):
                if isinstance(cell, str):
                    self.limits.append(cell)
                else:
                    borne.append(cell)
        if len(borne) < 2:
            return cells
        self.limits.append(
            f"the law goes up to {borne[-1].curve.pressure:g} kPa, because the whole arm was not solved at a higher "
            "pressure in experiment II; `pneurod cell` measures it without the whole arm"
        )
        return borne

    def _measured_cells(self, pressures: Sequence[float]) -> Iterator[Measured[CellCurve] | str]:
        """Cells at rising pressures; a sentence for one that is not borne."""
        self.context.progress.experiment("cell", pressures)
        for pressure, pending in [
            (p, self.tasks.submit(PieceCurves.cell, p, self._largest_bend(p))) for p in pressures
        ]:
            try:
                cell = pending.result()
            except (PieceFailed, RodError) as failure:
                reason = str(failure).rstrip(".")
                self.context.progress.stopped("cell", [pressure], reason)
                yield reason
                continue
            self._count("cell", cell)
            yield cell

    def _with_pressures_between(self, cells: list[Measured[CellCurve]]) -> list[Measured[CellCurve]]:
        """The cells with those at pressures between, where the interpolation was wrong by more than BETWEEN."""
        added: list[float] = []
        allowed = BETWEEN * max(float(np.abs(cell.curve.kappa).max()) for cell in cells)
        while True:
            errors = self._errors_between(cells)
            self.error_between = max(errors.values()) / allowed * BETWEEN if errors else None
            worst = sorted((pair for pair in errors if errors[pair] > allowed), key=lambda pair: -errors[pair])
            middles = [middle for pair in worst if (middle := self._divided(pair, errors[pair], allowed))]
            more = sorted(p for p in middles[: MOST_ADDED - len(added)] if p not in self.not_borne)
            if not more:
                break
            for pressure, cell in zip(more, self._measured_cells(more), strict=True):
                if isinstance(cell, str):
                    self.not_borne.add(pressure)
                    self.limits.append(cell)
                else:
                    added.append(pressure)
                    cells = sorted([*cells, cell], key=lambda measured: measured.curve.pressure)
        if self.error_between is not None and self.error_between > BETWEEN:
            self.limits.append(
                f"between two pressures the curvature is interpolated to {100 * self.error_between:.2g} % of the "
                f"largest one; at most {MOST_ADDED} pressures are added, and none where that does not help"
            )
        return cells

    def _divided(self, interval: tuple[float, float], error: float, allowed: float) -> float | None:
        """The pressure in kPa in the middle of an interval; None where dividing it does not help."""
        errors = (*self.errors_above.get(interval, ()), error)
        if is_not_reduced(errors, allowed):
            return None
        low, high = interval
        middle = 0.5 * (low + high)
        self.errors_above[low, middle] = self.errors_above[middle, high] = errors
        return middle

    def _errors_between(self, cells: Sequence[Measured[CellCurve]]) -> dict[tuple[float, float], float]:
        """Largest error of the curvature in the middle between two neighbours, 1/mm, by their pressures in kPa.

        Where it cannot be found it is left out, and a sentence is among the limits.
        """
        neighbours = {(a.curve.pressure, b.curve.pressure): (a.curve, b.curve) for a, b in pairwise(cells)}
        submit = self.tasks.submit
        new = {p: submit(PieceCurves.between, *both) for p, both in neighbours.items() if p not in self.errors}
        for pair, pending in new.items():
            self.errors[pair] = None
            try:
                deviation = pending.result()
            except (PieceFailed, RodError) as failure:
                reason = str(failure).rstrip(".")
                self.limits.append(f"the interpolation at {0.5 * sum(pair):g} kPa could not be checked: {reason}")
                continue
            self._count("between", deviation)
            self.errors[pair] = deviation.curve
        return {pair: error for pair in neighbours if (error := self.errors[pair]) is not None}

    def _ends(self, cells: Sequence[Measured[CellCurve]], half_cells: int) -> tuple[list[ClampCurve], list[TipCurve]]:
        """The clamped end and the tip by rising pressure, up to the last one that is borne."""
        curves = [cell.curve for cell in cells]
        for name in NAMES.values():
            self.context.progress.experiment(name, [curve.pressure for curve in curves])
        groups = [curves[first : first + IN_TURN] for first in range(0, len(curves), IN_TURN)]
        clamped_ends = [self.tasks.submit(PieceCurves.clamps, group, half_cells) for group in groups]
        free_ends = [self.tasks.submit(PieceCurves.tips, group, half_cells) for group in groups]
        clamps: list[ClampCurve] = []
        tips: list[TipCurve] = []
        for clamped_end, free_end in zip(clamped_ends, free_ends, strict=True):
            clamped, free = clamped_end.result(), free_end.result()
            for end in (clamped.measured, free.measured):
                for measured in end:
                    self._count("ends", measured)
            for clamp, tip in zip(clamped.measured, free.measured, strict=False):  # one of them may go further
                self.error_along_clamp = max(self.error_along_clamp, clamp.error)
                self.limits += [*cells[len(clamps)].limits, *clamp.limits, *tip.limits]
                clamps.append(clamp.curve)
                tips.append(tip.curve)
            if clamped.failure or free.failure:
                clamp_fails = clamped.failure and len(clamped.measured) <= len(free.measured)
                self.failures.append(clamped.failure if clamp_fails else free.failure)
                break
        return clamps, tips

    def _count(self, part: str, measured: Measured[Any]) -> None:
        self.factorizations[part] += measured.factorizations
        self.seconds[part] += measured.seconds


def _error_along(cells: Sequence[Measured[CellCurve]]) -> float:
    """Largest error of the curvature between two states of a cell, over the largest curvature of all."""
    largest = [float(np.abs(cell.curve.kappa).max()) for cell in cells]
    return max(cell.error * own for cell, own in zip(cells, largest, strict=True)) / max(largest)
