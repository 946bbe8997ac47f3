"""Tangent and residual of a chain of beam elements between its ends, under loads on its nodes.

The first node is where the clamp puts it (`rod.arm.end_kernels`): it is eliminated with the first element. The unknowns
are the motions of all others, in the plane x, y and angle, in space place and turn.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Index
from rod.arm import elements, end_kernels, section_kernels
from rod.arm.bands import solve_small
from rod.arm.elements import plane_element, space_element, strain_change
from rod.arm.end_kernels import TIP_COLUMNS, EndArrays, clamp_in_plane, clamp_in_space, tip_levers
from rod.arm.rotations import exponential, logarithm, multiply, multiply_transposed
from rod.arm.section_kernels import SectionArrays, add_memory, elastic, plane_section, space_section

#: numbers that are kept of an element
KEPT, FORCES, FORCES_IN_SPACE = 42, 4, 6
#: rad, of difference quotients at the tip
STEP = 1e-5
#: the angle in the plane among what may be held
TURN = 5


class LoadArrays(NamedTuple):
    """What acts on the nodes, and what holds them."""

    force: Array  #: (3,) N, on the end
    couple: Array  #: (3,) N mm, on the end
    nodes: Array  #: (N, 3) N, on the axis at the nodes
    couples: Array  #: (N, 3) N mm
    #: (N, 2, 3) N mm: forces times how far along the first and the second direction of the section they act
    beside: Array
    #: (k, 2) nodes, and what is held there: the place along x, y or z (0 to 2), or the angle in the plane (5)
    held: Index
    target: Array  #: (k,) mm or rad, of the point that is held
    lever: Array  #: (k, 2) mm, of this point beside the axis; for the end the tip has it


class StateArrays(NamedTuple):
    """A chain in a state; Newton's method changes it in place."""

    place: Array  #: (N, 3) mm
    angle: Array  #: (N,) rad, in the plane
    frames: Array  #: (N, 3, 3), in space
    inner: Array  #: (n, 3) N, axial and shear forces of the elements in the tangent
    reaction: Array  #: (k,) N or N mm, of what is held


class Chain(NamedTuple):
    """The elements."""

    in_space: bool
    is_loaded: bool  #: False: the tangent is that of the same shape without forces and moments
    h: Array  #: (n,) mm, rest lengths
    decides: int  #: node whose bending moment decides on the clamp
    beyond: float  #: mm, how far beyond this node the moment decides in fact
    free: int  #: first node beyond the clamped end, from which on unstable directions are counted
    length: float  #: mm


class Tangent(NamedTuple):
    """The tangent of a chain, with what holds it; overwritten by each iteration."""

    band: Array  #: (m (N - 1), 4 m - 1), as in `rod.arm.bands`; m unknowns of a node
    by_reaction: Array  #: (k, 6): the residual of the held node by the reaction
    by_motion: Array  #: (k, 6): the held place or angle by the motion of the node
    missed: Array  #: (k,) mm or rad
    direct: Array  #: (k, k) held places by reactions, of a tip that gives way
    residual: Array  #: (m (N - 1),) of the nodes beyond the clamp
    start: Array  #: (m, 1 + m) motion of the first node, and what it adds by that of the second
    #: (n, KEPT), of the elements for `predict`; forces from FORCES on, in space from FORCES_IN_SPACE on
    kept: Array


def acting(load: LoadArrays, state: StateArrays, factor: float) -> LoadArrays:
    """A part of the loads, with the reactions of what is held."""
    force, couple, nodes = factor * load.force, factor * load.couple, factor * load.nodes
    couples, beside = factor * load.couples, factor * load.beside
    for c in range(len(load.held)):
        node, axis, reaction = load.held[c, 0], load.held[c, 1], state.reaction[c]
        is_end = node == len(nodes) - 1
        if axis == TURN and is_end:
            couple[2] += reaction
        elif axis == TURN:
            couples[node, 2] += reaction
        elif is_end:
            force[axis] += reaction
        else:
            nodes[node, axis] += reaction
            beside[node, 0, axis] += reaction * load.lever[c, 0]
            beside[node, 1, axis] += reaction * load.lever[c, 1]
    return LoadArrays(force, couple, nodes, couples, beside, load.held, load.target, load.lever)


