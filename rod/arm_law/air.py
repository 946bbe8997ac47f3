"""Air in the cavities of an arm whose rod has been solved, from the volumes that its own law has."""

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import interpolate_columns
from rod.arm_law.curves import ClampCurve, TipCurve
from rod.arm_law.section import SectionLaw
from rod.errors import RodError
from rod.solution import RodSolution


def air_volumes(section: SectionLaw, clamp: ClampCurve, tip: TipCurve, state: RodSolution) -> Array:
    """(c,) mm3: air in each cavity of the arm in a state of the rod of these parts.

    Air of cells all along the arm, and what the pieces at both ends have besides: the clamped end at the moment that
    decides there, the tip without moment. Raises `RodError` for parts without volumes.
    """
    if not (section.volume.size and clamp.volume.size and tip.volume.size):
        raise RodError("The law has no volumes of the air; measure it anew with `pneurod cell`.")

    def of_cells(moment: Array) -> Array:
        return interpolate_columns(moment, section.moment, section.volume)

    clamped = np.interp([clamp.position], state.s, state.moment)
    at_ends = _of_ends(section, clamp, tip, clamped)[0]
    return np.asarray(np.trapezoid(of_cells(state.moment), state.s, axis=0) + at_ends)


def air_along(section: SectionLaw, clamp: ClampCurve, tip: TipCurve, h: Array, kappa: Array) -> Array:
    """(t, c) mm3: the same of elements of lengths h (n,) in mm with curvatures (t, n) in 1/mm."""
    if not section.volume.size:
        return np.empty((len(kappa), 0))
    decides = min(int(np.searchsorted(np.cumsum(h), clamp.position)), len(h) - 1)
    clamped = np.interp(kappa[:, decides], section.kappa, section.moment)
    cells = [np.interp(kappa, section.kappa, column) @ h for column in section.volume.T]
    return np.asarray(np.column_stack(cells) + _of_ends(section, clamp, tip, clamped))


def _of_ends(section: SectionLaw, clamp: ClampCurve, tip: TipCurve, clamped: Array) -> Array:
    """(k, c) mm3: air of both ends beyond that of cells, at moments (k,) in N mm that decide on the clamp."""
    cells = interpolate_columns(np.append(clamped, 0.0), section.moment, section.volume)
    at_clamp = clamp.volume_at(clamped) - float(clamp.s[-1]) * cells[:-1]
    return np.asarray(at_clamp + tip.volume + float(tip.s[0]) * cells[-1])
