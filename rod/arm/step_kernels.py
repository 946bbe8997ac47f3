"""A step in time of a chain of elements: generalised-alpha on the residual and tangent of `rod.arm`.

Forces are those at a time within the step; motions that no step resolves die out. J. Chung, G. M. Hulbert, J. Appl.
Mech. 60 (1993) 371; for rotations O. Bruels, A. Cardona, J. Comput. Nonlinear Dynam. 5 (2010) 031002. Branches of the
rubber are integrated exactly for forces that change evenly from one such time to the next.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.arm.chain import solve_chain
from rod.arm.newton import Inertia, NewtonResult, _newton
from rod.arm.nodes import FORCES, ArmArrays, Chain, LoadArrays, StateArrays, Tangent
from rod.arm.rotations import cross_into, exponential, logarithm, multiply, turn_matrix
from rod.arm.section_kernels import TABULATED, SectionArrays
from rod.compiled import CompiledLater

#: part of a motion that no step resolves which is left after a step
RHO = 0.6
#: weight of the last acceleration; where in a step the forces are taken; and the numbers of Newmark's formulas
LAST, WITHIN = (2.0 * RHO - 1.0) / (RHO + 1.0), 1.0 / (RHO + 1.0)
BETA, GAMMA = 0.25 * (2.0 - LAST - WITHIN) ** 2, 1.5 - LAST - WITHIN
#: error of a step over the change of the acceleration times its square
ERROR = abs(BETA - 1.0 / 6.0)
#: pieces of a smooth table, of which the first and the last are beyond the law
PIECES = 10
#: iterations of Newton's method
ITERATIONS = 25


class Bodies(NamedTuple):
    """What the nodes are as rigid bodies, tonne and mm."""

    mass: Array  #: (N,)
    first: Array  #: (N, 3) and second (N, 3, 3) moments, as in `rod.arm.newton.Inertia`
    second: Array
    means: Array  #: (3, N) weights of means of the places over the length, in which short waves cancel


class Moving(NamedTuple):
    """An arm in motion at the end of a step, in tonne, mm and s."""

    state: StateArrays
    speed: Array  #: (N, 6) of places and turns
    acceleration: Array  #: (N, 6)
    elastic: Array  #: (n, f) N mm and N, elastic forces of the elements at the last time within a step
    branches: Array  #: (K, n, f) of the rubber then


class StepReport(NamedTuple):
    """What is told of a step, beside its end."""

    converged: bool
    error: float  #: of means of the places over the length
    fast: float  #: 1/s, the speed of these means over the length
    outside: float  #: 1/mm, by how much a curvature leaves the law


def _moved(chain: Chain, state: StateArrays, motion: Array) -> StateArrays:
    """A copy of a state after a motion (N, 6)."""
    place, angle, frames, turned = state.place.copy(), state.angle.copy(), state.frames.copy(), np.empty((3, 3))
    for node in range(len(place)):
        for i in range(3):
            place[node, i] += motion[node, i]
        angle[node] += motion[node, 5]
        if chain.in_space:
            exponential(motion[node, 3:], turned)
            multiply(turned, state.frames[node], frames[node])
    return StateArrays(place, angle, frames, state.inner.copy(), state.reaction.copy())


def _motion(chain: Chain, before: StateArrays, after: StateArrays) -> Array:
    """(N, 6) between two states."""
    motion, turned = np.zeros((len(after.place), 6)), np.empty((3, 3))
    for node in range(len(motion)):
        for i in range(3):
            motion[node, i] = after.place[node, i] - before.place[node, i]
        motion[node, 5] = after.angle[node] - before.angle[node]
        if chain.in_space:
            multiply(after.frames[node], before.frames[node].T, turned)
            logarithm(turned, motion[node, 3:])
    return motion


def _largest(bodies: Bodies, motion: Array) -> float:
    """The largest component of the means of motions (N, 6)."""
    largest = 0.0
    for k in range(len(bodies.means)):
        for i in range(3):
            mean = 0.0
            for node in range(len(motion)):
                mean += bodies.means[k, node] * motion[node, i]
            largest = max(largest, abs(mean))
    return largest


def _outside(section: SectionArrays, kept: Array, column: int, found: float) -> float:
    """1/mm, by how much curvatures, in a column of what is kept of the elements, leave the law.

    found: by how much they leave the table, which goes beyond the law where it is one of `rod.in_time.body.smooth`.
    """
    if section.kind != TABULATED:
        return found
    step, pieces = section.numbers[1], section.table.shape[1]
    low, high = section.numbers[0] + step * (pieces // PIECES), section.numbers[0] + step * (pieces - pieces // PIECES)
    outside = 0.0
    for e in range(len(kept)):
        kappa = kept[e, column] + section.local[e, 0]
        outside = max(outside, low - kappa, kappa - high)
    return outside


def _inertia(now: Moving, bodies: Bodies, dt: float) -> tuple[Array, Inertia]:
    """The motion (N, 6) that is known of a step, without that by the last acceleration; and what resists."""
    state, v, a, by = now.state, now.speed, now.acceleration, 1.0 / (BETA * dt * dt)
    known, carried = dt * v + dt * dt * (0.5 - BETA) * a, np.empty((len(v), 9))
    carried[:, :6] = LAST * a - (1.0 - LAST) * by * known
    carried[:, 6:] = (v + WITHIN * (dt * (1.0 - GAMMA) * a - GAMMA * by * dt * known))[:, 3:]
    rates = np.array([(1.0 - LAST) * by / WITHIN, GAMMA * by * dt])
    inertia = Inertia(bodies.mass, bodies.first, bodies.second, state.place, state.angle, state.frames, carried, rates)
    return known, inertia


def _found(
    arm: ArmArrays, load: LoadArrays, now: Moving, inertia: Inertia, room: Tangent, dt: float, since: float
) -> tuple[NewtonResult, StateArrays]:
    """The state at the time within a step; since: as of `_advance`."""
    guess, motion = now.speed + 0.5 * WITHIN * dt * now.acceleration, np.empty((len(now.speed), 6))
    moved, found = now.state, NewtonResult(False, math.inf, math.inf, (0, 0), 0)
    for without in (since, 0.0):  # without mass a node may have moved to where it does not stay
        for node in range(len(motion)):
            motion[node] = (WITHIN * dt if inertia.mass[node] > 0.0 else without) * guess[node]
        moved = _moved(arm.chain, now.state, motion)
        found = _newton(arm, load, moved, 1.0, room, ITERATIONS, np.empty(0), inertia)
        if found.converged:
            break
    return found, moved


def _advance(
    arm: ArmArrays, load: LoadArrays, now: Moving, bodies: Bodies, room: Tangent, decay: Array, slowed: Array,
    dt: float, since: float,
) -> tuple[Moving, StepReport]:  # fmt: skip
    """The end of a step dt in s; since: s, from the last time within a step to that of this one.

    decay: (K,) what is left of the branches then; slowed: (K,) the mean of that on the way, times their shares.
    """
    v, a, chain, part = now.speed, now.acceleration, arm.chain, arm.section
    held, more, nodes = np.zeros((0, 0)), 0.0, len(v)
    if len(decay):
        more, held = slowed.sum(), np.zeros(now.elastic.shape)
        for k in range(len(decay)):
            held += decay[k] * now.branches[k]
        held -= more * now.elastic
    section = SectionArrays(part.kind, part.table, part.numbers, part.local, 1.0 + more, held)
    known, inertia = _inertia(now, bodies, dt)
    found, moved = _found(ArmArrays(section, arm.ends, chain), load, now, inertia, room, dt, since)
    if not found.converged:
        return now, StepReport(False, math.inf, 0.0, found.outside)
    motion = _motion(chain, now.state, moved)
    speed, later = np.empty((nodes, 6)), np.zeros((nodes, 6))
    for node in range(nodes):
        if bodies.mass[node] > 0.0:
            later[node] = (motion[node] / WITHIN - known[node]) / (BETA * dt * dt)
            speed[node] = v[node] + dt * ((1.0 - GAMMA) * a[node] + GAMMA * later[node])
        else:
            speed[node] = motion[node] / since
            motion[node] = 0.0
    first, elastic, branches = FORCES[1] if chain.in_space else FORCES[0], now.elastic, now.branches
    if len(decay):
        elastic, branches = np.empty_like(now.elastic), np.empty_like(now.branches)
        elastic[:] = (room.kept[:, first : first + elastic.shape[1]] - held) / (1.0 + more)
        for k in range(len(decay)):
            branches[k] = decay[k] * now.branches[k] + slowed[k] * (elastic - now.elastic)
    moved = _moved(chain, moved, (1.0 / WITHIN - 1.0) * motion)
    outside = _outside(section, room.kept, 2 if chain.in_space else 1, found.outside)
    error, fast = ERROR * dt * dt * _largest(bodies, later - a), _largest(bodies, speed)
    return Moving(moved, speed, later, elastic, branches), StepReport(
        True, error / chain.length, fast / chain.length, outside
    )


#: what is called of turns; and a step, compiled at its first call
OF_TURNS = (cross_into, turn_matrix, exponential, logarithm, multiply)
advance = CompiledLater(_advance, (solve_chain, *OF_TURNS, _moved, _motion, _largest, _outside, _inertia, _found), 0)
