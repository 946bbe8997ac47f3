"""A rod whose intrinsic curvature was measured under its weight: what moment it has in that shape.

Where nothing else acts the weight is in equilibrium on the shape of kappa_0. With M_0(s) the moment that it has there
about the neutral axis, the law of the rod relates changes from this state (see `shooting`):

    kappa = kappa_0 + (M + e N - M_0 - m0)/alpha

M is the moment of all loads. Everything is dimensionless as in `shooting`.
"""

import numpy as np

from geometry.arrays import Array
from rod.cubics import hermite
from rod.mechanics.luther import ABSCISSAE
from rod.mechanics.profile import Steps
from rod.mechanics.shooting import RodArrays, sweep

#: which of ABSCISSAE the beginning and the end of a step are, and their nodes
_ENDS = ((0, slice(None, -1)), (1, slice(1, None)))


def rest_moment(steps: Steps, stretch: Array, weight: Array, theta0: float, eccentricity: float) -> tuple[float, Array]:
    """M of the weight at the clamp, and (n, 6) M_0 at the stages of every step, by the cubics of its values and slopes
    at the ends of the step.

    stretch: (n, 6) of the shape of kappa_0; weight: (4,) as in `shooting`; theta0: rad, at the clamp;
    eccentricity: of the neutral axis, over the length.
    """
    states = np.empty((len(steps.s), 4))
    sweep(_rigid(steps, stretch, theta0), np.zeros(3), weight, states, np.empty(16))
    cosine, sine, beyond = np.cos(states[:, 0]), np.sin(states[:, 0]), 1.0 - steps.s
    along, across = weight[0] * cosine + weight[1] * sine, weight[0] * sine - weight[1] * cosine
    of_curve = states[:, 1] - states[-1, 1]
    moment = of_curve + eccentricity * beyond * along
    couple = weight[2] * cosine + weight[3] * sine - eccentricity * along
    step, slopes = np.diff(steps.s), []
    for at, nodes in _ENDS:
        lever = stretch[:, at] - eccentricity * steps.kappa_0[:, at]
        slopes.append(step * (lever * (beyond * across)[nodes] + couple[nodes]))
    stages = hermite(ABSCISSAE[:, None], moment[:-1], moment[1:], *slopes)
    return float(of_curve[0]), np.ascontiguousarray(stages.T)


def _rigid(steps: Steps, stretch: Array, theta0: float) -> RodArrays:
    """The rod with the shape of kappa_0, whatever acts on it."""
    n, zero = len(steps.s) - 1, np.zeros_like(steps.kappa_0)
    return RodArrays(steps.s, steps.kappa_0, stretch, np.full(n, np.inf), np.zeros(n), zero, 0.0, 0.0, theta0)
