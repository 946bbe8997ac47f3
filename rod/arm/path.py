"""The path of an arm from its inflated shape to the full load, in steps that shrink and grow.

A step whose number of unstable directions differs from that of the inflated arm is shortened: the path ends where the
arm buckles, and is not followed beyond. Where the height of the end alone is prescribed the path is that of experiment
III: the curvature without moment and the height grow together from the straight arm, which selects among several
equilibria. The end of the path is solved on elements of half the length too, and both give the limit (`extrapolated`).
"""

from typing import NamedTuple, Protocol

import numpy as np

from geometry.arrays import Array
from rod.along import check_inside
from rod.arm.assembly import StateArrays
from rod.arm.chain import (
    NO_SIDE,
    NodeLoads,
    Nodes,
    chain_arrays,
    extrapolated,
    halved,
    held_along,
    in_frame,
    load_arrays,
    nodes_of,
    planar_frames,
    rest_state,
    room_for,
    rotation,
    solve_chain,
    turn_of,
)
from rod.arm.end_kernels import TIP_COLUMNS, EndArrays, tip_levers
from rod.arm.newton import ITERATIONS, Found
from rod.arm.sections import Section
from rod.arm.small_motions import lowest
from rod.errors import RodError, buckles_at
from rod.spatial import Position, SpatialLoad
from rod.weight import Mass

#: smallest part of the load in one step
SMALLEST_STEP = 1e-5
#: rad, largest change of an angle in one step of the load
LARGEST_TURN = 1.0
#: largest distance of a state from the line through the two before, over its distance from the last one; rad, a change
#: that is small on any path
SMOOTH, SMALL = 0.5, 1e-2


class ArmModel(Protocol):
    """An arm at one pressure, as the path asks for it."""

    @property
    def section(self) -> Section:
        """Of the cells."""

    @property
    def mass(self) -> Mass | None:
        """How a weight is spread along the arm; None: evenly."""

    @property
    def decides_at(self) -> float:
        """mm, where the bending moment decides on the clamp."""

    @property
    def clamp_reach(self) -> float:
        """mm, how far the clamped end reaches."""

    @property
    def own(self) -> SpatialLoad:
        """A weight under which the section has its rest shape, besides those of a load."""

    def positions(self, breaks: tuple[float, ...]) -> Array:
        """(N,) mm: the nodes, with the breaks among them, and where the moment decides. The first element is short."""

    def ends(self, position: Position) -> EndArrays:
        """Clamp and tip, of an end that is held along the axes with a prescribed position."""

    def begin(self) -> tuple[Array, Array]:
        """Place (3,) in mm and frame (3, 3) of the axis at the clamp without moment."""


class Path(NamedTuple):
    """The end of a path."""

    nodes: Nodes  #: at the limit of the elements
    chains: tuple[Nodes, Nodes]  #: in equilibrium on the elements, and on those of half the length
    steps: int  #: of the load


class Way(NamedTuple):
    """How the loads grow."""

    together: bool = False  #: the path begins with the straight arm, and its curvature grows with the load
    in_space: bool = False


class Solver:
    """A chain of an arm under loads."""

    def __init__(self, arm: ArmModel, s: Array, load: SpatialLoad, position: Position, *, in_space: bool) -> None:
        self.arm, self.s = arm, s
        self.ends = arm.ends(position)
        self.chain = chain_arrays(s, arm.decides_at, arm.clamp_reach, in_space=in_space)
        self.room = room_for(self.chain)
        nodes = NodeLoads.of(load, arm.mass, s)
        if any(arm.own.weight):
            nodes = nodes.with_more(NodeLoads.of(arm.own, arm.mass, s))
        target = np.array([0.0 if at is None else at for at in position])
        self.load = load_arrays(load, nodes, held_along(position), target)

    def rest(self, grown: float = 1.0) -> StateArrays:
        """The chain without loads, at a part of its rest curvature."""
        return rest_state(self.s, self.arm.section.rest(self.s, grown), *self.arm.begin())

    def converge(self, state: StateArrays, factor: float, target: Array, grown: float = 1.0) -> Found:
        """The equilibrium near a state, which becomes it, under a part of the loads; the end is held at target (3,)."""
        section, load = self.arm.section.arrays(self.s, factor, grown), self.load._replace(target=target)
        return solve_chain(section, self.ends, self.chain, load, state, factor, self.room, ITERATIONS, NO_SIDE)

    def respond(self, state: StateArrays, side: Array = NO_SIDE) -> Array:
        """(N m + 3,): residual, motion of the first node and missed places of a state under the full load.

        A side (N m + 3,) becomes what the state answers to it (`rod.arm.newton`).
        """
        section = self.arm.section.arrays(self.s)
        solve_chain(section, self.ends, self.chain, self.load, state, 1.0, self.room, 0, side)
        return np.concatenate([self.room.residual, self.room.start[:, 0], self.room.missed])

    def end(self, state: StateArrays) -> Array:
        """(3,) mm, of the material curve."""
        frame = state.frames[-1] if self.chain.in_space else planar_frames(state.angle[-1:])[0]
        out = np.empty((3, 3))
        tip_levers(self.ends, frame, state.force, out, np.empty((2, TIP_COLUMNS)))
        return np.asarray(state.place[-1] + out[2])

    def nodes(self, state: StateArrays, found: Found) -> Nodes:
        """Moments and forces under the full load."""
        return nodes_of(self.s, state, self.chain, self.ends, self.load, found)


