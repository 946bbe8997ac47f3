"""What is driven along a path: the load factor, or the volume of a cavity with the load factor as an unknown. A third
quantity is in `fem.path.move`.

A limit point of the load, where no neighbouring equilibrium has more of it, is an ordinary point of a path on which the
volume is prescribed: the equation V(x) = V* joins the others with the load factor as its unknown, one bordered row and
column (E. Riks, "An incremental approach to the solution of snapping and buckling problems", Int. J. Solids Struct. 15
(1979), with the volume in place of the arc length).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Self, final

import numpy as np

from fem.effects.effect import Terms, at_constant_fraction
from fem.effects.loads import PressureTerm
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.system import System
from fem.solution import Step
from geometry.arrays import Array


@dataclass(frozen=True, eq=False)
class Control(ABC):
    """A quantity that is driven to the targets, as a rule from its value at rest, and the value prescribed at present.

    Loads and prescribed displacements that are constant along the path are brought up on the way to the first target.
    """

    name: ClassVar[str]  #: of the quantity, for sentences
    gives_load: ClassVar[bool]  #: whether the quantity determines the load factor

    system: System = field(repr=False)
    scale: float  #: what the residual is relative to, in the unit of the quantity
    value: float  #: prescribed value of the quantity
    constant_fraction: float  #: of constant loads and prescribed displacements: 0 at rest, 1 at the first target

    @final
    def target(self, value: float, constant_fraction: float) -> Self:
        """This control at another prescribed value."""
        return replace(self, value=value, constant_fraction=constant_fraction)

    @cached_property
    def prescribed(self) -> Array:
        """(n, 3) displacements where the model prescribes them, mm."""
        # with another quantity than the load factor no displacement is ramped, see `VolumeControl.of`
        return self.system.constraints.prescribed(self.value, self.constant_fraction)

    @final
    def value_of(self, step: Step) -> float:
        """The value of the quantity at a finished step."""
        return self._value_at(step.factor, step.positions)

    @final
    def residual(self, state: State) -> float:
        """The constraint equation: how far the quantity is from the prescribed value, relative."""
        return (self._value_at(state.factor, self.system.space.points + state.displacement) - self.value) / self.scale

    @abstractmethod
    def _value_at(self, factor: float, x: Array) -> float:
        """The value of the quantity at a load factor and current positions x (n, 3), mm."""

    @abstractmethod
    def start(self, state: State) -> State:
        """The state at which Newton's method starts, from a state near the prescribed value."""

    def increment(
        self, state: State, assembly: Assembly, linearised: Linearised, prescribed_increment: Array, terms: Terms
    ) -> tuple[Change, int]:
        """Newton increment of the free unknowns from the tangent at the state, and the number of unstable directions.

        prescribed_increment (n, 3), mm, is what the prescribed displacements still miss. The number is that of the
        negative eigenvalues of the tangent while the quantity is prescribed. Raises `SingularMatrix`.
        """
        return to_equilibrium(assembly, linearised), linearised.negative_pivots

    @abstractmethod
    def rate(self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms) -> State | None:
        """Tangent of the path, d(state)/d(value) at an equilibrium, from a tangent matrix near it.

        assembly is that of the state. None where that matrix does not give it. Raises `SingularMatrix`.
        """

    def rate_with_constants(
        self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms, growth: float
    ) -> State | None:
        """Tangent of the path at an equilibrium while constant loads and displacements grow as well, d(state)/d(value).

        growth: of their fraction per unit of the value. None where it is not available. Raises `SingularMatrix`.
        """
        return None

    def rate_at_rest(self, terms: Terms, fraction: float) -> State | None:
        """Tangent of the path at rest, d(state)/d(value), with constant loads growing by `fraction` per unit of value.

        Factorizes. None where the path is not started from it. Raises `SingularMatrix`.
        """
        return None


@final
@dataclass(frozen=True, eq=False)
class LoadControl(Control):
    """The load factor is prescribed, 0 at rest."""

    name = "load factor"
    gives_load = True

    @classmethod
    def of(cls, system: System) -> "LoadControl":
        """The body at rest."""
        return cls(system, scale=1.0, value=0.0, constant_fraction=0.0)

    def _value_at(self, factor: float, x: Array) -> float:
        return factor

    def start(self, state: State) -> State:
        return replace(state, factor=self.value)

    def rate(self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms) -> State | None:
        if self.system.constraints.ramped.any():  # would need the tangent's columns of the prescribed components
            return None
        change = _load_rate(self.system, state, linearised, terms)
        return self.system.rate(state, assembly, replace(change, factor=1.0))

    def rate_with_constants(
        self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms, growth: float
    ) -> State | None:
        system = self.system
        # the loads are linear in the load factor and the fraction
        more, less = (
            system.loads(
                state.displacement,
                state.factor + part,
                at_constant_fraction(terms, self.constant_fraction + part * growth),
            )
            for part in (0.5, -0.5)
        )
        motion = system.constraints.prescribed(1.0, growth)
        _, coupling = system.tangent(state, assembly, terms, motion, convex=False)
        return rate_with_motion(system, state, assembly, linearised, Drive(more - less, 1.0, motion, coupling))

    def rate_at_rest(self, terms: Terms, fraction: float) -> State | None:
        system, rest, unloaded = self.system, self.system.rest_state(), at_constant_fraction(terms, 0.0)
        motion = system.constraints.prescribed(1.0, fraction)
        assembly = system.assemble(rest, unloaded)
        linearised = system.linearise(rest, assembly, unloaded, motion)
        loaded = system.loads(rest.displacement, 1.0, at_constant_fraction(terms, fraction))
        loads = loaded - system.loads(rest.displacement, 0.0, unloaded)
        return rate_with_motion(system, rest, assembly, linearised, Drive(loads, 1.0, motion, linearised.coupling))


