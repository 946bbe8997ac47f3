"""A law moved to the limit of its mesh: at each pressure the moments of a cell times a factor, its curvatures shifted.

With the factor r and the shift s, both functions of the pressure p, that is M(kappa, p) -> r M(kappa - s, p): the same
states of the cell at other moments and curvatures. What a state has besides, such as stretch and ripple, stays with it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from pipeline.law.mesh_limit import Across, MeshLimit, Numbers, across_on, moment_at
from rod.arm_law.curves import CellCurve, ClampCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.moved import Move, moved_cell, moved_clamp
from rod.cubics import cubic, cubic_slope, monotone_slopes


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