def _element(
    section: SectionArrays,
    chain: Chain,
    state: StateArrays,
    e: int,
    work: Array,
    gradient: Array,
    hessian: Array,
    kept: Array,
    columns: Array,
) -> float:
    """Gradient and Hessian of element e; `kept` (n, KEPT) gets what `predict` needs."""
    h, place = chain.h[e], state.place
    strain, force = work[17, 0], work[17, 1]
    if not chain.in_space:
        angle = 0.5 * (state.angle[e] + state.angle[e + 1])
        c, s = math.cos(angle), math.sin(angle)
        x, y = (place[e + 1, 0] - place[e, 0]) / h, (place[e + 1, 1] - place[e, 1]) / h
        strain[0] = (state.angle[e + 1] - state.angle[e]) / h
        strain[1], strain[2] = c * x + s * y, c * y - s * x
        stiffness = work[18]
        outside = plane_section(section, e, strain, force, stiffness, columns)
        if len(section.memory):
            add_memory(section, e, force, stiffness)
        if not chain.is_loaded:
            force[:] = 0.0
        row = kept[e]
        row[0], row[1], row[2], row[3] = angle, strain[0], strain[1], strain[2]
        row[4], row[5], row[6] = force[0], force[1], force[2]
        for i in range(2):
            for j in range(3):
                row[7 + 3 * i + j] = stiffness[1 + i, j]
        plane_element(h, row[:5], force, stiffness, state.inner[e, :2], gradient, hessian)
        return outside
    turn, half, middle, between = work[17, 2], work[16, 0], work[18], work[19]
    multiply_transposed(state.frames[e], state.frames[e + 1], between)
    logarithm(between, turn)
    for i in range(3):
        half[i] = 0.5 * turn[i]
    exponential(half, between)
    multiply(state.frames[e], between, middle)
    row = kept[e]
    six, forces, stiff = row[:6], row[6:12], work[20:24].reshape(36).reshape((6, 6))
    for i in range(3):
        six[i] = turn[i] / h
        six[3 + i] = (
            middle[0, i] * (place[e + 1, 0] - place[e, 0])
            + middle[1, i] * (place[e + 1, 1] - place[e, 1])
            + middle[2, i] * (place[e + 1, 2] - place[e, 2])
        ) / h
    outside = space_section(section, e, six, forces, stiff, columns)
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
    space_element(h, middle, turn, six, forces, stiff, state.inner[e], work[:16], gradient, hessian)
    return outside


def _add(band: Array, residual: Array, row: int, gradient: Array, hessian: Array, half: int) -> None:
    """Add an element whose first row is `row`."""
    n = len(gradient)
    for i in range(n):
        residual[row + i] += gradient[i]
        for j in range(n):
            band[row + i, half + j - i] += hessian[i, j]


def _clamp(
    ends: EndArrays,
    chain: Chain,
    state: StateArrays,
    gradient: Array,
    hessian: Array,
    band: Array,
    residual: Array,
    start: Array,
    felt: Array,
    decides: float,
    scale: float,
    is_moving: bool,
) -> float:
    """Eliminate the first node: start (m, 1 + m) becomes its motion, and what it adds by that of the second node.

    felt: (2 m,), the gradient of the elastic forces. decides: N mm, the elastic bending moment that decides on rotation
    and offset. It changes as that at the end of the first element does, less the change of the force there on the way
    between both nodes; scale: of the Hessian over that of the elastic forces. is_moving: whether the residual is
    complete but for the first element; the moment then changes by what it has of it, too.
    """
    m = 6 if chain.in_space else 3
    missed, by_start, by_end = np.zeros(m), np.zeros((m, m)), np.zeros((m, m))
    at_end, at_start = np.empty(m), np.empty(m)
    for i in range(m):
        at_start[i], at_end[i] = -felt[i], felt[m + i]
    at_end[m - 1] = decides
    if chain.in_space:
        place, turned, away, turn = np.empty(3), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
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
    else:
        place = np.empty(3)
        beyond = clamp_in_plane(ends, at_end, place, by_end, np.empty((4, 3)))
        missed[0], missed[1] = place[0] - state.place[0, 0], place[1] - state.place[0, 1]
        missed[2] = place[2] - state.angle[0]
    if is_moving:
        left = _left(chain, state, residual, gradient) / scale
        for i in range(m):
            missed[i] += by_end[i, m - 1] * left
    for i in range(m):
        by_end[i, 0] += by_end[i, m - 1] * (state.place[chain.decides, 1] - state.place[1, 1])
        by_end[i, 1] -= by_end[i, m - 1] * (state.place[chain.decides, 0] - state.place[1, 0])
        for j in range(m):
            by_start[i, j] /= scale
            by_end[i, j] /= scale
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
    for i in range(m):
        residual[i] += gradient[m + i]
        for k in range(m):
            residual[i] += hessian[m + i, k] * start[k, 0]
        for j in range(m):
            value = hessian[m + i, m + j]
            for k in range(m):
                value += hessian[m + i, k] * start[k, 1 + j]
            band[i, 2 * m - 1 + j - i] += value
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


