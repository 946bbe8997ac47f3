"""An arm at one pressure as a chain of elements under loads, as its path and its stability ask for it."""

from copy import copy
from typing import Protocol

import numpy as np

from geometry.arrays import Array
from rod.along import Position
from rod.arm.chain import NO_SIDE, Nodes, load_arrays, nodes_of, rest_state, room_for, solve_chain
from rod.arm.end_kernels import EndArrays
from rod.arm.newton import ITERATIONS, STATICS, NewtonResult
from rod.arm.nodes import ArmArrays, Chain, StateArrays, acting, levers_of
from rod.arm.sections import Section
from rod.frames import planar_frames
from rod.load import Load
from rod.weight import Mass

#: of a state that no iteration has found
NOT_SOLVED = NewtonResult(True, 0.0, 0.0, (0, 0), 0)


class ArmModel(Protocol):
    """An arm at one pressure, as the path asks for it."""

    @property
    def section(self) -> Section:
        """Law of the cells."""

    @property
    def mass(self) -> Mass | None:
        """How a weight is spread along the arm; None: evenly."""

    @property
    def decides_at(self) -> float:
        """mm, where the bending moment decides on the clamp."""

    @property
    def clamp_reach(self) -> float:
        """mm, how far the clamped end reaches."""

    def positions(self, breaks: tuple[float, ...]) -> Array:
        """(N,) mm: the nodes, with the breaks among them, and where the moment decides. The first element is short."""

    def ends(self, end: Position) -> EndArrays:
        """Clamp and tip, of an end that is held along the axes with a prescribed position."""

    def begin(self) -> tuple[Array, Array]:
        """Place (3,) in mm and frame (3, 3) of the axis at the clamp without moment."""


class Solver:
    """A chain of an arm under loads, between its supports."""

    def __init__(self, arm: ArmModel, s: Array, load: Load, *, in_space: bool) -> None:
        self.arm, self.s = arm, s
        self.ends = arm.ends(load.end_at(float(s[-1])))
        free = min(max(int(np.searchsorted(s, arm.clamp_reach - 1e-9)), 1), len(s) - 1)
        node = int(np.argmin(np.abs(s - arm.decides_at)))
        self.chain = Chain(in_space, True, np.diff(s), node, arm.decides_at - float(s[node]), free, float(s[-1]))
        self.load = load_arrays(load, arm.mass, s)
        self.room = room_for(self.chain, len(self.load.held))
        self.push = np.zeros((len(s), 3))  #: N, on the nodes under any part of the loads but none

    def rest(self, grown: float = 1.0) -> StateArrays:
        """The chain without loads, at a part of its rest curvature."""
        return rest_state(self.s, self.arm.section.rest(self.s, grown), *self.arm.begin(), len(self.load.held))

    def converge(
        self, state: StateArrays, factor: float, target: Array, grown: float = 1.0, iterations: int = ITERATIONS
    ) -> NewtonResult:
        """The equilibrium near a state, which becomes it, under a part of the loads; what is held is at target (k,)."""
        nodes = self.load.nodes + self.push / factor if factor else self.load.nodes
        load = self.load._replace(target=target, nodes=nodes)
        return solve_chain(self.arrays(factor, grown), load, state, factor, self.room, iterations, NO_SIDE, STATICS)

    def arrays(self, factor: float = 1.0, grown: float = 1.0) -> ArmArrays:
        """The arm under a part of the loads, at a part of its rest curvature."""
        return ArmArrays(self.arm.section.arrays(self.s, factor, grown), self.ends, self.chain)

    def pushed(self, force: Array) -> "Solver":
        """This arm under forces (N, 3) in N on its nodes besides."""
        other = copy(self)
        other.push = self.push + force
        return other

    def moved_by(self, force: Array, state: StateArrays, factor: float, grown: float) -> Array:
        """(N, m) mm and rad: the small motion of a state under a part of the loads by forces (N, 3) on its nodes."""
        n, (m, places) = len(force), (6, 3) if self.chain.in_space else (3, 2)
        side = np.zeros(n * m + len(self.load.held))
        side[: (n - 1) * m].reshape(n - 1, m)[:, :places] = -force[1:, :places]
        self.respond(state, side, factor, grown)
        return side[: n * m].reshape(n, m)

    def respond(self, state: StateArrays, side: Array = NO_SIDE, factor: float = 1.0, grown: float = 1.0) -> Array:
        """(N m + k,): residual, motion of the first node, and by how much what is held misses, under a part of loads.

        A side (N m + k,) becomes what the state answers to it (`rod.arm.newton`).
        """
        solve_chain(self.arrays(factor, grown), self.load, state, factor, self.room, 0, side, STATICS)
        return np.concatenate([self.room.residual, self.room.start[:, 0], self.room.missed])

    def end(self, state: StateArrays) -> Array:
        """(6,): the end of the material curve in mm, and the force on it in N, with what holds it."""
        frame = state.frames[-1] if self.chain.in_space else planar_frames(state.angle[-1:])[0]
        force = acting(self.load, state, 1.0).force
        return np.concatenate([state.place[-1] + levers_of(self.ends, frame, force)[2], force])

    def held(self, state: StateArrays) -> Array:
        """(k,) mm or rad, of what is held: where a state has it."""
        copied = state._replace(inner=state.inner.copy())
        self.converge(copied, 0.0, np.zeros(len(self.load.held)), iterations=0)
        return self.room.missed.copy()

    def nodes(self, state: StateArrays, found: NewtonResult = NOT_SOLVED) -> Nodes:
        """Moments and forces under the full load."""
        return nodes_of(self.s, state, self.chain, self.ends, self.load, found)
