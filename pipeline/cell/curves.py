"""The curves of the pieces of an arm, each measured once and kept in the result folder."""

from pipeline.cell.deviation import DEVIATION_KEYS, Deviation, largest_deviation
from pipeline.cell.kept import KeptCurves, Measured
from pipeline.cell.measure import cell_without_moment, sweep_cell
from pipeline.cell.measure_ends import clamp_curve, clamp_without_moment, tip_curve
from pipeline.cell.pieces import ArmPieces
from pipeline.cell.reach import BEND_KEYS, Bend, Reach
from pipeline.store.store import Store
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.record import CELL_KEYS, CLAMP_KEYS, TIP_KEYS


class PieceCurves:
    """Curves of the cell, of the clamped end and of the tip at one pressure each.

    Every one begins with the piece at rest, so that it does not depend on which others were measured before. All raise
    `PieceFailed` and `RodError` for a piece that does not bear the pressure.
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

    def clamp(self, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
        """The clamped end with that many half cells over the moments of the cell."""

        def measure() -> Measured[ClampCurve]:
            piece = self.pieces.end(half_cells, "clamp")
            before = piece.factorizations
            clamp = clamp_curve(piece, cell)
            return Measured(clamp.curve, clamp.limits, clamp.error, piece.factorizations - before)

        return self._clamps.get(_end_name("clamp", half_cells, cell), measure)

    def clamp_without_moment(self, cell: CellCurve, half_cells: int) -> Measured[ClampCurve]:
        """The clamped end with that many half cells without moment alone."""

        def measure() -> Measured[ClampCurve]:
            piece = self.pieces.end(half_cells, "clamp")
            before = piece.factorizations
            curve = clamp_without_moment(piece, cell)
            return Measured(curve, (), 0.0, piece.factorizations - before)

        return self._clamps.get(_end_name("decay", half_cells, cell), measure)

    def tip(self, cell: CellCurve, half_cells: int) -> Measured[TipCurve]:
        """The tip with that many half cells."""

        def measure() -> Measured[TipCurve]:
            piece = self.pieces.end(half_cells, "free")
            before = piece.factorizations
            curve = tip_curve(piece, cell)
            return Measured(curve, (), 0.0, piece.factorizations - before)

        return self._tips.get(_end_name("tip", half_cells, cell), measure)

    def ends(self, cell: CellCurve, half_cells: int) -> tuple[Measured[ClampCurve], Measured[TipCurve]]:
        """The clamped end and the tip."""
        return self.clamp(cell, half_cells), self.tip(cell, half_cells)


def _cell_name(pressure: float) -> str:
    return f"cell_{pressure:.12g}kPa"


def _end_name(kind: str, half_cells: int, cell: CellCurve) -> str:
    return f"{kind}_{half_cells}_{cell.pressure:.12g}kPa"
