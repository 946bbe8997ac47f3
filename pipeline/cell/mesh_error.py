"""What the mesh contributes to the error of the arm's own law: the cell on a second mesh of half the size.

A cell is cheap enough for a finer mesh, and that tells more than a coarser one: twice as coarse as the walls are thick,
walls bend and touch by other laws. Limits by both meshes are in studies/cell.md beside those of fine meshes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from fem.cell.piece import PieceFailed
from pipeline.cell.curves import ArmTasks, PieceCurves
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.refinement import MOST_UNKNOWNS
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.identification.richardson import extrapolate
from pipeline.pressure import in_MPa, name_of_state
from pipeline.store.json_values import JsonObject
from rod.arm_law.curves import CellCurve

#: size of the second mesh over that of the law
FINER = 0.5
#: largest number of points on that mesh over that of the law: walls are one or two elements thick on both, so that the
#: number grows like areas, not like volumes. Measured 2.1 to 3.4 on five configurations with 2.5 and 4 mm
MORE_POINTS = FINER**-2
#: the same where the finer mesh is too large or fails, and the configuration has no `mesh.coarser`
COARSER = 1.5
#: numbers of a cell at one pressure whose error is estimated, in the units of the key
NUMBERS = ("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")


@dataclass(frozen=True)
class MeshError:
    """Estimated errors of kappa_0, of the rigidity from there on and of the moment at half of kappa_0, by pressure.

    The rigidity is the mean over a change of the curvature by one over the length of the arm, or as far as the curve of
    the law reaches: where walls touch node by node, the slope at a point says more about the node than about the mesh.
    """

    size_mm: float
    second_mm: float  #: size of the other mesh; `reason` names pressures that are from a coarser one
    pressures_kPa: tuple[float, ...]
    values: dict[str, tuple[float, ...]]  #: on the mesh of the law
    deviations: dict[str, tuple[float, ...]]  #: standard deviations due to the mesh, in the same units
    reason: str = ""  #: why a second mesh is not the finer one, where, or pressures are missing, one sentence

    def record(self) -> JsonObject:
        """The key `mesh_error` of law.json."""
        deviations = {f"{name}_std": values for name, values in self.deviations.items()}
        return {
            "size_mm": self.size_mm,
            "second_mm": self.second_mm,
            "pressures_kPa": self.pressures_kPa,
            **self.values,
            **deviations,
            "reason": self.reason,
        }


def mesh_error(pieces: ArmPieces, cells: Sequence[CellCurve], unknowns: int, context: RunContext) -> MeshError:
    """The errors at those pressures of the configuration at which the law of a cell has been measured, and at its last.

    unknowns: displacement components of the cell. The moment is that at half of kappa_0. A second mesh that cannot be
    made or does not bear a pressure says so. At pressures that the finer mesh does not bear the errors come from a
    coarser one.
    """
    pressurised = [cell for cell in cells if cell.pressure in (*pieces.config.pressures_kPa, cells[-1].pressure)]
    if unknowns * MORE_POINTS > MOST_UNKNOWNS:
        finer, reason = None, f"a mesh of half the size has more than {MOST_UNKNOWNS} unknowns"
    else:
        finer = _estimated(pieces, pressurised, FINER, context)
        if len(finer.pressures_kPa) == len(pressurised):
            return finer
        reason = finer.reason
    known = finer.pressures_kPa if finer else ()
    missing = [cell for cell in pressurised if cell.pressure not in known]
    coarser = _estimated(pieces, missing, pieces.config.mesh.coarser or COARSER, context)
    at = " at " + ", ".join(f"{cell.pressure:g}" for cell in missing) + " kPa" if known else ""
    sentence = f"the error of the mesh{at} is estimated from a coarser one, which is less certain, because {reason}"
    both = _joined(finer, coarser) if finer is not None and known else coarser
    return replace(both, reason=f"{sentence}; {coarser.reason}" if coarser.reason else sentence)


def _joined(finer: MeshError, coarser: MeshError) -> MeshError:
    """The errors at the pressures of both, in ascending order; `second_mm` is that of the first."""
    order = sorted((*finer.pressures_kPa, *coarser.pressures_kPa))

    def of_both(name: str, part: str) -> tuple[float, ...]:
        by_pressure = {
            pressure: value
            for error in (finer, coarser)
            for pressure, value in zip(error.pressures_kPa, getattr(error, part)[name], strict=True)
        }
        return tuple(by_pressure[pressure] for pressure in order)

    values, deviations = ({name: of_both(name, part) for name in NUMBERS} for part in ("values", "deviations"))
    return replace(finer, pressures_kPa=tuple(order), values=values, deviations=deviations)


def _estimated(pieces: ArmPieces, cells: Sequence[CellCurve], factor: float, context: RunContext) -> MeshError:
    """From a second mesh, factor times as large, at the pressures that it bears."""
    size = pieces.config.mesh.element_size_mm
    length = pieces.design.length
    second = ArmTasks.of(pieces.with_mesh_size(factor * size), context)
    pending = [(cell, second.submit(_numbers_on, cell, change_of(cell, length))) for cell in cells]
    rows: dict[float, tuple[tuple[float, ...], tuple[float, ...]]] = {}
    reasons: dict[str, None] = {}  # in their order, each once
    for cell, on_second in pending:
        try:
            rows[cell.pressure] = _numbers(cell, change_of(cell, length)), on_second.result()
        except (PieceFailed, InputError) as failure:
            reasons[str(failure).rstrip(".")] = None
    columns = list(rows.values())
    return MeshError(
        size,
        factor * size,
        tuple(rows),
        {name: tuple(own[i] for own, _ in columns) for i, name in enumerate(NUMBERS)},
        {name: tuple(deviation(factor, own[i], other[i]) for own, other in columns) for i, name in enumerate(NUMBERS)},
        f"on the mesh of {factor * size:.3g} mm: {'; '.join(reasons)}" if reasons else "",
    )


def deviation(factor: float, value: float, second: float) -> float:
    """Standard deviation of a value due to its mesh: its distance from the limit, and the uncertainty of that."""
    limit = extrapolate((1.0, factor), (value, second))
    return math.hypot(value - limit.limit, limit.limit_std)


def change_of(cell: CellCurve, length: float) -> float:
    """The change of the curvature for the rigidity, 1/mm: not beyond the farther end of the curve."""
    kappa_0 = cell.at(0.0)[0]
    upward, downward = (min(1.0 / length, side) for side in (cell.kappa[-1] - kappa_0, kappa_0 - cell.kappa[0]))
    return float(upward if upward >= downward else -downward)


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


def _numbers_on(curves: PieceCurves, cell: CellCurve, change: float) -> tuple[float, ...]:
    """NUMBERS of the cell on another mesh, the moment at half of its kappa_0; a task. Raises `PieceFailed`.

    change: of the curvature, 1/mm.
    """
    pieces, store = curves.pieces, curves.store
    name = f"law/{name_of_state(f'mesh_{pieces.config.mesh.element_size_mm:.12g}mm', cell.pressure)}.json"
    kept = store.read_json(name)
    if kept is None or kept["key"] != store.numbers_key:
        piece = pieces.cell
        at, h = cell_without_moment(piece, in_MPa(cell.pressure)).state, piece.body.length
        angles = (at.angle + change * h, 0.5 * cell.at(0.0)[0] * h)
        bent, halved = (piece.solve(at.pressure, angle, at) for angle in angles)
        numbers = (at.angle / h, (bent.moment - at.moment) / change, halved.moment)
        kept = {"key": store.numbers_key, "numbers": numbers}
        store.save_json(name, kept)
    return tuple(kept["numbers"])