def _frame(chain: Chain, state: StateArrays, i: int, out: Array) -> None:
    """The frame (3, 3) of a node."""
    if chain.in_space:
        out[:] = state.frames[i]
        return
    c, s = math.cos(state.angle[i]), math.sin(state.angle[i])
    out[:] = 0.0
    out[0, 0], out[1, 0], out[0, 1], out[1, 1], out[2, 2] = c, s, -s, c, 1.0


def _couple(band: Array, row: int, half: int, couple: Array) -> None:
    """Add what a couple of constant direction does to the tangent by turns: it has no potential.

    The second derivatives of the elements are symmetric, the derivative of their moments is not.
    """
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        band[row + i, half + j - i] += 0.5 * couple[k]
        band[row + i, half + k - i] -= 0.5 * couple[j]


def _nodal(load: LoadArrays, chain: Chain, state: StateArrays, band: Array, residual: Array, frame: Array) -> None:
    """Add the loads on the nodes."""
    m = 6 if chain.in_space else 3
    half = 2 * m - 1
    for node in range(1, len(state.place)):
        row = m * (node - 1)
        for i in range(3 if chain.in_space else 2):
            residual[row + i] -= load.nodes[node, i]
        along, normal = load.beside[node, 0], load.beside[node, 1]
        turn = row + (3 if chain.in_space else 2)
        if chain.in_space:
            for i in range(3):
                residual[turn + i] -= load.couples[node, i]
            _couple(band, turn, half, load.couples[node])
        else:
            residual[turn] -= load.couples[node, 2]
        if not (along.any() or normal.any()):
            continue
        _frame(chain, state, node, frame)
        for part in range(2):
            a, A = frame[:, part], load.beside[node, part]
            if not chain.in_space:
                residual[turn] -= a[0] * A[1] - a[1] * A[0]
                band[turn, half] += a[0] * A[0] + a[1] * A[1]
                continue
            dot = a[0] * A[0] + a[1] * A[1] + a[2] * A[2]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                residual[turn + i] -= a[j] * A[k] - a[k] * A[j]
                for other in range(3):
                    band[turn + i, half + other - i] -= 0.5 * (a[i] * A[other] + A[i] * a[other])
                band[turn + i, half] += dot


def _moved_frame(chain: Chain, frame: Array, axis: int, angle: float, work: Array, out: Array) -> None:
    """A frame turned about an axis of space."""
    vector = work[0]
    vector[:] = 0.0
    vector[axis] = angle
    exponential(vector, work[1:4])
    multiply(work[1:4], frame, out)


def _tip(
    ends: EndArrays,
    load: LoadArrays,
    chain: Chain,
    state: StateArrays,
    tangent: Tangent,
    residual: Array,
) -> None:
    """Add the load on the end, and what holds it."""
    band, m, last = tangent.band, 6 if chain.in_space else 3, len(state.place) - 1
    half, row, places = 2 * m - 1, m * (last - 1), 3 if chain.in_space else 2
    turn, first = row + places, 0 if chain.in_space else 2
    frame, moved, turned = np.empty((3, 3)), np.empty((3, 3)), np.empty((4, 3))
    out, ahead, behind = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    work, force, swing = np.empty((2, TIP_COLUMNS)), load.force, np.zeros((3, 3))
    _frame(chain, state, last, frame)
    tip_levers(ends, frame, force, out, work)
    for i in range(places):
        residual[row + i] -= force[i]
    for i in range(first, 3):
        residual[turn + i - first] -= out[0, i] + load.couple[i]
    if chain.in_space:
        _couple(band, turn, half, load.couple)
    for axis in range(first, 3):
        _moved_frame(chain, frame, axis, STEP, turned, moved)
        tip_levers(ends, moved, force, ahead, work)
        _moved_frame(chain, frame, axis, -STEP, turned, moved)
        tip_levers(ends, moved, force, behind, work)
        for i in range(first, 3):
            value = -(ahead[0, i] - behind[0, i]) / (2.0 * STEP)
            a, b = i - first, axis - first
            band[turn + a, half + b - a] += 0.5 * value
            band[turn + b, half + a - b] += 0.5 * value
        for i in range(places):
            swing[axis, i] = (ahead[2, i] - behind[2, i]) / (2.0 * STEP)
    for c in range(len(load.held)):
        axis = load.held[c, 1]
        if load.held[c, 0] != last or axis == TURN:
            continue
        tangent.missed[c] += out[2, axis]
        # the moment is quadratic in the force
        force[axis] += 1.0
        tip_levers(ends, frame, force, ahead, work)
        force[axis] -= 2.0
        tip_levers(ends, frame, force, behind, work)
        force[axis] += 1.0
        for i in range(first, 3):
            tangent.by_reaction[c, places + i - first] = 0.5 * (behind[0, i] - ahead[0, i])
            tangent.by_motion[c, places + i - first] = swing[i, axis]
        for other in range(len(load.held)):
            if load.held[other, 0] == last and load.held[other, 1] != TURN:
                tangent.direct[other, c] = ahead[2, load.held[other, 1]] - out[2, load.held[other, 1]]


