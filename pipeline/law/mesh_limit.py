"""What a mesh makes of a cell: the numbers that are compared, their limits, and laws that are moved to them.

At each pressure the moments of a cell are multiplied by a factor and its curvatures are shifted. With the factor r and
the shift s, both functions of the pressure p, that is M(kappa, p) -> r M(kappa - s, p): the same states of the cell at
other moments and curvatures. What a state has besides, such as stretch, ripple and air, stays with it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import copysign, hypot
from typing import Any, NamedTuple

import numpy as np

from geometry import Reason
from geometry.arrays import Array
from pipeline.values.json_values import JsonObject
from pipeline.values.law import LawMeshError
from pipeline.values.parameters import Column
from pipeline.values.run import SMALLEST_TURN
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.moved import Move, moved_cell, moved_clamp
from rod.cubics import cubic, cubic_slope, monotone_slopes


class Numbers(NamedTuple):
    """What a cell at one pressure is compared by."""

    kappa_0: float  #: curvature without moment, 1/mm
    #: N mm2, mean over a change of the curvature by one over the length of the arm, towards straight: where walls
    #: touch, the slope at a point says more about a node than about the mesh
    rigidity: float
    moment: float  #: that straightens the cell, N mm

    def over(self, length: float) -> "Numbers":
        """By what errors of these numbers are divided; those of an arm of `length` mm that hardly bends are larger."""
        turning = SMALLEST_TURN / length
        return Numbers(
            max(abs(self.kappa_0), turning), self.rigidity, max(abs(self.moment), turning * abs(self.rigidity))
        )


class Across(NamedTuple):
    """What a cell without moment at one pressure is compared by out of its plane, N mm2."""

    lateral_rigidity: float
    torsional_rigidity: float


@dataclass(frozen=True)
class CellMesh:
    """A mesh of the cell that was tried."""

    size_mm: float
    degrees_of_freedom: int
    error: float  #: largest relative distance of its numbers from their limits
    seconds: float  #: processor time
    kappa_0_per_mm: tuple[float | None, ...]  #: by pressure; None where the cell does not bear it
    rigidity_N_mm2: tuple[float | None, ...]
    moment_N_mm: tuple[float | None, ...]


@dataclass(frozen=True)
class MeshLimit:
    """The numbers of the cell in the limit of its mesh, and the meshes that they come from."""

    requested: float  #: relative error
    reached: float  #: largest relative standard deviation of a limit
    pressures_kPa: tuple[float, ...]  #: from rest on
    limits: tuple[Numbers, ...]  #: by pressure
    stds: tuple[Numbers, ...]
    meshes: tuple[CellMesh, ...]  #: the coarsest first
    across: Mapping[float, tuple[Across, Across]]  #: limits and standard deviations by pressure; empty: not measured
    reasons: tuple[Reason, ...] = ()  #: why finer meshes were not tried, and pressures without a limit

    @property
    def is_reached(self) -> bool:
        """Whether the error is within the requested one."""
        return self.reached <= self.requested

    def record(self) -> JsonObject:
        """The key `accuracy` of law.json."""
        common = {"requested": self.requested, "reached": self.reached, "is_reached": self.is_reached}
        return {**common, "pressures_kPa": self.pressures_kPa, "meshes": [asdict(mesh) for mesh in self.meshes]}

    def error_of(self, cells: Sequence[CellCurve], length: float, size_mm: float) -> LawMeshError:
        """Of a law on a mesh of that size: how far its numbers are from the limit, and how uncertain that is.

        length: mm, of the arm.
        """
        limits = {p: row for p, *row in zip(self.pressures_kPa, self.limits, self.stds, strict=True)}
        rows = []
        for cell in cells:
            if cell.pressure and (known := limits.get(cell.pressure)):
                own = numbers_on(cell, length, known[0])
                rows.append(
                    (cell.pressure, own, Numbers(*(hypot(a - b, c) for a, b, c in zip(own, *known, strict=True))))
                )
        columns: dict[str, Any] = {}
        for i, name in enumerate(("kappa_0_per_mm", "rigidity_N_mm2", "moment_N_mm")):
            columns[name] = tuple(own[i] for _, own, _ in rows)
            columns[f"{name}_std"] = tuple(std[i] for _, _, std in rows)
        out_of_plane = {cell.pressure: cell for cell in cells if cell.is_in_space and cell.pressure in self.across}
        if rows and out_of_plane:
            columns |= self._errors_across([out_of_plane.get(row[0]) for row in rows])
        return LawMeshError(size_mm, self.meshes[-1].size_mm, tuple(row[0] for row in rows), **columns)

    def _errors_across(self, cells: Sequence[CellCurve | None]) -> dict[str, Column]:
        """Columns of the rigidities of these cells out of their plane, and of their standard deviations."""
        rows: list[tuple[float | None, ...]] = []
        for cell in cells:
            if cell is None:
                rows.append((None,) * 4)
                continue
            own = across_on(cell)
            errors = (hypot(a - b, c) for a, b, c in zip(own, *self.across[cell.pressure], strict=True))
            rows.append((*own, *errors))
        names = [f"{name}_N_mm2{std}" for std in ("", "_std") for name in Across._fields]
        return dict(zip(names, zip(*rows, strict=True), strict=True))

    @property
    def remarks(self) -> tuple[Reason, ...]:
        """The error that is left, and why it is not smaller."""
        values = {"percent": 100.0 * self.requested, "size_mm": self.meshes[-1].size_mm}
        made = Reason("cell_accuracy", values | {"reached_percent": 100.0 * self.reached})
        return (made, *self.reasons)


def across_on(cell: CellCurve) -> Across:
    """Those of a curve with rigidities out of the plane."""
    return Across(*(float(np.interp(0.0, cell.moment, getattr(cell, name))) for name in Across._fields))


def numbers_on(cell: CellCurve, length: float, unknown: Numbers) -> Numbers:
    """The numbers of a curve, those of `unknown` where it does not reach them; length: mm, of the arm."""
    kappa_0 = cell.at(0.0)[0]
    change = change_for(kappa_0, length)
    moment, bent = moment_at(cell, 0.0), moment_at(cell, kappa_0 + change)
    rigidity = unknown.rigidity if bent is None else bent / change
    return Numbers(kappa_0, rigidity, unknown.moment if moment is None else moment)


def moment_at(cell: CellCurve, kappa: float) -> float | None:
    """N mm, where the cubics of the curvature over the moment have a curvature in 1/mm; None beyond the curve."""
    low, high = float(cell.moment[0]), float(cell.moment[-1])
    if not cell.kappa[0] <= kappa <= cell.kappa[-1]:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if cell.at(middle)[0] < kappa else (low, middle)
    return 0.5 * (low + high)


def change_for(kappa_0: float, length: float) -> float:
    """The change of the curvature for the rigidity, 1/mm; length: mm, of the arm."""
    return -copysign(1.0 / length, kappa_0)


@dataclass(frozen=True, eq=False)  # arrays inside
class Corrections:
    """By pressure, from rest on: monotone cubics between, constant beyond the last."""

    pressures: Array  #: (n,) kPa, rising
    shift: Array  #: (n,) 1/mm
    ratio: Array  #: (n,)
    #: pressures (m,) in kPa, and (m, 2) factors of the rigidities of `Across`; None: not corrected
    across: tuple[Array, Array] | None = None

    @staticmethod
    def of(cells: Sequence[CellCurve], own: Mapping[float, Numbers], limit: MeshLimit, length: float) -> "Corrections":
        """From cells with their own numbers by pressure to those in the limit; none where they have none in common.

        length: mm, of the arm.
        """
        curves, rows = {cell.pressure: cell for cell in cells}, [(0.0, 0.0, 1.0)]
        for pressure, numbers in zip(limit.pressures_kPa, limit.limits, strict=True):
            if pressure in own and (cell := curves.get(pressure)):
                rows = [row for row in rows if row[0] != pressure]
                rows.append((pressure, numbers.kappa_0 - cell.at(0.0)[0], _ratio(cell, own[pressure], numbers, length)))
        pressures, shift, ratio = np.array(rows).T
        return Corrections(pressures, shift, ratio, _across(cells, limit))

    def at(self, pressure: float) -> Move:
        """The move of the states at a pressure in kPa."""
        (shift, shift_slope), (ratio, ratio_slope) = (self._at(column, pressure) for column in (self.shift, self.ratio))
        return Move(shift, ratio, shift_slope=shift_slope, ratio_slope=ratio_slope)

    def out_of_plane(self, pressure: float) -> Array:
        """(2,) factors of the rigidities of `Across` at a pressure in kPa, by straight lines over the pressure."""
        if self.across is None:
            return np.ones(2)
        pressures, factors = self.across
        return np.array([np.interp(pressure, pressures, column) for column in factors.T])

    def _at(self, column: Array, pressure: float) -> tuple[float, float]:
        if len(column) < 2:
            return float(column[0]), 0.0
        slopes = monotone_slopes(self.pressures, column)
        inside = min(pressure, float(self.pressures[-1]))
        value, slope = (float(f(self.pressures, column, slopes, inside)) for f in (cubic, cubic_slope))
        return value, slope if inside == pressure else 0.0


def _across(cells: Sequence[CellCurve], limit: MeshLimit) -> tuple[Array, Array] | None:
    """Pressures and factors from the rigidities of cells out of the plane to those in the limit."""
    own = {cell.pressure: across_on(cell) for cell in cells if cell.is_in_space and cell.pressure in limit.across}
    known = {pressure: np.divide(limit.across[pressure][0], of_cell) for pressure, of_cell in own.items()}
    return (np.array(list(known)), np.array(list(known.values()))) if known else None


def corrected(law: ArmLaw, corrections: Corrections) -> ArmLaw:
    """The law with its cells and clamped ends at their corrected moments and curvatures."""
    across = [corrections.out_of_plane(pressure) for pressure in law.pressures]
    moves = [corrections.at(pressure) for pressure in law.pressures]
    cells = tuple(moved_cell(*pair) for pair in zip(law.cells, moves, strict=True))
    clamps = tuple(moved_clamp(*pair) for pair in zip(law.clamps, moves, strict=True))
    return replace(
        law,
        cells=tuple(_cell_across(*pair) for pair in zip(cells, across, strict=True)),
        clamps=tuple(_clamp_across(*pair) for pair in zip(clamps, across, strict=True)),
        rates={name: rate.with_moments([move.ratio for move in moves], across) for name, rate in law.rates.items()},
    )


def _ratio(cell: CellCurve, own: Numbers, limit: Numbers, length: float) -> float:
    """Of the moments in the limit over those of a cell: where it is straight, if that bends it by more than one over
    the length of the arm, else where it is bent by that much, on which the curve need not reach."""
    if abs(limit.kappa_0) > 1.0 / length:
        straight = moment_at(cell, cell.at(0.0)[0] - limit.kappa_0)
        if straight is not None:
            return limit.moment / straight
    return limit.rigidity / own.rigidity


def _cell_across(curve: CellCurve, factors: Array) -> CellCurve:
    """The curve with its rigidities of `Across` times their factors (2,)."""
    columns = zip(Across._fields, factors, strict=True)
    return replace(curve, **{name: factor * getattr(curve, name) for name, factor in columns})


def _clamp_across(curve: ClampCurve, factors: Array) -> ClampCurve:
    """The clamped end is stiffer by the factors (2,) of the cells, as it is in the plane.

    That of GJ belongs to torques and that of B_2 to moments about the normal. Turns by the other of the two have the
    mean of both, so that reciprocity holds. Nothing changes where a cell is unstable out of its plane.
    """
    if not curve.lateral_compliance.size or factors.min() <= 0.0:
        return curve
    roots = np.sqrt(factors[::-1])
    return replace(curve, lateral_compliance=curve.lateral_compliance / np.outer(roots, roots))
