"""The two ends of an arm: how many half cells they disturb, and their curves beside those of the cell."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import zip_longest
from typing import Generic, TypeVar

import numpy as np

from fem.cell.boundary import Boundary
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.cells import check_two
from pipeline.law.piece.measure_clamp import clamp_curve, clamp_without_moment, first_state
from pipeline.law.piece.measure_tip import tip_curve, tip_state
from pipeline.law.piece.point import Measured, failure_of
from pipeline.law.pieces import NoArmLaw
from pipeline.law.tasks import ArmTasks, Log, PieceCurves
from pipeline.store.parallel import Pending
from pipeline.values.pressure import name_of_state
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve

Curve = TypeVar("Curve", ClampCurve, TipCurve)

#: largest displacement of the arm's end, over its length, by which end pieces that differ by a cell may differ
DECAY = 5e-4
#: the same beyond which the arm is said to have no undisturbed cells
NOT_DECAYED = 1e-2
#: lengths without an equilibrium after which longer ends are not tried
MOST_FAILED = 2
#: part of the difference of two ends above which two half cells more have not reduced it; on `pneunet` at 31 kPa they
#: reduce it to 0.3 of it, at 45 and 60 kPa, where it is due to single nodes in contact, not at all
NOT_NEARER = 0.8
#: half cells of the ends from which the first numbers and a draft come
HALF_CELLS = 1
#: pressures at which an end of the arm is measured by one worker, each from the state at the one before
IN_TURN = 4


def begin_clamps(tasks: ArmTasks, cell: CellCurve, available: int) -> Callable[[int], Pending[Measured[ClampCurve]]]:
    """Gives the clamped end with so many half cells, without moment; the first two of them are begun at once.

    available: half cells of the arm.
    """

    @cache
    def clamp(half_cells: int) -> Pending[Measured[ClampCurve]]:
        return tasks.submit(clamp_alone, cell, half_cells)

    for half_cells in (1, 3) if available >= 3 else ():
        clamp(half_cells)
    return clamp


def choose_half_cells(
    clamp: Callable[[int], Pending[Measured[ClampCurve]]], cell: CellCurve, available: int, length: float
) -> tuple[int, float | None, Reason | None]:
    """So many half cells of an end piece that two more change the arm's end by less than DECAY.

    Longer ones are not tried where that is of no use: after MOST_FAILED lengths without an equilibrium, and where two
    more half cells have not reduced the change. Where walls touch, the slope at a moment depends on which nodes do.

    clamp, available: as in `begin_clamps`; length: mm, of the arm. Returns also the error of the arm's end by cells
    that the end still disturbs, over the length, and a reason where it is not known or has not decayed. Raises
    `NoArmLaw`.
    """
    if available < 3:
        return 1, None, Reason("ends_short")
    borne: dict[int, ClampCurve] = {}  # by half cells
    failed: dict[int, str] = {}  # why, of those without an equilibrium
    errors: dict[int, float] = {}  # by the half cells of the shorter end of a pair
    why = "the arm has no room"
    for half_cells in range(1, available // 2 + 3, 2):
        try:
            borne[half_cells] = clamp(half_cells).result().curve
        except PieceFailed as failure:
            failed[half_cells] = str(failure).rstrip(".")
            if len(failed) == MOST_FAILED:
                break
        shorter = half_cells - 2
        if shorter in borne and half_cells in borne:
            errors[shorter] = displacement(borne[shorter], borne[half_cells], cell, length)
            if errors[shorter] <= DECAY:
                return shorter, errors[shorter], None
            if is_not_nearer(tuple(errors.values())):
                why = "longer ones are not nearer to each other"
                break
    why = next(reversed(failed.values()), why)
    if not errors:
        return min(borne, default=1), None, Reason("ends_unknown", {"why": why})
    return _nearest(errors, why)


def is_not_nearer(errors: Sequence[float]) -> bool:
    """Whether the last of these differences of longer and longer ends is no smaller than the one before."""
    return len(errors) > 1 and errors[-1] > NOT_NEARER * errors[-2]


def _nearest(errors: Mapping[int, float], why: str) -> tuple[int, float, Reason]:
    """The half cells of the pair that differs least, and how much it and longer ones differ. Raises `NoArmLaw`.

    errors: over the length, by the half cells of the shorter end of a pair, rising.
    """
    half_cells = min(errors, key=lambda count: errors[count])
    if errors[half_cells] > NOT_DECAYED:
        percent = 100.0 * errors[half_cells]
        raise NoArmLaw(f"its two ends disturb all cells: two half cells more change its end by {percent:.2g} %")
    error = max(value for count, value in errors.items() if count >= half_cells)
    values = {"half_cells": half_cells, "longer": half_cells + 2, "percent": 100.0 * error}
    return half_cells, error, Reason("ends_differ", values | {"why": why})


def displacement(first: ClampCurve, second: ClampCurve, cell: CellCurve, length: float) -> float:
    """Largest displacement of the end of an arm of `length` mm by exchanging its clamped end, over the length.

    Both without moment, to first order up to the moment that straightens the cell.
    """
    straight = abs(cell.at(0.0)[0]) * float(np.interp(0.0, cell.moment, cell.rigidity))

    def distance(name: str) -> float:
        """Of the values without moment, and of their slopes at that moment."""
        (value, rate), (other, other_rate) = (_without_moment(clamp, name) for clamp in (first, second))
        return float(np.linalg.norm(value - other) + straight * np.linalg.norm(rate - other_rate))

    return distance("rotation") + distance("offset") / length


def _without_moment(clamp: ClampCurve, name: str) -> tuple[Array, Array]:
    """A value without moment, to first order, and its rate, of the first state."""
    rate = getattr(clamp, f"{name}_by_moment")[0]
    return getattr(clamp, name)[0] - clamp.moment[0] * rate, rate


def measure_ends(
    tasks: ArmTasks, log: Log, cells: list[Measured[CellCurve]], half_cells: int, clamp_end: "End[ClampCurve]"
) -> tuple[list[Measured[CellCurve]], list[Measured[ClampCurve]], list[TipCurve]]:
    """Cells, clamped ends and tips by rising pressure, up to the last one that both ends bear.

    Raises RunFailed for fewer than two.
    """
    curves = [cell.curve for cell in cells]
    for end in (clamp_end, TIP):
        tasks.context.progress.experiment(end.name, [curve.pressure for curve in curves])
    groups = [curves[first : first + IN_TURN] for first in range(0, len(curves), IN_TURN)]
    clamped_ends = [tasks.submit(end_curves, clamp_end, group, half_cells) for group in groups]
    free_ends = [tasks.submit(end_curves, TIP, group, half_cells) for group in groups]
    clamps: list[Measured[ClampCurve]] = []
    tips: list[TipCurve] = []
    for clamped_end, free_end in zip(clamped_ends, free_ends, strict=True):
        clamped, free = clamped_end.result(), free_end.result()
        for clamp, tip in zip_longest(clamped.measured, free.measured):
            log.count("ends", clamp, tip)
            if clamp and tip:  # one of them may go further
                log.limits.extend((*cells[len(clamps)].limits, *clamp.limits, *tip.limits))
                clamps.append(clamp)
                tips.append(tip.curve)
        if clamped.failure or free.failure:
            clamp_fails = clamped.failure and len(clamped.measured) <= len(free.measured)
            log.failures.extend(filter(None, [clamped.failure if clamp_fails else free.failure]))
            break
    check_two(clamps, log)
    return cells[: len(clamps)], clamps, tips


@dataclass(frozen=True)
class End(Generic[Curve]):
    """One of the two ends of an arm, and how it is measured beside a cell, from the state at a lower pressure."""

    curve: type[Curve]
    file: str  #: how the names of its files begin
    name: str  #: in the progress
    start: Boundary  #: what holds the piece
    measure: Callable[[BendingPiece, CellCurve, PieceState | None], tuple[Measured[Curve], PieceState]]
    solve_state: Callable[[BendingPiece, CellCurve, PieceState | None], PieceState]  #: that `measure` gives, alone


def _clamp_near(piece: BendingPiece, cell: CellCurve, _: PieceState | None) -> tuple[Measured[ClampCurve], PieceState]:
    """The clamped end from its state without moment alone, which needs no state at a lower pressure."""
    return Measured(straight_clamp(clamp_without_moment(piece, cell), cell.moment)), piece.rest()


def _rest(piece: BendingPiece, *_: object) -> PieceState:
    return piece.rest()


def straight_clamp(clamp: ClampCurve, moments: Array) -> ClampCurve:
    """A clamped end of which one state is known, to first order at moments (k,) in N mm."""
    change = moments - clamp.moment[0]
    rotation, offset = clamp.rotation_by_moment * change, clamp.offset_by_moment * change[:, None]
    alike = ("rotation_by_moment", "rotation_by_pressure", "offset_by_moment", "beside", "volume")
    rows = {name: getattr(clamp, name).repeat(len(moments), axis=0) for name in alike}
    return replace(clamp, moment=moments, rotation=clamp.rotation + rotation, offset=clamp.offset + offset, **rows)


CLAMP = End(ClampCurve, "clamp", "clamped end", "clamp", clamp_curve, first_state)
#: the same to first order, as a draft has it
CLAMP_NEAR = End(ClampCurve, "clamp_near", "clamped end", "clamp", _clamp_near, _rest)
TIP = End(TipCurve, "tip", "tip", "free", tip_curve, tip_state)


@dataclass(frozen=True)
class EndCurves(Generic[Curve]):
    """An end of the arm by rising pressure."""

    measured: tuple[Measured[Curve], ...]
    failure: Reason | None  #: why it goes no further; None where all pressures are borne


def clamp_alone(curves: PieceCurves, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
    """The clamped end with that many half cells without moment alone; a task. Raises `PieceFailed`."""
    name, pieces = name_of_state(f"decay_{half_cells}", cell.pressure), curves.pieces

    def measure(piece: BendingPiece) -> Measured[ClampCurve]:
        return Measured(clamp_without_moment(piece, cell))

    return curves.of_piece(ClampCurve, name, lambda: pieces.end(half_cells, "clamp"), measure)


def end_curves(curves: PieceCurves, end: End[Curve], cells: Sequence[CellCurve], half_cells: int) -> EndCurves[Curve]:
    """One end with that many half cells beside cells at rising pressures, up to the last one that it bears; a task.

    Each begins with the state at the pressure before. Curves of an earlier run have left no states. If one is needed it
    is solved again, so that a run that was interrupted has the same curves.
    """
    state: PieceState | None = None
    without_state: list[CellCurve] = []
    measured: list[Measured[Curve]] = []

    def piece() -> BendingPiece:
        nonlocal state
        made = curves.pieces.end(half_cells, end.start)
        for earlier in without_state:
            with suppress(PieceFailed):
                state = end.solve_state(made, earlier, state)
        without_state.clear()
        return made

    def measure(cell: CellCurve, made: BendingPiece) -> Measured[Curve]:
        nonlocal state
        curve, state = end.measure(made, cell, state)
        return curve

    for cell in cells:
        name = name_of_state(f"{end.file}_{half_cells}", cell.pressure)
        try:
            curve = curves.of_piece(end.curve, name, piece, partial(measure, cell))
        except (PieceFailed, RodError) as failed:
            curves.progress.stopped(end.name, [cell.pressure], str(failed).rstrip("."))
            return EndCurves(tuple(measured), failure_of(failed))
        if curve.is_stored:
            without_state.append(cell)
        curves.progress.step_done(end.name, cell.pressure, 0.0 if curve.is_stored else curve.seconds)
        measured.append(curve)
    return EndCurves(tuple(measured), None)