def _hold(load: LoadArrays, chain: Chain, state: StateArrays, tangent: Tangent, frame: Array) -> None:
    """Fill in what holds the nodes; `_tip` adds what the end has besides."""
    places, first = (3, 0) if chain.in_space else (2, 2)
    tangent.by_motion[:] = 0.0
    tangent.direct[:] = 0.0
    for c in range(len(load.held)):
        node, axis = load.held[c, 0], load.held[c, 1]
        row = tangent.by_motion[c]
        if axis == TURN:
            row[places + 2 - first] = 1.0
            tangent.missed[c] = state.angle[node] - load.target[c]
            continue
        row[axis] = 1.0
        tangent.missed[c] = state.place[node, axis] - load.target[c]
        if node == len(state.place) - 1:
            continue
        _frame(chain, state, node, frame)
        x, y, z = (
            frame[0, 0] * load.lever[c, 0] + frame[0, 1] * load.lever[c, 1],
            frame[1, 0] * load.lever[c, 0] + frame[1, 1] * load.lever[c, 1],
            frame[2, 0] * load.lever[c, 0] + frame[2, 1] * load.lever[c, 1],
        )
        lever = (x, y, z)
        tangent.missed[c] += lever[axis]
        # turns move it by the cross product with its lever
        i, j = (axis + 1) % 3, (axis + 2) % 3
        if i >= first:
            row[places + i - first] = lever[j]
        if j >= first:
            row[places + j - first] = -lever[i]
    tangent.by_reaction[:] = -tangent.by_motion


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
        state.frames[node] = work[1]
    return largest


def assemble(
    section: SectionArrays,
    ends: EndArrays,
    chain: Chain,
    given: LoadArrays,
    state: StateArrays,
    factor: float,
    tangent: Tangent,
    is_moving: bool,
) -> tuple[float, float]:
    """The tangent of a state under a part of the loads; is_moving: in a step of time.

    Returns by how much curvature and moment leave what is known.
    """
    m = 6 if chain.in_space else 3
    half, band, residual, kept = 2 * m - 1, tangent.band, tangent.residual, tangent.kept
    work, columns = np.zeros((24, 3, 3)), np.empty((3, max(section.table.shape[2], 1)))
    gradient, felt, hessian = np.empty(2 * m), np.empty(2 * m), np.empty((2 * m, 2 * m))
    rubber = elastic(section)
    load = acting(given, state, factor)
    band[:] = 0.0
    residual[:] = 0.0
    loaded = Chain(chain.in_space, True, chain.h, chain.decides, chain.beyond, chain.free, chain.length)
    outside = _element(rubber, loaded, state, max(chain.decides - 1, 0), work, gradient, hessian, kept, columns)
    decides = gradient[2 * m - 1] if chain.decides > 0 else -gradient[m - 1]
    d = chain.decides
    if d > 0 and chain.beyond != 0.0:
        part = chain.beyond / chain.h[d - 1]
        across = part * (state.place[d, 0] - state.place[d - 1, 0]), part * (state.place[d, 1] - state.place[d - 1, 1])
        decides -= across[0] * gradient[m + 1] - across[1] * gradient[m]
    outside = max(outside, _element(section, chain, state, 0, work, gradient, hessian, kept, columns))
    felt[:] = gradient
    if len(section.memory):
        _element(rubber, chain, state, 0, work, felt, hessian, kept, columns)
        _element(section, chain, state, 0, work, gradient, hessian, kept, columns)
    at_clamp, of_clamp = gradient.copy(), hessian.copy()
    for e in range(1, len(chain.h)):
        outside = max(outside, _element(section, chain, state, e, work, gradient, hessian, kept, columns))
        _add(band, residual, m * (e - 1), gradient, hessian, half)
    _nodal(load, chain, state, band, residual, work[0])
    _hold(load, chain, state, tangent, work[0])
    _tip(ends, load, chain, state, tangent, residual)
    parts = at_clamp, of_clamp, band, residual, tangent.start, felt, decides, section.scale, is_moving
    return outside, _clamp(ends, chain, state, *parts)


#: in the order in which they call each other, innermost first
CALLS = (
    *section_kernels.CALLS,
    *elements.CALLS,
    *end_kernels.CALLS,
    *(solve_small, acting, _element, _add, _left, _clamp, _frame, _couple, _nodal, _moved_frame),
    *(_hold, _tip, predict, move, assemble),
)
