"""The way from an equilibrium to another load factor and other prescribed displacements, driven from 0 to 1.

Another height of the end, at the pressure of a known state or above it, is reached from there in one increment. From
rest the way takes many where walls come into contact.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

from fem.effects.effect import Terms
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.system import System
from fem.path.control import Control, Drive, load_change, rate_with_motion, to_equilibrium
from fem.solution import Step
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)
class MoveControl(Control):
    """The part of the way from an equilibrium to another load factor and other prescribed displacements, 0 to 1.

    Both change along straight lines. Constant loads are those of the equilibrium, in full.
    """

    factors: tuple[float, float]  #: load factor at the beginning and at the end
    motion: Array = field(repr=False)  #: (n, 3) by which the supports move on the whole way, mm
    last: Array = field(repr=False)  #: (n, 3) prescribed displacements at the end, mm

    name = "part of the way"
    gives_load = True

    @classmethod
    def of(cls, system: System, begin: Step, factor: float) -> "MoveControl":
        """From a finished step of a model with equal supports, but for the displacements that they prescribe."""
        last = system.constraints.prescribed(factor, 1.0)
        motion = system.constraints.correction(begin.displacement, last)
        return cls(system, 1.0, 0.0, 1.0, (begin.factor, factor), motion, last)

    @cached_property
    def prescribed(self) -> Array:
        return self.last - (1.0 - self.value) * self.motion

    def _value_at(self, factor: float, x: Array) -> float:
        return self.value  # the load factor is given with it

    def start(self, state: State) -> State:
        first, last = self.factors
        return replace(state, factor=last - (1.0 - self.value) * (last - first))

    def increment(
        self, state: State, assembly: Assembly, linearised: Linearised, prescribed_increment: Array, terms: Terms
    ) -> tuple[Change, int]:
        return to_equilibrium(assembly, linearised), linearised.negative_pivots

    def rate(self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms) -> State | None:
        _, coupling = self.system.tangent(state, assembly, terms, self.motion, convex=False)
        return rate_with_motion(self.system, state, assembly, linearised, self._drive(state, terms, coupling))

    def rate_at_begin(self, state: State, terms: Terms) -> State:
        """Tangent of the path at the equilibrium where it begins; factorizes. Raises `SingularMatrix`."""
        assembly = self.system.assemble(state, terms)
        linearised = self.system.linearise(state, assembly, terms, self.motion)
        drive = self._drive(state, terms, linearised.coupling)
        return rate_with_motion(self.system, state, assembly, linearised, drive)

    def rate_at_rest(self, terms: Terms, fraction: float) -> State | None:
        return None  # the path does not begin at rest

    def _drive(self, state: State, terms: Terms, coupling: Change) -> Drive:
        growth = self.factors[1] - self.factors[0]
        return Drive(growth * load_change(self.system, state, terms), growth, self.motion, coupling)
