"""The curves of the pieces of an arm: each is a task of a worker, measured once and kept in the result folder."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter
from types import MappingProxyType
from typing import Any, Concatenate, Generic, ParamSpec, TypeAlias, TypeVar

from fem.cell.boundary import Boundary
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from pipeline.cell.deviation import largest_deviation
from pipeline.cell.measure import cell_without_moment, sweep_cell
from pipeline.cell.measure_clamp import clamp_curve, clamp_without_moment, first_state
from pipeline.cell.measure_tip import tip_curve, tip_state
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.reach import Reach
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.parallel import Pending, TaskContext
from pipeline.pressure import in_MPa, name_of_state
from pipeline.progress import Progress
from pipeline.store.store import Store
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.record import CELL_KEYS, CLAMP_KEYS, TIP_KEYS, curve_row, curve_values

P = ParamSpec("P")
Value = TypeVar("Value")
Curve = TypeVar("Curve", ClampCurve, TipCurve)

#: what holds an end piece, and its name in the progress, by the kind of its curves
BOUNDARIES: Mapping[str, Boundary] = MappingProxyType({"clamp": "clamp", "tip": "free"})
NAMES: Mapping[str, str] = MappingProxyType({"clamp": "clamped end", "tip": "tip"})
#: keys of the files of curves, by their type; other values are single numbers
_KEYS: dict[type, Mapping[str, str]] = {CellCurve: CELL_KEYS, ClampCurve: CLAMP_KEYS, TipCurve: TIP_KEYS}


@dataclass(frozen=True)
class Measured(Generic[Value]):
    """A curve, or a number, and what it cost."""

    curve: Value
    limits: tuple[str, ...] = ()  #: sentences: why it was not followed further
    #: of the cubics between its states: of a cell over the largest curvature, of a clamped end in rad
    error: float = 0.0
    factorizations: int = 0
    seconds: float = 0.0
    is_stored: bool = field(default=False, compare=False)  #: by an earlier run


#: a curve of an end, and the state that the one at the next pressure begins with
_End: TypeAlias = tuple[Measured[Curve], PieceState]


@dataclass(frozen=True)
class Ends(Generic[Value]):
    """An end of the arm by rising pressure."""

    measured: tuple[Measured[Value], ...]
    failure: str  #: a sentence: why it goes no further; empty where all pressures are borne


class PieceCurves:
    """Curves of the cell, of the clamped end and of the tip.

    Curves of the cell begin with the piece at rest, so that they do not depend on which others were measured before.
    Curves of the ends, which cost more, begin with the state at the pressure before. All but `clamps` and `tips` raise
    `PieceFailed` and `RodError` for a piece that does not bear the pressure.
    """

    def __init__(self, pieces: ArmPieces, store: Store, progress: Progress) -> None:
        self.pieces = pieces
        self.store = store
        self.progress = progress

    def bend(self, pressure: float) -> Measured[float]:
        """The curvature of the cell without moment at a pressure in kPa, 1/mm."""

        def measure(piece: BendingPiece) -> Measured[float]:
            return Measured(cell_without_moment(piece, in_MPa(pressure)).state.angle / piece.body.length)

        return self._of_cell(float, name_of_state("bend", pressure), measure)

    def cell(self, pressure: float, bend: float) -> Measured[CellCurve]:
        """The cell at a pressure in kPa, for arms whose cells bend up to a curvature `bend` (1/mm) without moment."""

        def measure(piece: BendingPiece) -> Measured[CellCurve]:
            sweep = sweep_cell(piece, pressure, Reach.of(self.pieces.config, bend))
            return Measured(sweep.curve(piece.body.length), tuple(sweep.limits), sweep.error)

        measured = self._of_cell(CellCurve, name_of_state("cell", pressure), measure)
        self.progress.step_done("cell", pressure, 0.0 if measured.is_stored else measured.seconds)
        return measured

    def between(self, lower: CellCurve, upper: CellCurve) -> Measured[float]:
        """How far the law interpolated halfway between two pressures is from the cell there, 1/mm at equal moments."""
        name = name_of_state(name_of_state("between", lower.pressure), upper.pressure)
        return self._of_cell(float, name, lambda piece: Measured(largest_deviation(piece, lower, upper)))

    def clamp_without_moment(self, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
        """The clamped end with that many half cells without moment alone."""
        piece = partial(self.pieces.end, half_cells, "clamp")
        name = _end_name("decay", half_cells, cell)
        return self._kept(ClampCurve, name, piece, lambda end: Measured(clamp_without_moment(end, cell)))

    def clamps(self, cells: Sequence[CellCurve], half_cells: int) -> Ends[ClampCurve]:
        """The clamped end with that many half cells over the moments of cells at rising pressures."""

        def measure(piece: BendingPiece, cell: CellCurve, start: PieceState | None) -> _End[ClampCurve]:
            clamp = clamp_curve(piece, cell, start)
            return Measured(clamp.curve, clamp.limits, clamp.error), clamp.first

        curves = self._ends(ClampCurve, "clamp", cells, half_cells, measure, first_state)
        return self._up_to_failure("clamp", cells, curves)

    def tips(self, cells: Sequence[CellCurve], half_cells: int) -> Ends[TipCurve]:
        """The tip with that many half cells beside cells at rising pressures."""

        def measure(piece: BendingPiece, cell: CellCurve, start: PieceState | None) -> _End[TipCurve]:
            tip = tip_curve(piece, cell, start)
            return Measured(tip.curve), tip.state

        return self._up_to_failure("tip", cells, self._ends(TipCurve, "tip", cells, half_cells, measure, tip_state))

    def unknowns_of_cell(self) -> int:
        """Displacement components of the half cell."""
        return 3 * len(self.pieces.cell.space.points)

    def unknowns_of_end(self, half_cells: int) -> int:
        """Displacement components of the clamped end with that many half cells."""
        return 3 * len(self.pieces.end(half_cells, "clamp").space.points)

    def _up_to_failure(self, kind: str, cells: Sequence[CellCurve], curves: Iterator[Measured[Curve]]) -> Ends[Curve]:
        """Curves of one end up to the last pressure that it bears."""
        measured: list[Measured[Curve]] = []
        for cell in cells:
            try:
                curve = next(curves)
            except (PieceFailed, RodError) as failed:
                reason = str(failed).rstrip(".")
                self.progress.stopped(NAMES[kind], [cell.pressure], reason)
                return Ends(tuple(measured), reason)
            self.progress.step_done(NAMES[kind], cell.pressure, 0.0 if curve.is_stored else curve.seconds)
            measured.append(curve)
        return Ends(tuple(measured), "")

    def _ends(
        self,
        kind_of_curve: type[Curve],
        kind: str,
        cells: Sequence[CellCurve],
        half_cells: int,
        measure: Callable[[BendingPiece, CellCurve, PieceState | None], _End[Curve]],
        state_of: Callable[[BendingPiece, CellCurve, PieceState | None], PieceState],
    ) -> Iterator[Measured[Curve]]:
        """Curves of an end at rising pressures, each from the state of the one before.

        Those of an earlier run have left no states. If one is needed it is solved again with `state_of`, so that a run
        that was interrupted has the same curves.
        """
        last: PieceState | None = None
        without_state: list[CellCurve] = []

        def measured(cell: CellCurve, piece: BendingPiece) -> Measured[Curve]:
            nonlocal last
            curve, last = measure(piece, cell, last)
            return curve

        def piece() -> BendingPiece:
            nonlocal last
            end = self.pieces.end(half_cells, BOUNDARIES[kind])
            for earlier in without_state:
                with suppress(PieceFailed):
                    last = state_of(end, earlier, last)
            without_state.clear()
            return end

        for cell in cells:
            curve = self._kept(kind_of_curve, _end_name(kind, half_cells, cell), piece, partial(measured, cell))
            if curve.is_stored:
                without_state.append(cell)
            yield curve

    def _of_cell(
        self, kind: type[Value], name: str, measure: Callable[[BendingPiece], Measured[Value]]
    ) -> Measured[Value]:
        return self._kept(kind, name, lambda: self.pieces.cell, measure)

    def _kept(
        self,
        kind: type[Value],
        name: str,
        piece_of: Callable[[], BendingPiece],
        measure: Callable[[BendingPiece], Measured[Value]],
    ) -> Measured[Value]:
        """The value of this name from an earlier run of these sources, or measured now and kept."""
        file, keys = f"law/{name}.json", _KEYS.get(kind)
        kept = self.store.read_json(file)
        if kept is not None and kept["key"] == self.store.numbers_key:
            value: Any = kept["curve"] if keys is None else kind(**curve_values(kept["curve"], keys))
            numbers = (kept["error"], kept["factorizations"], kept["seconds"])
            return Measured(value, tuple(kept["limits"]), *numbers, is_stored=True)
        begin, piece = perf_counter(), piece_of()
        before = piece.factorizations
        measured = measure(piece)
        spent = piece.factorizations - before
        measured = replace(measured, factorizations=spent, seconds=perf_counter() - begin)
        row: dict[str, Any] = {name: getattr(measured, name) for name in ("error", "factorizations", "seconds")}
        row["curve"] = measured.curve if keys is None else curve_row(measured.curve, keys)
        self.store.save_json(file, {"key": self.store.numbers_key, "limits": list(measured.limits), **row})
        return measured


def _end_name(kind: str, half_cells: int, cell: CellCurve) -> str:
    return name_of_state(f"{kind}_{half_cells}", cell.pressure)


@dataclass(frozen=True)
class ArmTasks:
    """Submits tasks on the pieces of one arm. Each worker meshes a piece once, and keeps its equations."""

    config: Config
    dhat: float | None  #: mm, as in `ArmPieces`
    outer: str  #: likewise
    context: RunContext

    @staticmethod
    def of(pieces: ArmPieces, context: RunContext) -> "ArmTasks":
        """For the same pieces."""
        return ArmTasks(pieces.config, pieces.dhat, pieces.outer, context)

    def submit(
        self, task: Callable[Concatenate[PieceCurves, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A method of `PieceCurves`, or a function like one. Its result raises `PieceFailed` and `RodError`."""
        store = self.context.store
        return self.context.submit(_with_curves, self.config, self.dhat, self.outer, store, task, *args, **kwargs)


def _with_curves(
    context: TaskContext,
    config: Config,
    dhat: float | None,
    outer: str,
    store: Store,
    task: Callable[Concatenate[PieceCurves, P], Value],
    *args: P.args,
    **kwargs: P.kwargs,
) -> Value:
    curves = context.kept(
        (PieceCurves, config.hash, dhat, outer, store.directory),
        lambda: PieceCurves(ArmPieces(config, dhat, outer), store, context.progress),
    )
    return task(curves, *args, **kwargs)
