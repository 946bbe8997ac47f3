"""The arm's own law at given pressures: a cell at each, pressures between, and the two ends."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from geometry import Reason
from pipeline.law.cells import CellMeasurer, measure_bends
from pipeline.law.ends import begin_clamps, choose_half_cells, measure_ends
from pipeline.law.mesh_limit import MeshLimit
from pipeline.law.piece.point import Measured
from pipeline.law.piece.rates import law_rates
from pipeline.law.pieces import ArmPieces
from pipeline.law.tasks import ArmTasks, Log
from pipeline.store.context import RunContext
from pipeline.values.law import LawMeshError
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw


@dataclass(frozen=True, eq=False)  # arrays inside
class MeasuredLaw:
    """The arm's own law, how it was measured, and how far it may be trusted."""

    law: ArmLaw
    half_cells: int  #: in each end piece
    added_kPa: tuple[float, ...]  #: pressures that were not asked for
    error_along: float  #: of the curvature between two moments of a curve, over the largest curvature of the law
    error_between: float | None  #: of the curvature between two pressures where it was checked; None: nowhere
    error_along_clamp: float  #: of the rotation of the clamped end between two moments, rad
    error_ends: float | None  #: of the arm's end by cells that the end pieces still disturb, over it; None: not known
    limits: tuple[Reason, ...]  #: where the law ends before the loads that it was made for, and why
    failures: tuple[Reason, ...]  #: pressures that the pieces do not bear
    factorizations: Mapping[str, int] = field(repr=False)  #: by part of the work
    seconds: Mapping[str, float] = field(repr=False)  #: by part of the work, of earlier runs too
    seconds_of_cells: tuple[float, ...] = field(repr=False)  #: by pressure
    unknowns: Mapping[str, int] = field(repr=False)  #: displacement components by piece
    mesh_error: LawMeshError | None = None  #: of the cell; None: not estimated
    limit: MeshLimit | None = None  #: of the mesh, to which the law was corrected; None: the law on one mesh


def build_law(
    pieces: ArmPieces,
    pressures_kPa: Sequence[float],
    context: RunContext,
    highest_kPa: Callable[[], float] | None = None,
    *,
    between: bool = True,
) -> MeasuredLaw:
    """Measure the law of an arm at rest, at rising pressures, and between where that is needed.

    between: False for a law that is read at these pressures alone. highest_kPa: gives the pressure that the law need
    not exceed, as soon as that is known. The cell may be solved above it, the ends of the arm, which cost most, are
    not.

    Curves that an earlier run has left in the store are not measured again. Raises `NoArmLaw` for an arm or effects
    that such a law does not describe, InputError for pieces that cannot be meshed, and RunFailed where not even the
    lowest pressure is borne.
    """
    tasks, log, repetition = ArmTasks(pieces, context), Log(), pieces.repetition  # refused before anything is solved
    measurer = CellMeasurer(tasks, log, measure_bends(tasks, log, pressures_kPa, highest_kPa))
    cells = measurer.measure_up_to_failure(sorted({0.0, *measurer.bends}))
    if highest_kPa:
        cells = measurer.end_at(cells, highest_kPa())
    last, length = cells[-1].curve, pieces.design.length
    clamp = begin_clamps(tasks, last, repetition.half_cells)  # done beside the pressures between
    cells, error_between = measurer.add_between(cells) if between else (cells, None)
    half_cells, error_ends, limit = choose_half_cells(clamp, last, repetition.half_cells, length)
    log.limits.extend(filter(None, [limit]))
    cells, clamps, tips = measure_ends(tasks, log, cells, half_cells)
    law = pieces.law([cell.curve for cell in cells], [end.curve for end in clamps], tips)
    if pieces.derivatives:
        law = replace(law, rates=law_rates(pieces.config, repetition, pieces.movements, cells, clamps))
    return MeasuredLaw(
        law=law,
        half_cells=half_cells,
        added_kPa=tuple(p for p in law.pressures[1:] if p not in pressures_kPa),
        error_along=_error_along(cells),
        error_between=error_between,
        error_along_clamp=max(end.error for end in clamps),
        error_ends=error_ends,
        limits=tuple(dict.fromkeys(log.limits)),
        failures=tuple(log.failures),
        factorizations=log.factorizations,
        seconds=log.seconds,
        seconds_of_cells=tuple(cell.seconds for cell in cells),
        unknowns={"cell": cells[0].unknowns, "end": clamps[0].unknowns},
    )


def _error_along(cells: Sequence[Measured[CellCurve]]) -> float:
    """Largest error of the curvature between two states of a cell, over the largest curvature of all."""
    largest = [float(np.abs(cell.curve.kappa).max()) for cell in cells]
    return max(cell.error * own for cell, own in zip(cells, largest, strict=True)) / max(largest)
