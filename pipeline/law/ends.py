"""The two ends of an arm: how many half cells they disturb, and their curves beside those of the cell."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

import numpy as np

from fem.cell.boundary import Boundary
from fem.cell.inflation import along_air, unloaded
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import continued
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.piece.measure_clamp import Begin, clamp_curve, clamp_without_moment, near_clamp, straight_point
from pipeline.law.piece.measure_tip import tip_curve
from pipeline.law.piece.pieces import ArmPieces, NoArmLaw
from pipeline.law.piece.point import KeptCurve, failure_of
from pipeline.law.piece.tasks import ArmTasks, Log, PieceCurves
from pipeline.values.pressure import in_MPa, name_of_state
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve

Curve = TypeVar("Curve", ClampCurve, TipCurve)

#: largest displacement of the arm's end, over its length, by which end pieces that differ by a cell may differ
DECAY = 5e-4
#: the same beyond which the arm is said to have no undisturbed cells
NOT_DECAYED = 1e-2
#: the same of swollen cells, as wide as the arm is long, whose law is delivered with this error
SWOLLEN_NOT_DECAYED = 0.1
#: of these the shortest ends, where the arm has room for both: those of one half cell are off by up to a tenth of it
SWOLLEN_HALF_CELLS = 3
#: lengths without an equilibrium after which longer ends are not tried
MOST_FAILED = 2
#: part of the difference of two ends above which two half cells more have not reduced it; on `pneunet` at 31 kPa they
#: reduce it to 0.3 of it, at 45 and 60 kPa, where it is due to single nodes in contact, not at all
NOT_NEARER = 0.8
#: half cells of the ends from which the first numbers and a draft come
HALF_CELLS = 1


def half_cells_of(curves: PieceCurves, cell: CellCurve) -> tuple[int, float | None, Reason | None]:
    """`choose_half_cells` for the clamped ends of an arm without moment; a task."""
    pieces = curves.pieces
    available, length, clamp = pieces.repetition.half_cells, pieces.design.length, partial(clamp_alone, curves, cell)
    if not _is_swollen(pieces, cell):
        return choose_half_cells(clamp, cell, available, length)
    most, first = 2 * SWOLLEN_HALF_CELLS, SWOLLEN_HALF_CELLS if available >= 2 * SWOLLEN_HALF_CELLS else HALF_CELLS
    why = "swollen they take minutes"
    return choose_half_cells(clamp, cell, min(available, most), length, SWOLLEN_NOT_DECAYED, why, first)


def choose_half_cells(
    clamp: Callable[[int], ClampCurve],
    cell: CellCurve,
    available: int,
    length: float,
    most: float = NOT_DECAYED,
    why: str = "the arm has no room",
    first: int = HALF_CELLS,
) -> tuple[int, float | None, Reason | None]:
    """So many half cells of an end piece that two more change the arm's end by less than DECAY.

    Longer ones are not tried where that is of no use: after MOST_FAILED lengths without an equilibrium, and where two
    more half cells have not reduced the change. Where walls touch, the slope at a moment depends on which nodes do.

    clamp: gives that with so many half cells; available: half cells of the arm; length: mm, of the arm; most: the
    change beyond which the arm is said to have no undisturbed cells; why: there are no longer ends; first: half cells
    of the shortest end. Returns also the error of the arm's end by cells that the end still disturbs, over the length,
    and a reason where it is not known or has not decayed. Raises `NoArmLaw`.
    """
    if available < 3:
        return 1, None, Reason("ends_short")
    borne: dict[int, ClampCurve] = {}  # by half cells
    failed: dict[int, str] = {}  # why, of those without an equilibrium
    errors: dict[int, float] = {}  # by the half cells of the shorter end of a pair
    for half_cells in range(first, available // 2 + 3, 2):
        try:
            borne[half_cells] = clamp(half_cells)
        except PieceFailed as failure:
            failed[half_cells] = str(failure).rstrip(".")
            if len(failed) == MOST_FAILED:
                break
        shorter = half_cells - 2
        if shorter in borne and half_cells in borne:
            errors[shorter] = displacement(borne[shorter], borne[half_cells], cell, length)
            if errors[shorter] <= DECAY:
                return shorter, errors[shorter], None
            if len(errors) > 1 and errors[shorter] > NOT_NEARER * errors[shorter - 2]:
                why = "longer ones are not nearer to each other"
                break
    why = next(reversed(failed.values()), why)
    if not errors:
        return min(borne, default=1), None, Reason("ends_unknown", {"why": why})
    return _nearest(errors, why, most)


def _nearest(errors: Mapping[int, float], why: str, most: float) -> tuple[int, float, Reason]:
    """The half cells of the pair that differs least, and how much it and longer ones differ. Raises `NoArmLaw`.

    errors: over the length, by the half cells of the shorter end of a pair, rising.
    """
    half_cells = min(errors, key=lambda count: errors[count])
    if errors[half_cells] > most:
        percent = 100.0 * errors[half_cells]
        raise NoArmLaw(f"its two ends disturb all cells: two half cells more change its end by {percent:.2g} %")
    error = max(value for count, value in errors.items() if count >= half_cells)
    values = {"half_cells": half_cells, "longer": half_cells + 2, "percent": 100.0 * error}
    return half_cells, error, Reason("ends_differ", values | {"why": why})


def displacement(first: ClampCurve, second: ClampCurve, cell: CellCurve, length: float) -> float:
    """Largest displacement of the end of an arm of `length` mm by exchanging its clamped end, over the length.

    Both without moment, to first order up to the moment that straightens the cell, or the largest one that it bears.
    """
    kappa_0, rigidity = cell.at(0.0)[0], float(np.interp(0.0, cell.moment, cell.rigidity))
    straight = min(abs(kappa_0) * rigidity, float(abs(cell.moment[-1 if kappa_0 < 0.0 else 0])))

    def distance(name: str) -> float:
        """Distance of the values without moment, and of their slopes at that moment."""
        (value, rate), (other, other_rate) = (_without_moment(clamp, name) for clamp in (first, second))
        return float(np.linalg.norm(value - other) + straight * np.linalg.norm(rate - other_rate))

    return distance("rotation") + distance("offset") / length


def _without_moment(clamp: ClampCurve, name: str) -> tuple[Array, Array]:
    """A value without moment, to first order, and its rate, of the first state."""
    rate = getattr(clamp, f"{name}_by_moment")[0]
    return getattr(clamp, name)[0] - clamp.moment[0] * rate, rate


def measure_ends(
    tasks: ArmTasks, log: Log, cells: list[KeptCurve[CellCurve]], half_cells: int, clamp_end: "End[ClampCurve]"
) -> tuple[list[KeptCurve[CellCurve]], list[KeptCurve[ClampCurve]], list[TipCurve]]:
    """Cells, clamped ends and tips by rising pressure, up to the last one that both ends bear.

    Raises RunFailed for fewer than two.
    """
    curves = [cell.curve for cell in cells]
    for end in (clamp_end, TIP):
        tasks.context.progress.experiment(end.name, [curve.pressure for curve in curves])
    clamped = [tasks.submit(end_at, clamp_end, curve, half_cells) for curve in curves]
    free = [tasks.submit(end_at, TIP, curve, half_cells) for curve in curves]
    clamps, tips = list[KeptCurve[ClampCurve]](), list[TipCurve]()
    for cell, clamped_end, free_end in zip(cells, clamped, free, strict=True):
        try:
            clamp, tip = clamped_end.result(), free_end.result()
        except (PieceFailed, RodError) as failed:
            log.failures.append(failure_of(failed))
            if tasks.pieces.config.effects.hoops.on:
                log.limits.append(Reason("end_without_thread", {"pressure_kPa": cell.curve.pressure}))
            break
        log.count("ends", clamp, tip)
        log.limits.extend((*cell.limits, *clamp.limits, *tip.limits))
        clamps.append(clamp)
        tips.append(tip.curve)
    log.check_two(clamps)
    return cells[: len(clamps)], clamps, tips


@dataclass(frozen=True)
class End(Generic[Curve]):
    """One of the two ends of an arm, and how it is measured beside a cell."""

    curve: type[Curve]
    file: str  #: how the names of its files begin
    name: str  #: in the progress
    start: Boundary  #: what holds the piece
    measure: Callable[[BendingPiece, CellCurve, Begin | None], KeptCurve[Curve]]


CLAMP = End(ClampCurve, "clamp", "clamped end", "clamp", clamp_curve)
#: the same to first order, as a draft has it
CLAMP_NEAR = End(ClampCurve, "clamp_near", "clamped end", "clamp", near_clamp)
TIP = End(TipCurve, "tip", "tip", "free", tip_curve)


def clamp_alone(curves: PieceCurves, cell: CellCurve, half_cells: int) -> ClampCurve:
    """The clamped end with that many half cells without moment alone. Raises `PieceFailed`."""
    name, pieces = name_of_state(f"decay_{half_cells}", cell.pressure), curves.pieces

    def measure(piece: BendingPiece) -> KeptCurve[ClampCurve]:
        return KeptCurve(clamp_without_moment(piece, cell, _begin(pieces, cell, half_cells, "clamp")))

    return curves.of_piece(ClampCurve, name, lambda: pieces.end(half_cells, "clamp"), measure).curve


def _begin(pieces: ArmPieces, cell: CellCurve, half_cells: int, start: Boundary) -> Begin | None:
    """From the state of a shorter clamped end and that of the cell, or from rest; None for the shortest one and tips.

    Along the air for those of swollen cells.
    """
    pressure, counts = in_MPa(cell.pressure), (half_cells, half_cells - 2)
    if _is_swollen(pieces, cell):
        return lambda _: along_air(pieces.end(half_cells, start), pressure)
    if half_cells <= HALF_CELLS or start == "free":
        return None

    def near(angle: float) -> PieceState:
        piece, shorter = (pieces.end(count, "clamp") for count in counts)
        with suppress(PieceFailed):
            at = straight_point(shorter, cell, _begin(pieces, cell, counts[1], "clamp")).state
            of = cell_without_moment(pieces.cell, pressure).state
            start = continued(piece, shorter, at, pieces.cell, of)
            return piece.solve_near(pressure, at.angle + 2.0 * of.angle, start, piece.rest())
        return unloaded(piece, pressure, angle)

    return near


def _is_swollen(pieces: ArmPieces, cell: CellCurve) -> bool:
    """Whether the air of a cell without moment has grown far more than by first order."""
    air = float(np.interp(0.0, cell.moment, cell.volume.sum(axis=1))) * pieces.cell.body.length
    return pieces.cell.is_swollen(air)


def end_at(curves: PieceCurves, end: End[Curve], cell: CellCurve, half_cells: int) -> KeptCurve[Curve]:
    """One end with that many half cells beside a cell; a task. Raises `PieceFailed` and `RodError`."""
    name, pieces = name_of_state(f"{end.file}_{half_cells}", cell.pressure), curves.pieces
    begin = _begin(pieces, cell, half_cells, end.start)
    try:
        curve = curves.of_piece(
            end.curve, name, lambda: pieces.end(half_cells, end.start), lambda piece: end.measure(piece, cell, begin)
        )
    except (PieceFailed, RodError) as failed:
        curves.progress.stopped(end.name, [cell.pressure], str(failed).rstrip("."))
        raise
    curves.progress.step_done(end.name, cell.pressure, 0.0 if curve.is_stored else curve.seconds)
    return curve
