"""The cell on finer and finer meshes: the limit of its numbers, and how far each mesh is from it.

A few states at each pressure say what a mesh makes of a law: where the cell stands without moment, what it takes to
bend it a little, and what to straighten it. They are solved on finer meshes, until the limit that follows is certain
enough. Limits are beside those of much finer meshes in studies/cell.md.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import hypot, inf
from time import process_time

import numpy as np

from fem.cell.inflation import MAX_FAILURES, along_air, bent, unloaded
from fem.cell.lateral import lateral_rigidities
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.elements import MOST_ACCURATE
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.post.mapped import fields_of, mapped, moved
from geometry import Reason
from geometry.arrays import Array
from pipeline.law.mesh_limit import (
    PLANE,
    CellMesh,
    Limits,
    MeshLimit,
    Numbers,
    change_for,
    halfway,
    limits_of,
    scales_of,
)
from pipeline.law.piece.measure import CellPoint, cell_without_moment
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.point import stable, without_moment
from pipeline.law.piece.tasks import ArmTasks, PieceCurves
from pipeline.store.context import RunContext
from pipeline.values.errors import InputError
from pipeline.values.pressure import in_MPa
from pipeline.values.richardson import Limit
from pipeline.values.run import SMALLEST_TURN
from rod.arm_law.curves import ACROSS

#: size of a mesh over that of the next finer one, and fewest meshes that are compared: three may agree by chance
RATIO, MESHES = 1.4, 4
#: elements that are too soft where walls are about as thin as elements, as `mixed` ones are too stiff
SOFT = "p2p0"
#: displacement components of a cell beyond which no finer one is tried
MOST_UNKNOWNS = 30_000
#: part of the bend up to which a state stands for that without moment, to which its numbers are moved to first order
CLOSE = 0.005
#: how often an increment to a pressure may fail on a mesh that does not bear the state of the one before
FEW_FAILURES = 2


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
    accuracy: float  #: relative
    fewest: int  #: meshes for the highest pressure at least; others have one less
    sizes: list[float] = field(default_factory=list)  #: mm
    solved: dict[float, dict[float, SolvedNumbers]] = field(default_factory=dict)  #: by pressure and size
    #: the coarsest mesh on which a pressure is not borne, and why, by pressure
    failures: dict[float, tuple[float, str]] = field(default_factory=dict)

    def solve(self, size: float) -> None:
        """Find the numbers on a mesh at the pressures that need it, and that coarser ones bear."""
        self.sizes.append(size)
        tasks, length = ArmTasks(self.pieces.with_mesh_size(size), self.context), self.pieces.design.length
        needed = self.uncertain()
        name, progress = f"cell, mesh {size:.3g} mm", self.context.progress
        progress.experiment(name, needed)
        coarser = {
            p: self.pieces.with_mesh_size(min(self.solved[p])).mesh_name if p in self.solved else "" for p in needed
        }
        pending = [(p, tasks.submit(solve_numbers, p, self.bends[p], length, coarser[p])) for p in needed]
        for pressure, numbers in pending:
            try:
                known = self.solved.setdefault(pressure, {})[size] = numbers.result()
            except (PieceFailed, InputError) as failure:
                self.failures[pressure] = size, str(failure).rstrip(".")
                progress.stopped(name, [pressure], self.failures[pressure][1])
                continue
            progress.step_done(name, pressure, known.seconds)

    def uncertain(self) -> list[float]:
        """The pressures with too few meshes or a limit that is not known to the accuracy, unless a mesh failed."""
        limits, borne = self.limits(), [p for p in self.bends if p not in self.failures]
        few = [p for p in borne if len(self.solved.get(p, ())) < max(2, self.fewest - (p < max(borne)))]
        return [p for p in borne if p in few or self.reached({p: limits[p]}) > self.accuracy]

    def limits(self) -> dict[float, Limits]:
        """The limits of the numbers by the pressures at which two meshes have some.

        A pressure without the finest meshes has what these change at the highest one with them as a part of its
        deviations.
        """
        length, known = self.pieces.design.length, {p: self.solved[p] for p in sorted(self.solved)}
        numbers = {p: {s: one.numbers for s, one in rows.items()} for p, rows in known.items() if len(rows) > 1}
        limits: dict[float, Limits] = {p: limits_of(by_size, length) for p, by_size in numbers.items()}
        finest = max(numbers, key=lambda p: (len(numbers[p]), p), default=0.0)
        for p, own in limits.items():
            as_fine = {s: one for s, one in numbers[finest].items() if s >= min(numbers[p])}
            if 1 < len(as_fine) < len(numbers[finest]):
                before, scales, units = (
                    limits_of(as_fine, length),
                    scales_of(own, length),
                    scales_of(limits[finest], length),
                )
                changes = {n: scales[n] * (limits[finest][n].value - before[n].value) / units[n] for n in before}
                limits[p] = {n: Limit(one.value, hypot(one.std, changes.get(n, 0.0))) for n, one in own.items()}
        return limits

    def soft(self, limits: Mapping[float, Limits]) -> dict[float, dict[str, float]]:
        """About what SOFT elements give on the finest mesh of each pressure that they bear.

        Both kinds of elements are taken to change by the same from the mesh before, on which these are solved.
        """
        length, mesh, pending, found = self.pieces.design.length, self.pieces.config.mesh, {}, {}
        for p in limits:
            finest, size = sorted(self.solved[p])[:2]
            tasks = ArmTasks(self.pieces.with_mesh(replace(mesh, formulation=SOFT, size_mm=size)), self.context)
            same, after, before = (
                self.pieces.with_mesh_size(size).mesh_name,
                self.solved[p][finest],
                self.solved[p][size],
            )
            change = {n: value - before.numbers[n] for n, value in after.numbers.items() if n in before.numbers}
            pending[p] = change, tasks.submit(solve_numbers, p, self.bends[p], length, same)
        for p, (changes, soft) in pending.items():
            with suppress(PieceFailed):
                found[p] = {n: value + changes[n] for n, value in soft.result().numbers.items() if n in changes}
        return found

    def reached(self, limits: Mapping[float, Limits]) -> float:
        """The largest relative standard deviation of a limit in the plane."""
        rows = [(row, scales_of(row, self.pieces.design.length)) for row in limits.values()]
        return max((row[name].std / scales[name] for row, scales in rows for name in PLANE), default=inf)

    def why_no_finer(self) -> str:
        """A clause; empty where a finer mesh may be tried."""
        unknowns = [known.unknowns for by_size in self.solved.values() for known in by_size.values()]
        if max(unknowns, default=0) * RATIO**2 > MOST_UNKNOWNS:
            return f"a finer mesh has more than {MOST_UNKNOWNS} unknowns"
        no_more = self.failures.keys() >= self.bends.keys() - {0.0} or not self.uncertain()
        return "no finer mesh bears the pressures" if no_more else ""

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

    Pressures below the highest one have no finer mesh than they need. Meshes have `mixed` elements where the given one
    has SOFT ones, whose numbers do not converge steadily. Those of arms with gaps lie between the limit of the one kind
    and the finest mesh of the other (studies/cell.md).
    """
    if pieces.config.mesh.formulation == SOFT:
        pieces = pieces.with_mesh(replace(pieces.config.mesh, formulation=MOST_ACCURATE))
    ladder, size, why = _Ladder(pieces, bends, context, accuracy, fewest), pieces.config.mesh.size_mm, ""
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
            moved = {name: halfway(own[name], number) for name, number in soft.items() if name in own}
            limits[pressure] = {**own, **moved}
        reached = ladder.reached(limits)
        why = (why or f"{MOST_ACCURATE} and {SOFT} elements differ") if reached > accuracy else ""
    reasons = [Reason("cell_accuracy_missed", {"why": why})] if why else []
    for pressure, (failed, clause) in sorted(ladder.failures.items()):
        reasons.append(Reason("cell_no_limit", {"pressure_kPa": pressure, "size_mm": failed, "why": clause}))
    return MeshLimit(accuracy, reached, limits, tuple(ladder.meshes(limits)), tuple(reasons))


