"""Tangent and residual of a chain of beam elements between its ends, under loads on its nodes."""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.arm import elements, end_kernels, nodes, section_kernels
from rod.arm.bands import solve_small
from rod.arm.elements import plane_element, space_element, strain_change
from rod.arm.end_kernels import EndArrays, clamp_in_plane, clamp_in_space
from rod.arm.nodes import ArmArrays, Chain, LoadArrays, StateArrays, Tangent, acting, hold_nodes, load_nodes, load_tip
from rod.arm.rotations import copy_into, exponential, logarithm, multiply, multiply_transposed
from rod.arm.section_kernels import SectionArrays, add_memory, elastic, plane_section, space_section


class Scratch(NamedTuple):
    """Arrays that are overwritten by each element; m unknowns of a node."""

    work: Array  #: (24, 3, 3)
    columns: Array  #: (3, c), of the table of a section
    gradient: Array  #: (2 m,)
    hessian: Array  #: (2 m, 2 m)


def _in_plane(section: SectionArrays, chain: Chain, state: StateArrays, e: int, room: Scratch, row: Array) -> float:
    """Gradient and Hessian of element e in the plane; row (KEPT,) gets what `predict` needs."""
    place = state.place
    h, strain, force, stiffness = chain.h[e], room.work[17, 0], room.work[17, 1], room.work[18]
    angle = 0.5 * (state.angle[e] + state.angle[e + 1])
    c, s = math.cos(angle), math.sin(angle)
    x, y = (place[e + 1, 0] - place[e, 0]) / h, (place[e + 1, 1] - place[e, 1]) / h
    strain[0] = (state.angle[e + 1] - state.angle[e]) / h
    strain[1], strain[2] = c * x + s * y, c * y - s * x
    outside = plane_section(section, e, strain, force, stiffness, room.columns)
    if len(section.memory):
        add_memory(section, e, force, stiffness)
    if not chain.is_loaded:
        force[:] = 0.0
    row[0], row[1], row[2], row[3] = angle, strain[0], strain[1], strain[2]
    row[4], row[5], row[6] = force[0], force[1], force[2]
    for i in range(2):
        for j in range(3):
            row[7 + 3 * i + j] = stiffness[1 + i, j]
    plane_element(h, row[:5], force, stiffness, state.inner[e, :2], room.gradient, room.hessian)
    return outside


def _strains(state: StateArrays, e: int, h: float, work: Array, six: Array) -> None:
    """Strains (6,) of element e in space, its turn and the frame in its middle."""
    turn, half, middle, between, place = work[17, 2], work[16, 0], work[18], work[19], state.place
    multiply_transposed(state.frames[e], state.frames[e + 1], between)
    logarithm(between, turn)
    for i in range(3):
        half[i] = 0.5 * turn[i]
    exponential(half, between)
    multiply(state.frames[e], between, middle)
    for i in range(3):
        six[i] = turn[i] / h
        six[3 + i] = (
            middle[0, i] * (place[e + 1, 0] - place[e, 0])
            + middle[1, i] * (place[e + 1, 1] - place[e, 1])
            + middle[2, i] * (place[e + 1, 2] - place[e, 2])
        ) / h


def _in_space(section: SectionArrays, chain: Chain, state: StateArrays, e: int, room: Scratch, row: Array) -> float:
    """As `_in_plane`, in space."""
    h, work = chain.h[e], room.work
    turn, middle, forces, stiff = work[17, 2], work[18], row[6:12], work[20:24].reshape(36).reshape((6, 6))
    _strains(state, e, h, work, row[:6])
    outside = space_section(section, e, row[:6], forces, stiff, room.columns)
    if len(section.memory):
        add_memory(section, e, forces, stiff)
    if not chain.is_loaded:
        forces[:] = 0.0
    for i in range(3):
        row[12 + i] = turn[i]
        for j in range(3):
            row[15 + 3 * i + j] = middle[i, j]
        for j in range(6):
            row[24 + 6 * i + j] = stiff[3 + i, j]
    space_element(h, middle, row[:15], stiff, state.inner[e], work[:16], room.gradient, room.hessian)
    return outside