@final
@dataclass(frozen=True, eq=False)
class VolumeControl(Control):
    """The volume behind the faces of `pressures` is prescribed, mm3; the load factor that brings it about is unknown.

    The volume of each term counts times its pressure at load factor 1: what the load factor works on, if they are all
    the pressures of the body.
    """

    pressures: tuple[PressureTerm, ...] = field(repr=False)

    name = "volume in mm3"
    gives_load = False

    @classmethod
    def of(cls, system: System, where: str) -> "VolumeControl":
        """The body at rest, with the volume behind the named faces.

        Raises ValueError for faces that do not exist and for prescribed displacements that grow with the load factor.
        """
        if system.constraints.ramped.any():
            raise ValueError("with a prescribed volume no displacement can grow with the load factor; set ramp=False")
        return cls.behind(system, (PressureTerm(system.space.surface(where), 1.0),))

    @classmethod
    def behind(cls, system: System, pressures: tuple[PressureTerm, ...]) -> "VolumeControl":
        """The body at rest, with the volume that is enclosed by the faces of these terms, by their flux."""
        rest = cls(system, 1.0, 0.0, 0.0, pressures)
        x = system.space.points
        # a volume of the size that the faces could enclose: their area to the power 3/2
        scale = float(np.linalg.norm(rest.gradient(x), axis=1).sum() ** 1.5)
        return replace(rest, scale=scale, value=rest.volume(x))

    def volume(self, x: Array) -> float:
        """At positions x (n, 3), mm3."""
        return -sum(term.energy(x, 1.0) for term in self.pressures)

    def gradient(self, x: Array) -> Array:
        """Derivative (n, 3) of the volume by the positions x (n, 3), mm2."""
        minus = np.zeros_like(x)
        for term in self.pressures:
            term.gradient(x, 1.0, minus)
        return -minus

    def _value_at(self, factor: float, x: Array) -> float:
        return self.volume(x)

    def start(self, state: State) -> State:
        return state

    def increment(
        self, state: State, assembly: Assembly, linearised: Linearised, prescribed_increment: Array, terms: Terms
    ) -> tuple[Change, int]:
        area = self.gradient(self.system.space.points + state.displacement)
        unloaded = to_equilibrium(assembly, linearised)
        loaded = _load_rate(self.system, state, linearised, terms)
        compliance = float(np.vdot(area, loaded.displacement))
        if compliance == 0.0:
            raise SingularMatrix("the load does not change the prescribed volume")
        excess = self.residual(state) * self.scale
        excess += float(np.vdot(area, unloaded.displacement + prescribed_increment))
        factor = -excess / compliance
        # by Sylvester's law of inertia for the bordered matrix: a prescribed volume takes one negative direction away
        unstable = linearised.negative_pivots - (1 if compliance < 0 else 0)
        return unloaded + replace(loaded.scaled(factor), factor=factor), unstable

    def rate(self, state: State, assembly: Assembly, linearised: Linearised, terms: Terms) -> State | None:
        area = self.gradient(self.system.space.points + state.displacement)
        loaded = _load_rate(self.system, state, linearised, terms)
        compliance = float(np.vdot(area, loaded.displacement))
        if not compliance:
            return None
        return self.system.rate(state, assembly, replace(loaded.scaled(1 / compliance), factor=1 / compliance))


def to_equilibrium(assembly: Assembly, linearised: Linearised) -> Change:
    """Newton increment under the present load, with the increment of the prescribed displacements."""
    coupling = linearised.coupling
    return linearised.solve(assembly.gradient + coupling.displacement, assembly.pressure_residual + coupling.pressure)


def _load_rate(system: System, state: State, linearised: Linearised, terms: Terms) -> Change:
    """Change of displacement and pressures per unit of the load factor."""
    return linearised.solve(load_change(system, state, terms))


def load_change(system: System, state: State, terms: Terms) -> Array:
    """Change (n, 3) of the loads per unit of the load factor, in which they are linear."""
    more, less = (system.loads(state.displacement, state.factor + step, terms) for step in (0.5, -0.5))
    return more - less


@dataclass(frozen=True, eq=False)
class Drive:
    """What changes along a path, per unit of the driven quantity."""

    loads: Array  #: (n, 3) of the nodal loads, N
    factor: float  #: of the load factor
    motion: Array  #: (n, 3) of the prescribed displacements, mm
    coupling: Change  #: the tangent times that motion


def rate_with_motion(system: System, state: State, assembly: Assembly, linearised: Linearised, drive: Drive) -> State:
    """d(state) per unit of the driven quantity while supports move as well."""
    change = linearised.solve(drive.loads + drive.coupling.displacement, drive.coupling.pressure)
    displacement = change.displacement + drive.motion
    return system.rate(state, assembly, replace(change, factor=drive.factor, displacement=displacement))
