"""The cell on finer and finer meshes: the limit of its numbers, and how far each mesh is from it.

A few states at each pressure say what a mesh makes of a law: where the cell stands without moment, what it takes to
bend it a little, and what to straighten it. They are solved on finer meshes, until the limit that follows is certain
enough. Limits are beside those of much finer meshes in studies/cell.md.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from math import copysign, hypot, inf, sqrt
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from fem.cell.piece import PieceFailed
from fem.cell.response import inflated
from fem.elements import MOST_ACCURATE
from geometry import Reason
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.tasks import ArmTasks, PieceCurves
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.identification.richardson import extrapolate
from pipeline.pressure import in_MPa, name_of_state
from pipeline.results.law import LawMeshError
from pipeline.results.values import SMALLEST_TURN
from pipeline.store.json_values import JsonObject
from pipeline.store.kept import kept
from rod.arm_law.curves import CellCurve

#: size of a mesh over that of the next finer one, and fewest meshes that are compared: three may agree by chance
RATIO, MESHES = 1.4, 4
#: stated standard deviation over that of the extrapolation, and the least one, relative: meshes that are not nested
#: scatter. With these nine of ten true errors are below 1.65 stated ones (docs/cell.md)
INFLATED, LEAST_STD = 1.3, 0.0015
#: elements that are too soft where walls are about as thin as elements, as `mixed` ones are too stiff
SOFT = "p2p0"
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 30_000


class Numbers(NamedTuple):
    """What a cell at one pressure is compared by."""

    kappa_0: float  #: curvature without moment, 1/mm
    #: N mm2, mean over a change of the curvature by one over the length of the arm, towards straight: where walls
    #: touch, the slope at a point says more about a node than about the mesh
    rigidity: float
    moment: float  #: that straightens the cell, N mm

    def over(self, length: float) -> "Numbers":
        """By what errors of these numbers are divided; those of an arm of `length` mm that hardly bends are larger."""
        turning = SMALLEST_TURN / length
        return Numbers(
            max(abs(self.kappa_0), turning), self.rigidity, max(abs(self.moment), turning * abs(self.rigidity))
        )


@dataclass(frozen=True)
class SolvedNumbers:
    """The numbers of a cell at one pressure on one mesh, and what they took."""

    numbers: Numbers
    unknowns: int  #: displacement components
    seconds: float  #: of processor time


@dataclass(frozen=True)
class CellMesh:
    """A mesh of the cell that was tried."""

    size_mm: float
    degrees_of_freedom: int
    error: float  #: largest relative distance of its numbers from their limits
    seconds: float  #: processor time
    kappa_0_per_mm: tuple[float | None, ...]  #: by pressure; None where the cell does not bear it
    rigidity_N_mm2: tuple[float | None, ...]
    moment_N_mm: tuple[float | None, ...]


@dataclass(frozen=True)
class MeshLimit:
    """The numbers of the cell in the limit of its mesh, and the meshes that they come from."""

    requested: float  #: relative error
    reached: float  #: largest relative standard deviation of a limit
    pressures_kPa: tuple[float, ...]  #: from rest on
    limits: tuple[Numbers, ...]  #: by pressure
    stds: tuple[Numbers, ...]
    meshes: tuple[CellMesh, ...]  #: the coarsest first
    reasons: tuple[Reason, ...] = ()  #: why finer meshes were not tried, and pressures without a limit

    @property
    def is_reached(self) -> bool:
        """Whether the error is within the requested one."""
        return self.reached <= self.requested

    def record(self) -> JsonObject:
        """The key `accuracy` of law.json."""
        common = {"requested": self.requested, "reached": self.reached, "is_reached": self.is_reached}
        return {**common, "pressures_kPa": self.pressures_kPa, "meshes": [asdict(mesh) for mesh in self.meshes]}

    def error_of(self, cells: Sequence[CellCurve], length: float, size_mm: float) -> LawMeshError:
        """Of a law on a mesh of that size: how far its numbers are from the limit, and how uncertain that is.

        length: mm, of the arm.
        """
        limits = {p: row for p, *row in zip(self.pressures_kPa, self.limits, self.stds, strict=True)}
        rows = []
        for cell in cells:
            if cell.pressure and (known := limits.get(cell.pressure)):
                own = numbers_on(cell, length, known[0])
                rows.append(
                    (cell.pressure, own, Numbers(*(hypot(a - b, c) for a, b, c in zip(own, *known, strict=True))))
                )
        columns: dict[str, Any] = {}
        for i, name in enumerate(("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")):
            columns[name] = tuple(own[i] for _, own, _ in rows)
            columns[f"{name}_std"] = tuple(std[i] for _, _, std in rows)
        return LawMeshError(size_mm, self.meshes[-1].size_mm, tuple(row[0] for row in rows), **columns)

    @property
    def remarks(self) -> tuple[Reason, ...]:
        """The error that is left, and why it is not smaller."""
        values = {"percent": 100.0 * self.requested, "size_mm": self.meshes[-1].size_mm}
        made = Reason("cell_accuracy", values | {"reached_percent": 100.0 * self.reached})
        return (made, *self.reasons)


Limits = tuple[Numbers, Numbers]  #: the numbers of a cell at one pressure in the limit, and their standard deviations


@dataclass(frozen=True)
class _Ladder:
    """The meshes that are tried, with the numbers that are known of them."""

    pieces: ArmPieces  #: on the coarsest mesh
    bends: Mapping[float, float]  #: about the curvatures without moment, 1/mm, by pressure in kPa
    context: RunContext
    sizes: list[float] = field(default_factory=list)  #: mm
    solved: dict[float, dict[float, SolvedNumbers]] = field(default_factory=dict)  #: by pressure and size
    #: the coarsest mesh on which a pressure is not borne, and why, by pressure
    failures: dict[float, tuple[float, str]] = field(default_factory=dict)

    def solve(self, size: float) -> None:
        """Find the numbers on a mesh at the pressures that coarser ones bear."""
        self.sizes.append(size)
        tasks, length = ArmTasks(self.pieces.with_mesh_size(size), self.context), self.pieces.design.length
        borne = [pressure for pressure in self.bends if pressure not in self.failures]
        name, progress = f"cell, mesh {size:.3g} mm", self.context.progress
        progress.experiment(name, borne)
        pending = [(p, tasks.submit(solve_numbers, p, self.bends[p], length)) for p in borne]
        for pressure, numbers in pending:
            try:
                known = self.solved.setdefault(pressure, {})[size] = numbers.result()
            except (PieceFailed, InputError) as failure:
                self.failures[pressure] = size, str(failure).rstrip(".")
                progress.stopped(name, [pressure], self.failures[pressure][1])
                continue
            progress.step_done(name, pressure, known.seconds)

    def limits(self) -> dict[float, Limits]:
        """The limits of the numbers by the pressures at which two meshes have some."""
        limits: dict[float, Limits] = {}
        for pressure, by_size in sorted(self.solved.items()):
            if len(by_size) >= 2:
                columns = np.array([known.numbers for known in by_size.values()]).T
                found = [extrapolate(list(by_size), column) for column in columns]
                limit = Numbers(*(number.limit for number in found))
                scales = limit.over(self.pieces.design.length)
                stds = [
                    hypot(INFLATED * number.limit_std, LEAST_STD * scale)
                    for number, scale in zip(found, scales, strict=True)
                ]
                limits[pressure] = limit, Numbers(*stds)
        return limits

    def between_kinds(self, limits: Mapping[float, Limits]) -> dict[float, Limits]:
        """The limits halfway to what SOFT elements give on the finest mesh, where they bear the pressure."""
        mesh = replace(self.pieces.config.mesh, formulation=SOFT, size_mm=self.sizes[-1])
        tasks, length = ArmTasks(self.pieces.with_mesh(mesh), self.context), self.pieces.design.length
        pending = {p: tasks.submit(solve_numbers, p, self.bends[p], length) for p in limits if p not in self.failures}
        moved = dict(limits)
        for pressure, numbers in pending.items():
            with suppress(PieceFailed):
                moved[pressure] = halfway(*limits[pressure], numbers.result().numbers)
        return moved

    def reached(self, limits: Mapping[float, Limits]) -> float:
        """The largest relative standard deviation of a limit."""
        length = self.pieces.design.length
        relative = [
            std / scale for row, stds in limits.values() for std, scale in zip(stds, row.over(length), strict=True)
        ]
        return max(relative, default=inf)

    def why_no_finer(self) -> str:
        """A clause; empty where a finer mesh may be tried."""
        unknowns = [known.unknowns for by_size in self.solved.values() for known in by_size.values()]
        if max(unknowns, default=0) * RATIO**2 > MOST_UNKNOWNS:
            return f"a finer mesh has more than {MOST_UNKNOWNS} unknowns"
        return "no finer mesh bears the pressures" if self.failures.keys() >= self.bends.keys() - {0.0} else ""

    def meshes(self, limits: Mapping[float, Limits]) -> Iterator[CellMesh]:
        """The coarsest first."""
        length = self.pieces.design.length
        for size in sorted({size for by_size in self.solved.values() for size in by_size}, reverse=True):
            known = {p: by_size[size] for p, by_size in self.solved.items() if size in by_size}
            errors = [0.0]
            for p in limits.keys() & known.keys():
                limit = limits[p][0]
                errors += [abs(a - b) / s for a, b, s in zip(known[p].numbers, limit, limit.over(length), strict=True)]
            columns = [tuple(known[p].numbers[i] if p in known else None for p in limits) for i in range(3)]
            unknowns, seconds = max(k.unknowns for k in known.values()), sum(k.seconds for k in known.values())
            yield CellMesh(size, unknowns, max(errors), seconds, *columns)


def find_limit(
    pieces: ArmPieces, bends: Mapping[float, float], accuracy: float, context: RunContext, fewest: int = MESHES
) -> MeshLimit:
    """The limit of the cell's numbers, from as many meshes as it takes for the accuracy, beginning with the given one.

    bends: about the curvatures without moment, 1/mm, by pressure in kPa; at rest zero. accuracy: relative, at every
    pressure. fewest: meshes that are compared at least.

    Meshes have `mixed` elements where the given one has SOFT ones, whose numbers do not converge steadily. Those of
    arms with gaps lie between the limit of the one kind and the finest mesh of the other (studies/cell.md).
    """
    if pieces.config.mesh.formulation == SOFT:
        pieces = pieces.with_mesh(replace(pieces.config.mesh, formulation=MOST_ACCURATE))
    ladder, size, why = _Ladder(pieces, bends, context), pieces.config.mesh.size_mm, ""
    while not why:
        ladder.solve(size)
        limits = ladder.limits()
        reached, size = ladder.reached(limits), size / RATIO
        if len(ladder.sizes) >= fewest and reached <= accuracy:
            break
        why = ladder.why_no_finer()
    if pieces.design.outer_corners and pieces.config.mesh.formulation == MOST_ACCURATE:
        limits = ladder.between_kinds(limits)
        reached = ladder.reached(limits)
        why = (why or f"{MOST_ACCURATE} and {SOFT} elements differ") if reached > accuracy else ""
    reasons = [Reason("cell_accuracy_missed", {"why": why})] if why else []
    for pressure, (failed, clause) in sorted(ladder.failures.items()):
        reasons.append(Reason("cell_no_limit", {"pressure_kPa": pressure, "size_mm": failed, "why": clause}))
    values, stds = (tuple(row[part] for row in limits.values()) for part in (0, 1))
    return MeshLimit(accuracy, reached, tuple(limits), values, stds, tuple(ladder.meshes(limits)), tuple(reasons))


def halfway(limit: Numbers, stds: Numbers, soft: Numbers) -> Limits:
    """Between a limit and other numbers, everywhere with the same probability."""
    rows = zip(limit, stds, soft, strict=True)
    moved = [(0.5 * (a + b), hypot(std, (a - b) / sqrt(12.0))) for a, std, b in rows]
    return Numbers(*(row[0] for row in moved)), Numbers(*(row[1] for row in moved))


def numbers_on(cell: CellCurve, length: float, unknown: Numbers) -> Numbers:
    """The numbers of a curve, those of `unknown` where it does not reach them; length: mm, of the arm."""
    kappa_0 = cell.at(0.0)[0]
    change = change_for(kappa_0, length)
    moment, bent = moment_at(cell, 0.0), moment_at(cell, kappa_0 + change)
    rigidity = unknown.rigidity if bent is None else bent / change
    return Numbers(kappa_0, rigidity, unknown.moment if moment is None else moment)


def moment_at(cell: CellCurve, kappa: float) -> float | None:
    """N mm, where the cubics of the curvature over the moment have a curvature in 1/mm; None beyond the curve."""
    low, high = float(cell.moment[0]), float(cell.moment[-1])
    if not cell.kappa[0] <= kappa <= cell.kappa[-1]:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cell.at(middle)[0] < kappa else (low, middle)
    return 0.5 * (low + high)


def change_for(kappa_0: float, length: float) -> float:
    """The change of the curvature for the rigidity, 1/mm; length: mm, of the arm."""
    return -copysign(1.0 / length, kappa_0)


def solve_numbers(curves: PieceCurves, pressure: float, bend: float, length: float) -> SolvedNumbers:
    """The numbers of a cell at a pressure in kPa; a task. Raises `PieceFailed`.

    bend: about the curvature without moment, 1/mm; length: mm, of the arm.
    """

    def solve() -> SolvedNumbers:
        begin, piece = process_time(), curves.pieces.cell
        h = piece.body.length
        near = inflated(piece, in_MPa(pressure), bend * h)
        at = cell_without_moment(piece, near.pressure, near).state
        kappa_0 = at.angle / h
        change = change_for(kappa_0, length)
        bent = piece.solve(at.pressure, at.angle + change * h, at)
        straight = piece.solve(at.pressure, 0.0, bent if abs(kappa_0) > 1.0 / length else at)
        numbers = Numbers(kappa_0, (bent.moment - at.moment) / change, straight.moment - at.moment)
        return SolvedNumbers(numbers, 3 * len(piece.space.points), process_time() - begin)

    return kept(curves.store, curves.file(name_of_state("numbers", pressure)), SolvedNumbers, solve)
