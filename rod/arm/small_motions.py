"""Small motions of an arm in equilibrium: the lowest eigenvalue of its tangent over that without forces and moments.

It is 1 without loads, 0 where the arm buckles and below 0 beyond. The pivots of the tangent minus a multiple of the
elastic part count the eigenvalues below it (Sylvester), so that bisection finds the lowest; inverse iteration finds its
motion. Negative stiffnesses that a measured clamp has without loads are not counted.
"""

import numpy as np

from geometry.arrays import Array, Index, Mask
from rod.arm.assembly import Chain, LoadArrays, StateArrays, Tangent
from rod.arm.bands import factorize, solve, solve_small
from rod.arm.chain import NO_SIDE, room_for, solve_chain
from rod.arm.end_kernels import EndArrays
from rod.arm.newton import border_system, held_axes, negative_of, unstable
from rod.arm.section_kernels import SectionArrays
from rod.compiled import CompiledLater

#: bisections, and where the search for the lowest eigenvalue ends
BISECTIONS, LARGEST = 40, 1e6
#: negative stiffnesses that a clamp has at most: three motions and three turns
OF_CLAMP = 6


def lowest(
    section: SectionArrays, ends: EndArrays, chain: Chain, load: LoadArrays, state: StateArrays, kept: Mask
) -> tuple[float, Array]:
    """The lowest eigenvalue of a chain in space, and its motion (N, 6).

    kept: (6,), which of the motions along and turns about x, y and z are possible.
    """
    loaded = _tangent(section, ends, chain, load, state, kept)
    zero = [np.zeros_like(values) for values in (load.force, load.couple, load.nodes, load.couples, load.beside)]
    none = LoadArrays(zero[0], zero[1], load.held, load.target, *zero[2:])
    still = state._replace(force=np.zeros(3))
    free = _tangent(section, ends, chain._replace(is_loaded=False), none, still, kept)
    value, vector = lowest_of(loaded, free, kept, held_axes(load, 3))
    return float(value), np.concatenate([np.zeros((1, 6)), vector.reshape(-1, 6)])


def _tangent(
    section: SectionArrays, ends: EndArrays, chain: Chain, load: LoadArrays, state: StateArrays, kept: Mask
) -> Tangent:
    """The tangent of a state; motions that are not kept are left out."""
    tangent = room_for(chain)
    copied = StateArrays(*(values.copy() for values in state))
    solve_chain(section, ends, chain, load, copied, 1.0, tangent, 0, NO_SIDE)
    rows = np.arange(len(tangent.band))[:, None]
    columns = rows + np.arange(-11, 12)
    is_out = ~(kept[rows % 6] & kept[columns % 6])
    tangent.band[is_out] = np.broadcast_to(rows == columns, is_out.shape)[is_out]
    tangent.border[:, ~kept] = 0.0
    return tangent


def _below(
    loaded: Tangent,
    free: Tangent,
    value: float,
    axes: Index,
    shifted: Tangent,
    columns: Array,
    small: Array,
    right: Array,
) -> int:
    """Negative pivots of the one tangent minus a value times the other, with the constraints of the end.

    The band of `shifted` becomes the factors.
    """
    for row in range(len(shifted.band)):
        for k in range(23):
            shifted.band[row, k] = loaded.band[row, k] - value * free.band[row, k]
    if not factorize(shifted.band, 11, 1e-300):
        return -1
    columns[:, 0] = 0.0
    border_system(shifted, axes, columns, small, right)
    return unstable(shifted.band, 0, small)


def _lowest_of(loaded: Tangent, free: Tangent, kept: Mask, axes: Index) -> tuple[float, Array]:
    """The lowest eigenvalue of two tangents, and its vector."""
    rows, count = len(loaded.band), len(axes)
    band = np.empty((rows, 23))
    shifted = Tangent(band, loaded.border, loaded.missed, loaded.direct, loaded.residual, loaded.start)
    columns, small, right = np.empty((rows, 1 + count)), np.empty((count, count)), np.empty((count, 1))
    # a measured clamp may have negative stiffnesses in series with the arm; what is more belongs to the cells
    clamp = min(max(_below(free, free, 0.0, axes, shifted, columns, small, right), 0), OF_CLAMP)
    low, high, size = 0.0, 1.0 + 1e-9, 1.0
    while _below(loaded, free, low, axes, shifted, columns, small, right) > clamp and size < LARGEST:
        high, low, size = low, -size, 2.0 * size
    while high > 0.0 and _below(loaded, free, high, axes, shifted, columns, small, right) == clamp and size < LARGEST:
        low, high, size = high, 2.0 * high, 2.0 * size
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _below(loaded, free, middle, axes, shifted, columns, small, right) > clamp:
            high = middle
        else:
            low = middle
    _below(loaded, free, low - 1e-6 * max(1.0, abs(low)), axes, shifted, columns, small, right)
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
        border_system(shifted, axes, columns, small, right)
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