def solve_numbers(curves: PieceCurves, pressure: float, bend: float, length: float, coarser: str = "") -> SolvedNumbers:
    """The numbers of a cell at a pressure in kPa; a task. Raises `PieceFailed`.

    bend: about the curvature without moment, 1/mm; length: mm, of the arm. coarser: name of a mesh whose states are
    mapped to this one, where Newton's method then starts. They are about as far bent as on that mesh, and the numbers
    follow to first order.
    """

    def solve() -> SolvedNumbers:
        begin, piece = process_time(), curves.pieces.cell
        h, known = piece.body.length, _Mapped.of(curves, coarser, pressure)
        at, slope = known.without_moment(bend * h, CLOSE * max(abs(bend) * h, SMALLEST_TURN * h / length))
        change = known.change or change_for(at.angle / h, length) * h
        further = known.bent(1, at.angle + change, at, at)
        straight = known.straight(at, further, far=abs(at.angle / h) > 1.0 / length)
        left = -at.moment / slope  # rad, to the state without moment
        by_angle = 2.0 * (further.moment - at.moment) / change - slope  # where the cell is bent, N mm
        across = dict[str, float]()
        if curves.pieces.config.law_in_space and piece.body.half:
            with suppress(SingularMatrix):
                found = lateral_rigidities(piece, at)
                across = dict(zip(ACROSS, (found.bending, found.torsion), strict=True))
        values = (at.angle + left) / h, (further.moment + by_angle * left) * h / change, straight.moment
        numbers = dict(zip(PLANE, values, strict=True)) | across
        if curves.pieces.config.mesh.formulation != SOFT:
            fields = np.hstack([fields_of(piece.space, one.state) for one in (at, further, straight)])
            mesh = {"points": piece.space.points, "nodes": piece.space.nodes, "fields": fields}
            angles = np.array([at.angle, further.angle, straight.angle])
            moment = np.array([at.moment, slope])
            curves.store.save_state(curves.pieces.mesh_name, pressure, angles=angles, moment=moment, **mesh)
        return SolvedNumbers(numbers, 3 * len(piece.space.points), process_time() - begin)

    return curves.number(SolvedNumbers, "numbers", pressure, solve)


