"""The arm's own law at the limit of its mesh: measured on a fine mesh and corrected to the limit of finer ones."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import inf

import numpy as np

from fem.cell.piece import PieceFailed
from pipeline.cell.build import MeasuredLaw, build_law
from pipeline.cell.cells import measure_bends
from pipeline.cell.corrected import Corrections, corrected
from pipeline.cell.meshes import MeshLimit, Numbers, find_limit, solve_numbers
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.tasks import ArmTasks, Log
from pipeline.config.automatic_mesh import MeshSettings, cell_mesh
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed

#: pressures at which the limit is found, at most; corrections are interpolated between them
PRESSURES = 3


def deliver_law(pieces: ArmPieces, context: RunContext) -> MeasuredLaw:
    """The law of an arm at the pressures of its configuration, with its derivatives and the error of its mesh.

    pieces: those on the mesh of the arm. The law has the relative accuracy of the configuration in kappa_0, the
    rigidity and the moment that straightens the cell; where no mesh reaches it the best law is returned, whose `limit`
    says so. Without an accuracy it is the law on the mesh of the arm. Raises as `build_law`.
    """
    pressures_kPa, accuracy = pieces.config.pressures_kPa, pieces.config.accuracy
    if accuracy is None:
        return _law_on_mesh(pieces.with_derivatives(), pressures_kPa, context)
    measured, taken = _farthest(pieces, pressures_kPa, context)
    limit = _limit(pieces, measured, pressures_kPa, accuracy, context)
    length, size = pieces.design.length, taken.config.mesh.size_mm
    own = _numbers(taken, _bends(measured, limit.pressures_kPa), context)
    law = corrected(measured.law, Corrections.of(measured.law.cells, own, limit, length))
    return replace(measured, law=law, mesh_error=limit.error_of(law.cells, length, size), limit=limit)


def _law_on_mesh(pieces: ArmPieces, pressures_kPa: Sequence[float], context: RunContext) -> MeasuredLaw:
    """The law as `build_law` measures it on exactly the given mesh, with its error."""
    measured = build_law(pieces, pressures_kPa, context)
    limit = _limit(pieces, measured, pressures_kPa, inf, context)
    error = limit.error_of(measured.law.cells, pieces.design.length, pieces.config.mesh.size_mm)
    return replace(measured, mesh_error=error)


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


def _farthest(pieces: ArmPieces, pressures_kPa: Sequence[float], context: RunContext) -> tuple[MeasuredLaw, ArmPieces]:
    """The law on a fine mesh, or on that of the arm where only that one bears the pressures, and the pieces of it.

    A surface may buckle on a fine mesh where a coarse one cannot.
    """
    laws: list[tuple[MeasuredLaw, ArmPieces]] = []
    failure: InputError | RunFailed | None = None
    for own in _by_pressures([one.with_derivatives() for one in (fine_pieces(pieces), pieces)], pressures_kPa, context):
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
    pieces: Sequence[ArmPieces], pressures_kPa: Sequence[float], context: RunContext
) -> Sequence[ArmPieces]:
    """Two meshes without the first one where its cell bears fewer of the pressures; one where both are the same."""
    fine, own = pieces
    if fine.key == own.key:
        return [own]
    borne = []
    for one in pieces:
        try:
            borne.append(len(measure_bends(ArmTasks(one, context), Log(), pressures_kPa, None)))
        except (InputError, RunFailed):
            borne.append(0)
    return [own] if borne[0] < borne[1] else pieces


def _limit(
    pieces: ArmPieces, measured: MeasuredLaw, pressures_kPa: Sequence[float], accuracy: float, context: RunContext
) -> MeshLimit:
    """At rest, at some pressures of a law that were asked for, and at its last one."""
    pressures = measured.law.pressures
    asked = [pressure for pressure in pressures if pressure in pressures_kPa or pressure == pressures[-1]]
    rows = np.unique(np.linspace(0, len(asked) - 1, PRESSURES).round().astype(int))
    coarsest = pieces.with_mesh(fine_mesh(pieces))
    return find_limit(coarsest, _bends(measured, [0.0, *(asked[row] for row in rows)]), accuracy, context)


def _bends(measured: MeasuredLaw, pressures_kPa: Sequence[float]) -> dict[float, float]:
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
