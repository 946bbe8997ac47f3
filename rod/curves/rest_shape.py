"""The shape of an unloaded arm as the rest shape of a rod."""

import numpy as np
from scipy.interpolate import CubicSpline

from geometry import Centreline
from geometry.arrays import Array


def rest_curvature(free: Centreline) -> tuple[float, Array]:
    """theta (rad) at the clamp, and (n, 2) columns s (mm) and kappa (1/mm) at the nodes of the unloaded shape.

    The integral of theta is a cubic spline through the chords, so that a rod with this curvature, straight between
    nodes, has the chords' directions. It has the ripple and the noise of the shape; only its integrals matter.
    """
    s = free.s - free.s[0]
    rise = np.cumsum(np.diff(s) * free.angle)
    integral = CubicSpline(s, np.concatenate([[0.0], rise]))
    return float(integral(0.0, 1)), np.column_stack([s, integral(s, 2)])
