"""The arm's own law: from a cell and two ends on one mesh, and at the limit of finer ones.

A cell is measured at each pressure, and at pressures between where that is needed. The law on a fine mesh is corrected
to the limit of finer ones.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import inf
from typing import TypeVar

import numpy as np

from fem.cell.piece import PieceFailed
from geometry import Reason
from pipeline.config.automatic_mesh import MeshSettings, cell_mesh
from pipeline.config.config import Config
from pipeline.law.ends import CLAMP, CLAMP_NEAR, HALF_CELLS, half_cells_of, measure_ends
from pipeline.law.layers import measure_layers
from pipeline.law.mesh_limit import Corrections, MeshLimit, Numbers, corrected
from pipeline.law.meshes import find_limit, solve_numbers
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.point import KeptCurve
from pipeline.law.piece.rates import law_rates
from pipeline.law.piece.tasks import ArmTasks, Log
from pipeline.law.snap import measurer_of_form, swollen_pieces
from pipeline.law.unloaded import first_states
from pipeline.results.unloaded import first_numbers
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.law import DeliveredLaw, InterpolationError
from rod.arm_law.curves import CellCurve
from rod.arm_law.law import ArmLaw

Number = TypeVar("Number", int, float)

#: pressures at which the limit is found, at most; corrections are interpolated between them
PRESSURES = 3


@dataclass(frozen=True, eq=False, kw_only=True)  # arrays inside
class MeasuredLaw(DeliveredLaw):
    """The arm's own law of a run, how it was measured, and how far it may be trusted."""

    law: ArmLaw
    half_cells: int  #: in each end piece
    added_kPa: tuple[float, ...]  #: pressures that were not asked for
    interpolation_error: InterpolationError
    limits: tuple[Reason, ...]  #: where the law ends before the loads that it was made for, and why
    failures: tuple[Reason, ...]  #: pressures that the pieces do not bear
    factorizations: Mapping[str, int] = field(repr=False)  #: by part of the work
    seconds: Mapping[str, float] = field(repr=False)  #: by part of the work, of earlier runs too
    seconds_of_cells: tuple[float, ...] = field(repr=False)  #: by pressure
    unknowns: Mapping[str, int] = field(repr=False)  #: displacement components by piece
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

    A draft leaves out pressures between and longer ends. It has the clamped end to first order in the moment, as laws
    of cells that swell have. Curves that an earlier run has left in the store are not measured again. Raises `NoArmLaw`
    for an arm or effects that such a law does not describe, InputError for pieces that cannot be meshed, and RunFailed
    where not even the lowest pressure is borne.
    """
    tasks, log, repetition = ArmTasks(pieces, context), Log(), pieces.repetition  # refused before anything is solved
    measurer, limits = measurer_of_form(tasks, log, pressures_kPa, highest_kPa)
    cells = measurer.measure_up_to_failure(measurer.pressures)
    if highest_kPa:
        cells = measurer.end_at(cells, highest_kPa())
    half_cells, error_ends, error_between, draft = HALF_CELLS, None, None, pieces.config.draft
    if not draft:
        chosen = tasks.submit(half_cells_of, cells[-1].curve)  # done beside the pressures between
        cells, error_between = measurer.add_between(cells) if between else (cells, None)
        half_cells, error_ends, limit = chosen.result()
        log.limits.extend(filter(None, [limit]))
    cells, clamps, tips = measure_ends(tasks, log, cells, half_cells, CLAMP_NEAR if draft or log.swelling else CLAMP)
    law = limits.on(pieces.law([cell.curve for cell in cells], [end.curve for end in clamps], tips), log, pressures_kPa)
    if pieces.derivatives:
        law = replace(law, rates=law_rates(pieces.config, repetition, pieces.movements, cells, clamps))
    return MeasuredLaw(
        law=law,
        draft=draft,
        half_cells=half_cells,
        added_kPa=tuple(p for p in law.pressures[1:] if p not in pressures_kPa),
        interpolation_error=InterpolationError(
            _error_along(cells), max(end.error for end in clamps), error_between, error_ends
        ),
        limits=tuple(dict.fromkeys(log.limits)),
        failures=tuple(log.failures),
        factorizations=log.factorizations,
        seconds=log.seconds,
        seconds_of_cells=tuple(cell.seconds for cell in cells),
        unknowns={"cell": cells[0].unknowns, "end": clamps[0].unknowns},
    )


def _error_along(cells: Sequence[KeptCurve[CellCurve]]) -> float:
    """Largest error of the curvature between two states of a cell, over the largest curvature of all."""
    largest = [float(np.abs(cell.curve.kappa).max()) for cell in cells]
    return max(cell.error * own for cell, own in zip(cells, largest, strict=True)) / max(largest)


def deliver_law(
    pieces: ArmPieces, context: RunContext, begin_others: Callable[[], object] = lambda: None
) -> MeasuredLaw:
    """The law of an arm at the pressures of its configuration, with its derivatives and the error of its mesh.

    pieces: those on the mesh of the arm. begin_others: called when the first numbers are told. An arm that snaps at a
    limit of the pressure has the form after the snap as well. Raises as `build_law`.
    """
    measured = _deliver_form(pieces, context, begin_others)
    measured = replace(measured, layers=measure_layers(ArmTasks(pieces, context), measured.law.pressures))
    after = swollen_pieces(pieces, measured.law)
    if after is None:
        return measured
    try:
        swollen = _deliver_form(after, context)
    except (InputError, RunFailed) as failure:
        missing = Reason("form_not_measured", {"why": str(failure).rstrip(".")})
        return replace(measured, limits=(*measured.limits, missing))
    return replace(
        measured,
        law=replace(measured.law, swollen=swollen.law),
        limits=(*measured.limits, *swollen.limits),
        failures=(*measured.failures, *swollen.failures),
        factorizations=_added(measured.factorizations, swollen.factorizations),
        seconds=_added(measured.seconds, swollen.seconds),
    )


def _added(first: Mapping[str, Number], second: Mapping[str, Number]) -> dict[str, Number]:
    return {name: value + second[name] for name, value in first.items()}


def _deliver_form(
    pieces: ArmPieces, context: RunContext, begin_others: Callable[[], object] = lambda: None
) -> MeasuredLaw:
    """As `deliver_law`, of the form of the pieces alone.

    The law has the relative accuracy of the configuration in kappa_0, the rigidity and the moment that straightens the
    cell; where no mesh reaches it the best law is returned, whose `limit` says so. Without an accuracy it is the law on
    exactly the mesh of the arm, with its error. The limit is found beside the law, from the curvatures of single
    states. A draft has no derivatives and no error. Raises as `build_law`.
    """
    pressures_kPa, accuracy = pieces.config.pressures_kPa, pieces.config.accuracy
    if pieces.config.draft:
        return build_law(pieces, pressures_kPa, context)
    first = pieces if accuracy is None else fine_pieces(pieces)
    given = [one.with_derivatives() for one in dict.fromkeys((first, pieces))]
    tell_first(given[0], context)
    begin_others()
    meshes, bends = _by_pressures(given, pressures_kPa, context)
    begun = context.workers.beside(_find_limit, pieces, bends, context)
    measured, taken = _farthest(meshes, pressures_kPa, context)
    borne = _bends(measured, measured.law.pressures)
    is_same = _at_limit(pieces.config, borne) == _at_limit(pieces.config, bends)
    limit = begun.result() if is_same else _find_limit(pieces, borne, context)
    length, size = pieces.design.length, taken.config.mesh.size_mm
    law = measured.law
    if accuracy is not None:
        own = _numbers(taken, _bends(measured, limit.limits), context)
        law = corrected(law, Corrections.of(law.cells, own, limit, length))
        measured = replace(measured, law=law, limit=limit)
    return replace(measured, mesh_error=limit.error_of(law.cells, length, size))


def correction_of(pieces: ArmPieces, curves: Sequence[CellCurve], context: RunContext) -> Corrections:
    """To the limit of their mesh, of cells on `fine_pieces`, as `deliver_law` corrects them.

    pieces: those on the mesh of the arm. curves: at the pressures of the configuration; they may reach little farther
    than the state without moment. Raises as `find_limit`.
    """
    bends = {curve.pressure: curve.at(0.0)[0] for curve in curves}
    limit = _find_limit(pieces, bends, context)
    own = _numbers(fine_pieces(pieces), {p: bends[p] for p in limit.limits if p in bends}, context)
    return Corrections.of(curves, own, limit, pieces.design.length)


def tell_first(pieces: ArmPieces, context: RunContext) -> None:
    """Tell the arm without a load from single states of these pieces, unless nobody listens."""
    if isinstance(context.progress, Silent):
        return
    if states := first_states(ArmTasks(pieces, context), pieces.config.pressures_kPa):
        context.progress.remark(first_numbers(states, pieces.config.mesh.size_mm))


def fine_pieces(pieces: ArmPieces) -> ArmPieces:
    """The arm on the mesh of its law: its own if that is fine enough.

    On arms whose walls touch, a law on the coarse `p2p0` mesh of an arm, corrected in the same way, is off by 2 to 6 %
    of kappa_0 between the numbers that it is corrected by, on this mesh by 0.1 to 2 % (studies/cell.md).
    """
    own, mesh = pieces.config.mesh, fine_mesh(pieces)
    is_fine = own.formulation == mesh.formulation and own.size_mm <= mesh.size_mm
    return pieces if is_fine else pieces.with_mesh(mesh)


def fine_mesh(pieces: ArmPieces) -> MeshSettings:
    """The coarsest of the meshes from which the limit follows."""
    config = pieces.config
    return cell_mesh(config.design, config.material.law, config.poisson_ratio, config.effects.incompressibility.decided)


def _farthest(
    meshes: Sequence[ArmPieces], pressures_kPa: Sequence[float], context: RunContext
) -> tuple[MeasuredLaw, ArmPieces]:
    """The law on the first mesh that bears the pressures, or on that which bears most, and the pieces of it.

    A surface may buckle on a fine mesh where a coarse one cannot.
    """
    laws: list[tuple[MeasuredLaw, ArmPieces]] = []
    failure: InputError | RunFailed | None = None
    for own in meshes:
        try:
            measured = build_law(own, pressures_kPa, context)
        except (InputError, RunFailed) as failed:
            failure = failure or failed
            continue
        if not measured.failures:
            return measured, own
        laws.append((measured, own))
    if not laws and failure:
        raise failure
    return max(laws, key=lambda pair: pair[0].law.pressures[-1])


def _by_pressures(
    meshes: Sequence[ArmPieces], pressures_kPa: Sequence[float], context: RunContext
) -> tuple[Sequence[ArmPieces], Mapping[float, float]]:
    """The meshes without a first one whose cell bears fewer of the pressures, and without a second one like the first.

    With the curvatures without moment on the first of them, 1/mm by pressure; none where it bears no pressure.
    """
    if len({own.key for own in meshes}) == 1:
        meshes = meshes[:1]
    borne = []
    for own in meshes:
        try:
            borne.append(measurer_of_form(ArmTasks(own, context), Log(), pressures_kPa)[0].bends)
        except (InputError, RunFailed):
            borne.append({})
    first = 0 if len(borne[0]) >= len(borne[-1]) else 1
    return meshes[first:], borne[first]


def _at_limit(config: Config, bends: Mapping[float, float]) -> tuple[float, ...]:
    """Pressures at which the limit is found, kPa: some that were asked for, and the last one of all that are borne."""
    pressures = sorted({0.0, *bends})
    asked = [p for p in pressures if p in config.pressures_kPa or p == pressures[-1]]
    rows = np.unique(np.linspace(0, len(asked) - 1, PRESSURES).round().astype(int))
    return tuple(dict.fromkeys((0.0, *(asked[row] for row in rows))))


def _find_limit(pieces: ArmPieces, bends: Mapping[float, float], context: RunContext) -> MeshLimit:
    """Of an arm's cell at rest and these pressures; bends: curvatures without moment by all that are borne, 1/mm."""
    config, known = pieces.config, {0.0: 0.0, **bends}
    at = {p: known[p] for p in _at_limit(config, bends)}
    return find_limit(pieces.with_mesh(fine_mesh(pieces)), at, config.accuracy or inf, context)


def _bends(measured: MeasuredLaw, pressures_kPa: Collection[float]) -> dict[float, float]:
    """Curvatures without moment, 1/mm, by pressure."""
    return {cell.pressure: cell.at(0.0)[0] for cell in measured.law.cells if cell.pressure in pressures_kPa}


def _numbers(pieces: ArmPieces, bends: Mapping[float, float], context: RunContext) -> dict[float, Numbers]:
    """By those pressures that the cell bears."""
    tasks, numbers = ArmTasks(pieces, context), {}
    pending = {p: tasks.submit(solve_numbers, p, bend, pieces.design.length) for p, bend in bends.items()}
    for pressure, solved in pending.items():
        with suppress(PieceFailed):
            numbers[pressure] = solved.result().numbers
    return numbers
