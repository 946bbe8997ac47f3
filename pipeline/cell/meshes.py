"""The cell on finer and finer meshes: the limit of its numbers, and how far each mesh is from it.

A few states at each pressure say what a mesh makes of a law: where the cell stands without moment, what it takes to
bend it a little, and what to straighten it. They are solved on finer meshes, until the limit that follows is certain
enough. Limits are beside those of much finer meshes in studies/cell.md.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from math import copysign, hypot
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from fem.cell.piece import PieceFailed
from geometry import Reason
from pipeline.cell.measure import cell_without_moment
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.tasks import ArmTasks, PieceCurves
from pipeline.context import RunContext
from pipeline.errors import InputError
from pipeline.identification.richardson import Extrapolated, extrapolate
from pipeline.parallel import Pending
from pipeline.pressure import in_MPa, name_of_state
from pipeline.results.law import LawMeshError
from pipeline.results.values import SMALLEST_TURN
from pipeline.store.json_values import JsonObject
from pipeline.store.kept import kept

#: size of a mesh over that of the next finer one, and fewest meshes that are compared: two may agree by chance
RATIO, MESHES = 1.4, 3
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 60_000


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

    def error_of(self, pressures_kPa: Sequence[float], own: Mapping[float, Numbers], size_mm: float) -> LawMeshError:
        """Of a law with its own numbers by pressure, or in the limit where it has none.

        pressures_kPa: those that the law has; size_mm: of its mesh.
        """
        rows = [
            (pressure, own.get(pressure, limit), limit, std)
            for pressure, limit, std in zip(self.pressures_kPa, self.limits, self.stds, strict=True)
            if pressure > 0.0 and pressure in pressures_kPa
        ]
        columns: dict[str, Any] = {}
        for i, name in enumerate(("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")):
            columns[name] = tuple(numbers[i] for _, numbers, _, _ in rows)
            columns[f"{name}_std"] = tuple(hypot(n[i] - limit[i], std[i]) for _, n, limit, std in rows)
        return LawMeshError(size_mm, self.meshes[-1].size_mm, tuple(row[0] for row in rows), **columns)

    @property
    def remarks(self) -> tuple[Reason, ...]:
        """The error that is left, and why it is not smaller."""
        values = {"percent": 100.0 * self.requested, "size_mm": self.meshes[-1].size_mm}
        made = Reason("cell_accuracy", values | {"reached_percent": 100.0 * self.reached})
        return (made, *self.reasons)


Limits = tuple[Extrapolated, Extrapolated, Extrapolated]  #: of the numbers of a cell at one pressure


@dataclass(frozen=True)
class _Ladder:
    """The meshes that are tried, with the numbers that are known of them."""

    pieces: ArmPieces  #: on the coarsest mesh
    pressures: Sequence[float]  #: kPa
    context: RunContext
    #: by size in mm and pressure
    pending: dict[tuple[float, float], Pending[SolvedNumbers]] = field(default_factory=dict)
    solved: dict[float, dict[float, SolvedNumbers]] = field(default_factory=dict)  #: by pressure and size
    failures: dict[float, dict[float, str]] = field(default_factory=dict)  #: why there are none, by pressure and size

    def begin(self, size: float) -> None:
        """Begin to solve the numbers of a mesh at the pressures that coarser ones bear."""
        tasks = ArmTasks(self.pieces.with_mesh_size(size), self.context)
        for pressure in self.pressures:
            if pressure not in self.failures:
                self.pending[size, pressure] = tasks.submit(solve_numbers, pressure, self.pieces.design.length)

    def gather(self) -> None:
        """Wait for what was begun."""
        for size, pressure in sorted(self.pending, reverse=True):
            try:
                self.solved.setdefault(pressure, {})[size] = self.pending.pop((size, pressure)).result()
            except (PieceFailed, InputError) as failure:
                self.failures.setdefault(pressure, {})[size] = str(failure).rstrip(".")

    def limits(self) -> dict[float, Limits]:
        """The limits of the numbers by the pressures at which two meshes have some."""
        limits: dict[float, Limits] = {}
        for pressure, by_size in sorted(self.solved.items()):
            if len(by_size) >= 2:
                columns = np.array([known.numbers for known in by_size.values()]).T
                kappa_0, rigidity, moment = (extrapolate(list(by_size), column) for column in columns)
                limits[pressure] = kappa_0, rigidity, moment
        return limits

    def reached(self, limits: Mapping[float, Limits]) -> float:
        """The largest relative standard deviation of a limit."""
        return max(
            (
                number.limit_std / scale
                for row in limits.values()
                for number, scale in zip(row, numbers_of(row).over(self.pieces.design.length), strict=True)
            ),
            default=np.inf,
        )

    def why_no_finer(self) -> str:
        """A clause; empty where a finer mesh may be tried."""
        unknowns = [known.unknowns for by_size in self.solved.values() for known in by_size.values()]
        if max(unknowns, default=0) * RATIO**2 > MOST_UNKNOWNS:
            return f"a finer mesh has more than {MOST_UNKNOWNS} unknowns"
        return "no finer mesh bears the pressures" if self.failures.keys() >= {*self.pressures} - {0.0} else ""

    def meshes(self, limits: Mapping[float, Limits]) -> Iterator[CellMesh]:
        """The coarsest first."""
        length = self.pieces.design.length
        for size in sorted({size for by_size in self.solved.values() for size in by_size}, reverse=True):
            known = {p: by_size[size] for p, by_size in self.solved.items() if size in by_size}
            errors = [0.0]
            for p in limits.keys() & known.keys():
                limit = numbers_of(limits[p])
                errors += [abs(a - b) / s for a, b, s in zip(known[p].numbers, limit, limit.over(length), strict=True)]
            columns = [tuple(known[p].numbers[i] if p in known else None for p in limits) for i in range(3)]
            unknowns, seconds = max(k.unknowns for k in known.values()), sum(k.seconds for k in known.values())
            yield CellMesh(size, unknowns, max(errors), seconds, *columns)


def numbers_of(limits: Limits) -> Numbers:
    """In the limit."""
    kappa_0, rigidity, moment = (number.limit for number in limits)
    return Numbers(kappa_0, rigidity, moment)


def find_limit(pieces: ArmPieces, pressures_kPa: Sequence[float], accuracy: float, context: RunContext) -> MeshLimit:
    """The limit of the cell's numbers, from as many meshes as it takes for the accuracy, beginning with the given one.

    accuracy: relative, at every pressure.
    """
    ladder, size = _Ladder(pieces, sorted({0.0, *pressures_kPa}), context), pieces.config.mesh.size_mm
    context.progress.stage("finer meshes of the cell")
    for k in range(MESHES - 1):
        ladder.begin(size / RATIO**k)
    while True:
        ladder.begin(size / RATIO ** (MESHES - 1))
        ladder.gather()
        limits = ladder.limits()
        reached = ladder.reached(limits)
        why = "" if reached <= accuracy else ladder.why_no_finer()
        if reached <= accuracy or why:
            break
        size /= RATIO
    reasons = [Reason("cell_accuracy_missed", {"why": why})] if why else []
    for pressure, by_size in sorted(ladder.failures.items()):
        size, clause = max(by_size.items())
        reasons.append(Reason("cell_no_limit", {"pressure_kPa": pressure, "size_mm": size, "why": clause}))
    values = tuple(map(numbers_of, limits.values()))
    stds = tuple(Numbers(*(number.limit_std for number in row)) for row in limits.values())
    return MeshLimit(accuracy, reached, tuple(limits), values, stds, tuple(ladder.meshes(limits)), tuple(reasons))


def solve_numbers(curves: PieceCurves, pressure: float, length: float) -> SolvedNumbers:
    """The numbers of a cell at a pressure in kPa; length: mm, of the arm. A task. Raises `PieceFailed`."""

    def solve() -> SolvedNumbers:
        begin, piece = process_time(), curves.pieces.cell
        h, at = piece.body.length, cell_without_moment(piece, in_MPa(pressure)).state
        kappa_0 = at.angle / h
        change = -copysign(1.0 / length, kappa_0)
        bent = piece.solve(at.pressure, at.angle + change * h, at)
        straight = piece.solve(at.pressure, 0.0, bent if abs(kappa_0) > 1.0 / length else at)
        numbers = Numbers(kappa_0, (bent.moment - at.moment) / change, straight.moment - at.moment)
        return SolvedNumbers(numbers, 3 * len(piece.space.points), process_time() - begin)

    return kept(curves.store, curves.file(name_of_state("numbers", pressure)), SolvedNumbers, solve)