#: largest change of the end over the length by halving the elements, and how often they are halved for it
COARSEST, MOST_HALVINGS = 1e-3, 3
#: distance of a load from both ends, over the length, from which on a node stands there
APART = 1e-4
#: of a state that no iteration has found
NOT_SOLVED = Found(True, 0.0, 0.0, 0, 0)


def follow(arm: ArmModel, load: SpatialLoad, position: Position, how: Way) -> Path:
    """The equilibrium on the path from the inflated arm to the full load.

    Raises `RodError` where the path ends or becomes unstable, and for a load off the arm.
    """
    length = float(arm.positions(())[-1])
    for one in load.along:
        check_inside(one, length)
    breaks = {s for one in load.along for s in one.breaks if APART < s / length < 1.0 - APART}
    together, in_space = how
    s = arm.positions(tuple(breaks))
    coarse = Solver(arm, s, load, position, in_space=in_space)
    state, found, steps = _followed(coarse, position, together)
    for _ in range(MOST_HALVINGS):
        fine = Solver(arm, halved(coarse.s), load, position, in_space=in_space)
        finer = _refined(state, in_space)
        there = fine.converge(finer, 1.0, fine.load.target)
        if not (there.converged and there.negative == found.negative):
            finer, there, steps = _followed(fine, position, together)
        chains = coarse.nodes(state, found), fine.nodes(finer, there)
        if float(np.abs(finer.place[-1] - state.place[-1]).max()) <= COARSEST * float(s[-1]):
            return Path(extrapolated(*chains, in_space=in_space), chains, steps)
        coarse, state, found = fine, finer, there
    raise RodError("The load bends the rod within less than a two-hundredth of its length; this solver ends there.")


def beside(arm: ArmModel, load: SpatialLoad, position: Position, near: tuple[Nodes, Nodes], *, in_space: bool) -> Path:
    """The equilibrium beside another one, with as many unstable directions. Raises `RodError` where there is none."""
    s, chains = arm.positions(()), []
    while 1.5 * len(s) < len(near[0].s):
        s = halved(s)
    for known, places in zip(near, (s, halved(s)), strict=True):
        solver, state = Solver(arm, places, load, position, in_space=in_space), known.on(places)
        found = solver.converge(state, 1.0, solver.load.target)
        turn = np.abs(_turns(known.on(places), state, in_space)).max()
        if not (found.converged and turn <= LARGEST_TURN) or found.negative != known.found.negative:
            raise RodError("No equilibrium that is as stable was found beside the one that is known.")
        chains.append(solver.nodes(state, found))
    coarse, fine = chains
    return Path(extrapolated(coarse, fine, in_space=in_space), (coarse, fine), 0)


def _followed(solver: Solver, position: Position, together: bool) -> tuple[StateArrays, Found, int]:
    """The state at the end of the path, how it was found, and the number of steps."""
    grown, in_space = (0.0 if together else 1.0), solver.chain.in_space
    here = _inflated(solver, position, grown)
    begin = solver.end(here)
    goal = np.array([at if held is None else held for at, held in zip(begin, position, strict=True)])
    found = solver.converge(here, 0.0, begin, grown)
    if not found.converged:
        raise RodError("The inflated arm has no equilibrium without loads.")
    rest, before, behind, reached, count = found.negative, here, 0.0, 0.0, 0
    step = 1.0
    if together:
        turn = float(np.abs(solver.arm.section.rest(solver.s)[:, :3]).sum(axis=1) @ np.diff(solver.s))
        step = 1.0 / max(1.0, turn)
    while reached < 1.0:
        factor = min(1.0, reached + step)
        part = 0.0 if reached == behind else (factor - reached) / (reached - behind)
        there = _ahead(before, here, part, in_space)
        trial = solver.converge(there, factor, begin + factor * (goal - begin), factor if together else 1.0)
        near = trial.converged and _is_near(before, here, there, part, in_space)
        if not near or trial.negative != rest:
            step = 0.4 * (factor - reached)
            if step < SMALLEST_STEP:
                nowhere = f"No equilibrium was found beyond {100 * reached:.3g} % of the load."
                raise RodError(_buckling(solver, there, factor, reached) if near else nowhere)
            continue
        before, behind, here, found, reached, count = here, reached, there, trial, factor, count + 1
        step = 2.0 * (reached - behind)
    return here, found, count


