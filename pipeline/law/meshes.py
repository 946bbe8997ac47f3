"""The cell on finer and finer meshes: the limit of its numbers, and how far each mesh is from it.

A few states at each pressure say what a mesh makes of a law: where the cell stands without moment, what it takes to
bend it a little, and what to straighten it. They are solved on finer meshes, until the limit that follows is certain
enough. Limits are beside those of much finer meshes in studies/cell.md.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import hypot, inf, sqrt
from time import process_time

import numpy as np

from fem.cell.lateral import lateral_rigidities
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import MAX_FAILURES, inflated
from fem.elements import MOST_ACCURATE
from fem.equations.linear import SingularMatrix
from fem.post.mapped import fields_of, mapped, moved
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.mesh_limit import PLANE, CellMesh, Limits, MeshLimit, Numbers, change_for, scales_of
from pipeline.law.piece.measure import cell_without_moment
from pipeline.law.pieces import ArmPieces
from pipeline.law.tasks import ArmTasks, PieceCurves
from pipeline.store.context import RunContext
from pipeline.values.errors import InputError
from pipeline.values.pressure import in_MPa
from pipeline.values.richardson import Limit, extrapolate_all
from rod.arm_law.curves import ACROSS

#: size of a mesh over that of the next finer one, and fewest meshes that are compared: three may agree by chance
RATIO, MESHES = 1.4, 4
#: stated standard deviation over that of the extrapolation, and the least one, relative: meshes that are not nested
#: scatter. With these nine of ten true errors are below 1.65 stated ones (docs/cell.md)
INFLATED, LEAST_STD = 1.3, 0.0015
#: elements that are too soft where walls are about as thin as elements, as `mixed` ones are too stiff
SOFT = "p2p0"
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 30_000
#: how often an increment to a pressure may fail on a mesh that does not bear the state of the one before
FEW_FAILURES = 4


@dataclass(frozen=True)
class SolvedNumbers:
    """The numbers of a cell at one pressure on one mesh, and what they took."""

    numbers: Numbers
    unknowns: int  #: displacement components
    seconds: float  #: of processor time


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
        coarser = self.mesh_name(-2) if len(self.sizes) > 1 else ""
        borne = [pressure for pressure in self.bends if pressure not in self.failures]
        name, progress = f"cell, mesh {size:.3g} mm", self.context.progress
        progress.experiment(name, borne)
        pending = [(p, tasks.submit(solve_numbers, p, self.bends[p], length, coarser)) for p in borne]
        for pressure, numbers in pending:
            try:
                known = self.solved.setdefault(pressure, {})[size] = numbers.result()
            except (PieceFailed, InputError) as failure:
                self.failures[pressure] = size, str(failure).rstrip(".")
                progress.stopped(name, [pressure], self.failures[pressure][1])
                continue
            progress.step_done(name, pressure, known.seconds)

    def mesh_name(self, number: int) -> str:
        """Of the mesh of that number."""
        return self.pieces.with_mesh_size(self.sizes[number]).mesh_name

    def limits(self) -> dict[float, Limits]:
        """The limits of the numbers by the pressures at which two meshes have some."""
        length = self.pieces.design.length
        return {p: _limits(by_size, length) for p, by_size in sorted(self.solved.items()) if len(by_size) >= 2}

    def soft(self, limits: Mapping[float, Limits]) -> dict[float, SolvedNumbers]:
        """What SOFT elements give on the finest mesh, at the pressures that they bear."""
        mesh = replace(self.pieces.config.mesh, formulation=SOFT, size_mm=self.sizes[-1])
        tasks, length = ArmTasks(self.pieces.with_mesh(mesh), self.context), self.pieces.design.length
        borne, same = [p for p in limits if p not in self.failures], self.mesh_name(-1)
        pending = {p: tasks.submit(solve_numbers, p, self.bends[p], length, same) for p in borne}
        solved = {}
        for pressure, numbers in pending.items():
            with suppress(PieceFailed):
                solved[pressure] = numbers.result()
        return solved

    def reached(self, limits: Mapping[float, Limits]) -> float:
        """The largest relative standard deviation of a limit in the plane."""
        rows = [(row, scales_of(row, self.pieces.design.length)) for row in limits.values()]
        return max((row[name].std / scales[name] for row, scales in rows for name in PLANE), default=inf)

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
                row, scales = limits[p], scales_of(limits[p], length)
                errors += [abs(known[p].numbers[name] - row[name].value) / scales[name] for name in PLANE]
            columns = [tuple(known[p].numbers[name] if p in known else None for p in limits) for name in PLANE]
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
        for pressure, soft in ladder.soft(limits).items():
            own = limits[pressure]
            moved = {name: halfway(own[name], number) for name, number in soft.numbers.items() if name in own}
            limits[pressure] = {**own, **moved}
        reached = ladder.reached(limits)
        why = (why or f"{MOST_ACCURATE} and {SOFT} elements differ") if reached > accuracy else ""
    reasons = [Reason("cell_accuracy_missed", {"why": why})] if why else []
    for pressure, (failed, clause) in sorted(ladder.failures.items()):
        reasons.append(Reason("cell_no_limit", {"pressure_kPa": pressure, "size_mm": failed, "why": clause}))
    return MeshLimit(accuracy, reached, limits, tuple(ladder.meshes(limits)), tuple(reasons))


def _limits(by_size: Mapping[float, SolvedNumbers], length: float) -> dict[str, Limit]:
    """Of the numbers that two meshes have at least, with stated standard deviations."""
    found = extrapolate_all({size: known.numbers for size, known in by_size.items()})
    limits = {name: Limit(one.limit, INFLATED * one.limit_std) for name, one in found.items()}
    least = {name: LEAST_STD * scale for name, scale in scales_of(limits, length).items()}
    return {name: Limit(one.value, hypot(one.std, least[name])) for name, one in limits.items()}


def halfway(limit: Limit, soft: float) -> Limit:
    """Between a limit and another number, everywhere with the same probability."""
    return Limit(0.5 * (limit.value + soft), hypot(limit.std, (limit.value - soft) / sqrt(12.0)))


def solve_numbers(curves: PieceCurves, pressure: float, bend: float, length: float, coarser: str = "") -> SolvedNumbers:
    """The numbers of a cell at a pressure in kPa; a task. Raises `PieceFailed`.

    bend: about the curvature without moment, 1/mm; length: mm, of the arm. coarser: name of a mesh whose states are
    mapped to this one, where Newton's method then starts.
    """

    def solve() -> SolvedNumbers:
        begin, piece = process_time(), curves.pieces.cell
        h, known = piece.body.length, _Mapped.of(curves, coarser, pressure)
        at = cell_without_moment(piece, in_MPa(pressure), known.first(bend * h)).state
        across = dict[str, float]()
        if curves.pieces.config.law_in_space and piece.body.half:
            with suppress(SingularMatrix):
                found = lateral_rigidities(piece, at)
                across = dict(zip(ACROSS, (found.bending, found.torsion), strict=True))
        kappa_0 = at.angle / h
        change = change_for(kappa_0, length)
        bent = known.bent(1, at.angle + change * h, at, at)
        straight = known.bent(2, 0.0, at, bent if abs(kappa_0) > 1.0 / length else at)
        values = kappa_0, (bent.moment - at.moment) / change, straight.moment - at.moment
        numbers = dict(zip(PLANE, values, strict=True)) | across
        if curves.pieces.config.mesh.formulation != SOFT:
            fields = np.hstack([fields_of(piece.space, one.state) for one in (at, bent, straight)])
            mesh = {"points": piece.space.points, "nodes": piece.space.nodes, "fields": fields}
            angles = np.array([at.angle, bent.angle, straight.angle])
            curves.store.save_state(curves.pieces.mesh_name, pressure, angles=angles, **mesh)
        return SolvedNumbers(numbers, 3 * len(piece.space.points), process_time() - begin)

    return curves.number(SolvedNumbers, "numbers", pressure, solve)


@dataclass(frozen=True, eq=False)  # arrays inside
class _Mapped:
    """The three states of a cell at one pressure as a coarser mesh has them: where Newton's method starts."""

    piece: BendingPiece
    pressure: float  #: MPa
    angles: Array  #: (3,) rad, without moment, bent and straight; (0,) where no coarser mesh is known
    fields: Array  #: (3, n, 10) of them at the nodes of the piece (`fem.post.mapped.fields_of`)

    @staticmethod
    def of(curves: PieceCurves, coarser: str, pressure: float) -> "_Mapped":
        """Nothing where the states on the mesh of that name are not known."""
        piece, known = curves.pieces.cell, curves.store.load_state(coarser, pressure) if coarser else None
        if known is None:
            return _Mapped(piece, in_MPa(pressure), np.empty(0), np.empty((0, 0, 10)))
        fields = mapped(known["points"], known["nodes"], known["fields"], piece.space.points)
        return _Mapped(piece, in_MPa(pressure), known["angles"], np.stack(np.split(fields, 3, axis=1)))

    def first(self, angle: float) -> PieceState:
        """A state near that without moment; angle: rad, at which it is solved from rest where nothing is mapped."""
        piece, rest, is_known = self.piece, self.piece.rest(), len(self.angles) > 0
        with suppress(PieceFailed):
            if is_known and self.pressure:
                predicted = moved(piece.system, rest.state, self.fields[0], self.pressure)
                return piece.solve_near(self.pressure, float(self.angles[0]), predicted, rest)
        return inflated(piece, self.pressure, angle, failures=FEW_FAILURES if is_known else MAX_FAILURES)

    def bent(self, number: int, angle: float, at: PieceState, start: PieceState) -> PieceState:
        """The state of that number at an angle in rad, by the mapped way, else from `start`."""
        if not len(self.angles) or self.angles[number] == self.angles[0]:
            return self.piece.solve(self.pressure, angle, start)
        part = (angle - at.angle) / float(self.angles[number] - self.angles[0])
        change = part * (self.fields[number] - self.fields[0])
        return self.piece.solve(self.pressure, angle, start, moved(self.piece.system, at.state, change, self.pressure))
