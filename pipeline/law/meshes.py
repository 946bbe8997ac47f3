"""The cell on finer and finer meshes: the limit of its numbers, and how far each mesh is from it.

A few states at each pressure say what a mesh makes of a law: where the cell stands without moment, what it takes to
bend it a little, and what to straighten it. They are solved on finer meshes, until the limit that follows is certain
enough. Limits are beside those of much finer meshes in studies/cell.md.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import hypot, inf, sqrt
from time import process_time
from typing import TypeVar

from fem.cell.lateral import lateral_rigidities
from fem.cell.piece import PieceFailed
from fem.cell.response import inflated
from fem.elements import MOST_ACCURATE
from fem.equations.linear import SingularMatrix
from geometry import Reason
from pipeline.law.mesh_limit import Across, CellMesh, MeshLimit, Numbers, change_for
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.pieces import ArmPieces
from pipeline.law.tasks import ArmTasks, PieceCurves
from pipeline.store.context import RunContext
from pipeline.store.kept import KeptFile
from pipeline.values.errors import InputError
from pipeline.values.pressure import in_MPa, name_of_state
from pipeline.values.richardson import extrapolate

#: size of a mesh over that of the next finer one, and fewest meshes that are compared: three may agree by chance
RATIO, MESHES = 1.4, 4
#: stated standard deviation over that of the extrapolation, and the least one, relative: meshes that are not nested
#: scatter. With these nine of ten true errors are below 1.65 stated ones (docs/cell.md)
INFLATED, LEAST_STD = 1.3, 0.0015
#: elements that are too soft where walls are about as thin as elements, as `mixed` ones are too stiff
SOFT = "p2p0"
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 30_000


@dataclass(frozen=True)
class SolvedNumbers:
    """The numbers of a cell at one pressure on one mesh, and what they took."""

    numbers: Numbers
    unknowns: int  #: displacement components
    seconds: float  #: of processor time
    across: Across | None = None  #: None: not measured


Compared = TypeVar("Compared", Numbers, Across)
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
        length = self.pieces.design.length
        solved = {p: {size: known.numbers for size, known in rows.items()} for p, rows in sorted(self.solved.items())}
        return {p: _limit(rows, lambda limit: limit.over(length)) for p, rows in solved.items() if len(rows) >= 2}

    def across(self) -> dict[float, tuple[Across, Across]]:
        """The same of the rigidities out of the plane."""
        solved = {
            p: {size: known.across for size, known in rows.items() if known.across}
            for p, rows in sorted(self.solved.items())
        }
        return {p: _limit(rows, lambda limit: limit) for p, rows in solved.items() if len(rows) >= 2}

    def soft(self, limits: Mapping[float, Limits]) -> dict[float, SolvedNumbers]:
        """What SOFT elements give on the finest mesh, at the pressures that they bear."""
        mesh = replace(self.pieces.config.mesh, formulation=SOFT, size_mm=self.sizes[-1])
        tasks, length = ArmTasks(self.pieces.with_mesh(mesh), self.context), self.pieces.design.length
        pending = {p: tasks.submit(solve_numbers, p, self.bends[p], length) for p in limits if p not in self.failures}
        solved = {}
        for pressure, numbers in pending.items():
            with suppress(PieceFailed):
                solved[pressure] = numbers.result()
        return solved

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
    across = ladder.across()
    if pieces.design.outer_corners and pieces.config.mesh.formulation == MOST_ACCURATE:
        for pressure, soft in ladder.soft(limits).items():
            limits[pressure] = halfway(*limits[pressure], soft.numbers)
            if soft.across and pressure in across:
                across[pressure] = halfway(*across[pressure], soft.across)
        reached = ladder.reached(limits)
        why = (why or f"{MOST_ACCURATE} and {SOFT} elements differ") if reached > accuracy else ""
    reasons = [Reason("cell_accuracy_missed", {"why": why})] if why else []
    for pressure, (failed, clause) in sorted(ladder.failures.items()):
        reasons.append(Reason("cell_no_limit", {"pressure_kPa": pressure, "size_mm": failed, "why": clause}))
    values, stds = (tuple(row[part] for row in limits.values()) for part in (0, 1))
    meshes = tuple(ladder.meshes(limits))
    return MeshLimit(accuracy, reached, tuple(limits), values, stds, meshes, across, tuple(reasons))


def _limit(by_size: Mapping[float, Compared], scales: Callable[[Compared], Compared]) -> tuple[Compared, Compared]:
    """The limit of numbers on meshes of two or more sizes, and stated standard deviations; scales: of a limit."""
    found = [extrapolate(list(by_size), column) for column in zip(*by_size.values(), strict=True)]
    kind = type(next(iter(by_size.values())))
    limit = kind(*(one.limit for one in found))
    stds = (hypot(INFLATED * one.limit_std, LEAST_STD * abs(of)) for one, of in zip(found, scales(limit), strict=True))
    return limit, kind(*stds)


def halfway(limit: Compared, stds: Compared, soft: Compared) -> tuple[Compared, Compared]:
    """Between a limit and other numbers, everywhere with the same probability."""
    rows = zip(limit, stds, soft, strict=True)
    moved = [(0.5 * (a + b), hypot(std, (a - b) / sqrt(12.0))) for a, std, b in rows]
    kind = type(limit)
    return kind(*(row[0] for row in moved)), kind(*(row[1] for row in moved))


def solve_numbers(curves: PieceCurves, pressure: float, bend: float, length: float) -> SolvedNumbers:
    """The numbers of a cell at a pressure in kPa; a task. Raises `PieceFailed`.

    bend: about the curvature without moment, 1/mm; length: mm, of the arm.
    """

    def solve() -> SolvedNumbers:
        begin, piece = process_time(), curves.pieces.cell
        h = piece.body.length
        near = inflated(piece, in_MPa(pressure), bend * h)
        point = cell_without_moment(piece, near.pressure, near)
        at, across = point.state, None
        if curves.pieces.config.law_in_space and piece.body.half:
            with suppress(SingularMatrix):
                found = lateral_rigidities(piece, at)
                across = Across(found.bending, found.torsion)
        kappa_0 = at.angle / h
        change = change_for(kappa_0, length)
        bent = piece.solve(at.pressure, at.angle + change * h, at)
        straight = piece.solve(at.pressure, 0.0, bent if abs(kappa_0) > 1.0 / length else at)
        numbers = Numbers(kappa_0, (bent.moment - at.moment) / change, straight.moment - at.moment)
        return SolvedNumbers(numbers, 3 * len(piece.space.points), process_time() - begin, across)

    file = curves.file(name_of_state("numbers", pressure))
    return KeptFile[SolvedNumbers].of_run(curves.store, file, SolvedNumbers).read_or_make(solve)
