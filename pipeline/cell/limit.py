"""The arm's own law at the limit of its mesh: measured on a fine mesh and corrected to the limit of finer ones."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from math import inf

from fem.cell.piece import PieceFailed
from pipeline.cell.build import MeasuredLaw, build_law
from pipeline.cell.corrected import Corrections, corrected
from pipeline.cell.meshes import Numbers, find_limit, solve_numbers
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.tasks import ArmTasks
from pipeline.config.automatic_mesh import GivenMesh, chosen_mesh
from pipeline.context import RunContext

#: largest relative error of a delivered law unless another one is requested
ACCURACY = 0.01


def deliver_law(
    pieces: ArmPieces,
    pressures_kPa: Sequence[float],
    context: RunContext,
    highest_kPa: Callable[[], float] | None = None,
    accuracy: float = ACCURACY,
) -> MeasuredLaw:
    """The law of an arm as `build_law` measures it, but on a mesh of its own, and corrected to the limit of finer ones.

    pieces: those on the mesh of the arm. accuracy: relative, of kappa_0, the rigidity and the moment that straightens
    the cell at each pressure; where no mesh reaches it the best law is returned, whose `limit` says so. Raises as
    `build_law`.
    """
    fine = fine_pieces(pieces).with_derivatives()
    measured = build_law(fine, pressures_kPa, context, highest_kPa)
    limit = find_limit(fine, _compared(measured, pressures_kPa), accuracy, context)
    own = _numbers(fine, limit.pressures_kPa, context)
    law = corrected(measured.law, Corrections.between(own, limit))
    error = limit.error_of(law.pressures, {}, fine.config.mesh.size_mm)
    return replace(measured, law=law, mesh_error=error, limit=limit)


def law_on_mesh(
    pieces: ArmPieces,
    pressures_kPa: Sequence[float],
    context: RunContext,
    highest_kPa: Callable[[], float] | None = None,
) -> MeasuredLaw:
    """The law as `build_law` measures it on exactly the given mesh, with its error. Raises as `build_law`."""
    measured = build_law(pieces, pressures_kPa, context, highest_kPa)
    limit = find_limit(fine_pieces(pieces), _compared(measured, pressures_kPa), inf, context)
    own = _numbers(pieces, limit.pressures_kPa, context)
    borne = [pressure for pressure in measured.law.pressures if pressure in own]
    return replace(measured, mesh_error=limit.error_of(borne, own, pieces.config.mesh.size_mm))


def fine_pieces(pieces: ArmPieces) -> ArmPieces:
    """The same arm on the mesh that the program would choose for it, or one as fine as its own."""
    config = pieces.config
    against_locking = config.effects.incompressibility.decided
    mesh = chosen_mesh(config.design, config.material.law, config.poisson_ratio, against_locking, GivenMesh())
    size = min(mesh.size_mm, config.mesh.size_mm)
    return pieces.with_mesh(replace(mesh, size_mm=size, coarser=config.mesh.coarser))


def _compared(measured: MeasuredLaw, pressures_kPa: Sequence[float]) -> list[float]:
    """The pressures of a law that were asked for, and its last one."""
    pressures = measured.law.pressures
    return [pressure for pressure in pressures if pressure in pressures_kPa or pressure == pressures[-1]]


def _numbers(pieces: ArmPieces, pressures_kPa: Sequence[float], context: RunContext) -> Mapping[float, Numbers]:
    """By those pressures that the cell bears."""
    tasks, numbers = ArmTasks(pieces, context), {}
    pending = {pressure: tasks.submit(solve_numbers, pressure, pieces.design.length) for pressure in pressures_kPa}
    for pressure, solved in pending.items():
        with suppress(PieceFailed):
            numbers[pressure] = solved.result().numbers
    return numbers
