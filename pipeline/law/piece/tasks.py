"""Tasks of workers on the pieces of an arm: what they measure is kept in the result folder, and measured once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any, Concatenate, ParamSpec, TypeVar

from fem.cell.piece import BendingPiece
from geometry import Reason
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.point import KeptCurve
from pipeline.results.laws import record_of, value_of
from pipeline.store.context import RunContext
from pipeline.store.kept import KeptFile
from pipeline.store.parallel import Pending, TaskContext
from pipeline.store.progress import Progress
from pipeline.store.store import Store
from pipeline.values.errors import RunFailed
from pipeline.values.pressure import name_of_state
from pipeline.values.reasons import render_all
from rod.arm_law.curves import ClampCurve, TipCurve

P = ParamSpec("P")
Value = TypeVar("Value")
Curve = TypeVar("Curve", ClampCurve, TipCurve)

#: how the names of curves begin that have derivatives by the design where pieces have them
WITH_RATES = ("cell", "clamp")
#: of the work for a law
PARTS = ("cell", "between", "ends")


class PieceCurves:
    """Keeps what was measured on the pieces of one arm, with the work that it took."""

    def __init__(self, pieces: ArmPieces, store: Store, progress: Progress) -> None:
        self.pieces = pieces
        self.store = store
        self.progress = progress

    def of_cell(
        self, kind: type[Value], name: str, measure: Callable[[BendingPiece], KeptCurve[Value]]
    ) -> KeptCurve[Value]:
        """What is measured on the cell, and kept under a name."""
        return self.of_piece(kind, name, lambda: self.pieces.cell, measure)

    def of_piece(
        self,
        kind: type[Value],
        name: str,
        piece_of: Callable[[], BendingPiece],
        measure: Callable[[BendingPiece], KeptCurve[Value]],
    ) -> KeptCurve[Value]:
        """What is measured on a piece, which is made where an earlier run of these sources has kept nothing."""
        file: KeptFile[KeptCurve[Any]] = KeptFile.of_run(self.store, self._file(name), KeptCurve[Any])
        needs_rates = self.pieces.derivatives and name.startswith(WITH_RATES)
        if (kept := file.read()) is not None and (kept.rates or not needs_rates):
            return replace(kept, curve=kept.curve if kind is float else value_of(kind, kept.curve), is_stored=True)
        begin, piece = perf_counter(), piece_of()
        before = piece.factorizations
        measured = measure(piece)
        spent, seconds = piece.factorizations - before, perf_counter() - begin
        unknowns = 3 * len(piece.space.points)
        measured = replace(measured, factorizations=spent, seconds=seconds, unknowns=unknowns)
        made: Any = measured
        file.save(replace(made, curve=made.curve if kind is float else record_of(made.curve)))
        return measured

    def number(self, kind: type[Value], name: str, pressure: float, make: Callable[[], Value]) -> Value:
        """What is made of states at a pressure in kPa, and kept under a name without the work that it took."""
        file = self._file(name_of_state(name, pressure))
        return KeptFile[Value].of_run(self.store, file, kind).read_or_make(make)

    def _file(self, name: str) -> str:
        return f"law/{self.pieces.mesh_name}/{name}.json"


@dataclass(frozen=True)
class Log:
    """What was measured of an arm so far: where its law ends, and what it took by part of the work."""

    limits: list[Reason] = field(default_factory=list)  #: before the loads that it is made for
    failures: list[Reason] = field(default_factory=list)  #: pressures that the pieces do not bear
    swelling: list[float] = field(default_factory=list)  #: kPa, at which chambers have swollen
    factorizations: dict[str, int] = field(default_factory=lambda: dict.fromkeys(PARTS, 0))
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PARTS, 0.0))

    def check_two(self, cells: Sequence[object]) -> None:
        """Raise RunFailed for fewer than two pressures."""
        if len(cells) < 2:
            raise RunFailed(f"the arm's own law has fewer than two pressures: {render_all(self.failures)}")

    def count(self, part: str, *measured: KeptCurve[Any] | None) -> None:
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
        """A function that takes `PieceCurves` first. Its result raises `PieceFailed` and `RodError`."""
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
