"""Where an equilibrium is softest: the eigenvalue of the tangent nearest to zero, and the motion that belongs to it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.system import State, System, Terms

Array = NDArray[np.float64]

ITERATIONS = 30


@dataclass(frozen=True)
class Softest:
    """The direction in which the body resists least."""

    stiffness: float  #: eigenvalue of the tangent nearest to zero, N/mm; negative where the equilibrium is unstable
    motion: Array  #: (n, 3) its eigenvector, of norm 1
    at: tuple[float, float, float]  #: reference position of the node that moves most, mm


def softest_direction(system: System, state: State, terms: Terms) -> Softest:
    """By inverse iteration with the factor of the tangent at an equilibrium.

    Raises `fem.linear.SingularMatrix` at a limit point itself.
    """
    rest = np.zeros_like(state.displacement)
    still = np.zeros_like(state.pressure)
    system.factorize(state, system.assemble(state, terms), terms, rest, convex=False)
    free = ~system.constraints.fixed
    motion = np.where(free, np.random.default_rng(0).normal(size=rest.shape), 0.0)
    stiffness = np.inf
    for _ in range(ITERATIONS):
        motion /= np.linalg.norm(motion)
        answer = -system.solve(motion, still).displacement
        before, stiffness = stiffness, 1.0 / float(np.vdot(motion, answer))
        motion = answer
        if abs(stiffness - before) < 1e-3 * abs(stiffness):
            break
    motion = motion / np.linalg.norm(motion)
    x, y, z = system.space.points[int(np.argmax(np.linalg.norm(motion, axis=1)))]
    return Softest(stiffness, motion, (float(x), float(y), float(z)))
