"""The way from an equilibrium to another load factor, other prescribed displacements and more loads, in parts of it.

Another height of the end or a force on it, at the pressure of a known state or above it, is reached from there in one
increment. From rest the way takes many where walls come into contact.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

from fem.effects.effect import Terms, at_constant_fraction
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.system import System
from fem.path.active_set import ActiveSet
from fem.path.control import Control, Drive, load_change, rate_with_motion
from fem.solution import Step
from geometry.arrays import Array


@final
@dataclass(frozen=True, eq=False)
class MoveControl(Control):
    """The part of the way from an equilibrium to another load factor, other prescribed displacements and more loads.

    All change along straight lines. Constant loads of the equilibrium stay in full; those that it lacks grow from zero.
    """

    factors: tuple[float, float]  #: load factor at the beginning and at the end
    motion: Array = field(repr=False)  #: (n, 3) by which the supports move on the whole way, mm
    last: Array = field(repr=False)  #: (n, 3) prescribed displacements at the end, mm
    unbalanced: Array = field(repr=False)  #: (n, 3) gradient at the beginning, N: the loads that grow from zero

    name = "part of the way"
    gives_load = True

    @classmethod
    def of(cls, system: System, begin: Step, factor: float) -> "MoveControl":
        """From a finished step of a model whose supports may prescribe other displacements, without the last loads."""
        last = system.constraints.prescribed(factor, 1.0)
        motion = system.constraints.correction(begin.displacement, last)
        state, terms = system.state_at(begin.displacement, begin.factor), ActiveSet.of_step(system.terms, begin).active
        unbalanced = system.assemble(state, at_constant_fraction(terms, 1.0)).gradient
        return cls(system, 1.0, 0.0, 1.0, (begin.factor, factor), motion, last, unbalanced)

    @cached_property
    def prescribed(self) -> Array:
        return self.last - (1.0 - self.value) * self.motion

    def _value_at(self, factor: float, x: Array) -> float:
        return self.value  # the load factor is given with it

    def start(self, state: State) -> State:
        first, last = self.factors
        return replace(state, factor=last - (1.0 - self.value) * (last - first))

    def rate(self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms) -> State | None:
        _, coupling = self.system.tangent(state, assembly, terms, self.motion, convex=False)
        return rate_with_motion(self.system, state, assembly, linearised, self._drive(state, terms, coupling))

    def rate_at_begin(self, state: State, terms: Terms) -> State:
        """Tangent of the path at the equilibrium where it begins; factorizes. Raises `SingularMatrix`."""
        assembly = self.system.assemble(state, terms)
        linearised = self.system.linearise(state, assembly, terms, self.motion)
        drive = self._drive(state, terms, linearised.coupling)
        return rate_with_motion(self.system, state, assembly, linearised, drive)

    def _drive(self, state: State, terms: Terms, coupling: Change) -> Drive:
        growth = self.factors[1] - self.factors[0]
        loads = self.unbalanced + growth * load_change(self.system, state, terms)
        return Drive(loads, growth, self.motion, coupling)
