"""Newton's method for a chain of beam elements (`rod.arm.assembly`): one load, from a state near by.

Unknowns besides the motions are the reactions of what holds the arm.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Index
from rod.arm import assembly
from rod.arm.assembly import assemble, move, predict
from rod.arm.bands import factorize, solve, solve_small
from rod.arm.nodes import ArmArrays, Chain, LoadArrays, StateArrays, Tangent, frame_of
from rod.arm.rotations import cross_into, logarithm, multiply, skew

#: Newton's method: largest last correction (rad, and mm over the length), in a step of time the next one if corrections
#: go on falling as they do, and iterations
TOLERANCE, IN_TIME, ITERATIONS = 1e-8, 2e-7, 25
#: iteration of a step of time from which on half of each correction is made: at a kink of a law whole ones may cycle
CYCLING = 8
#: rad, largest turn of a node in an iteration of a step of time
LARGEST = 0.05


class Inertia(NamedTuple):
    """What the nodes are as rigid bodies, and their motion before a step of time, in tonne, mm and s.

    The motion u of a node in the step, from the state before it, has the acceleration `of_motion` u + `carried`.
    """

    mass: Array  #: (N,); empty: nothing resists, as in statics
    first: Array  #: (N, 3) mass times its place beside the node, in the frame of the node
    second: Array  #: (N, 3, 3) moments of inertia about the node, in its frame
    place: Array  #: (N, 3), before the step, and so are angle (N,) and frames (N, 3, 3)
    angle: Array
    frames: Array
    #: (N, 9) of places and turns of the acceleration, and of turns of the speed
    carried: Array
    of_motion: Array  #: (2,) acceleration and speed by the motion


#: nothing resists
STATICS = Inertia(*(np.empty(shape) for shape in (0, (0, 3), (0, 3, 3), (0, 3), 0, (0, 3, 3), (0, 9), 2)))


class NewtonResult(NamedTuple):
    """The outcome."""

    converged: bool
    outside: float  #: by how much a curvature (1/mm) leaves the section's table at the most
    beyond: float  #: by how much the moment at the clamp leaves its curve, N mm
    #: unstable directions, of the whole arm and of what lies beyond the clamped end
    negative: tuple[int, int]
    iterations: int

    def is_as_stable_as(self, other: "NewtonResult") -> bool:
        """Whether one of both numbers is that of another state.

        A measured clamp adds a negative pivot to the first number, and this pivot may move beyond the clamped end.
        """
        return self.negative[0] == other.negative[0] or self.negative[1] == other.negative[1]


def border_system(tangent: Tangent, held: Index, columns: Array, small: Array, right: Array) -> None:
    """Solve for columns (rows, 1 + k) with a factorized band: the first without reactions, the others by each.

    held: (k, 2) as in `LoadArrays`. small (k, k) and right (k, 1) become the system for the reactions.
    """
    band, by_reaction, by_motion = tangent.band, tangent.by_reaction, tangent.by_motion
    rows, count = len(band), len(held)
    half = band.shape[1] // 2
    m = (half + 1) // 2
    for c in range(count):
        for k in range(rows):
            columns[k, 1 + c] = 0.0
        for i in range(m):
            columns[m * (held[c, 0] - 1) + i, 1 + c] = -by_reaction[c, i]
    solve(band, half, columns)
    for a in range(count):
        row = m * (held[a, 0] - 1)
        right[a, 0] = -tangent.missed[a]
        for i in range(m):
            right[a, 0] -= by_motion[a, i] * columns[row + i, 0]
        for b in range(count):
            small[a, b] = tangent.direct[a, b]
            for i in range(m):
                small[a, b] += by_motion[a, i] * columns[row + i, 1 + b]


def unstable(band: Array, first: int, small: Array) -> int:
    """Unstable directions among the rows from `first` on of a factorized band, with what holds the arm there.

    The residual has the reactions with the minus sign: each one that holds makes one positive pivot of small.
    """
    half = band.shape[1] // 2
    negative = 0
    for k in range(first, len(band)):
        if band[k, half] < 0.0:
            negative += 1
    return negative - negative_of(small)


def _inertial(
    inertia: Inertia, node: int, lever: Array, second: Array, motion: Array, out: Array, block: Array
) -> None:
    """Force and moment of inertia (6,) of a node, and their derivative (6, 6) without that of its speed.

    lever: (3,) mass times its place beside the node; second: (3, 3), of inertia; motion: (3, 3) acceleration of the
    place, that of the turn, and speed of the turn.
    """
    by, along, spin, speed = inertia.of_motion[0], motion[0], motion[1], motion[2]
    skewed, whirl = np.empty((3, 3)), np.empty(3)
    skew(lever, skewed)
    cross_into(speed, lever, whirl)
    cross_into(speed, whirl, out[:3])
    for i in range(3):
        whirl[i] = second[i, 0] * speed[0] + second[i, 1] * speed[1] + second[i, 2] * speed[2]
    cross_into(speed, whirl, out[3:])
    for i in range(3):
        out[i] += inertia.mass[node] * along[i]
        block[i, i] = by * inertia.mass[node]
        for j in range(3):
            out[i] -= skewed[i, j] * spin[j]
            out[3 + i] += skewed[i, j] * along[j] + second[i, j] * spin[j]
            block[i, 3 + j], block[3 + i, j] = -by * skewed[i, j], by * skewed[i, j]
            block[3 + i, 3 + j] = by * second[i, j]


def add_inertia(inertia: Inertia, chain: Chain, state: StateArrays, tangent: Tangent) -> None:
    """Add forces and moments of inertia of all nodes but the first, which the clamp moves, to residual and tangent.

    The tangent is without what the speeds and the turning of a lever add.
    """
    m, three = 6 if chain.in_space else 3, np.empty((4, 3, 3))
    frame, between, second, turned = three[0], three[1], three[2], three[3]
    first, turn, motion, out, block = np.empty(3), np.zeros(3), np.empty((3, 3)), np.empty(6), np.zeros((6, 6))
    by, half = inertia.of_motion, 2 * m - 1
    for node in range(1, len(state.place)):
        if inertia.mass[node] == 0.0:
            continue
        frame_of(chain, state, node, frame)
        if chain.in_space:
            multiply(frame, inertia.frames[node].T, between)
            logarithm(between, turn)
        else:
            turn[2] = state.angle[node] - inertia.angle[node]
        multiply(frame, inertia.second[node], turned)
        multiply(turned, frame.T, second)
        carried = inertia.carried[node]
        for i in range(3):
            first[i] = frame[i, 0] * inertia.first[node, 0] + frame[i, 1] * inertia.first[node, 1]
            first[i] += frame[i, 2] * inertia.first[node, 2]
            motion[0, i] = by[0] * (state.place[node, i] - inertia.place[node, i]) + carried[i]
            motion[1, i], motion[2, i] = by[0] * turn[i] + carried[3 + i], by[1] * turn[i] + carried[6 + i]
        _inertial(inertia, node, first, second, motion, out, block)
        row = m * (node - 1)
        for i in range(m):
            at = i if m == 6 or i < 2 else 5
            tangent.residual[row + i] += out[at]
            for j in range(m):
                tangent.band[row + i, half + j - i] += block[at, j if m == 6 or j < 2 else 5]


class Step(NamedTuple):
    """The motion that a tangent gives; overwritten by each iteration."""

    motion: Array  #: (N, m) of the nodes
    columns: Array  #: (rows, 1 + k): first the motion without reactions, then by each
    small: Array  #: (k, k), the system for the reactions
    reaction: Array  #: (k, 1) their changes


def _solved(tangent: Tangent, load: LoadArrays, free: int, step: Step) -> tuple[bool, tuple[int, int]]:
    """Fill in the motion and reactions that a tangent gives: whether it can be solved, and its unstable directions.

    free: as in `Chain`.
    """
    band, columns, right, motion, start = tangent.band, step.columns, step.reaction, step.motion, tangent.start
    rows, m, count = len(columns), motion.shape[1], len(load.held)
    if not factorize(band, 2 * m - 1, 1e-300):
        return False, (0, 0)
    for k in range(rows):
        columns[k, 0] = -tangent.residual[k]
    border_system(tangent, load.held, columns, step.small, right)
    negative = unstable(band, 0, step.small), unstable(band, m * (free - 1), step.small)
    if count and solve_small(step.small, right) == 0.0:
        return False, (0, 0)
    for a in range(count):
        for k in range(rows):
            columns[k, 0] += columns[k, 1 + a] * right[a, 0]
    for node in range(1, len(motion)):
        for i in range(m):
            motion[node, i] = columns[m * (node - 1) + i, 0]
    for i in range(m):
        motion[0, i] = start[i, 0]
        for j in range(m):
            motion[0, i] += start[i, 1 + j] * motion[1, j]
    return True, negative


def _load_by(side: Array, tangent: Tangent) -> None:
    """Make a side the residual of a tangent, the motion of the first node and what is missed."""
    rows, m = len(tangent.residual), len(tangent.start)
    for k in range(rows):
        tangent.residual[k] = side[k]
    for i in range(m):
        tangent.start[i, 0] = side[rows + i]
    for a in range(len(tangent.missed)):
        tangent.missed[a] = side[rows + m + a]


def _answer(step: Step, side: Array) -> None:
    """Fill in a side by motions and reactions."""
    nodes, m = step.motion.shape
    for k in range(nodes * m):
        side[k] = step.motion[k // m, k % m]
    for a in range(len(step.reaction)):
        side[nodes * m + a] = step.reaction[a, 0]


def _newton(
    arm: ArmArrays,
    load: LoadArrays,
    state: StateArrays,
    factor: float,
    tangent: Tangent,
    iterations: int,
    side: Array,
    inertia: Inertia,
) -> NewtonResult:
    """The equilibrium near a state under a part of the loads; the state becomes it.

    Without iterations the tangent becomes that of the state, and its forces stand in the geometric part. A side
    (N m + k,) is what a parameter adds to the residual, to the motion of the first node and to what is held; it becomes
    what the arm answers: the motions of the nodes, and the reactions.
    """
    m, nodes, count, is_moving = 6 if arm.chain.in_space else 3, len(state.place), len(load.held), len(inertia.mass) > 0
    columns, small, right = np.empty((m * (nodes - 1), 1 + count)), np.empty((count, count)), np.empty((count, 1))
    step, work, before = Step(np.empty((nodes, m)), columns, small, right), np.empty((2, 3, 3)), math.inf
    outside, beyond = math.inf, math.inf
    for iteration in range(max(iterations, 2)):
        outside, beyond = assemble(arm, load, state, factor, tangent, is_moving)
        if iterations == 0:
            step.motion[:] = 0.0
            predict(arm.chain, state, tangent.kept, step.motion)
            continue
        if is_moving:
            add_inertia(inertia, arm.chain, state, tangent)
        known, negative = _solved(tangent, load, arm.chain.free, step)
        if not known:
            return NewtonResult(False, outside, beyond, (0, 0), iteration)
        for a in range(count):
            state.reaction[a] += right[a, 0]
        if is_moving:
            _shorten(step.motion, iteration)
        predict(arm.chain, state, tangent.kept, step.motion)
        largest = move(arm.chain, state, step.motion, work)
        if not largest < 30.0:
            return NewtonResult(False, outside, beyond, (0, 0), iteration)
        # the tangent of the first step has the forces of the state before
        is_small = largest < TOLERANCE or (is_moving and largest * min(largest, before) < IN_TIME * before)
        if is_small and iteration > 0:
            return NewtonResult(True, outside, beyond, negative, iteration + 1)
        before = largest
    if iterations == 0 and len(side):
        _load_by(side, tangent)
        if _solved(tangent, load, arm.chain.free, step)[0]:
            _answer(step, side)
    return NewtonResult(iterations == 0, outside, beyond, (0, 0), iterations)


def _shorten(motion: Array, iteration: int) -> None:
    """Keep the turns of a step of time small, and later its whole correction."""
    turn = 0.0
    for node in range(len(motion)):
        turn = max(turn, abs(motion[node, motion.shape[1] - 1]))
    motion *= 0.5 if iteration >= CYCLING else min(1.0, LARGEST / max(turn, LARGEST))


def negative_of(matrix: Array) -> int:
    """Negative eigenvalues of a matrix (k, k) that is nearly symmetric, by its pivots."""
    n = len(matrix)
    copied = matrix.copy()
    negative = 0
    for k in range(n):
        if copied[k, k] < 0.0:
            negative += 1
        if copied[k, k] == 0.0:
            continue
        for i in range(k + 1, n):
            factor = copied[i, k] / copied[k, k]
            for j in range(k + 1, n):
                copied[i, j] -= factor * copied[k, j]
    return negative


#: the functions that `_newton` calls, innermost first
CALLS = (
    *assembly.CALLS,
    *(
        factorize,
        solve,
        negative_of,
        border_system,
        unstable,
        _inertial,
        add_inertia,
        _solved,
        _load_by,
        _answer,
        _shorten,
    ),
)