@dataclass(frozen=True, eq=False)  # arrays inside
class _Mapped:
    """The three states of a cell at one pressure as a coarser mesh has them: where Newton's method starts."""

    piece: BendingPiece
    pressure: float  #: MPa
    angles: Array  #: (3,) rad, about without moment, bent and straight; zeros where no coarser mesh is known
    moment: Array  #: (2,) N mm, that of the first one and about its slope by the angle
    fields: Array  #: (3, n, 10) of them at the nodes of the piece (`fem.post.mapped.fields_of`)

    @staticmethod
    def of(curves: PieceCurves, coarser: str, pressure: float) -> "_Mapped":
        """Nothing where the states on the mesh of that name are not known."""
        piece, known = curves.pieces.cell, curves.store.load_state(coarser, pressure) if coarser else None
        if known is None:
            return _Mapped(piece, in_MPa(pressure), np.zeros(3), np.zeros(2), np.empty((3, 0, 10)))
        fields = mapped(known["points"], known["nodes"], known["fields"], piece.space.points)
        fields = np.stack(np.split(fields, 3, axis=1))
        return _Mapped(piece, in_MPa(pressure), known["angles"], known["moment"], fields)

    @property
    def change(self) -> float:
        """rad, from the first state to the bent one; 0 where no coarser mesh is known."""
        return float(self.angles[1] - self.angles[0])

    def without_moment(self, angle: float, close: float) -> tuple[PieceState, float]:
        """A state with about no moment, and about the slope of its moment by the angle, N mm.

        close: rad, of what is mapped up to which no further state is solved. angle: rad, at which it is solved from
        rest where nothing is mapped.
        """
        piece, rest, failures = self.piece, self.piece.rest(), FEW_FAILURES if self.change else MAX_FAILURES
        starts, swells = list[State](), False
        if self.change:
            slope, turn = float(self.moment[1]), -float(self.moment[0] / self.moment[1])
            fields = self.fields[0] + turn / self.change * (self.fields[1] - self.fields[0])
            first, smooth = float(self.angles[0]) + turn, moved(piece.system, rest.state, fields, self.pressure)
            swells = piece.is_swollen(piece.volume(smooth))
            # far stretched walls have strains that are not smooth on any mesh
            starts = [smooth, piece.system.state_at(smooth.displacement, self.pressure)][swells:]
        for start in starts:
            with suppress(PieceFailed):
                at = piece.solve_near(self.pressure, first, start, rest) if self.pressure else rest
                with stable(piece, at):
                    if abs(at.moment / slope) <= close:
                        return at, slope
                point = without_moment(piece, at, CellPoint.of, close)
                return point.state, point.slopes.moment_by_angle
        at = along_air(piece, self.pressure) if swells else unloaded(piece, self.pressure, angle, failures=failures)
        point = cell_without_moment(piece, self.pressure, at)
        return point.state, point.slopes.moment_by_angle

    def bent(self, number: int, angle: float, at: PieceState, start: PieceState) -> PieceState:
        """The state of that number at an angle in rad, by the mapped way, else from `start`."""
        predicted = None
        if self.angles[number] != self.angles[0]:
            part = (angle - at.angle) / float(self.angles[number] - self.angles[0])
            change = part * (self.fields[number] - self.fields[0])
            predicted = moved(self.piece.system, at.state, change, self.pressure)
        if not self.piece.is_swollen(self.piece.volume(start.state)):
            return self.piece.solve(self.pressure, angle, start, predicted)
        with suppress(PieceFailed):
            if predicted:
                return self.piece.solve_near(self.pressure, angle, predicted, start)
        return bent(self.piece, angle, start, None, CellPoint.of(self.piece, start).path_point)

    def straight(self, at: PieceState, further: PieceState, *, far: bool) -> PieceState:
        """The straight cell; of one that swells the state that is bent further, where it is not stable when straight.

        far: whether it is solved from this state.
        """
        angle = float(self.angles[2]) if self.change else 0.0
        try:
            return self.bent(2, angle, at, further if far else at)
        except PieceFailed:
            if not self.piece.is_swollen(self.piece.volume(at.state)):
                raise
            return further
