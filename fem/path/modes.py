"""Modes of an equilibrium: the motion in which it falls, and the one in which stress and loads have taken most of the
elastic stiffness."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from fem.effects.effect import Terms
from fem.equations.state import State
from fem.equations.system import System
from fem.reasons import position_of
from fem.supports import COMPONENTS
from geometry.arrays import Array

#: relative error of the eigenvalue of the motion in which an equilibrium falls
TOLERANCE = 1e-3
#: number of power iterations for the stiffness ratio: nearly all motions keep all of their elastic stiffness, so that a
#: small change is no sign of convergence; a motion that keeps a half grows by 2^25
POWER_ITERATIONS = 25


@dataclass(frozen=True)
class Mode:
    """A motion of the body and what resists it."""

    stiffness: float  #: what each function says, negative where the equilibrium is unstable
    motion: Array  #: (n, 3), of norm 1
    position: tuple[float, float, float]  #: reference position of the node that moves most, mm

    @property
    def axis(self) -> str:
        """The axis, x, y or z, along which something moves most."""
        return COMPONENTS[int(np.argmax(np.abs(self.motion).max(axis=0)))]


def falling_mode(system: System, state: State, terms: Terms) -> Mode:
    """The motion in which an unstable equilibrium falls: the eigenvector of the tangent whose eigenvalue is negative
    and, of those, nearest to zero; by the Lanczos method for the inverse. In a stable equilibrium it is the stiffest.

    Its `stiffness` is that eigenvalue, N/mm. Factorizes: earlier factorizations become stale. Raises
    `fem.equations.linear.SingularMatrix` at a limit point itself.
    """
    linearised = system.linearise(state, system.assemble(state, terms), terms)
    start = _random_motion(system)

    def compliance(force: Array) -> Array:
        return np.asarray(-linearised.solve(force.reshape(start.shape)).displacement).ravel()

    inverse = LinearOperator((start.size, start.size), compliance, dtype=float)
    values, motions = eigsh(inverse, k=1, which="SA", v0=start.ravel(), tol=TOLERANCE)
    return _mode(system, 1.0 / float(values[0]), motions[:, 0].reshape(start.shape))


def stiffness_ratio_mode(system: System, state: State, terms: Terms) -> Mode:
    """The mode of the smallest eigenvalue r of K v = r E v, E being the part of the tangent K that comes from the law.

    Its `stiffness` is r, the fraction of the elastic stiffness that stress and loads leave: 1 at rest and 0 at a limit
    point. The eigenvalue of K itself would not tell: a slender body is softer in bending at rest than its walls are
    where they balloon; and compared with the tangent at rest every part that has turned is softer. E is taken without
    the pressures of mixed elements, which a motion that keeps the volume does not feel. Factorizes: earlier
    factorizations become stale. Raises `fem.equations.linear.SingularMatrix` at a limit point itself.
    """
    elastic, assembly = replace(state, stress=np.zeros_like(state.stress)), system.assemble(state, terms)
    linearised = system.linearise(state, assembly, terms)
    motion, ratio = -linearised.solve(_random_motion(system)).displacement, np.inf
    for _ in range(POWER_ITERATIONS):
        motion /= np.linalg.norm(motion)
        _, force = system.tangent(elastic, assembly, (), motion, convex=False)
        answer = -linearised.solve(force.displacement).displacement
        ratio = float(np.vdot(motion, force.displacement) / np.vdot(answer, force.displacement))
        motion = answer
    return _mode(system, ratio, motion)


def _random_motion(system: System) -> Array:
    """A motion (n, 3) that the supports admit, always the same."""
    return system.constraints.project(np.random.default_rng(0).normal(size=system.space.points.shape))


def _mode(system: System, stiffness: float, motion: Array) -> Mode:
    motion = motion / np.linalg.norm(motion)
    most = int(np.argmax(np.linalg.norm(motion, axis=1)))
    return Mode(stiffness, motion, position_of(system.space.points[most]))
