"""What the mesh contributes to the error of the arm's own law: the cell on a second, coarser mesh."""

from collections.abc import Sequence
from dataclasses import dataclass

from fem.cell.piece import PieceFailed
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.identification.richardson import extrapolated
from pipeline.store.json_values import JsonObject
from rod.arm_law.curves import CellCurve

#: size of the coarser mesh over that of the law, where the configuration has no `mesh.coarser`
COARSER = 1.5
#: numbers of a cell at one pressure whose error is estimated, in the units of the key
NUMBERS = ("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")


@dataclass(frozen=True)
class MeshError:
    """Estimated errors of kappa_0, of the rigidity from there on and of the moment at half of kappa_0, by pressure.

    The rigidity is the mean over a change of the curvature by one over the length of the arm: where walls touch node by
    node, the slope at a point says more about the node than about the mesh.
    """

    size_mm: float
    coarser_mm: float
    pressures_kPa: tuple[float, ...]
    values: dict[str, tuple[float, ...]]  #: on the mesh of the law
    deviations: dict[str, tuple[float, ...]]  #: standard deviations due to the mesh, in the same units
    reason: str = ""  #: why there are fewer than the law has pressures, one sentence

    def record(self) -> JsonObject:
        """The key `mesh_error` of law.json."""
        deviations = {f"{name}_std": values for name, values in self.deviations.items()}
        return {
            "size_mm": self.size_mm,
            "coarser_mm": self.coarser_mm,
            "pressures_kPa": self.pressures_kPa,
            **self.values,
            **deviations,
            "reason": self.reason,
        }


def mesh_error(pieces: ArmPieces, cells: Sequence[CellCurve], context: RunContext) -> MeshError:
    """The errors at those pressures of the configuration at which the law of a cell has been measured.

    The moment is that at half of kappa_0. A coarser mesh that cannot be made or does not bear a pressure says so.
    """
    mesh = pieces.config.mesh
    factor = mesh.coarser or COARSER
    size, coarser = mesh.element_size_mm, factor * mesh.element_size_mm
    pressurised = [cell for cell in cells if cell.pressure in pieces.config.pressures_kPa]
    change = 1.0 / pieces.design.length
    rows: list[tuple[tuple[float, ...], tuple[float, ...]]] = []
    reason = ""
    try:
        second = pieces.with_mesh_size(coarser)
        for cell in pressurised:
            rows.append((_numbers(cell, change), _coarse_numbers(second, cell, context, change)))
    except (PieceFailed, InputError) as failure:
        reason = f"on the mesh {factor:g} times as coarse: {failure}"
    estimates = [
        [extrapolated((size, coarser), pair) for pair in zip(fine, coarse, strict=True)] for fine, coarse in rows
    ]
    return MeshError(
        size,
        coarser,
        tuple(cell.pressure for cell in pressurised[: len(rows)]),
        {name: tuple(fine[i] for fine, _ in rows) for i, name in enumerate(NUMBERS)},
        {name: tuple(row[i].error_std for row in estimates) for i, name in enumerate(NUMBERS)},
        reason,
    )


def _numbers(cell: CellCurve, change: float) -> tuple[float, ...]:
    """change: of the curvature, 1/mm."""
    kappa_0, _, _ = cell.at(0.0)
    return kappa_0, _moment_at(cell, kappa_0 + change) / change, _moment_at(cell, 0.5 * kappa_0)


def _moment_at(cell: CellCurve, kappa: float) -> float:
    """N mm, where the cubics of the curvature over the moment have a curvature in 1/mm, by bisection."""
    low, high = float(cell.moment[0]), float(cell.moment[-1])
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cell.at(middle)[0] < kappa else (low, middle)
    return 0.5 * (low + high)


def _coarse_numbers(pieces: ArmPieces, cell: CellCurve, context: RunContext, change: float) -> tuple[float, ...]:
    """The same numbers of the cell on the coarser mesh, the moment at the same curvature."""
    store, name = context.store, f"law/coarser_{cell.pressure:.12g}kPa.json"
    kept = store.read_json(name)
    if kept is None or kept["key"] != store.numbers_key:
        piece = pieces.cell
        middle = cell_without_moment(piece, cell.pressure / 1000.0)
        h = piece.body.length
        at = middle.state
        bent, half = (
            piece.solve(at.pressure, angle, at) for angle in (at.angle + change * h, 0.5 * cell.at(0.0)[0] * h)
        )
        numbers = [at.angle / h, (bent.moment - at.moment) / change, half.moment]
        kept = {"key": store.numbers_key, "numbers": numbers}
        store.save_json(name, kept)
    return tuple(kept["numbers"])
