"""Small motions of an arm in equilibrium: the lowest eigenvalue of its tangent over that without forces and moments.

It is 1 without loads, 0 where the arm buckles and below 0 beyond. The pivots of the tangent minus a multiple of the
elastic part count the eigenvalues below it (Sylvester), so that bisection finds the lowest; inverse iteration finds its
motion. Negative stiffnesses that a measured clamp has without loads are not counted.
"""

import numpy as np

from geometry.arrays import Array, Index, Mask
from rod.arm.bands import factorize, solve, solve_small
from rod.arm.chain import NO_SIDE, room_for, solve_chain
from rod.arm.newton import STATICS, border_system, negative_of, unstable
from rod.arm.nodes import ArmArrays, Chain, LoadArrays, StateArrays, Tangent, acting
from rod.arm.solver import Solver
from rod.compiled import CompiledLater

#: bisections, and where the search for the lowest eigenvalue ends
BISECTIONS, LARGEST = 40, 1e6
#: negative stiffnesses that a clamp has at most: three motions and three turns
OF_CLAMP = 6


def lowest(solver: Solver, state: StateArrays, kept: Mask) -> tuple[float, Array]:
    """The lowest eigenvalue of a chain in space under its loads, and its motion (N, 6).

    kept: (6,), which of the motions along and turns about x, y and z are possible.
    """
    load = acting(solver.load, state, 1.0)
    stays = kept[load.held[:, 1]]
    load = load._replace(held=load.held[stays], target=load.target[stays], lever=load.lever[stays])
    still = state._replace(reaction=np.zeros(len(load.held)))
    loaded, free = (_tangent(solver, load, still, kept, is_loaded=is_loaded) for is_loaded in (True, False))
    value, vector = lowest_of(loaded, free, kept, load.held)
    return float(value), np.concatenate([np.zeros((1, 6)), vector.reshape(-1, 6)])


def tangent_of(solver: Solver, load: LoadArrays, state: StateArrays, *, is_loaded: bool) -> Tangent:
    """The tangent of a state, which stays as it is, with or without its loads."""
    chain = solver.chain._replace(is_loaded=is_loaded)
    tangent = room_for(chain, len(load.held))
    copied = StateArrays(*(values.copy() for values in state))
    arm = ArmArrays(solver.arm.section.arrays(solver.s), solver.ends, chain)
    solve_chain(arm, load, copied, float(is_loaded), tangent, 0, NO_SIDE, STATICS)
    return tangent


def _tangent(solver: Solver, load: LoadArrays, state: StateArrays, kept: Mask, *, is_loaded: bool) -> Tangent:
    """As `tangent_of`, in space; motions that are not kept are left out."""
    tangent = tangent_of(solver, load, state, is_loaded=is_loaded)
    rows = np.arange(len(tangent.band))[:, None]
    columns = rows + np.arange(-11, 12)
    is_out = ~(kept[rows % 6] & kept[columns % 6])
    tangent.band[is_out] = np.broadcast_to(rows == columns, is_out.shape)[is_out]
    tangent.by_reaction[:, ~kept] = 0.0
    tangent.by_motion[:, ~kept] = 0.0
    return tangent


def _below(
    loaded: Tangent,
    free: Tangent,
    value: float,
    held: Index,
    shifted: Tangent,
    columns: Array,
    small: Array,
    right: Array,
) -> int:
    """Negative pivots of the one tangent minus a value times the other, with what holds the arm.

    The band of `shifted` becomes the factors.
    """
    for row in range(len(shifted.band)):
        for k in range(23):
            shifted.band[row, k] = loaded.band[row, k] - value * free.band[row, k]
    if not factorize(shifted.band, 11, 1e-300):
        return -1
    columns[:, 0] = 0.0
    border_system(shifted, held, columns, small, right)
    return unstable(shifted.band, 0, small)


def _lowest_of(loaded: Tangent, free: Tangent, kept: Mask, held: Index) -> tuple[float, Array]:
    """The lowest eigenvalue of two tangents, and its vector."""
    rows, count = len(loaded.band), len(held)
    shifted = Tangent(np.empty((rows, 23)), *loaded[1:])
    columns, small, right = np.empty((rows, 1 + count)), np.empty((count, count)), np.empty((count, 1))
    # a measured clamp may have negative stiffnesses in series with the arm; what is more belongs to the cells
    clamp = min(max(_below(free, free, 0.0, held, shifted, columns, small, right), 0), OF_CLAMP)
    low, high, size = 0.0, 1.0 + 1e-9, 1.0
    while _below(loaded, free, low, held, shifted, columns, small, right) > clamp and size < LARGEST:
        high, low, size = low, -size, 2.0 * size
    while high > 0.0 and _below(loaded, free, high, held, shifted, columns, small, right) == clamp and size < LARGEST:
        low, high, size = high, 2.0 * high, 2.0 * size
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _below(loaded, free, middle, held, shifted, columns, small, right) > clamp:
            high = middle
        else:
            low = middle
    _below(loaded, free, low - 1e-6 * max(1.0, abs(low)), held, shifted, columns, small, right)
    vector = np.ones(rows)
    shifted.missed[:] = 0.0
    for _ in range(4):
        for row in range(rows):
            value = 0.0
            for k in range(23):
                column = row + k - 11
                if 0 <= column < rows:
                    value += free.band[row, k] * vector[column]
            columns[row, 0] = value
        border_system(shifted, held, columns, small, right)
        if count:
            solve_small(small, right)
        largest = 0.0
        for row in range(rows):
            for a in range(count):
                columns[row, 0] += columns[row, 1 + a] * right[a, 0]
            if kept[row % 6]:
                largest = max(largest, abs(columns[row, 0]))
        for row in range(rows):
            vector[row] = columns[row, 0] / largest if kept[row % 6] else 0.0
    return 0.5 * (low + high), vector


#: `_lowest_of`, in plain Python for a few states and compiled for many
lowest_of = CompiledLater(_lowest_of, (factorize, solve, solve_small, negative_of, border_system, unstable, _below), 2)


def compile_solver() -> None:
    """Compile the solver of chains and the search for the lowest eigenvalue, or load them from disk."""
    for kernel in (solve_chain, lowest_of):
        kernel.remaining = 0
    none = room_for(Chain(True, True, np.ones(1), 0, 0.0, 1, 1.0), 0)
    none.band[:, 11] = 1.0
    lowest_of(none, none, np.ones(6, bool), np.zeros((0, 2), np.int64))
