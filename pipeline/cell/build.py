"""The arm's own law of a configuration: a cell at every pressure, pressures between, and the two ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from time import perf_counter
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.cell.piece import BendingPiece, PieceFailed
from pipeline.cell.ahead import cells_ahead, ends_ahead
from pipeline.cell.curves import PieceCurves
from pipeline.cell.kept import Measured
from pipeline.cell.pieces import ArmPieces, NoArmLaw
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.simulation.scene import Scene
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.section import SectionLaw, section_at

#: largest error of the curvature between two pressures, over the largest curvature of the law
BETWEEN = 2e-3
#: moments at which a pressure between is checked, and how many pressures are added at most
CHECKS, MOST_ADDED = 5, 4
#: largest displacement of the arm's end, over its length, by which end pieces that differ by a cell may differ
DECAY = 5e-4
#: the same beyond which the arm is said to have no undisturbed cells
NOT_DECAYED = 1e-2


@dataclass(frozen=True, eq=False)  # arrays inside
class MeasuredLaw:
    """The arm's own law, how it was measured, and how far it may be trusted."""

    law: ArmLaw
    half_cells: int  #: in each end piece
    added_kPa: tuple[float, ...]  #: pressures that are none of the configuration, measured for the interpolation
    error_along: float  #: of the curvature between two moments of a curve, over the largest curvature of the law
    error_between: float  #: of the curvature between two pressures, where it was checked; over the same
    error_ends: float  #: of the arm's end by cells that the end pieces still disturb, over the length
    limits: tuple[str, ...]  #: sentences: where the law ends before the loads that it was made for, and why
    failures: tuple[str, ...]  #: sentences: pressures that the pieces do not bear
    factorizations: Mapping[str, int] = field(repr=False)  #: by part of the work
    seconds: Mapping[str, float] = field(repr=False)  #: by part of the work, of earlier runs too
    seconds_of_cells: tuple[float, ...] = field(repr=False)  #: by pressure
    unknowns: Mapping[str, int] = field(repr=False)  #: displacement components by piece


def build_law(scene: Scene, context: RunContext) -> MeasuredLaw:
    """Measure the arm's own law at the pressures of the configuration, at rest, and between where that is needed.

    Curves that an earlier run has left in the store are not measured again. Raises `NoArmLaw` for an arm or effects
    that such a law does not describe, InputError for pieces that cannot be meshed, and RunFailed where not even the
    lowest pressure is borne.
    """
    return _Builder(ArmPieces.of(scene), context).law()


