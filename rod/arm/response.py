"""How an arm in equilibrium changes with a parameter, and the equilibrium of another arm beside it.

What is out of balance in a state where a parameter is a little smaller and larger is one more right-hand side for its
tangent (`rod.arm.newton`): loads enter it linearly, a law by the forces of its sections at the strains of the state.
"""

from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from geometry.arrays import Array, read_only
from rod.along import check_inside
from rod.arm.chain import Nodes
from rod.arm.nodes import StateArrays
from rod.arm.path import Path, beside
from rod.arm.small_motions import OF_CLAMP
from rod.arm.solver import ArmModel, Solver
from rod.errors import RodError
from rod.load import Load

#: solutions with one tangent, which leaves out how the place of the moment that decides on a clamp moves; and the
#: motion (rad, and mm over the length) by which that is found
PASSES, MOVED = 4, 1e-5


class Posed(Protocol):
    """An arm at one pressure, as it is solved."""

    def posed(self, load: Load) -> tuple[ArmModel, Load]:
        """The arm, and all that acts on it and holds it."""

    @property
    def is_in_space(self) -> bool:
        """Whether it is known out of a plane."""

    def outside(self, path: Path) -> str:
        """A sentence where a state leaves what is known of the arm; empty elsewhere."""


#: an arm, and what acts on it
Case: TypeAlias = tuple[Posed, Load]
#: a load, or two arms
Parameter: TypeAlias = Load | tuple[Posed, Posed]


class Response(NamedTuple):
    """Derivatives of an arm in equilibrium by a parameter. All arrays are read-only."""

    axis: Array  #: (n, 3) mm, of its places at the s of the solution
    turn: Array  #: (n, 3) rad, of its sections, about x, y and z
    end: Array  #: (3,) mm, of the end of the material curve
    force: Array  #: (3,) N, on the end; a reaction where it is held


