"""Small motions of an arm in equilibrium: the lowest eigenvalue of its tangent over that without forces and moments.

It is 1 without loads, 0 where the arm buckles and below 0 beyond. The pivots of the tangent minus a multiple of the
elastic part count the eigenvalues below it (Sylvester), so that bisection finds the lowest; inverse iteration finds its
motion. The clamped end and the elements beside it follow the others in equilibrium.
"""

from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Index, Mask
from rod.arm import newton
from rod.arm.bands import factorize, solve_small
from rod.arm.end_kernels import EndArrays
from rod.arm.newton import (
    Chain,
    LoadArrays,
    StateArrays,
    _border_system,
    _held_axes,
    _unstable,
    assemble,
)
from rod.arm.section_kernels import SectionArrays
from rod.compiled import CompiledLater

#: bisections, and where the search for the lowest eigenvalue ends
BISECTIONS, LARGEST = 40, 1e6


class Tangent(NamedTuple):
    """The tangent of a chain with what holds its end."""

    band: Array
    border: Array
    missed: Array
    direct: Array


def _tangent(
    section: SectionArrays, ends: EndArrays, chain: Chain, load: LoadArrays, state: StateArrays, kept: Mask
) -> Tangent:
    """The tangent of a chain in space; motions that are not kept (6,) are left out."""
    rows = 6 * (len(state.place) - 1)
    band, residual, start = np.empty((rows, 23)), np.empty(rows), np.empty((6, 7))
    border, missed, direct = np.empty((2, 6, 3)), np.empty(3), np.empty((3, 3))
    kept_strains = np.empty((len(chain.h), newton.KEPT))
    assemble(section, ends, chain, load, state, 1.0, band, residual, start, border, missed, direct, kept_strains)
    for e in range(len(chain.h)):  # the geometric part has the forces of this state
        for i in range(3):
            state.inner[e, i] = kept_strains[e, 9 + i]
    assemble(section, ends, chain, load, state, 1.0, band, residual, start, border, missed, direct, kept_strains)
    for row in range(rows):
        for column in range(max(0, row - 11), min(rows, row + 12)):
            if not (kept[row % 6] and kept[column % 6]):
                band[row, 11 + column - row] = 1.0 if row == column else 0.0
    for i in range(6):
        if not kept[i]:
            border[:, i] = 0.0
    return Tangent(band, border, missed, direct)


def _below(
    loaded: Tangent,
    free: Tangent,
    value: float,
    first: int,
    axes: Index,
    band: Array,
    columns: Array,
    small: Array,
    right: Array,
) -> int:
    """How many eigenvalues are below a value; band becomes the factors."""
    for row in range(len(band)):
        for k in range(23):
            band[row, k] = loaded.band[row, k] - value * free.band[row, k]
    if not factorize(band, 11, 1e-300):
        return -1
    columns[:, 0] = 0.0
    _border_system(band, loaded.border, loaded.missed, loaded.direct, axes, columns, small, right)
    return _unstable(band, first, small)


def _lowest(
    section: SectionArrays, ends: EndArrays, chain: Chain, load: LoadArrays, state: StateArrays, kept: Mask
) -> tuple[float, Array]:
    """The lowest eigenvalue, and its motion (N, 6)."""
    loaded = _tangent(section, ends, chain, load, state, kept)
    none = LoadArrays(
        np.zeros(3),
        np.zeros(3),
        load.held,
        load.target,
        np.zeros_like(load.nodes),
        np.zeros_like(load.couples),
        np.zeros_like(load.beside),
    )
    still = StateArrays(state.place, state.angle, state.frames, state.inner, np.zeros(3))
    free = _tangent(section, ends, Chain(True, False, chain.h, chain.free, chain.length), none, still, kept)
    rows, axes, first = len(loaded.band), _held_axes(load, 3), 6 * (chain.free - 1)
    band, columns = np.empty((rows, 23)), np.empty((rows, 1 + len(axes)))
    small, right = np.empty((len(axes), len(axes))), np.empty((len(axes), 1))
    low, high, size = 0.0, 1.0 + 1e-9, 1.0
    while _below(loaded, free, low, first, axes, band, columns, small, right) > 0 and size < LARGEST:
        high, low, size = low, -size, 2.0 * size
    while high > 0.0 and _below(loaded, free, high, first, axes, band, columns, small, right) == 0 and size < LARGEST:
        low, high, size = high, 2.0 * high, 2.0 * size
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _below(loaded, free, middle, first, axes, band, columns, small, right) > 0:
            high = middle
        else:
            low = middle
    motion = np.zeros((len(state.place), 6))
    _below(loaded, free, low - 1e-6 * max(1.0, abs(low)), first, axes, band, columns, small, right)
    vector = np.ones(rows)
    for _ in range(4):
        for row in range(rows):
            value = 0.0
            for k in range(23):
                column = row + k - 11
                if 0 <= column < rows:
                    value += free.band[row, k] * vector[column]
            columns[row, 0] = value
        _border_system(band, loaded.border, np.zeros(3), loaded.direct, axes, columns, small, right)
        if len(axes):
            solve_small(small, right)
        largest = 0.0
        for row in range(rows):
            for a in range(len(axes)):
                columns[row, 0] += columns[row, 1 + a] * right[a, 0]
            if kept[row % 6]:
                largest = max(largest, abs(columns[row, 0]))
        for row in range(rows):
            vector[row] = columns[row, 0] / largest if kept[row % 6] else 0.0
    for row in range(rows):
        motion[1 + row // 6, row % 6] = vector[row]
    return 0.5 * (low + high), motion


#: `_lowest`, in plain Python for a few states and compiled for many
lowest = CompiledLater(_lowest, (*newton.CALLS, _tangent, _below), 2)
