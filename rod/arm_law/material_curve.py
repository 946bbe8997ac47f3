"""The material curve beside the axis of a rod with the arm's own law."""

import numpy as np

from geometry.arrays import Array
from rod.arm_law.section import SectionLaw


def ripple(law: SectionLaw, from_middle: Array, moment: Array) -> Array:
    """(m, 2) mm: the material curve beside the axis within the cells, along and normal to it.

    from_middle: (m,) mm, from the middle of the nearest cell, of which both halves are mirror images. moment: (m,).
    """
    row = np.clip((moment - law.moment[0]) / (law.moment[1] - law.moment[0]), 0.0, len(law.moment) - 1.0)
    i = np.minimum(row.astype(int), len(law.moment) - 2)
    t = row - i
    column = np.clip(np.searchsorted(law.s, np.abs(from_middle), side="right") - 1, 0, len(law.s) - 2)
    u = (np.abs(from_middle) - law.s[column]) / (law.s[column + 1] - law.s[column])
    corner = law.ripple
    values = (1 - t)[:, None] * ((1 - u)[:, None] * corner[i, column] + u[:, None] * corner[i, column + 1])
    values += t[:, None] * ((1 - u)[:, None] * corner[i + 1, column] + u[:, None] * corner[i + 1, column + 1])
    values[:, 0] *= np.where(from_middle < 0.0, -1.0, 1.0)
    return np.asarray(values)