def _element(section: SectionArrays, chain: Chain, state: StateArrays, e: int, room: Scratch, kept: Array) -> float:
    """Gradient and Hessian of element e, and by how much it leaves what is known of the section."""
    if chain.in_space:
        return _in_space(section, chain, state, e, room, kept[e])
    return _in_plane(section, chain, state, e, room, kept[e])


def _add(band: Array, residual: Array, row: int, gradient: Array, hessian: Array) -> None:
    """Add an element whose first row is `row`."""
    n, half = len(gradient), band.shape[1] // 2
    for i in range(n):
        residual[row + i] += gradient[i]
        for j in range(n):
            band[row + i, half + j - i] += hessian[i, j]


class First(NamedTuple):
    """The first element, and what decides on the clamp."""

    gradient: Array  #: (2 m,)
    hessian: Array  #: (2 m, 2 m)
    felt: Array  #: (2 m,), the gradient of the elastic forces
    #: N mm, the elastic bending moment that decides on rotation and offset. It changes as that at the end of the first
    #: element does, less the change of the force there on the way between both nodes
    decides: float
    scale: float  #: of the Hessian over that of the elastic forces


def _missed(ends: EndArrays, state: StateArrays, first: First, missed: Array, by_start: Array, by_end: Array) -> float:
    """By how much the first node misses its place and turn (m,), and how these change with the forces (m, m) at both
    ends of the first element. Returns by how much the moment leaves what is known of the clamp."""
    m = len(missed)
    at_end, at_start, place = np.empty(m), np.empty(m), np.empty(3)
    for i in range(m):
        at_start[i], at_end[i] = -first.felt[i], first.felt[m + i]
    at_end[m - 1] = first.decides
    if m == 3:
        beyond = clamp_in_plane(ends, at_end, place, by_end, np.empty((4, 3)))
        missed[0], missed[1] = place[0] - state.place[0, 0], place[1] - state.place[0, 1]
        missed[2] = place[2] - state.angle[0]
        return beyond
    turned, away, turn = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    beyond = clamp_in_space(ends, state.frames[0], at_start, at_end, place, turned, by_start, by_end)
    for i in range(3):
        for j in range(3):
            away[i, j] = (
                turned[i, 0] * state.frames[0, j, 0]
                + turned[i, 1] * state.frames[0, j, 1]
                + turned[i, 2] * state.frames[0, j, 2]
            )
    logarithm(away, turn)
    for i in range(3):
        missed[i], missed[3 + i] = place[i] - state.place[0, i], turn[i]
    return beyond


def _eliminate(hessian: Array, missed: Array, by_start: Array, by_end: Array, start: Array) -> None:
    """The motion of the first node, and what it adds by that of the second."""
    m = len(missed)
    matrix = np.zeros((m, m))
    for i in range(m):
        matrix[i, i] = 1.0
        start[i, 0] = missed[i]
        for j in range(m):
            start[i, 1 + j] = 0.0
            for k in range(m):
                matrix[i, j] += by_start[i, k] * hessian[k, j] - by_end[i, k] * hessian[m + k, j]
                start[i, 1 + j] += by_end[i, k] * hessian[m + k, m + j] - by_start[i, k] * hessian[k, m + j]
    solve_small(matrix, start)