class SolvedPath(NamedTuple):
    """How a state was found."""

    rod: Posed
    load: Load  #: what acts on the rod besides what always does, and holds it
    chains: tuple[Nodes, Nodes]  #: both chains of elements in equilibrium
    in_space: bool = False
    fall: str = ""  #: how the arm buckled on the way, a sentence

    def refuse_fall(self) -> "SolvedPath":
        """Give a path back. Raises `RodError` where the arm falls on the way."""
        if self.fall:
            raise RodError(self.fall)
        return self

    @property
    def sideways(self) -> str:
        """A sentence where an arm in its plane is unstable out of it; empty elsewhere, and where that is not known."""
        if self.in_space or not self.rod.is_in_space:
            return ""
        nodes = self.chains[1]
        solver, state = self._replace(in_space=True)._solver(nodes, self.rod, self.load), nodes.state
        rest = solver.rest()
        free, found = solver.converge(rest, 0.0, solver.held(rest)), solver.converge(state, 1.0, solver.load.target)
        if found.converged and found.negative[0] <= min(free.negative[0], OF_CLAMP):
            return ""
        return "The arm buckles out of its plane before this load; give a third component to follow it."

    def derivative(self, by: Parameter, passes: int = PASSES) -> Response:
        """The derivative as of `rod.solution.RodSolution.derivative`; the first pass is right to half a percent."""
        if isinstance(by, tuple):
            return self._change((by[0], self.load), (by[1], self.load), passes)
        if by.supports:
            raise RodError("A rod has derivatives by loads and by its law; a support is neither.")
        for one in by.along:
            check_inside(one, float(self.chains[0].s[-1]))
        if by.leaves_plane and not self.in_space:
            raise RodError("A load across the plane moves an arm in space; solve the rod there.")
        less, more = ((self.rod, self.load.plus(by, part)) for part in (-0.5, 0.5))
        return self._change(less, more, passes)

    def beside(self, load: Load) -> Path:
        """The equilibrium under another load beside this one. Raises `RodError` where there is none as stable."""
        return beside(*self.rod.posed(load), self.chains, in_space=self.in_space)

    def at(self, rod: Posed) -> "SolvedPath":
        """The equilibrium of another arm beside this one. Raises `RodError` where there is none as stable."""
        path = self._replace(rod=rod).beside(self.load)
        if outside := rod.outside(path):
            raise RodError(outside)
        return self._replace(rod=rod, chains=path.chains)

    @property
    def state(self) -> Array:
        """(9,): the end of the material curve in mm, the force on it in N, and how its section is turned: about x, y
        and z in rad for an arm in its plane, in space its normal."""
        ends = (self._solver(nodes, self.rod, self.load).end(nodes.state) for nodes in self.chains)
        turns = (n.frames[-1, :, 0] if self.in_space else (0.0, 0.0, n.angle[-1]) for n in self.chains)
        low, high = (np.append(end, turn) for end, turn in zip(ends, turns, strict=True))
        return np.asarray(high + (high - low) / 3.0)

    def change_of_state(self, response: Response) -> Array:
        """(9,): how `state` changes with the parameter of a response."""
        turn = response.turn[-1]
        turn = np.cross(turn, self.chains[1].frames[-1, :, 0]) if self.in_space else turn
        return np.concatenate([response.end, response.force, turn])

    def bending_deg(self, states: Array) -> Array:
        """(...,) degrees, how far the end section is turned from rest in states (..., 9) of this arm.

        In its plane it is positive to the side to which this arm bends without load, and counts full turns.
        """
        if self.in_space:
            return np.degrees(np.arctan2(np.hypot(states[..., 7], states[..., 8]), states[..., 6]))
        arm, s = self.rod.posed(self.load)[0], self.chains[0].s
        bends_up = np.diff(s) @ arm.section.rest(s)[:, 2] > 0.0
        return np.degrees(states[..., 8]) * (1.0 if bends_up else -1.0)

    def _change(self, less: Case, more: Case, passes: int) -> Response:
        """At the limit of the elements: the errors are those of h^2."""
        (low, *lower), (high, *higher) = (self._of(nodes, less, more, passes) for nodes in self.chains)
        at = np.searchsorted(self.chains[1].s, self.chains[0].s - 1e-9 * self.chains[0].s[-1])
        pairs = zip((low, *lower), (high[at], *higher), strict=True)
        motion, end, force = (fine + (fine - coarse) / 3.0 for coarse, fine in pairs)
        return Response(*map(read_only, (motion[:, :3].copy(), motion[:, 3:].copy(), end, force)))

    def _of(self, nodes: Nodes, less: Case, more: Case, passes: int) -> tuple[Array, Array, Array]:
        """Of one chain: motions (N, 6), end (3,) and force (3,)."""
        solver, left, right = (self._solver(nodes, *one) for one in ((self.rod, self.load), less, more))
        side = _out_of_balance(right, nodes.state) - _out_of_balance(left, nodes.state)
        unknowns = [0, 1, 2, 3, 4, 5] if self.in_space else [0, 1, 5]
        motion, moved, total = np.zeros((len(nodes.s), 6)), np.zeros(len(side) - 6), side
        count = len(motion) * len(unknowns)
        for _ in range(passes if solver.chain.decides else 1):
            solver.respond(nodes.state, answer := total[:-6].copy())
            moved = moved + answer
            motion[:, unknowns] = moved[:count].reshape(len(motion), -1)
            part = MOVED / max(np.abs(motion[:, :3]).max() / nodes.s[-1], np.abs(motion[:, 3:]).max(), 1e-300)
            states = (nodes.moved(step * motion, step * moved[count:]) for step in (part, -part))
            ahead, behind = (_out_of_balance(solver, state) for state in states)
            total = side + (ahead - behind) / (2.0 * part)
        return motion, total[-6:-3], total[-3:]

    def _solver(self, nodes: Nodes, rod: Posed, load: Load) -> Solver:
        arm, posed = rod.posed(load)
        return Solver(arm, nodes.s, posed, in_space=self.in_space)


def _out_of_balance(solver: Solver, state: StateArrays) -> Array:
    """(N m + k + 6,): what a state misses under the full load, and the end in mm and the force on it in N."""
    return np.concatenate([solver.respond(state), solver.end(state)])
