"""How far the law interpolated halfway between two pressures is from the cell itself."""

from dataclasses import dataclass

import numpy as np

from fem.cell.piece import BendingPiece
from fem.cell.response import inflated
from geometry.arrays import Index
from rod.arm_law.between import doubts
from rod.arm_law.curves import CellCurve
from rod.arm_law.section import SectionLaw, section_at

#: states of the cell that are solved
CHECKS = 5
#: rigidity against bending over the median of the law below which it is not checked: where the moment hardly rises any
#: more, as before a limit point, a small difference of the moment is a large one of the curvature
SOFTEST = 0.1


@dataclass(frozen=True)
class Deviation:
    """Largest deviation of the curvature at equal moments, 1/mm."""

    kappa: float


#: of the file that keeps it
DEVIATION_KEYS = {"kappa_per_mm": "kappa"}


def largest_deviation(piece: BendingPiece, lower: CellCurve, upper: CellCurve) -> Deviation:
    """The deviation at CHECKS states of the cell halfway between two pressures.

    Raises `PieceFailed` where the cell does not reach a curvature of the law, and `RodError` where there is no law.
    """
    section = section_at((lower, upper), 0.5 * (lower.pressure + upper.pressure))
    pressure, rows = section.pressure / 1000.0, _doubtful(section, lower, upper)
    angles = section.kappa * piece.body.length
    state, largest = inflated(piece, pressure, float(angles[rows[0]])), 0.0
    for row in rows:
        state = piece.solve(pressure, float(angles[row]), state)
        difference = (state.moment - section.moment[row]) * section.kappa_slope[row]
        largest = max(largest, abs(float(difference)))
    return Deviation(largest)


def _doubtful(section: SectionLaw, lower: CellCurve, upper: CellCurve) -> Index:
    """Rows (CHECKS,) of the law, by rising amount of the moment: one in each of as many equal ranges of the moment,
    where what the slopes of both curves predict differs most."""
    difference = np.interp(section.kappa, *doubts(lower, upper))
    flexibility = np.abs(section.kappa_slope)
    ranges = np.array_split(np.flatnonzero(flexibility <= np.median(flexibility) / SOFTEST), CHECKS)
    rows = np.array([own[int(np.argmax(difference[own]))] for own in ranges])
    return np.asarray(rows[np.argsort(np.abs(section.moment[rows]), kind="stable")])