def _clamp(ends: EndArrays, chain: Chain, state: StateArrays, first: First, tangent: Tangent, is_moving: bool) -> float:
    """Eliminate the first node: tangent.start becomes its motion, and what it adds by that of the second node.

    is_moving: whether the residual is complete but for the first element; the moment then changes by what it has of it,
    too. Returns as `_missed`.
    """
    gradient, hessian, start = first.gradient, first.hessian, tangent.start
    m, residual = len(start), tangent.residual
    missed, by_start, by_end = np.zeros(m), np.zeros((m, m)), np.zeros((m, m))
    beyond = _missed(ends, state, first, missed, by_start, by_end)
    if is_moving:
        left = _left(chain, state, residual, gradient) / first.scale
        for i in range(m):
            missed[i] += by_end[i, m - 1] * left
    for i in range(m):
        by_end[i, 0] += by_end[i, m - 1] * (state.place[chain.decides, 1] - state.place[1, 1])
        by_end[i, 1] -= by_end[i, m - 1] * (state.place[chain.decides, 0] - state.place[1, 0])
        for j in range(m):
            by_start[i, j] /= first.scale
            by_end[i, j] /= first.scale
    _eliminate(hessian, missed, by_start, by_end, start)
    for i in range(m):
        residual[i] += gradient[m + i]
        for k in range(m):
            residual[i] += hessian[m + i, k] * start[k, 0]
        for j in range(m):
            value = hessian[m + i, m + j]
            for k in range(m):
                value += hessian[m + i, k] * start[k, 1 + j]
            tangent.band[i, 2 * m - 1 + j - i] += value
    return beyond


def _left(chain: Chain, state: StateArrays, residual: Array, gradient: Array) -> float:
    """N mm: by how much the moment at the end of the first element, with its force, misses that which decides.

    residual: without the first element; gradient: of that.
    """
    m, d, left = len(gradient) // 2, chain.decides, 0.0
    for node in range(1, d):
        row, first, part = m * (node - 1), 1.0 if node == 1 else 0.0, chain.beyond / chain.h[d - 1]
        x, y = state.place[d, 0] - state.place[node, 0], state.place[d, 1] - state.place[node, 1]
        x += part * (state.place[d, 0] - state.place[d - 1, 0])
        y += part * (state.place[d, 1] - state.place[d - 1, 1])
        left += residual[row + m - 1] + first * gradient[2 * m - 1]
        left += y * (residual[row] + first * gradient[m]) - x * (residual[row + 1] + first * gradient[m + 1])
    return left


def predict(chain: Chain, state: StateArrays, kept: Array, motion: Array) -> None:
    """Forces of the elements after a motion (N, m), by the tangent, for the next geometric part."""
    d, p, q, change = np.empty(3), np.empty(3), np.empty(3), np.empty(6)
    for e in range(len(chain.h)):
        row, h = kept[e], chain.h[e]
        if not chain.in_space:
            c, s = math.cos(row[0]), math.sin(row[0])
            x, y = motion[e + 1, 0] - motion[e, 0], motion[e + 1, 1] - motion[e, 1]
            turn = 0.5 * (motion[e, 2] + motion[e + 1, 2])
            kappa = (motion[e + 1, 2] - motion[e, 2]) / h
            stretch, shear = (c * x + s * y) / h + row[3] * turn, (c * y - s * x) / h - row[2] * turn
            for i in range(2):
                state.inner[e, i] = (
                    row[5 + i] + row[7 + 3 * i] * kappa + row[8 + 3 * i] * stretch + row[9 + 3 * i] * shear
                )
            continue
        for i in range(3):
            d[i] = p[i] = q[i] = 0.0
            for j in range(3):
                along = row[15 + 3 * j + i]  # of the middle frame
                d[i] += along * (motion[e + 1, j] - motion[e, j])
                q[i] += along * (motion[e + 1, 3 + j] - motion[e, 3 + j])
                p[i] += along * 0.5 * (motion[e + 1, 3 + j] + motion[e, 3 + j])
        strain_change(h, row[12:15], row[3:6], d, p, q, change)
        for i in range(3):
            state.inner[e, i] = row[9 + i]
            for j in range(6):
                state.inner[e, i] += row[24 + 6 * i + j] * change[j]


