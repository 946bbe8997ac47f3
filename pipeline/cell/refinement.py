"""The mesh of the cell for a requested accuracy: finer and finer ones, until their numbers change little enough."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from fem.cell.piece import PieceFailed
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.context import RunContext
from pipeline.errors import InputError, RunFailed
from pipeline.identification.richardson import extrapolate
from pipeline.pressure import in_MPa
from pipeline.results.values import SMALLEST_TURN
from pipeline.store.json_values import JsonObject

#: size of a mesh over that of the next finer one
RATIO = 1.4
#: fewest meshes that are compared: two may agree by chance
MESHES = 3
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 60_000


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
    reason: str  #: why no finer mesh was tried although the accuracy is not reached; one sentence

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
    def sentence(self) -> str:
        """For the terminal."""
        sizes = ", ".join(f"{numbers.size_mm:.3g}" for numbers in self.meshes)
        reached = "reached" if self.is_reached else f"not reached: {self.reason}"
        return (
            f"requested accuracy {100 * self.requested:g} % is {reached}; meshes of {sizes} mm were compared, and that "
            f"of {self.size_mm:.3g} mm was taken; its estimated errors at {self.pressure_kPa:g} kPa are "
            f"{100 * self.estimated_kappa_0:.2g} % of κ₀ and {100 * self.estimated_rigidity:.2g} % of the rigidity"
        )


def refined_mesh(pieces: ArmPieces, context: RunContext, requested: float) -> RefinedMesh:
    """Meshes of the cell from that of `pieces` on, at the highest pressure, until the estimated error is small enough.

    Raises RunFailed where the coarsest mesh bears no such pressure, and InputError where it cannot be made.
    """
    pressure = pieces.config.pressures_kPa[-1]
    meshes: list[CellNumbers] = []
    size, reason = pieces.config.mesh.element_size_mm, ""
    while not reason:
        context.progress.stage(f"cell with a mesh of {size:.3g} mm")
        try:
            meshes.append(_numbers(pieces, context, size, pressure))
        except (PieceFailed, InputError) as failure:
            reason = f"on a mesh of {size:.3g} mm: {str(failure).rstrip('.')}"
            break
        result = _estimated(pieces, meshes, requested, "")
        if result is not None and result.is_reached:
            return result
        size /= RATIO
        if meshes[-1].degrees_of_freedom * RATIO**2 > MOST_UNKNOWNS:
            reason = f"a finer mesh has more than {MOST_UNKNOWNS} unknowns"
    result = _estimated(pieces, meshes, requested, reason)
    if result is None:
        raise RunFailed(f"the error of the mesh cannot be estimated from fewer than {MESHES} meshes: {reason}")
    return result


def _numbers(pieces: ArmPieces, context: RunContext, size: float, pressure: float) -> CellNumbers:
    store, name = context.store, f"law/size_{size:.12g}mm.json"
    kept = store.read_json(name)
    if kept is None or kept["key"] != store.numbers_key:
        piece = pieces.with_mesh_size(size).cell
        middle = cell_without_moment(piece, in_MPa(pressure))
        h, change = piece.body.length, 1.0 / pieces.design.length
        bent = piece.solve(middle.state.pressure, middle.state.angle + change * h, middle.state)
        numbers = CellNumbers(
            size, 3 * len(piece.space.points), middle.state.angle / h, (bent.moment - middle.moment) / change
        )
        kept = {"key": store.numbers_key, **asdict(numbers)}
        store.save_json(name, kept)
    return CellNumbers(**{key: value for key, value in kept.items() if key != "key"})


def _estimated(pieces: ArmPieces, meshes: Sequence[CellNumbers], requested: float, reason: str) -> RefinedMesh | None:
    """The errors of the last mesh by extrapolation over all of them; None for too few meshes."""
    if len(meshes) < MESHES:
        return None
    last, sizes = meshes[-1], [mesh.size_mm for mesh in meshes]

    def error(name: str, over: float) -> float:
        return extrapolate(sizes, [getattr(mesh, name) for mesh in meshes]).error_std / over

    return RefinedMesh(
        requested,
        pieces.config.pressures_kPa[-1],
        tuple(meshes),
        error("kappa_0_per_mm", max(abs(last.kappa_0_per_mm), SMALLEST_TURN / pieces.design.length)),
        error("rigidity_N_mm2", abs(last.rigidity_N_mm2)),
        reason,
    )
