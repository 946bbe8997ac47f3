"""The curves of the pieces of an arm, each measured once and kept in the result folder."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import TypeAlias, TypeVar

from fem.cell.boundary import Boundary
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from pipeline.cell.deviation import DEVIATION_KEYS, Deviation, largest_deviation
from pipeline.cell.kept import KeptCurves, Measured
from pipeline.cell.measure import cell_without_moment, sweep_cell
from pipeline.cell.measure_clamp import clamp_curve, clamp_without_moment, first_state
from pipeline.cell.measure_tip import tip_curve, tip_state
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.reach import BEND_KEYS, Bend, Reach
from pipeline.store.store import Store
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.record import CELL_KEYS, CLAMP_KEYS, TIP_KEYS

Curve = TypeVar("Curve", ClampCurve, TipCurve)
#: a curve of an end, and the state that the one at the next pressure begins with
_End: TypeAlias = tuple[Measured[Curve], PieceState]

#: what holds an end piece, by the kind of its curves
BOUNDARIES: Mapping[str, Boundary] = MappingProxyType({"clamp": "clamp", "tip": "free"})


class PieceCurves:
    """Curves of the cell, of the clamped end and of the tip at one pressure each.

    Those of the cell begin with the piece at rest, so that they do not depend on which others were measured before; the
    ends, which cost more, begin with their state at the pressure before. All raise `PieceFailed` and `RodError` for a
    piece that does not bear the pressure.
    """

    def __init__(self, pieces: ArmPieces, store: Store) -> None:
        self.pieces = pieces
        self.store = store
        self._bends = KeptCurves(store, Bend, BEND_KEYS)
        self._cells = KeptCurves(store, CellCurve, CELL_KEYS)
        self._clamps = KeptCurves(store, ClampCurve, CLAMP_KEYS)
        self._tips = KeptCurves(store, TipCurve, TIP_KEYS)
        self._deviations = KeptCurves(store, Deviation, DEVIATION_KEYS)

    def bend(self, pressure: float) -> Measured[Bend]:
        """The curvature of the cell without moment at a pressure in kPa."""

        def measure() -> Measured[Bend]:
            piece = self.pieces.cell
            before = piece.factorizations
            point = cell_without_moment(piece, pressure / 1000.0)
            bend = Bend(point.state.angle / piece.body.length)
            return Measured(bend, factorizations=piece.factorizations - before)

        return self._bends.get(f"bend_{pressure:.12g}kPa", measure)

    def cell(self, pressure: float, bend: Bend) -> Measured[CellCurve]:
        """The cell at a pressure in kPa, for arms whose cells bend up to `bend` without moment."""

        def measure() -> Measured[CellCurve]:
            piece = self.pieces.cell
            before = piece.factorizations
            sweep = sweep_cell(piece, pressure, Reach.of(self.pieces.config, bend.kappa))
            limits = tuple(sweep.limits)
            return Measured(sweep.curve(piece.body.length), limits, sweep.error, piece.factorizations - before)

        return self._cells.get(_cell_name(pressure), measure)

    def between(self, lower: CellCurve, upper: CellCurve) -> Measured[Deviation]:
        """How far the law that is interpolated halfway between two pressures is from the cell there."""

        def measure() -> Measured[Deviation]:
            piece = self.pieces.cell
            before = piece.factorizations
            deviation = largest_deviation(piece, lower, upper)
            return Measured(deviation, factorizations=piece.factorizations - before)

        return self._deviations.get(f"between_{lower.pressure:.12g}kPa_{upper.pressure:.12g}kPa", measure)

    def clamps(self, cells: Sequence[CellCurve], half_cells: int) -> Iterator[Measured[ClampCurve]]:
        """The clamped end with that many half cells over the moments of cells at rising pressures."""

        def measure(piece: BendingPiece, cell: CellCurve, start: PieceState | None) -> _End[ClampCurve]:
            clamp = clamp_curve(piece, cell, start)
            return Measured(clamp.curve, clamp.limits, clamp.error), clamp.first

        return self._ends(self._clamps, "clamp", cells, half_cells, measure, first_state)

    def clamp_without_moment(self, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
        """The clamped end with that many half cells without moment alone."""

        def measure() -> Measured[ClampCurve]:
            piece = self.pieces.end(half_cells, "clamp")
            before = piece.factorizations
            curve = clamp_without_moment(piece, cell)
            return Measured(curve, (), 0.0, piece.factorizations - before)

        return self._clamps.get(_end_name("decay", half_cells, cell), measure)

    def tips(self, cells: Sequence[CellCurve], half_cells: int) -> Iterator[Measured[TipCurve]]:
        """The tip with that many half cells beside cells at rising pressures."""

        def measure(piece: BendingPiece, cell: CellCurve, start: PieceState | None) -> _End[TipCurve]:
            tip = tip_curve(piece, cell, start)
            return Measured(tip.curve), tip.state

        return self._ends(self._tips, "tip", cells, half_cells, measure, tip_state)

    def _ends(
        self,
        kept: KeptCurves[Curve],
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

        def measured(cell: CellCurve) -> Measured[Curve]:
            nonlocal last
            piece = self.pieces.end(half_cells, BOUNDARIES[kind])
            for earlier in without_state:
                with suppress(PieceFailed):
                    last = state_of(piece, earlier, last)
            without_state.clear()
            before = piece.factorizations
            curve, last = measure(piece, cell, last)
            return replace(curve, factorizations=piece.factorizations - before)

        for cell in cells:
            curve = kept.get(_end_name(kind, half_cells, cell), partial(measured, cell))
            if curve.is_stored:
                without_state.append(cell)
            yield curve


def _cell_name(pressure: float) -> str:
    return f"cell_{pressure:.12g}kPa"


def _end_name(kind: str, half_cells: int, cell: CellCurve) -> str:
    return f"{kind}_{half_cells}_{cell.pressure:.12g}kPa"
