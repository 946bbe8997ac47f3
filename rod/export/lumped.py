"""The rod as a chain: the contribution of a piece to one joint.

Over an interval the tangent turns by the integral of kappa_0 + (M - m0)/alpha. With M nearly constant over it that is

    rest rotation + M * compliance,   rest rotation = integral of kappa_rest,   compliance = integral of 1/alpha

so a joint with the spring 1/compliance and the neutral angle `rest rotation` represents the five parameters, wherever
d lies in the interval; the error of a chain of n joints is of order 1/n^2.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from geometry.arrays import Array
from rod.errors import RodError
from rod.load import Load
from rod.mechanics.equilibrium import Rod


@dataclass(frozen=True)
class Joints:
    """Springs at the middles of the intervals of a rod that carries a load."""

    edges: Array  #: (n + 1,) mm, from 0 to the length
    compliance: Array  #: (n,) rad/(N mm)
    rest_rotation: Array  #: (n,) rad


def cut_into_joints(rod: Rod, edges: Array) -> Joints:
    """The rod cut at `edges`, (n + 1,) mm rising from 0 to the length. Raises `RodError` for other edges."""
    edges = np.asarray(edges, float)
    if edges.ndim != 1 or len(edges) < 3 or np.any(np.diff(edges) <= 0.0) or edges[0] != 0.0:
        raise RodError("A rod is cut into at least two pieces by lengths that rise from 0.")
    if abs(edges[-1] - rod.length) > 1e-9 * rod.length:
        raise RodError(f"The last cut must be the end of the rod, {rod.length:g} mm, not {edges[-1]:g} mm.")
    law, rest = rod.five, rod.under(Load())
    turned = CubicHermiteSpline(rest.s, rest.theta, rest.kappa)(np.minimum(edges, rod.length))
    first = np.minimum(edges, law.d)
    compliance = first / law.alpha1 + (edges - first) / law.alpha2
    offset = first * law.m01 / law.alpha1 + (edges - first) * law.m02 / law.alpha2
    return Joints(edges, np.diff(compliance), np.diff(turned - offset))
