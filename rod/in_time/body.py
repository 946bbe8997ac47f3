"""What moves: an arm over its pressures, with its mass and its rubber, and what acts on it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.arm import step_kernels
from rod.arm.end_kernels import EndArrays
from rod.arm.section_kernels import TABULATED, SectionArrays
from rod.arm.solver import Solver
from rod.arm_law.kinds import Law
from rod.cubics import cubic, cubic_coefficients, cubic_slope, parabola_slopes
from rod.errors import RodError
from rod.in_time.relaxation import ELASTIC, Creep, Relaxation
from rod.load import Load, Loading
from rod.mechanics.equilibrium import Arm, Rod
from rod.pressurised_rod import PressurisedRod
from rod.weight import Mass, position_along

#: tonne
GRAM = 1e-6
#: pieces of stretch and rigidities over the curvature, and besides two beyond the law
SMOOTH = step_kernels.PIECES - 2
#: pieces of rotation and offset of a clamp over its moments; kinks of these are hinges as well
CLAMP = 20
#: part of its moments at either end that is left out: between two pressures, states of walls that touch are least alike
#: there, and an axial force would make the clamp jump
EDGE = 0.05


@final
@dataclass(frozen=True, eq=False)  # a law has arrays
class Body:
    """An arm with all that decides on its motion."""

    law: Law | PressurisedRod | Rod  #: a `Rod` stays as it is at any pressure
    relaxation: Relaxation = ELASTIC  #: of the forces of its sections
    mass: Mass | None = None  #: None: that of the law
    #: mm2, mean squares of its distance from its centre, along y and z; None: its rigidities over that against stretch
    spread: tuple[float, float] | None = None
    felt: Relaxation | None = None  #: of the pressure that is felt; None: the same

    def at(self, pressures: Array) -> Arm:
        """The arm at pressures (c,) in kPa. Raises `RodError` as the law does."""
        return self._known(tuple(pressures.tolist()))

    @cached_property
    def _known(self) -> Callable[[tuple[float, ...]], Arm]:
        """Arms, which take longer than a step."""

        def at(pressures: tuple[float, ...]) -> Arm:
            return self.law.at(pressures).arm

        return lru_cache(256)(at)

    def relaxing(self, arm: Arm) -> float:
        """The part of the rigidity of an arm, at its shape without load, that is the rubber's, and so relaxes.

        It is the rigidity without pressure over that with it, and 1 where the law does not begin without pressure.
        """
        try:
            at_rest = self.at(np.zeros(len(self.law.cavities)))
            return at_rest.rigidity_at(arm.kappa_0) / arm.rigidity_at(arm.kappa_0)
        except RodError:
            return 1.0

    @property
    def creep(self) -> Creep:
        """Creep of the pressure that is felt."""
        return (self.felt or self.relaxation).creep

    @property
    def weighed(self) -> Mass:
        """Its mass. Raises `RodError` where it is not known."""
        mass = self.mass or self.law.mass
        if mass is None:
            raise RodError("The mass of the arm is not known; a motion needs material.density in the configuration.")
        return mass

    def loaded(self, acting: Loading, arm: Arm) -> Load:
        """What acts, as a load; masses without a direction of gravity have no weight. Raises as `Loading.on`."""
        return acting.on(arm.length, None if acting.direction is None else self.weighed, arm.weight)

    def inertia(self, acting: Loading, solver: Solver) -> tuple[Array, Array, Array]:
        """Mass (N,), its place in the frame (N, 3) and moments of inertia (N, 3, 3) of the nodes; tonne and mm."""
        s, length = solver.s, float(solver.s[-1])
        edges = np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])
        mass, heights = (-GRAM * np.diff(one) for one in self.weighed.within(length - edges))
        lever = np.zeros((len(s), 3))
        lever[:, 1] = heights / mass
        y, z = self.spread or (_gyration(solver),) * 2
        along = np.diff(edges) ** 2 / 12.0
        second = np.zeros((len(s), 3, 3))
        squares = np.array([along, along + y, along + z]).T  # of the distances along the three directions
        second[:, [0, 1, 2], [0, 1, 2]] = mass[:, None] * (squares.sum(axis=1)[:, None] - squares)
        second += _about(mass, lever)
        first = mass[:, None] * lever
        tip = np.array([*solver.ends.tip[len(solver.ends.tip) // 2, 4:6], solver.ends.tip[0, 6]])
        points = [(length, acting.tip_mass, tip)]
        points += [(position_along(at, length), grams, np.zeros(3)) for at, grams in acting.hung]
        for at, grams, beside in points:
            node, one = int(np.abs(s - at).argmin()), np.array([GRAM * grams])
            mass[node] += one[0]
            first[node] += one[0] * beside
            second[node] += _about(one, beside[None])[0]
        # cells and the negative stiffness of a measured clamp are one spring, without masses inside
        for values in (mass, first, second):
            values[: solver.chain.free] = 0.0
        return mass, first, second


def _gyration(solver: Solver) -> float:
    """mm2: the rigidity against bending over that against stretch."""
    arrays = solver.arm.section.arrays(solver.s)
    middle = arrays.table[0, arrays.table.shape[1] // 2]
    stretched = middle[2] if arrays.kind == TABULATED else arrays.numbers[0]
    return float(solver.arm.section.rigidity / stretched)


def _about(mass: Array, lever: Array) -> Array:
    """(n, 3, 3) moments of inertia of masses (n,) at levers (n, 3)."""
    squares = (lever**2).sum(axis=1)[:, None, None] * np.eye(3)
    return np.asarray(mass[:, None, None] * (squares - lever[:, :, None] * lever[:, None, :]))


@lru_cache(256)
def arrays_of(arm: Arm, load: Load, s: tuple[float, ...], in_space: bool) -> tuple[SectionArrays, EndArrays]:
    """Sections and ends of an arm under a load, of one size at all pressures; s: (N,) mm, of the nodes."""
    model, _ = arm.posed(load)
    section, ends = model.section.arrays(np.array(s)), model.ends(load.end_at(s[-1]))
    if section.kind == TABULATED:
        section = _smooth(section, section.table.shape[2] if in_space else 4)
    low, high = ends.moment[[0, -1]]
    low, high = low + EDGE * (high - low), high - EDGE * (high - low)
    # a clamp whose slope ended at its last moment would have a kink there
    inside = np.linspace(low, high, CLAMP + 1)
    clamped = cubic(ends.moment, ends.clamped, ends.clamped_slope, inside)
    slope = parabola_slopes(inside, clamped)[[0, *range(CLAMP + 1), -1]]
    beyond = (high - low) * slope[[0, -1]]
    moment = np.concatenate([[2.0 * low - high], inside, [2.0 * high - low]])
    clamped = np.concatenate([clamped[:1] - beyond[:1], clamped, clamped[-1:] + beyond[1:]])
    return section, ends._replace(moment=moment, clamped=clamped, clamped_slope=slope)


def _smooth(section: SectionArrays, columns: int) -> SectionArrays:
    """A tabulated section without kinks and ends: its stretch and rigidities follow `SMOOTH` cubics.

    Forces of inertia are large beside dead loads; under them every kink of a rigidity would be a hinge.
    """
    (first, step), pieces = section.numbers, section.table.shape[1]
    every = pieces // SMOOTH
    n = np.arange(-every, pieces + every + 1)
    kappa, row = step * n, np.clip(n, 0, pieces - 1)
    inside = step * (np.clip(n, 0, pieces) - row)[:, None]
    c0, c1, c2, c3 = section.table[:, row, :columns]
    values, slopes = c0 + inside * (c1 + inside * (c2 + inside * c3)), c1 + inside * (2.0 * c2 + 3.0 * inside * c3)
    values[:, :2] += (kappa - step * np.clip(n, 0, pieces))[:, None] * slopes[:, :2]
    knots = kappa[::every], values[::every], parabola_slopes(kappa[::every], values[::every])
    knots[2][[0, -1], 2:] = 0.0
    values[:, 1:], slopes[:, 1:] = cubic(*knots, kappa)[:, 1:], cubic_slope(*knots, kappa)[:, 1:]
    table = np.ascontiguousarray(cubic_coefficients(kappa, values, slopes))
    return section._replace(table=table, numbers=np.array([first + kappa[0], step]))
