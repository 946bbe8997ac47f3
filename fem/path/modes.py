"""Where an equilibrium is softest, by the eigenvalue of the tangent nearest to zero, and where stress and loads have
taken most of the elastic stiffness; and the motions that belong to them."""

from dataclasses import dataclass, replace

import numpy as np

from fem.effects.effect import Terms
from fem.equations.state import State
from fem.equations.system import System
from geometry.arrays import Array

ITERATIONS = 30
#: iterations for the share of the elastic stiffness: nearly all motions keep all of it, so that standing still is no
#: sign of having arrived; a motion that keeps a half grows by 2^25
POWERS = 25


@dataclass(frozen=True)
class Softest:
    """The direction in which the body resists least."""

    stiffness: float  #: eigenvalue of the tangent nearest to zero, N/mm; negative where the equilibrium is unstable
    motion: Array  #: (n, 3) its eigenvector, of norm 1
    at: tuple[float, float, float]  #: reference position of the node that moves most, mm


def softest_direction(system: System, state: State, terms: Terms) -> Softest:
    """By inverse iteration with the tangent at an equilibrium.

    Factorizes: earlier factorizations become stale. Raises `fem.equations.linear.SingularMatrix` at a limit point
    itself.
    """
    linearised = system.linearise(state, system.assemble(state, terms), terms)
    motion = system.constraints.project(np.random.default_rng(0).normal(size=state.displacement.shape))
    stiffness = np.inf
    for _ in range(ITERATIONS):
        motion /= np.linalg.norm(motion)
        answer = -linearised.solve(motion).displacement
        before, stiffness = stiffness, 1.0 / float(np.vdot(motion, answer))
        motion = answer
        if abs(stiffness - before) < 1e-3 * abs(stiffness):
            break
    return Softest(stiffness, *_largest(system, motion))


def most_softened(system: System, state: State, terms: Terms) -> Softest:
    """The smallest eigenvalue of K v = share E v, E being the part of the tangent K that comes from the law alone.

    Its `stiffness` is what stress and loads leave of the elastic stiffness, 1 at rest and 0 at a limit point. The
    eigenvalue of K itself would not tell: a slender body is softer in bending at rest than its walls are where they
    balloon; and against the tangent at rest every part that has turned is softer. E is taken without the pressures of
    mixed elements, which a motion that keeps the volume does not feel. Earlier factorizations become stale. Raises
    `fem.equations.linear.SingularMatrix` at a limit point itself.
    """
    elastic, assembly = replace(state, stress=np.zeros_like(state.stress)), system.assemble(state, terms)
    linearised = system.linearise(state, assembly, terms)
    random = system.constraints.project(np.random.default_rng(0).normal(size=state.displacement.shape))
    motion, share = -linearised.solve(random).displacement, np.inf
    for _ in range(POWERS):
        motion /= np.linalg.norm(motion)
        _, pulled = system.tangent(elastic, assembly, (), motion, convex=False)
        answer = -linearised.solve(pulled.displacement).displacement
        share = float(np.vdot(motion, pulled.displacement) / np.vdot(answer, pulled.displacement))
        motion = answer
    return Softest(share, *_largest(system, motion))


def _largest(system: System, motion: Array) -> tuple[Array, tuple[float, float, float]]:
    """The motion with norm 1, and where at rest the node stands that moves most."""
    motion = motion / np.linalg.norm(motion)
    x, y, z = system.space.points[int(np.argmax(np.linalg.norm(motion, axis=1)))]
    return motion, (float(x), float(y), float(z))