def move(chain: Chain, state: StateArrays, motion: Array, work: Array) -> float:
    """Move all nodes by motion (N, m); the largest part of it, rad and mm over the length."""
    largest = 0.0
    for node in range(len(motion)):
        if not chain.in_space:
            for i in range(2):
                state.place[node, i] += motion[node, i]
                largest = max(largest, abs(motion[node, i]) / chain.length)
            state.angle[node] += motion[node, 2]
            largest = max(largest, abs(motion[node, 2]))
            continue
        for i in range(3):
            state.place[node, i] += motion[node, i]
            largest = max(largest, abs(motion[node, i]) / chain.length, abs(motion[node, 3 + i]))
        exponential(motion[node, 3:], work[0])
        multiply(work[0], state.frames[node], work[1])
        copy_into(work[1], state.frames[node])
    return largest


def _first(section: SectionArrays, chain: Chain, state: StateArrays, room: Scratch, kept: Array) -> tuple[float, First]:
    """The first element, and by how much it and that which decides on the clamp leave what is known."""
    d, rubber, gradient = chain.decides, elastic(section), room.gradient
    m = len(gradient) // 2
    loaded = Chain(chain.in_space, True, chain.h, d, chain.beyond, chain.free, chain.length)
    outside = _element(rubber, loaded, state, max(d - 1, 0), room, kept)
    decides = gradient[2 * m - 1] if d > 0 else -gradient[m - 1]
    if d > 0 and chain.beyond != 0.0:
        part = chain.beyond / chain.h[d - 1]
        across = part * (state.place[d, 0] - state.place[d - 1, 0]), part * (state.place[d, 1] - state.place[d - 1, 1])
        decides -= across[0] * gradient[m + 1] - across[1] * gradient[m]
    outside = max(outside, _element(section, chain, state, 0, room, kept))
    felt = gradient.copy()
    if len(section.memory):
        _element(rubber, chain, state, 0, room, kept)
        felt = gradient.copy()
        _element(section, chain, state, 0, room, kept)
    return outside, First(gradient.copy(), room.hessian.copy(), felt, decides, section.scale)


def assemble(
    arm: ArmArrays, given: LoadArrays, state: StateArrays, factor: float, tangent: Tangent, is_moving: bool
) -> tuple[float, float]:
    """The tangent of a state under a part of the loads; is_moving: in a step of time.

    Returns by how much curvature and moment leave what is known.
    """
    section, ends, chain, m = arm.section, arm.ends, arm.chain, 6 if arm.chain.in_space else 3
    band, residual, kept = tangent.band, tangent.residual, tangent.kept
    columns = np.empty((3, max(section.table.shape[2], 1)))
    room = Scratch(np.zeros((24, 3, 3)), columns, np.empty(2 * m), np.empty((2 * m, 2 * m)))
    load = acting(given, state, factor)
    band[:] = 0.0
    residual[:] = 0.0
    outside, first = _first(section, chain, state, room, kept)
    for e in range(1, len(chain.h)):
        if chain.in_space:
            outside = max(outside, _in_space(section, chain, state, e, room, kept[e]))
        else:
            outside = max(outside, _in_plane(section, chain, state, e, room, kept[e]))
        _add(band, residual, m * (e - 1), room.gradient, room.hessian)
    load_nodes(load, chain, state, tangent, room.work[0])
    hold_nodes(load, chain, state, tangent, room.work[0])
    load_tip(ends, load, chain, state, tangent)
    return outside, _clamp(ends, chain, state, first, tangent, is_moving)


#: in the order in which they call each other, innermost first
CALLS = (
    *section_kernels.CALLS,
    *elements.CALLS,
    *end_kernels.CALLS,
    *nodes.CALLS,
    *(solve_small, _in_plane, _strains, _in_space, _element, _add, _left, _missed, _eliminate, _clamp),
    *(_first, predict, move, assemble),
)
