"""Elements along an arm, the loads on their nodes, and what the solver finds there."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from geometry.topology import cross
from rod.arm import newton
from rod.arm.end_kernels import EndArrays
from rod.arm.newton import NewtonResult
from rod.arm.nodes import KEPT, Chain, LoadArrays, StateArrays, Tangent, acting, levers_of
from rod.compiled import CompiledLater
from rod.frames import in_frame, planar_frames, rotation, turn_of
from rod.load import Load
from rod.weight import Mass

#: two positions nearer than this part of an element are one node
SAME = 1e-3
#: nothing that a chain answers besides its equilibrium
NO_SIDE = np.empty(0)


def positions_between(breaks: Sequence[float], longest: float) -> Array:
    """(N,) mm, rising: the breaks, and between them equal elements that are no longer than `longest`."""
    places = list(breaks[:1])
    for low, high in pairwise(breaks):
        if high - low > SAME * longest:
            count = max(1, math.ceil((high - low) / longest - 1e-9))
            places += [high] if count == 1 else np.linspace(low, high, count + 1)[1:].tolist()
    return np.array(places, dtype=float)


def halved(s: Array) -> Array:
    """The positions with one in the middle of all elements but the first, which is short."""
    middle = 0.5 * (s[1:-1] + s[2:])
    return np.sort(np.concatenate([s, middle]))


def thinned(s: Array, kept: Array, least: int) -> Array:
    """Every second of positions (N,), where more than `least` elements are left; the first two and those kept stay."""
    if len(s) < 2 * least:
        return s
    stays, before = (np.abs(s[:, None] - kept).min(axis=1) < SAME * np.diff(s).max()), 1
    stays[[0, 1, -1]] = True
    for k in range(2, len(s)):
        stays[k] |= before < k - 1
        before = k if stays[k] else before
    return s[stays]


class Nodes(NamedTuple):
    """A chain in equilibrium, at its nodes."""

    s: Array  #: (N,) mm
    place: Array  #: (N, 3) mm, of the axis
    angle: Array  #: (N,) rad, of an arm in its plane
    frames: Array  #: (N, 3, 3)
    moment: Array  #: (N, 3) N mm, on the part before the node
    inner: Array  #: (N, 3) N, force on the part before the node
    force: Array  #: (3,) N, on the end, with what holds it
    reaction: Array  #: (k,) N or N mm, of what is held
    found: NewtonResult

    @property
    def state(self) -> StateArrays:
        """A copy that the solver may change."""
        place, angle, frames, reaction = (one.copy() for one in (self.place, self.angle, self.frames, self.reaction))
        return StateArrays(place, angle, frames, np.zeros((len(self.s) - 1, 3)), reaction)

    def on(self, s: Array) -> StateArrays:
        """The state on other nodes (n,) mm, with the strains of these elements."""
        if np.array_equal(s, self.s):
            return self.state
        h = np.diff(self.s)
        turns = turn_of(np.swapaxes(self.frames[:-1], 1, 2) @ self.frames[1:])
        strains = np.column_stack([turns, np.linalg.norm(np.diff(self.place, axis=0), axis=1)]) / h[:, None]
        middle, at = self.s[:-1] + 0.5 * h, s[:-1] + 0.5 * np.diff(s)
        there = np.column_stack([np.interp(at, middle, column) for column in strains.T])
        state = rest_state(s, there, self.place[0], self.frames[0], 0)
        return state._replace(reaction=self.reaction.copy())

    @property
    def acting(self) -> tuple[Array, Array]:
        """Moments and forces (N, 3) on the part before each node, along its frame."""
        return in_frame(self.frames, self.moment), in_frame(self.frames, self.inner)

    def moved(self, motion: Array, reaction: Array) -> StateArrays:
        """The state after a motion (N, 6) of its nodes, with reactions (k,) added."""
        frames = rotation(motion[:, 3:]) @ self.frames
        inner = np.zeros((len(self.s) - 1, 3))
        place, angle = self.place + motion[:, :3], self.angle + motion[:, 5]
        return StateArrays(place, angle, frames, inner, self.reaction + reaction)


solve_chain = CompiledLater(newton._newton, newton.CALLS, 20)


def load_arrays(load: Load, mass: Mass | None, s: Array) -> LoadArrays:
    """Loads and supports on the nodes at positions (N,) mm; the weight is spread as the mass is (None: evenly)."""
    n = len(s)
    forces, couples, beside = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 2, 3))
    if any(load.weight):
        mass = mass or Mass.even(float(s[-1]), 1.0, load.weight_height)
        edges = float(s[-1]) - np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])
        (grams, heights), (all_grams, _) = mass.within(edges), mass.within(s[-1:])
        total = np.array(load.weight) * float(s[-1]) / all_grams
        forces = -np.diff(grams)[:, None] * total
        beside[:, 1] = -np.diff(heights)[:, None] * total
    for one in load.along:
        share = one.shares(s)[:, None]
        forces += share * one.force
        couples += share * one.couple
        beside += share[:, None] * np.outer(one.beside, one.force)
    rows: list[tuple[float, ...]] = []
    for support in load.supports:
        node = int(np.abs(s - support.s).argmin())
        rows += [(node, axis, at, *support.beside) for axis, at in support.held.items()]
    table = np.array(rows, float).reshape(-1, 5)
    held, target, lever = table[:, :2].astype(np.int64), table[:, 2].copy(), table[:, 3:].copy()
    return LoadArrays(np.array(load.force), np.array(load.couple), forces, couples, beside, held, target, lever)


def rest_state(s: Array, strains: Array, place: Array, frame: Array, held: int) -> StateArrays:
    """The chain without loads from its first node; strains (n, 4): three curvatures and the stretch of its elements.

    held: number of reactions.
    """
    n, h = len(s) - 1, np.diff(s)
    angle = math.atan2(frame[1, 0], frame[0, 0]) + np.concatenate([[0.0], np.cumsum(h * strains[:, 2])])
    if np.any(strains[:, :2]) or abs(frame[2, 2] - 1.0) > 1e-15:
        frames, half = np.empty((n + 1, 3, 3)), rotation(0.5 * h[:, None] * strains[:, :3])
        frames[0] = frame
        for e in range(n):
            frames[e + 1] = frames[e] @ half[e] @ half[e]
        along = (frames[:-1] @ half)[:, :, 0]
    else:
        frames = planar_frames(angle)
        along = planar_frames(0.5 * (angle[1:] + angle[:-1]))[:, :, 0]
    places = place + np.concatenate([np.zeros((1, 3)), np.cumsum((h * strains[:, 3])[:, None] * along, axis=0)])
    return StateArrays(places, angle, frames, np.zeros((n, 3)), np.zeros(held))


def nodes_of(
    s: Array, state: StateArrays, chain: Chain, ends: EndArrays, load: LoadArrays, found: NewtonResult
) -> Nodes:
    """Moments and forces by statics, in the state that was found under the full load."""
    frames = state.frames if chain.in_space else planar_frames(state.angle)
    place, load = state.place, acting(load, state, 1.0)
    # right of a node: all that acts beyond it
    beyond = load.force + np.cumsum(load.nodes[::-1], axis=0)[::-1]
    elements = np.concatenate([beyond[1:], load.force[None]])
    out = levers_of(ends, frames[-1], load.force)
    couples = load.couples + cross(frames[:, :, 0], load.beside[:, 0]) + cross(frames[:, :, 1], load.beside[:, 1])
    steps = cross(np.diff(place, axis=0), elements[:-1])
    at_end = out[0] + load.couple
    behind = np.concatenate([np.cumsum((steps + couples[1:])[::-1], axis=0)[::-1], np.zeros((1, 3))]) + at_end
    # a couple of a node acts on its middle; those of the first and the last node belong to half an element
    moment = behind + 0.5 * couples
    moment[0], moment[-1] = behind[0] + couples[0], at_end
    return Nodes(s, place, state.angle, frames, moment, elements, load.force, state.reaction, found)


def extrapolated(coarse: Nodes, fine: Nodes, *, in_space: bool) -> Nodes:
    """The limit of the elements at the nodes of the coarse chain: the errors are those of h^2."""
    at = np.searchsorted(fine.s, coarse.s - 1e-9 * coarse.s[-1])

    def limit(name: str) -> Array:
        less, more = getattr(coarse, name), getattr(fine, name)
        known = more if name in ("force", "reaction") else more[at]
        return np.asarray(known + (known - less) / 3.0)

    angle = limit("angle")
    if in_space:
        turned = turn_of(fine.frames[at] @ np.swapaxes(coarse.frames, 1, 2))
        frames = rotation(turned / 3.0) @ fine.frames[at]
    else:
        frames = planar_frames(angle)
    place, moment, inner, force, reaction = map(limit, ("place", "moment", "inner", "force", "reaction"))
    return Nodes(coarse.s, place, angle, frames, moment, inner, force, reaction, fine.found)


def room_for(chain: Chain, held: int) -> Tangent:
    """A tangent that is not filled yet, of a chain with a number of reactions."""
    m = 6 if chain.in_space else 3
    rows, by = m * len(chain.h), np.zeros((2, held, 6))
    borders = by[0], by[1], np.zeros(held), np.zeros((held, held))
    last = np.zeros(rows), np.zeros((m, 1 + m)), np.zeros((len(chain.h), KEPT))
    return Tangent(np.zeros((rows, 4 * m - 1)), *borders, *last)
