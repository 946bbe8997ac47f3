"""The cell on other meshes: the error that the mesh makes of a law, and the mesh for a requested accuracy.

A cell is cheap enough for a second mesh of half the size, and that tells more than a coarser one: twice as coarse as
the walls are thick, walls bend and touch by other laws. Limits by both are in studies/cell.md beside those of fine
meshes.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from geometry import Reason
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.tasks import ArmTasks, PieceCurves
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed
from pipeline.identification.richardson import extrapolate
from pipeline.notes import render
from pipeline.pressure import in_MPa, name_of_state
from pipeline.results.law import LawMeshError
from pipeline.results.values import SMALLEST_TURN
from pipeline.store.json_values import JsonObject
from pipeline.store.kept import kept
from rod.arm_law.curves import CellCurve

#: size of the second mesh over that of the law
FINER = 0.5
#: largest number of points on that mesh over that of the law: walls are one or two elements thick on both, so that the
#: number grows like areas, not like volumes. Measured 2.1 to 3.4 on five configurations with 2.5 and 4 mm
MORE_POINTS = FINER**-2
#: the same where the finer mesh is too large or fails, and the configuration has no `mesh.coarser`
COARSER = 1.5
#: for a requested accuracy: size of a mesh over that of the next finer one, and fewest meshes that are compared: two
#: may agree by chance
RATIO, MESHES = 1.4, 3
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 60_000
#: numbers of a cell at one pressure whose error is estimated: kappa_0, the rigidity from there on and the moment at
#: half of kappa_0. The rigidity is the mean over a change of the curvature by one over the length of the arm, or as far
#: as the curve of the law reaches: where walls touch, the slope at a point says more about a node than about the mesh
NUMBERS = ("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")

Numbers = tuple[float, float, float]


def estimate_mesh_error(
    pieces: ArmPieces, cells: Sequence[CellCurve], unknowns: int, context: RunContext
) -> LawMeshError:
    """The errors of these cells.

    unknowns: displacement components of a cell. At pressures at which the finer mesh is too large or bears nothing
    the errors come from a coarser one; one that gives nothing either is left out.
    """
    rows: dict[float, tuple[Numbers, Numbers]] = {}
    if unknowns * MORE_POINTS > MOST_UNKNOWNS:
        why = f"a mesh of half the size has more than {MOST_UNKNOWNS} unknowns"
    else:
        rows, why = _compare(pieces, cells, FINER, context)
    missing, factor, reason = [cell for cell in cells if cell.pressure not in rows], FINER, ""
    if missing:
        coarser = pieces.config.mesh.coarser or COARSER
        factor = FINER if rows else coarser
        others, why_not = _compare(pieces, missing, coarser, context)
        why, at = "; ".join(filter(None, (why, why_not))), [cell.pressure for cell in missing]
        rows, reason = rows | others, render(Reason("cell_mesh_coarser", {"pressures_kPa": at, "why": why}))
    size, ordered = pieces.config.mesh.size_mm, sorted(rows)
    columns = {
        f"{name}{suffix}": tuple(rows[pressure][part][i] for pressure in ordered)
        for i, name in enumerate(NUMBERS)
        for part, suffix in enumerate(("", "_std"))
    }
    return LawMeshError(size, factor * size, tuple(ordered), **columns, reason=reason)


def _compare(
    pieces: ArmPieces, cells: Sequence[CellCurve], factor: float, context: RunContext
) -> tuple[dict[float, tuple[Numbers, Numbers]], str]:
    """Numbers and their standard deviations by pressure, from a mesh `factor` times as large, and why some lack."""
    size, length = factor * pieces.config.mesh.size_mm, pieces.design.length
    second = ArmTasks(pieces.with_mesh_size(size), context)
    pending = [(cell, second.submit(_solve_numbers, cell, change_of(cell, length))) for cell in cells]
    rows: dict[float, tuple[Numbers, Numbers]] = {}
    reasons: dict[str, None] = {}  # in their order, each once
    for cell, on_second in pending:
        try:
            own, other = numbers_of(cell, change_of(cell, length)), on_second.result()
        except (PieceFailed, InputError) as failure:
            reasons[str(failure).rstrip(".")] = None
            continue
        kappa_0, rigidity, moment = map(deviation, (factor,) * 3, own, other)
        rows[cell.pressure] = own, (kappa_0, rigidity, moment)
    return rows, f"on the mesh of {size:.3g} mm: {'; '.join(reasons)}" if reasons else ""


def deviation(factor: float, value: float, second: float) -> float:
    """Standard deviation of a value due to its mesh: its distance from the limit, and the uncertainty of that."""
    return extrapolate((1.0, factor), (value, second)).std_of(value)


def change_of(cell: CellCurve, length: float) -> float:
    """The change of the curvature for the rigidity, 1/mm: not beyond the farther end of the curve."""
    kappa_0 = cell.at(0.0)[0]
    upward, downward = (min(1.0 / length, side) for side in (cell.kappa[-1] - kappa_0, kappa_0 - cell.kappa[0]))
    return float(upward if upward >= downward else -downward)


def numbers_of(cell: CellCurve, change: float) -> Numbers:
    """NUMBERS of a curve; change: of the curvature, 1/mm."""
    kappa_0, _, _ = cell.at(0.0)
    return kappa_0, _moment_at(cell, kappa_0 + change) / change, _moment_at(cell, 0.5 * kappa_0)


def _moment_at(cell: CellCurve, kappa: float) -> float:
    """N mm, where the cubics of the curvature over the moment have a curvature in 1/mm, by bisection."""
    low, high = float(cell.moment[0]), float(cell.moment[-1])
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cell.at(middle)[0] < kappa else (low, middle)
    return 0.5 * (low + high)


def _solve_numbers(curves: PieceCurves, cell: CellCurve, change: float) -> Numbers:
    """NUMBERS of the cell on another mesh, the moment at half of its own kappa_0; a task. Raises `PieceFailed`.

    change: of the curvature, 1/mm.
    """

    def solve() -> Numbers:
        piece = curves.pieces.cell
        kappa_0, rigidity, at = _bend(piece, cell.pressure, change)
        return kappa_0, rigidity, piece.solve(at.pressure, 0.5 * cell.at(0.0)[0] * piece.body.length, at).moment

    name = name_of_state(f"law/mesh_{curves.pieces.config.mesh.size_mm:.12g}mm", cell.pressure)
    return kept(curves.store, f"{name}.json", Numbers, solve)


def _bend(piece: BendingPiece, pressure_kPa: float, change: float) -> tuple[float, float, PieceState]:
    """kappa_0 in 1/mm, the mean rigidity over a change of the curvature from there on, and the state at kappa_0."""
    at, h = cell_without_moment(piece, in_MPa(pressure_kPa)).state, piece.body.length
    bent = piece.solve(at.pressure, at.angle + change * h, at)
    return at.angle / h, (bent.moment - at.moment) / change, at


@dataclass(frozen=True)
class CellNumbers:
    """The cell at one pressure on one mesh."""

    size_mm: float
    degrees_of_freedom: int
    kappa_0_per_mm: float
    rigidity_N_mm2: float  #: mean over a change of the curvature by one over the length of the arm, from kappa_0 on


@dataclass(frozen=True)
class RefinedMesh:
    """The meshes that were tried for a requested accuracy, and the errors that are estimated for the last one."""

    requested: float
    pressure_kPa: float
    meshes: tuple[CellNumbers, ...]  #: the coarsest first
    estimated_kappa_0: float  #: relative error of kappa_0 on the last one
    estimated_rigidity: float
    reason: str = ""  #: why no finer mesh was tried although the accuracy is not reached

    @property
    def size_mm(self) -> float:
        """Of the mesh that was taken."""
        return self.meshes[-1].size_mm

    @property
    def is_reached(self) -> bool:
        """Whether both errors are within the requested one."""
        return max(self.estimated_kappa_0, self.estimated_rigidity) <= self.requested

    def record(self) -> JsonObject:
        """The key `accuracy` of law.json."""
        return {**asdict(self), "size_mm": self.size_mm, "is_reached": self.is_reached}

    @property
    def remarks(self) -> tuple[Reason, ...]:
        """The mesh and its errors, and why the accuracy is not reached."""
        errors = 100.0 * self.estimated_kappa_0, 100.0 * self.estimated_rigidity
        values = {"percent": 100.0 * self.requested, "size_mm": self.size_mm}
        values |= {"kappa_0_percent": errors[0], "rigidity_percent": errors[1]}
        missed = () if self.is_reached else (Reason("cell_accuracy_missed", {"why": self.reason}),)
        return (Reason("cell_accuracy", values), *missed)


def refine_mesh(pieces: ArmPieces, pressure: float, requested: float, context: RunContext) -> RefinedMesh:
    """Meshes of the cell from that of `pieces` on, at a pressure in kPa, until the estimated error is small enough.

    Raises RunFailed where fewer than MESHES of them bear the pressure.
    """
    length = pieces.design.length
    meshes: list[CellNumbers] = []
    size, reason = pieces.config.mesh.size_mm, ""

    def solve() -> CellNumbers:
        piece = pieces.with_mesh_size(size).cell
        kappa_0, rigidity, _ = _bend(piece, pressure, 1.0 / length)
        return CellNumbers(size, 3 * len(piece.space.points), kappa_0, rigidity)

    def error(name: str, least: float) -> float:
        values = [getattr(mesh, name) for mesh in meshes]
        return extrapolate([mesh.size_mm for mesh in meshes], values).error_std / max(abs(values[-1]), least)

    while True:
        context.progress.stage(f"cell with a mesh of {size:.3g} mm")
        try:
            meshes.append(kept(context.store, f"law/size_{size:.12g}mm.json", CellNumbers, solve))
        except (PieceFailed, InputError) as failure:
            reason = f"on a mesh of {size:.3g} mm: {str(failure).rstrip('.')}"
        else:
            size /= RATIO
            if meshes[-1].degrees_of_freedom * RATIO**2 > MOST_UNKNOWNS:
                reason = f"a finer mesh has more than {MOST_UNKNOWNS} unknowns"
        if len(meshes) >= MESHES:
            errors = error("kappa_0_per_mm", SMALLEST_TURN / length), error("rigidity_N_mm2", 0.0)
            refined = RefinedMesh(requested, pressure, tuple(meshes), *errors)
            if reason or refined.is_reached:
                return refined if refined.is_reached else replace(refined, reason=reason)
        elif reason:
            raise RunFailed(f"the error of the mesh cannot be estimated from fewer than {MESHES} meshes: {reason}")
