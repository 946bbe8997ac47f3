"""A rod whose intrinsic curvature was measured under its weight: what of it the weight has bent.

With M_w(s) the moment of the weight on the shape of kappa_0, for which it is in equilibrium where nothing else acts,

    kappa = kappa_0 + (M - M_w - m0)/alpha = (kappa_0 - M_w/alpha) + (M - m0)/alpha,

so that a rod with the curvature kappa_0 - M_w/alpha which carries its weight is that rod. M is then the moment of all
loads. Everything is dimensionless as in `shooting`.
"""

import numpy as np

from geometry.arrays import Array
from rod.cubics import hermite
from rod.mechanics.profile import Steps
from rod.mechanics.shooting import ABSCISSAE, RodArrays, sweep


def moment_of_weight(steps: Steps, stretch: Array, weight: Array, theta0: float) -> Array:
    """(n, 6) M_w at the stages of every step, by the cubics of its values and slopes at the ends of the step.

    stretch: (n, 6) of the shape of kappa_0; weight: (4,) as in `shooting`; theta0: rad, at the clamp.
    """
    n = len(steps.s) - 1
    rigid = RodArrays(steps.s, steps.kappa_0, stretch, np.full(n, np.inf), np.zeros(n), 0.0, 0.0, theta0)
    states = np.empty((n + 1, 4))
    sweep(rigid, np.zeros(3), weight, states, np.empty(16))
    moment = states[:, 1] - states[-1, 1]
    cosine, sine = np.cos(states[:, 0]), np.sin(states[:, 0])
    across, couple = (1.0 - steps.s) * (weight[0] * sine - weight[1] * cosine), weight[2] * cosine + weight[3] * sine
    step = np.diff(steps.s)
    first, last = step * (stretch[:, 0] * across[:-1] + couple[:-1]), step * (stretch[:, 1] * across[1:] + couple[1:])
    return np.ascontiguousarray(hermite(ABSCISSAE[:, None], moment[:-1], moment[1:], first, last).T)
