"""How far the law interpolated halfway between two pressures is from the cell itself."""

import numpy as np

from fem.cell.piece import BendingPiece
from fem.cell.response import inflated
from geometry.arrays import Index
from pipeline.values.pressure import in_MPa
from rod.arm_law.between import measure_disagreement
from rod.arm_law.curves import CellCurve
from rod.arm_law.section import SectionLaw, section_at

#: states of the cell that are solved
CHECKS = 5


def largest_deviation(piece: BendingPiece, lower: CellCurve, upper: CellCurve) -> float:
    """Largest deviation of the curvature at equal moments, 1/mm, at CHECKS states halfway between two pressures.

    From the state of the smallest moment the cell is bent to one side and then to the other: a change of the sides at
    once may lead to equilibria in which a wall has buckled, which the law does not describe. Raises `PieceFailed` where
    the cell does not reach a curvature of the law, and `RodError` where there is no law.
    """
    halfway = 0.5 * (lower.pressure + upper.pressure)
    section = section_at((lower.placed, upper.placed), halfway, halfway)
    pressure, rows = in_MPa(section.pressure), _doubtful(section, lower, upper)
    angles = section.kappa * piece.body.length
    first, largest = rows[np.argmin(np.abs(section.moment[rows]))], 0.0
    middle = inflated(piece, pressure, float(angles[first]))
    for side in (rows[rows >= first], rows[rows < first][::-1]):
        state = middle
        for row in side:
            state = piece.solve(pressure, float(angles[row]), state)
            difference = (state.moment - section.moment[row]) * section.kappa_slope[row]
            largest = max(largest, abs(float(difference)))
    return largest


def _doubtful(section: SectionLaw, lower: CellCurve, upper: CellCurve) -> Index:
    """Rows (CHECKS,) of the law, rising: one in each of as many equal ranges of the moment, where what the slopes of
    both curves predict differs most."""
    difference = np.interp(section.kappa, *measure_disagreement(lower.placed, upper.placed))
    ranges = np.array_split(np.arange(len(section.moment)), CHECKS)
    return np.array([own[int(np.argmax(difference[own]))] for own in ranges])
