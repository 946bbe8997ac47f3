"""The nodes of a chain of beam elements: their arrays, the loads on them and on its end, and what holds them.

The first node is where the clamp puts it (`rod.arm.end_kernels`): it is eliminated with the first element. The unknowns
are the motions of all others, in the plane x, y and angle, in space place and turn.
"""

import math
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Index
from rod.arm.end_kernels import TIP_COLUMNS, EndArrays, tip_levers
from rod.arm.rotations import copy_into, exponential, multiply
from rod.arm.section_kernels import SectionArrays

#: numbers that are kept of an element, and where its forces begin, in the plane and in space
KEPT, FORCES = 42, (4, 6)
#: the angle in the plane among what may be held
TURN = 5
#: rad, of difference quotients at the tip
STEP = 1e-5


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


class ArmArrays(NamedTuple):
    """An arm in a state of pressure: what it consists of."""

    section: SectionArrays
    ends: EndArrays
    chain: Chain


class Tangent(NamedTuple):
    """The tangent of a chain, with what holds it; overwritten by each iteration."""

    band: Array  #: (m (N - 1), 4 m - 1), as in `rod.arm.bands`; m unknowns of a node
    by_reaction: Array  #: (k, 6): the residual of the held node by the reaction
    by_motion: Array  #: (k, 6): the held place or angle by the motion of the node
    missed: Array  #: (k,) mm or rad
    direct: Array  #: (k, k) held places by reactions, of a tip that gives way
    residual: Array  #: (m (N - 1),) of the nodes beyond the clamp
    start: Array  #: (m, 1 + m) motion of the first node, and what it adds by that of the second
    #: (n, KEPT), of the elements for `predict`; forces from FORCES on
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


def frame_of(chain: Chain, state: StateArrays, i: int, out: Array) -> None:
    """The frame (3, 3) of a node."""
    if chain.in_space:
        copy_into(state.frames[i], out)
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


def load_nodes(load: LoadArrays, chain: Chain, state: StateArrays, tangent: Tangent, frame: Array) -> None:
    """Add the loads on the nodes."""
    band, residual, m = tangent.band, tangent.residual, 6 if chain.in_space else 3
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
        frame_of(chain, state, node, frame)
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


def _moved_frame(frame: Array, axis: int, angle: float, work: Array, out: Array) -> None:
    """A frame turned about an axis of space."""
    vector = work[0]
    vector[:] = 0.0
    vector[axis] = angle
    exponential(vector, work[1:4])
    multiply(work[1:4], frame, out)


def hold_nodes(load: LoadArrays, chain: Chain, state: StateArrays, tangent: Tangent, frame: Array) -> None:
    """Fill in what holds the nodes; `load_tip` adds what the end has besides."""
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
        frame_of(chain, state, node, frame)
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
    for c in range(len(load.held)):
        for i in range(6):
            tangent.by_reaction[c, i] = -tangent.by_motion[c, i]


def _turned_tip(
    ends: EndArrays, chain: Chain, force: Array, frame: Array, tangent: Tangent, row: int, swing: Array
) -> None:
    """Add what turns of the tip's frame do to its couple, by difference quotients; row: of the last node.

    swing: (3, 3), by how much its held point moves.
    """
    band, places, first = tangent.band, 3 if chain.in_space else 2, 0 if chain.in_space else 2
    half, turn = band.shape[1] // 2, row + places
    moved, turned = np.empty((3, 3)), np.empty((4, 3))
    ahead, behind, work = np.empty((3, 3)), np.empty((3, 3)), np.empty((2, TIP_COLUMNS))
    for axis in range(first, 3):
        _moved_frame(frame, axis, STEP, turned, moved)
        tip_levers(ends, moved, force, ahead, work)
        _moved_frame(frame, axis, -STEP, turned, moved)
        tip_levers(ends, moved, force, behind, work)
        for i in range(first, 3):
            value = -(ahead[0, i] - behind[0, i]) / (2.0 * STEP)
            a, b = i - first, axis - first
            band[turn + a, half + b - a] += 0.5 * value
            band[turn + b, half + a - b] += 0.5 * value
        for i in range(places):
            swing[axis, i] = (ahead[2, i] - behind[2, i]) / (2.0 * STEP)


def _hold_tip(
    ends: EndArrays, load: LoadArrays, chain: Chain, frame: Array, out: Array, tangent: Tangent, swing: Array
) -> None:
    """Add what holds the point beside the end; out: (3, 3), its levers under the load; swing: of `_turned_tip`."""
    places, first = (3, 0) if chain.in_space else (2, 2)
    ahead, behind, work, force = np.empty((3, 3)), np.empty((3, 3)), np.empty((2, TIP_COLUMNS)), load.force
    last = len(load.nodes) - 1
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


def levers_of(ends: EndArrays, frame: Array, force: Array) -> Array:
    """(3, 3) of the tip with its frame under a force, as `tip_levers`: couple in N mm, lever and end of curve in mm."""
    out = np.empty((3, 3))
    tip_levers(ends, frame, force, out, np.empty((2, TIP_COLUMNS)))
    return out


def load_tip(ends: EndArrays, load: LoadArrays, chain: Chain, state: StateArrays, tangent: Tangent) -> None:
    """Add the load on the end, and what holds it."""
    residual, last = tangent.residual, len(state.place) - 1
    places, first = (3, 0) if chain.in_space else (2, 2)
    row = (places + 3 - first) * (last - 1)
    frame, swing = np.empty((3, 3)), np.zeros((3, 3))
    frame_of(chain, state, last, frame)
    out = levers_of(ends, frame, load.force)
    for i in range(places):
        residual[row + i] -= load.force[i]
    for i in range(first, 3):
        residual[row + places + i - first] -= out[0, i] + load.couple[i]
    if chain.in_space:
        _couple(tangent.band, row + places, tangent.band.shape[1] // 2, load.couple)
    _turned_tip(ends, chain, load.force, frame, tangent, row, swing)
    _hold_tip(ends, load, chain, frame, out, tangent, swing)


#: in the order in which they call each other, innermost first
CALLS = (acting, frame_of, _couple, load_nodes, _moved_frame, hold_nodes, _turned_tip, _hold_tip, levers_of, load_tip)