class _Builder:
    """The law in the making."""

    def __init__(self, pieces: ArmPieces, context: RunContext) -> None:
        self.pieces = pieces
        self.context = context
        self.curves = PieceCurves(pieces, context.store)
        self.limits: list[str] = []
        self.failures: list[str] = []
        self.factorizations = dict.fromkeys(("cell", "between", "ends"), 0)
        self.seconds = dict.fromkeys(self.factorizations, 0.0)
        self.error_between = 0.0
        self.error_ends = 0.0

    def law(self) -> MeasuredLaw:
        """All curves, put together."""
        config = self.pieces.config
        self.pieces.repetition  # noqa: B018 - refuses an arm that is too short before anything is solved
        requested = config.pressures_kPa
        cells = self._cells(sorted({0.0, *requested}))
        cells, added = self._with_pressures_between(cells)
        half_cells = self._half_cells(cells[-1].curve)
        clamps, free, held = self._ends(cells, half_cells)
        cells = cells[: len(clamps)]
        if len(cells) < 2:
            raise RunFailed(f"the law of a cell has fewer than two pressures: {'; '.join(self.failures)}")
        repetition = self.pieces.repetition
        law = ArmLaw(
            pitch=2.0 * repetition.half_pitch,
            first_middle=repetition.middle,
            length=self.pieces.design.length,
            cells=tuple(cell.curve for cell in cells),
            clamps=tuple(clamps),
            free_tips=tuple(free),
            held_tips=tuple(held),
        )
        return MeasuredLaw(
            law=law,
            half_cells=half_cells,
            added_kPa=tuple(p for p in added if p in law.pressures),
            error_along=_error_along(cells),
            error_between=self.error_between,
            error_ends=self.error_ends,
            limits=tuple(dict.fromkeys(self.limits)),
            failures=tuple(self.failures),
            factorizations=MappingProxyType(self.factorizations),
            seconds=MappingProxyType(self.seconds),
            seconds_of_cells=tuple(cell.seconds for cell in cells),
            unknowns=MappingProxyType(self._unknowns(half_cells)),
        )

    def _cells(self, pressures: Sequence[float]) -> list[Measured[CellCurve]]:
        """Cells by rising pressure, up to the last one that is borne."""
        progress = self.context.progress
        progress.experiment("cell", pressures)
        cells: list[Measured[CellCurve]] = []
        pairs: list[tuple[float, float | None]] = [*pairwise(pressures), (pressures[-1], None)]
        reported = cells_ahead(self.curves, self.context, pairs)
        for pressure, following in pairs:
            try:
                cells.append(self._cell(pressure, following))
            except (PieceFailed, RodError) as failure:
                self.failures.append(str(failure).rstrip("."))
                break
            if pressure not in reported:
                progress.step_done("cell", pressure, 0.0 if cells[-1].is_stored else cells[-1].seconds)
        if len(cells) < 2:
            raise RunFailed(f"the law of a cell has fewer than two pressures: {'; '.join(self.failures)}")
        return cells

    def _cell(self, pressure: float, following: float | None) -> Measured[CellCurve]:
        measured = self.curves.cell(pressure, following)
        self._count("cell", measured)
        return measured

    def _with_pressures_between(
        self, cells: list[Measured[CellCurve]]
    ) -> tuple[list[Measured[CellCurve]], tuple[float, ...]]:
        """The cells with those at pressures between, where the interpolation was wrong by more than BETWEEN."""
        added: list[float] = []
        largest = max(float(np.abs(cell.curve.kappa).max()) for cell in cells)
        errors = [self._error_between(*pair) for pair in pairwise(cells)]
        while max(errors) > BETWEEN * largest and len(added) < MOST_ADDED:
            i = int(np.argmax(errors))
            middle = 0.5 * (cells[i].curve.pressure + cells[i + 1].curve.pressure)
            self.context.progress.experiment("cell", [middle])
            try:
                cell = self._cell(middle, cells[i + 1].curve.pressure)
            except (PieceFailed, RodError) as failure:
                self.limits.append(str(failure).rstrip("."))
                break
            self.context.progress.step_done("cell", middle, 0.0 if cell.is_stored else cell.seconds)
            added.append(middle)
            cells.insert(i + 1, cell)
            errors[i : i + 1] = [self._error_between(*pair) for pair in ((cells[i], cell), (cell, cells[i + 2]))]
        self.error_between = max(errors) / largest
        if len(added) == MOST_ADDED and self.error_between > BETWEEN:
            self.limits.append(
                f"between two pressures the curvature is interpolated to {100 * self.error_between:.2g} % of the "
                f"largest one; {MOST_ADDED} pressures were added and no more are"
            )
        return cells, tuple(sorted(added))

    def _error_between(self, lower: Measured[CellCurve], upper: Measured[CellCurve]) -> float:
        """Largest error of the curvature in the middle between two pressures, 1/mm.

        Zero, and a sentence among the limits, where it cannot be found.
        """
        first, second = lower.curve, upper.curve
        pressure = 0.5 * (first.pressure + second.pressure)
        name = f"between_{first.pressure:.12g}kPa_{second.pressure:.12g}kPa"
        store = self.context.store
        kept = store.read_json(f"law/{name}.json")
        if kept is None or kept["key"] != store.numbers_key:
            piece = self.pieces.cell
            begin, before = perf_counter(), piece.factorizations
            try:
                error = largest_error(piece, section_at((first, second), pressure))
            except (PieceFailed, RodError) as failure:
                reason = str(failure).rstrip(".")
                self.limits.append(f"the interpolation at {pressure:g} kPa could not be checked: {reason}")
                return 0.0
            kept = {"key": store.numbers_key, "error_per_mm": error, "seconds": perf_counter() - begin}
            kept["factorizations"] = piece.factorizations - before
            store.save_json(f"law/{name}.json", kept)
        self.factorizations["between"] += kept["factorizations"]
        self.seconds["between"] += kept["seconds"]
        return float(kept["error_per_mm"])

    def _half_cells(self, cell: CellCurve) -> int:
        """Half cells of the end pieces, so many that two more change the arm's end by less than DECAY."""
        available, length = self.pieces.repetition.half_cells, self.pieces.design.length
        for half_cells in range(1, available // 2 + 1, 2):
            if half_cells + 2 > available:
                self.limits.append("the arm is too short to see how far its ends disturb the cells")
                return half_cells
            try:
                shorter, longer = (self.curves.clamp(cell, k, 0).curve for k in (half_cells, half_cells + 2))
            except PieceFailed:  # reported with the ends
                return half_cells
            self.error_ends = difference(shorter, longer, cell, length)
            if self.error_ends <= DECAY:
                return half_cells
        if self.error_ends > NOT_DECAYED:
            raise NoArmLaw(
                f"the two ends disturb all cells of the arm: end pieces of {half_cells} and {half_cells + 2} half "
                f"cells differ by {100 * self.error_ends:.2g} % of the length at its end"
            )
        self.limits.append(
            f"end pieces of {half_cells} and {half_cells + 2} half cells differ by "
            f"{100 * self.error_ends:.2g} % of the length at the end of the arm, which has no room for longer ones"
        )
        return half_cells

    def _ends(
        self, cells: Sequence[Measured[CellCurve]], half_cells: int
    ) -> tuple[list[ClampCurve], list[TipCurve], list[TipCurve]]:
        """The clamped end and both tips by rising pressure, up to the last one that is borne."""
        progress = self.context.progress
        progress.experiment("ends", [cell.curve.pressure for cell in cells])
        reported = ends_ahead(self.curves, self.context, [(cell.curve, half_cells) for cell in cells])
        clamps: list[ClampCurve] = []
        free: list[TipCurve] = []
        held: list[TipCurve] = []
        for cell in cells:
            try:
                parts = self.curves.ends(cell.curve, half_cells)
            except (PieceFailed, RodError) as failure:
                self.failures.append(str(failure).rstrip("."))
                break
            clamps.append(parts[0].curve)
            free.append(parts[1].curve)
            held.append(parts[2].curve)
            if cell.curve.pressure not in reported:
                stored = all(part.is_stored for part in parts)
                progress.step_done("ends", cell.curve.pressure, 0.0 if stored else sum(part.seconds for part in parts))
            self.limits += cell.limits
            for part in parts:
                self.limits += part.limits
                self._count("ends", part)
        return clamps, free, held

    def _count(self, part: str, measured: Measured[Any]) -> None:
        self.factorizations[part] += measured.factorizations
        self.seconds[part] += measured.seconds

    def _unknowns(self, half_cells: int) -> dict[str, int]:
        """Displacement components by piece."""
        return {
            "cell": 3 * len(self.pieces.cell.space.points),
            "end": 3 * len(self.pieces.end(half_cells, "clamp").space.points),
        }


def _error_along(cells: Sequence[Measured[CellCurve]]) -> float:
    """Largest error of the curvature between two states of a cell, over the largest curvature of all."""
    largest = [float(np.abs(cell.curve.kappa).max()) for cell in cells]
    return max(cell.error * own for cell, own in zip(cells, largest, strict=True)) / max(largest)


def largest_error(piece: BendingPiece, section: SectionLaw) -> float:
    """Largest error of the curvature of a section at one pressure against the cell itself, at CHECKS moments, 1/mm.

    Raises `PieceFailed` where the cell does not reach a curvature of the section.
    """
    rows = np.linspace(0, len(section.moment) - 1, CHECKS + 2).round().astype(int)[1:-1]
    state = piece.rest()
    error = 0.0
    for row in rows[np.argsort(np.abs(section.moment[rows]), kind="stable")]:
        state = piece.solve(section.pressure / 1000.0, float(section.kappa[row]) * piece.body.length, state)
        error = max(error, abs((state.moment - section.moment[row]) * float(section.kappa_slope[row])))
    return error


def difference(first: ClampCurve, second: ClampCurve, cell: CellCurve, length: float) -> float:
    """Largest displacement of the end of an arm of `length` mm by exchanging its clamped end, over the length.

    Both without moment, to first order up to the moment that straightens the cell.
    """
    straight = abs(cell.at(0.0)[0]) * float(np.interp(0.0, cell.moment, cell.rigidity))

    def distance(name: str) -> float:
        """Of the values without moment, and of their slopes at that moment."""
        values, rates = (getattr(first, key)[0] - getattr(second, key)[0] for key in (name, f"{name}_by_moment"))
        return float(np.linalg.norm(values) + straight * np.linalg.norm(rates))

    return distance("rotation") + distance("offset") / length
