"""What workers do for the arm's own law, a task each: one curve, one check, the numbers of one cell on another mesh."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Concatenate, Generic, ParamSpec, TypeVar

from fem.cell.piece import PieceFailed
from pipeline.cell.curves import PieceCurves
from pipeline.cell.deviation import Deviation
from pipeline.cell.kept import Measured
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.reach import Bend
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.parallel import Pending, TaskContext
from pipeline.store.store import Store
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve

P = ParamSpec("P")
Value = TypeVar("Value")


#: in the progress
CLAMPED_END, TIP = "clamped end", "tip"


@dataclass(frozen=True)
class Ends(Generic[Value]):
    """An end of the arm by rising pressure."""

    measured: tuple[Measured[Value], ...]
    failure: str  #: a sentence: why it goes no further; empty where all pressures are borne


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
        self, task: Callable[Concatenate[PieceCurves, TaskContext, P], Value], *args: P.args, **kwargs: P.kwargs
    ) -> Pending[Value]:
        """A function of this module, or one like it. Its result raises `PieceFailed` and `RodError`."""
        store = self.context.store
        return self.context.submit(_with_curves, self.config, self.dhat, self.outer, store, task, *args, **kwargs)


def _with_curves(
    context: TaskContext,
    config: Config,
    dhat: float | None,
    outer: str,
    store: Store,
    task: Callable[Concatenate[PieceCurves, TaskContext, P], Value],
    *args: P.args,
    **kwargs: P.kwargs,
) -> Value:
    curves = context.kept(
        (PieceCurves, config.hash, dhat, outer, store.directory),
        lambda: PieceCurves(ArmPieces(config, dhat, outer), store),
    )
    return task(curves, context, *args, **kwargs)


def bend(curves: PieceCurves, context: TaskContext, pressure: float) -> Measured[Bend]:
    """The curvature of the cell without moment at a pressure in kPa."""
    return curves.bend(pressure)


def cell(curves: PieceCurves, context: TaskContext, pressure: float, largest: Bend) -> Measured[CellCurve]:
    """The cell at a pressure in kPa; largest: how it bends at the highest pressure at which its curve is used."""
    measured = curves.cell(pressure, largest)
    context.progress.step_done("cell", pressure, 0.0 if measured.is_stored else measured.seconds)
    return measured


def between(curves: PieceCurves, context: TaskContext, lower: CellCurve, upper: CellCurve) -> Measured[Deviation]:
    """How far the law that is interpolated halfway between two pressures is from the cell there."""
    return curves.between(lower, upper)


def clamp_without_moment(
    curves: PieceCurves, context: TaskContext, beside: CellCurve, half_cells: int
) -> Measured[ClampCurve]:
    """The clamped end with that many half cells without moment alone."""
    return curves.clamp_without_moment(beside, half_cells)


def clamps(curves: PieceCurves, context: TaskContext, cells: Sequence[CellCurve], half_cells: int) -> Ends[ClampCurve]:
    """The clamped end beside cells at rising pressures."""
    return _ends(CLAMPED_END, cells, curves.clamps(cells, half_cells), context)


def tips(curves: PieceCurves, context: TaskContext, cells: Sequence[CellCurve], half_cells: int) -> Ends[TipCurve]:
    """The tip beside cells at rising pressures."""
    return _ends(TIP, cells, curves.tips(cells, half_cells), context)


def _ends(
    name: str, cells: Sequence[CellCurve], curves: Iterator[Measured[Value]], context: TaskContext
) -> Ends[Value]:
    """Curves of one end up to the last pressure that it bears; name: for the progress."""
    measured: list[Measured[Value]] = []
    for cell in cells:
        try:
            curve = next(curves)
        except (PieceFailed, RodError) as failed:
            reason = str(failed).rstrip(".")
            context.progress.stopped(name, [cell.pressure], reason)
            return Ends(tuple(measured), reason)
        context.progress.step_done(name, cell.pressure, 0.0 if curve.is_stored else curve.seconds)
        measured.append(curve)
    return Ends(tuple(measured), "")


def unknowns_of_cell(curves: PieceCurves, context: TaskContext) -> int:
    """Displacement components of the half cell."""
    return 3 * len(curves.pieces.cell.space.points)


def unknowns_of_end(curves: PieceCurves, context: TaskContext, half_cells: int) -> int:
    """Displacement components of the clamped end with that many half cells."""
    return 3 * len(curves.pieces.end(half_cells, "clamp").space.points)
