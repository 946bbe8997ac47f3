"""The curves of the pieces of an arm: each is a task of a worker, measured once and kept in the result folder."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

from fem.cell.boundary import Boundary
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from geometry import Reason
from pipeline.law.piece.deviation import largest_deviation
from pipeline.law.piece.in_space import cell_in_space
from pipeline.law.piece.measure import cell_without_moment, sweep_cell
from pipeline.law.piece.measure_clamp import clamp_curve, clamp_without_moment, first_state
from pipeline.law.piece.measure_tip import tip_curve, tip_state
from pipeline.law.piece.near import cell_near
from pipeline.law.piece.point import Measured, failure_of
from pipeline.law.piece.rates import cell_rates
from pipeline.law.piece.reach import Reach
from pipeline.law.pieces import ArmPieces
from pipeline.store.context import RunContext
from pipeline.store.kept import KeptFile
from pipeline.store.parallel import Pending, TaskContext
from pipeline.store.progress import Progress
from pipeline.store.store import Store
from pipeline.values.pressure import in_MPa, name_of_state
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.keys import curve_of, record_of

P = ParamSpec("P")
Value = TypeVar("Value")
Curve = TypeVar("Curve", ClampCurve, TipCurve)

#: how the names of curves begin that have derivatives by the design where pieces have them
WITH_RATES = ("cell", "clamp")
#: of the work for a law
PARTS = ("cell", "between", "ends")


@dataclass(frozen=True)
class End(Generic[Curve]):
    """One of the two ends of an arm, and how it is measured beside a cell, from the state at a lower pressure."""

    curve: type[Curve]
    file: str  #: how the names of its files begin
    name: str  #: in the progress
    start: Boundary  #: what holds the piece
    measure: Callable[[BendingPiece, CellCurve, PieceState | None], tuple[Measured[Curve], PieceState]]
    solve_state: Callable[[BendingPiece, CellCurve, PieceState | None], PieceState]  #: that `measure` gives, alone


CLAMP = End(ClampCurve, "clamp", "clamped end", "clamp", clamp_curve, first_state)
TIP = End(TipCurve, "tip", "tip", "free", tip_curve, tip_state)


@dataclass(frozen=True)
class EndCurves(Generic[Curve]):
    """An end of the arm by rising pressure."""

    measured: tuple[Measured[Curve], ...]
    failure: Reason | None  #: why it goes no further; None where all pressures are borne


class PieceCurves:
    """Curves of the cell, of the clamped end and of the tip.

    Curves of the cell begin with the piece at rest, so that they do not depend on which others were measured before.
    Curves of the ends, which cost more, begin with the state at the pressure before. All but `ends` raise `PieceFailed`
    and `RodError` for a piece that does not bear the pressure.
    """

    def __init__(self, pieces: ArmPieces, store: Store, progress: Progress) -> None:
        self.pieces = pieces
        self.store = store
        self.progress = progress

    def bend(self, pressure: float) -> Measured[float]:
        """The curvature of the cell without moment at a pressure in kPa, 1/mm."""

        def measure(cell: BendingPiece) -> Measured[float]:
            return Measured(cell_without_moment(cell, in_MPa(pressure)).state.angle / cell.body.length)

        return self._of_cell(float, name_of_state("bend", pressure), measure)

    def cell(self, pressure: float, bend: float) -> Measured[CellCurve]:
        """The cell at a pressure in kPa, for arms whose cells bend up to a curvature `bend` (1/mm) without moment."""

        def measure(cell: BendingPiece) -> Measured[CellCurve]:
            sweep = sweep_cell(cell, pressure, Reach.of(self.pieces.config, bend))
            curve, limits = sweep.curve(cell.body.length), sweep.limits
            if self.pieces.config.law_in_space:
                curve, unstable = cell_in_space(cell, curve, [point.state for point in sweep.points])
                limits = (*limits, *unstable)
            return Measured(curve, limits, sweep.error, rates=cell_rates(cell, sweep.points, curve))

        measured = self._of_cell(CellCurve, name_of_state("cell", pressure), measure)
        self.progress.step_done("cell", pressure, 0.0 if measured.is_stored else measured.seconds)
        return measured

    def near(self, pressure: float, bend: float) -> Measured[CellCurve]:
        """The cell at a pressure in kPa without moment, and bent by `bend` (1/mm) more and less."""

        def measure(cell: BendingPiece) -> Measured[CellCurve]:
            sweep = cell_near(cell, pressure, bend)
            return Measured(sweep.curve(cell.body.length), rates=cell_rates(cell, sweep.points))

        return self._of_cell(CellCurve, name_of_state("cell_near", pressure), measure)

    def between(self, lower: CellCurve, upper: CellCurve) -> Measured[float]:
        """How far the law interpolated halfway between two pressures is from the cell there, 1/mm at equal moments."""
        name = name_of_state(name_of_state("between", lower.pressure), upper.pressure)
        return self._of_cell(float, name, lambda cell: Measured(largest_deviation(cell, lower, upper)))

    def clamp_without_moment(self, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
        """The clamped end with that many half cells without moment alone."""
        name = name_of_state(f"decay_{half_cells}", cell.pressure)
        return self._read(ClampCurve, name) or self._measure(
            name,
            lambda: self.pieces.end(half_cells, "clamp"),
            lambda piece: Measured(clamp_without_moment(piece, cell)),
        )

    def ends(self, end: End[Curve], cells: Sequence[CellCurve], half_cells: int) -> EndCurves[Curve]:
        """One end with that many half cells beside cells at rising pressures, up to the last one that it bears.

        Each begins with the state at the pressure before. Curves of an earlier run have left no states. If one is
        needed it is solved again, so that a run that was interrupted has the same curves.
        """
        state: PieceState | None = None
        without_state: list[CellCurve] = []
        measured: list[Measured[Curve]] = []

        def piece() -> BendingPiece:
            nonlocal state
            made = self.pieces.end(half_cells, end.start)
            for earlier in without_state:
                with suppress(PieceFailed):
                    state = end.solve_state(made, earlier, state)
            without_state.clear()
            return made

        def measure(cell: CellCurve, made: BendingPiece) -> Measured[Curve]:
            nonlocal state
            curve, state = end.measure(made, cell, state)
            return curve

        for cell in cells:
            name = name_of_state(f"{end.file}_{half_cells}", cell.pressure)
            try:
                curve = self._read(end.curve, name) or self._measure(name, piece, partial(measure, cell))
            except (PieceFailed, RodError) as failed:
                self.progress.stopped(end.name, [cell.pressure], str(failed).rstrip("."))
                return EndCurves(tuple(measured), failure_of(failed))
            if curve.is_stored:
                without_state.append(cell)
            self.progress.step_done(end.name, cell.pressure, 0.0 if curve.is_stored else curve.seconds)
            measured.append(curve)
        return EndCurves(tuple(measured), None)

    def _of_cell(
        self, kind: type[Value], name: str, measure: Callable[[BendingPiece], Measured[Value]]
    ) -> Measured[Value]:
        return self._read(kind, name) or self._measure(name, lambda: self.pieces.cell, measure)

    def _read(self, kind: type[Value], name: str) -> Measured[Value] | None:
        """The value of this name from an earlier run of these sources."""
        kept = self._kept(name).read()
        if kept is None or (self.pieces.derivatives and name.startswith(WITH_RATES) and not kept.rates):
            return None
        return replace(kept, curve=kept.curve if kind is float else curve_of(kind, kept.curve), is_stored=True)

    def _measure(
        self, name: str, piece_of: Callable[[], BendingPiece], measure: Callable[[BendingPiece], Measured[Value]]
    ) -> Measured[Value]:
        """The value measured now, which is kept under this name."""
        begin, piece = perf_counter(), piece_of()
        before = piece.factorizations
        measured = measure(piece)
        spent = piece.factorizations - before
        seconds, unknowns = perf_counter() - begin, 3 * len(piece.space.points)
        measured = replace(measured, factorizations=spent, seconds=seconds, unknowns=unknowns)
        made: Any = measured
        content = made.curve if isinstance(made.curve, float) else record_of(made.curve)
        self._kept(name).save(replace(made, curve=content))
        return measured

    def _kept(self, name: str) -> KeptFile[Measured[Any]]:
        return KeptFile.of_run(self.store, self.file(name), Measured[Any])

    def file(self, name: str) -> str:
        """Where what has this name is kept of these pieces."""
        return f"law/{self.pieces.mesh_name}/{name}.json"


@dataclass(frozen=True)
class Log:
    """What was measured of an arm so far: where its law ends, and what it took by part of the work."""

    limits: list[Reason] = field(default_factory=list)  #: before the loads that it is made for
    failures: list[Reason] = field(default_factory=list)  #: pressures that the pieces do not bear
    factorizations: dict[str, int] = field(default_factory=lambda: dict.fromkeys(PARTS, 0))
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PARTS, 0.0))

    def count(self, part: str, *measured: Measured[Any] | None) -> None:
        """Add the work for what was measured."""
        for one in filter(None, measured):
            self.factorizations[part] += one.factorizations
            self.seconds[part] += one.seconds


@dataclass(frozen=True)
class ArmTasks:
    """Submits tasks on the pieces of one arm. Each worker meshes a piece once, and keeps its equations."""

    pieces: ArmPieces
    context: RunContext

    def submit(
        self, task: Callable[Concatenate[PieceCurves, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A method of `PieceCurves`, or a function like one. Its result raises `PieceFailed` and `RodError`."""
        return self.context.submit(_on_pieces, self.pieces, self.context.store, task, *args, **kwargs)


def _on_pieces(
    context: TaskContext,
    pieces: ArmPieces,
    store: Store,
    task: Callable[Concatenate[PieceCurves, P], Value],
    *args: P.args,
    **kwargs: P.kwargs,
) -> Value:
    curves = context.kept(
        (PieceCurves, pieces.key, store.directory), lambda: PieceCurves(pieces, store, context.progress)
    )
    return task(curves, *args, **kwargs)
