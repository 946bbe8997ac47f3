"""A step in time of a chain of elements: generalised-alpha on the residual and tangent of `rod.arm`.

Forces are those at a time within the step; motions that no step resolves die out. J. Chung, G. M. Hulbert, J. Appl.
Mech. 60 (1993) 371; for rotations O. Bruels, A. Cardona, J. Comput. Nonlinear Dynam. 5 (2010) 031002. Branches of the
rubber are integrated exactly for forces that change evenly from one such time to the next.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.arm.chain import solve_chain
from rod.arm.end_kernels import EndArrays
from rod.arm.newton import Inertia
from rod.arm.nodes import FORCES, ArmArrays, StateArrays
from rod.arm.section_kernels import SectionArrays
from rod.arm.solver import Solver
from rod.frames import rotation, turn_of
from rod.in_time.relaxation import Creep, Relaxation

#: part of a motion that no step resolves which is left after a step
RHO = 0.6
#: weight of the last acceleration; where in a step the forces are taken; and the numbers of Newmark's formulas
LAST, WITHIN = (2.0 * RHO - 1.0) / (RHO + 1.0), 1.0 / (RHO + 1.0)
BETA, GAMMA = 0.25 * (2.0 - LAST - WITHIN) ** 2, 1.5 - LAST - WITHIN
#: error of a step over the change of the acceleration times its square
ERROR = abs(BETA - 1.0 / 6.0)
#: iterations of Newton's method
ITERATIONS = 25


class Joined:
    """Sections, ends and the part that relaxes between two pressures, by straight lines; views of one buffer."""

    def __init__(self, *both: tuple[SectionArrays, EndArrays, float]) -> None:
        first, second = ([*section[1:4], *ends[1:], np.array([part])] for section, ends, part in both)
        self.low = np.concatenate([values.ravel() for values in first])
        self.way = np.concatenate([values.ravel() for values in second]) - self.low
        self.buffer, self.part = self.low.copy(), 0.0
        cuts = np.split(self.buffer, np.cumsum([values.size for values in first])[:-1])
        views = [cut.reshape(values.shape) for cut, values in zip(cuts, first, strict=True)]
        self.section = both[0][0]._replace(table=views[0], numbers=views[1], local=views[2])
        self.ends, self.relaxing = EndArrays(both[0][1].is_polynomial, *views[3:-1]), views[-1]

    def go(self, part: float) -> None:
        """To a part of the way."""
        if part != self.part:
            np.multiply(self.way, part, out=self.buffer)
            self.buffer += self.low
            self.part = part


class Memory(NamedTuple):
    """What the branches of the rubber remember of the last time within a step."""

    time: float  #: s
    pressure: Array  #: (c,) kPa
    late: Array  #: (K, c) kPa, of the pressure that is not felt yet
    elastic: Array  #: (n, f) N mm and N, elastic forces of the elements
    forces: Array  #: (K, n, f) of the branches


@dataclass(frozen=True, eq=False)  # arrays inside
class Moment:
    """An arm in motion at the end of a step, in tonne, mm and s; columns 0 to 5 are places and turns."""

    time: float
    state: StateArrays
    speed: Array  #: (N, 6)
    acceleration: Array  #: (N, 6)
    memory: Memory
    pressure: Array  #: (c,) kPa
    error: float = 0.0  #: of the step, of means of the places over the length, in which short waves cancel
    outside: float = 0.0  #: 1/mm, by how much a curvature leaves the law
    volume: float = 0.0  #: mm3, of air that decides on its pressure


class Stepper:
    """Makes steps of a chain of elements."""

    def __init__(
        self, solver: Solver, bodies: tuple[Array, Array, Array], relaxation: Relaxation, creep: Creep
    ) -> None:
        """bodies: mass (N,), first (N, 3) and second (N, 3, 3) moments of the nodes."""
        self.solver, self.bodies = solver, bodies
        solve_chain.compile_next()
        self.in_space = solver.chain.in_space
        self.has_mass = (bodies[0] > 0.0)[:, None]
        means = bodies[0] * np.array([np.ones_like(solver.s), solver.s, solver.s**2])
        self.means = means / means.sum(axis=1)[:, None]
        self.first = FORCES[self.in_space]
        self.shares, self.times = np.array(relaxation.shares), np.array(relaxation.times_s)
        self.creep = np.array(creep.shares), np.array(creep.times_s)

    def felt(self, memory: Memory, time: float, pressure: Array) -> tuple[Array, Array]:
        """Pressures (c,) that are felt at a time, and what of them is late (K, c)."""
        shares, times = self.creep
        decay, slowed = _branches((time - memory.time) / times)
        late = decay[:, None] * memory.late + (shares * slowed)[:, None] * (pressure - memory.pressure)
        return pressure - late.sum(axis=0), late

    def step(self, now: Moment, dt: float, joined: Joined, pressures: Array, late: Array) -> Moment | None:
        """The end of a step under pressures (2, c), within it and at its end; None where none is found.

        joined: at the pressure that is felt then; late: as `felt` gives it.
        """
        memory, time = now.memory, now.time + WITHIN * dt
        decay, slowed = _branches((time - memory.time) / self.times)
        section, slowed = joined.section, joined.relaxing * self.shares * slowed
        scale = 1.0 + float(slowed.sum())
        if len(slowed):
            held = (decay @ memory.forces.reshape(len(decay), -1)).reshape(memory.elastic.shape)
            held -= (scale - 1.0) * memory.elastic
            section = section._replace(scale=scale, memory=held)
        v, a, by = now.speed, now.acceleration, 1.0 / (BETA * dt * dt)
        known = dt * v + dt * dt * (0.5 - BETA) * a
        carried = np.empty((len(v), 9))
        carried[:, :6] = LAST * a - (1.0 - LAST) * by * known
        carried[:, 6:] = (v + WITHIN * (dt * (1.0 - GAMMA) * a - GAMMA * by * dt * known))[:, 3:]
        rates = np.array([(1.0 - LAST) * by / WITHIN, GAMMA * by * dt])
        inertia = Inertia(*self.bodies, now.state.place, now.state.angle, now.state.frames, carried, rates)
        since, solver = np.where(self.has_mass, WITHIN * dt, time - memory.time), self.solver
        for guess in (since, self.has_mass * since):  # without mass a node may have moved to where it does not stay
            state = self._moved(now.state, guess * (v + 0.5 * WITHIN * dt * a))
            arm = ArmArrays(section, joined.ends, solver.chain)
            found = solve_chain(arm, solver.load, state, 1.0, solver.room, ITERATIONS, np.empty(0), inertia)
            if found.converged:
                break
        else:
            return None
        motion = self._motion(now.state, state)
        later = self.has_mass * by * (motion / WITHIN - known)
        speed = np.where(self.has_mass, v + dt * ((1.0 - GAMMA) * a + GAMMA * later), motion / since)
        error = ERROR * dt * dt * float(np.abs(self.means @ (later - a)[:, :3]).max()) / solver.chain.length
        forces = solver.room.kept[:, self.first : self.first + memory.elastic.shape[1]]
        if len(slowed):
            elastic = (forces - held) / scale
            branches = decay[:, None, None] * memory.forces + np.multiply.outer(slowed, elastic - memory.elastic)
            memory = Memory(time, pressures[0], late, elastic, branches)
        else:
            memory = memory._replace(time=time, pressure=pressures[0])
        state = self._moved(state, (1.0 / WITHIN - 1.0) * self.has_mass * motion)
        return Moment(now.time + dt, state, speed, later, memory, pressures[1], error, found.outside)

    def _motion(self, before: StateArrays, after: StateArrays) -> Array:
        """(N, 6) between two states."""
        motion = np.zeros((len(after.place), 6))
        motion[:, :3] = after.place - before.place
        if self.in_space:
            motion[:, 3:] = turn_of(after.frames @ np.swapaxes(before.frames, 1, 2))
        else:
            motion[:, 5] = after.angle - before.angle
        return motion

    def _moved(self, state: StateArrays, motion: Array) -> StateArrays:
        """A copy of a state after a motion (N, 6)."""
        frames = rotation(motion[:, 3:]) @ state.frames if self.in_space else state.frames
        place, angle = state.place + motion[:, :3], state.angle + motion[:, 5]
        return StateArrays(place, angle, frames, state.inner.copy(), state.reaction.copy())


def _branches(x: Array) -> tuple[Array, Array]:
    """What is left of branches (K,) after x times their time, and the mean of it on the way."""
    decay = np.exp(-x)
    return decay, np.where(x > 0.0, -np.expm1(-x) / np.where(x > 0.0, x, 1.0), 1.0)
