"""Steps in time of a chain of elements, whose rubber relaxes and whose pressure creeps."""

import math
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.arm import step_kernels
from rod.arm.end_kernels import EndArrays
from rod.arm.nodes import ArmArrays
from rod.arm.section_kernels import TABULATED, SectionArrays
from rod.arm.solver import Solver
from rod.in_time.relaxation import Creep, Relaxation


class Joined:
    """Sections, ends and the part that relaxes at one pressure and beside it, joined by straight lines."""

    def __init__(self, *all_of: tuple[SectionArrays, EndArrays, float]) -> None:
        """The first at the lower pressures, one more at each higher one."""
        first, *others = ([*section[1:4], *ends[1:], np.array([part])] for section, ends, part in all_of)
        self.low = np.concatenate([values.ravel() for values in first])
        self.ways = [np.concatenate([values.ravel() for values in one]) - self.low for one in others]
        self.buffer, self.parts = self.low.copy(), np.zeros(len(others))
        cuts = np.split(self.buffer, np.cumsum([values.size for values in first])[:-1])
        views = [cut.reshape(values.shape) for cut, values in zip(cuts, first, strict=True)]
        self.section = all_of[0][0]._replace(table=views[0], numbers=views[1], local=views[2])
        self.ends, self.relaxing = EndArrays(all_of[0][1].is_polynomial, *views[3:-1]), views[-1]

    def go(self, parts: Array) -> None:
        """To parts (c,) of the ways."""
        if not np.array_equal(parts, self.parts):
            np.multiply(self.ways[0], parts[0], out=self.buffer)
            for way, part in zip(self.ways[1:], parts[1:], strict=True):
                self.buffer += part * way
            self.buffer += self.low
            self.parts = parts

    @property
    def curvatures(self) -> tuple[float, float]:
        """1/mm, between which the law knows the section."""
        kind, numbers = self.section.kind, self.section.numbers
        if kind != TABULATED:
            reach = float(numbers[12]) if len(numbers) > 12 else math.inf
            return -reach, reach
        edge = self.section.table.shape[1] // step_kernels.PIECES
        first, step = numbers.tolist()
        return first + step * edge, first + step * (self.section.table.shape[1] - edge)

    @property
    def width(self) -> float:
        """1/mm, of these curvatures."""
        low, high = self.curvatures
        return high - low


@dataclass(frozen=True, eq=False)  # arrays inside
class Moment:
    """An arm at the end of a step."""

    time: float  #: s
    moving: step_kernels.Moving
    within: float  #: s, the last time within a step, of which the rubber remembers what follows
    felt_then: Array  #: (c,) kPa, the pressure then
    late: Array  #: (K, c) kPa, what of it was not felt yet
    pressure: Array  #: (c,) kPa
    error: float = 0.0  #: of the step, as in `rod.arm.step_kernels.StepReport`, and so is the speed
    fast: float = 0.0
    outside: float = 0.0  #: 1/mm, by how much a curvature leaves the law
    volume: float = 0.0  #: mm3, of air that decides on its pressure


class Stepper:
    """Makes steps of a chain of elements."""

    def __init__(
        self, solver: Solver, bodies: tuple[Array, Array, Array], relaxation: Relaxation, creep: Creep
    ) -> None:
        """bodies: mass (N,), first (N, 3) and second (N, 3, 3) moments of the nodes."""
        self.solver = solver
        means = bodies[0] * np.array([np.ones_like(solver.s), solver.s, solver.s**2])
        self.bodies = step_kernels.Bodies(*bodies, means / means.sum(axis=1)[:, None])
        self.shares, self.times = np.array(relaxation.shares), np.array(relaxation.times_s)
        self.creep = np.array(creep.shares), np.array(creep.times_s)

    def felt(self, now: Moment, time: float, pressure: Array) -> tuple[Array, Array]:
        """Pressures (c,) that are felt at a time, and what of them is late (K, c)."""
        shares, times = self.creep
        decay, slowed = _branches((time - now.within) / times)
        late = decay[:, None] * now.late + (shares * slowed)[:, None] * (pressure - now.felt_then)
        return pressure - late.sum(axis=0), late

    def step(self, now: Moment, dt: float, joined: Joined, pressures: Array, late: Array) -> Moment | None:
        """The end of a step under pressures (2, c), within it and at its end; None where none is found.

        joined: at the pressure that is felt then; late: as `felt` gives it.
        """
        time, solver = now.time + step_kernels.WITHIN * dt, self.solver
        decay, slowed = _branches((time - now.within) / self.times)
        slowed *= joined.relaxing * self.shares
        arm = ArmArrays(joined.section, joined.ends, solver.chain)
        moving, told = step_kernels.advance(
            arm, solver.load, now.moving, self.bodies, solver.room, decay, slowed, dt, time - now.within
        )
        if not told.converged:
            return None
        return Moment(now.time + dt, moving, time, pressures[0], late, pressures[1], *told[1:])


def _branches(x: Array) -> tuple[Array, Array]:
    """What is left of branches (K,) after x times their time, and the mean of it on the way."""
    decay = np.exp(-x)
    return decay, np.where(x > 0.0, -np.expm1(-x) / np.where(x > 0.0, x, 1.0), 1.0)