def _buckling(solver: Solver, state: StateArrays, factor: float, reached: float) -> str:
    """The sentence on a path that becomes unstable beyond a part of the load; state: beyond it, at a factor."""
    if not solver.chain.in_space:
        return buckles_at(reached)
    load = solver.load
    now = load._replace(
        force=factor * load.force,
        couple=factor * load.couple,
        nodes=factor * load.nodes,
        couples=factor * load.couples,
        beside=factor * load.beside,
    )
    section, kept = solver.arm.section.arrays(solver.s), np.ones(6, bool)
    _, motion = lowest(section, solver.ends, solver.chain, now, state, kept)
    moved = np.abs(in_frame(state.frames, motion[:, :3])).max(axis=0)
    return buckles_at(reached, out_of_plane=bool(moved[2] > moved[:2].max()))


def _inflated(solver: Solver, position: Position, grown: float) -> StateArrays:
    """The arm without loads. In space an end that is free along x is first held at its height as in experiment III."""
    if not (solver.chain.in_space and position[0] is None and position[1] is not None):
        return solver.rest(grown)
    held: Position = (None, position[1], None)
    planar = Solver(solver.arm, solver.s, SpatialLoad(), held, in_space=False)
    state, _, _ = _followed(planar, held, together=True)
    return state._replace(frames=planar_frames(state.angle))


def _ahead(before: StateArrays, here: StateArrays, part: float, in_space: bool) -> StateArrays:
    """The state as far from the last one as the one before is behind it, times a part; arrays of its own."""
    frames = here.frames.copy()
    if part and in_space:
        frames = rotation(part * turn_of(here.frames @ np.swapaxes(before.frames, 1, 2))) @ frames
    return StateArrays(
        here.place + part * (here.place - before.place),
        here.angle + part * (here.angle - before.angle),
        frames,
        here.inner.copy(),
        here.force + part * (here.force - before.force),
    )


def _is_near(before: StateArrays, here: StateArrays, there: StateArrays, part: float, in_space: bool) -> bool:
    """Whether a state may follow two others on a smooth path: near a buckling load Newton's method may leave it."""
    change = _turns(here, there, in_space)
    size = float(np.abs(change).max())
    if size > LARGEST_TURN or part == 0.0:
        return size <= LARGEST_TURN
    return float(np.abs(change - part * _turns(before, here, in_space)).max()) <= max(SMOOTH * size, SMALL)


def _turns(here: StateArrays, there: StateArrays, in_space: bool) -> Array:
    """(N,) or (N, 3) of all nodes between two states, rad."""
    if not in_space:
        return np.asarray(there.angle - here.angle)
    return turn_of(there.frames @ np.swapaxes(here.frames, 1, 2))


def _refined(state: StateArrays, in_space: bool) -> StateArrays:
    """The state with a node in the middle of all elements but the first."""
    n = len(state.angle) - 1
    frames = state.frames if in_space else planar_frames(state.angle)
    middle = frames[1:-1]
    if in_space:
        middle = middle @ rotation(0.5 * turn_of(np.swapaxes(frames[1:-1], 1, 2) @ frames[2:]))
    distance = np.linalg.norm(np.diff(state.place[1:], axis=0), axis=1)[:, None]
    place = 0.5 * (state.place[1:-1] + state.place[2:])
    place += distance / 8.0 * (frames[1:-1, :, 0] - frames[2:, :, 0])

    def mixed(old: Array, new: Array) -> Array:
        both = np.empty((2 * n, *old.shape[1:]))
        both[0], both[1::2], both[2::2] = old[0], old[1:], new
        return both

    inner = np.concatenate([state.inner[:1], np.repeat(state.inner[1:], 2, axis=0)])
    angle = mixed(state.angle, 0.5 * (state.angle[1:-1] + state.angle[2:]))
    return StateArrays(mixed(state.place, place), angle, mixed(state.frames, middle), inner, state.force.copy())
