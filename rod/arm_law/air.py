"""Air in the cavities of an arm whose rod has been solved, from the volumes that its own law has."""

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import interpolate_columns
from rod.arm_law.curves import ClampCurve, TipCurve
from rod.arm_law.section import SectionLaw
from rod.errors import RodError


def air_volumes(section: SectionLaw, clamp: ClampCurve, tip: TipCurve, s: Array, bending: Array) -> Array:
    """(c,) mm3: air in each cavity of an arm of these parts, whose cells bend by moments (n,) in N mm at s (n,) in mm.

    Air of cells all along the arm, and what the pieces at both ends have besides: the clamped end at the moment that
    decides there, the tip without moment. Raises `RodError` for parts without volumes.
    """
    if not (section.volume.size and clamp.volume.size and tip.volume.size):
        raise RodError("The law has no volumes of the air; measure it anew with `pneurod cell`.")

    def of_cells(moment: Array) -> Array:
        return interpolate_columns(moment, section.moment, section.volume)

    clamped = np.interp([clamp.position], s, bending)
    at_clamp = clamp.volume_at(clamped) - float(clamp.s[-1]) * of_cells(clamped)
    at_tip = tip.volume + float(tip.s[0]) * of_cells(np.zeros(1))
    return np.asarray(np.trapezoid(of_cells(bending), s, axis=0) + at_clamp[0] + at_tip[0])
