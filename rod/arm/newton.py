"""Newton's method for a chain of beam elements (`rod.arm.assembly`): one load, from a state near by.

Unknowns besides the motions are the reactions of what holds the arm.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Index
from rod.arm import assembly
from rod.arm.assembly import KEPT, Chain, LoadArrays, StateArrays, Tangent, assemble, move, predict
from rod.arm.bands import factorize, solve, solve_small
from rod.arm.end_kernels import EndArrays
from rod.arm.section_kernels import SectionArrays

#: Newton's method: largest last correction (rad, and mm over the length), and iterations
TOLERANCE, ITERATIONS = 1e-8, 25


class Found(NamedTuple):
    """The outcome."""

    converged: bool
    outside: float  #: by how much a curvature (1/mm) leaves the section's table at the most
    beyond: float  #: by how much the moment at the clamp leaves its curve, N mm
    #: unstable directions, of the whole arm and of what lies beyond the clamped end
    negative: tuple[int, int]
    iterations: int

    def is_as_stable_as(self, other: "Found") -> bool:
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


def _newton(
    section: SectionArrays,
    ends: EndArrays,
    chain: Chain,
    load: LoadArrays,
    state: StateArrays,
    factor: float,
    tangent: Tangent,
    iterations: int,
    side: Array,
) -> Found:
    """The equilibrium near a state under a part of the loads; the state becomes it.

    Without iterations the tangent becomes that of the state, and its forces stand in the geometric part. A side
    (N m + k,) is what a parameter adds to the residual, to the motion of the first node and to what is held; it becomes
    what the arm answers: the motions of the nodes, and the reactions.
    """
    m = 6 if chain.in_space else 3
    nodes = len(state.place)
    rows, half, band = m * (nodes - 1), 2 * m - 1, tangent.band
    residual, start, kept = tangent.residual, tangent.start, np.empty((len(chain.h), KEPT))
    motion, work = np.empty((nodes, m)), np.empty((2, 3, 3))
    count = len(load.held)
    columns, small, right = np.empty((rows, 1 + count)), np.empty((count, count)), np.empty((count, 1))
    outside = beyond = math.inf
    for iteration in range(max(iterations, 2)):
        outside, beyond = assemble(section, ends, chain, load, state, factor, tangent, kept)
        if iterations == 0:
            motion[:] = 0.0
            predict(chain, state, kept, motion)
            if iteration == 0 or len(side) == 0:
                continue
            residual[:], start[:, 0], tangent.missed[:] = side[:rows], side[rows : rows + m], side[rows + m :]
        if not factorize(band, half, 1e-300):
            return Found(False, outside, beyond, (0, 0), iteration)
        for k in range(rows):
            columns[k, 0] = -residual[k]
        border_system(tangent, load.held, columns, small, right)
        negative = unstable(band, 0, small), unstable(band, m * (chain.free - 1), small)
        if count and solve_small(small, right) == 0.0:
            return Found(False, outside, beyond, (0, 0), iteration)
        for a in range(count):
            for k in range(rows):
                columns[k, 0] += columns[k, 1 + a] * right[a, 0]
        for node in range(1, nodes):
            for i in range(m):
                motion[node, i] = columns[m * (node - 1) + i, 0]
        for i in range(m):
            motion[0, i] = start[i, 0]
            for j in range(m):
                motion[0, i] += start[i, 1 + j] * motion[1, j]
        if iterations == 0:
            side[: rows + m], side[rows + m :] = motion.reshape(rows + m), right[:, 0]
            continue
        for a in range(count):
            state.reaction[a] += right[a, 0]
        predict(chain, state, kept, motion)
        largest = move(chain, state, motion, work)
        if not largest < 30.0:
            return Found(False, outside, beyond, (0, 0), iteration)
        # the tangent of the first step has the forces of the state before
        if largest < TOLERANCE and iteration > 0:
            return Found(True, outside, beyond, negative, iteration + 1)
    return Found(iterations == 0, outside, beyond, (0, 0), iterations)


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
CALLS = (*assembly.CALLS, factorize, solve, negative_of, border_system, unstable)
