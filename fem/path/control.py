"""What a step prescribes: the load factor, or the volume of a cavity with the load factor as an unknown.

A limit point of the load, where no neighbouring equilibrium has more of it, is an ordinary point of a path on which the
volume is prescribed: the equation V(x) = V* joins the others with the load factor as its unknown, one bordered row and
column (E. Riks, "An incremental approach to the solution of snapping and buckling problems", Int. J. Solids Struct. 15
(1979), with the volume in place of the arc length).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from fem.discretisation import Faces
from fem.effects.effect import Terms
from fem.effects.loads import enclosed_volume, volume_gradient
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import Linearised
from fem.equations.state import Assembly, Change, State
from fem.equations.system import System
from geometry.arrays import Array


@dataclass(frozen=True)
class Control(ABC):
    """What is prescribed in a step."""

    prescribed: Array = field(repr=False)  #: (n, 3) displacements where the model prescribes them, mm

    @abstractmethod
    def begin(self, state: State) -> State:
        """The state Newton's method starts from."""

    @abstractmethod
    def miss(self, system: System, state: State) -> float:
        """How far the state is from what is prescribed, relative."""

    @abstractmethod
    def change(
        self, system: System, state: State, assembly: Assembly, linearised: Linearised, jump: Array, terms: Terms
    ) -> tuple[Change, int]:
        """Newton's change of the unknowns but the prescribed displacements, with the tangent at the state.

        jump (n, 3) is what those still miss.

        And the number of directions in which the body is unstable while the prescribed quantity is held.
        """

    @abstractmethod
    def rate(self, system: System, state: State, linearised: Linearised, terms: Terms) -> Change | None:
        """Change of the unknowns per unit of the prescribed quantity in equilibrium, with a tangent near the state.

        None where that cannot tell.
        """


@final
@dataclass(frozen=True)
class LoadControl(Control):
    """The load factor is prescribed."""

    factor: float

    def begin(self, state: State) -> State:
        return replace(state, factor=self.factor)

    def miss(self, system: System, state: State) -> float:
        return 0.0

    def change(
        self, system: System, state: State, assembly: Assembly, linearised: Linearised, jump: Array, terms: Terms
    ) -> tuple[Change, int]:
        return _to_equilibrium(assembly, linearised), linearised.negative_pivots

    def rate(self, system: System, state: State, linearised: Linearised, terms: Terms) -> Change | None:
        if system.constraints.ramped.any():  # would need the tangent's columns of the prescribed components
            return None
        return replace(_loaded(system, state, linearised, terms), factor=1.0)


@final
@dataclass(frozen=True)
class VolumeControl(Control):
    """The volume behind `faces` is prescribed, mm3; the load factor is the unknown that brings it about."""

    faces: Faces = field(repr=False)
    volume: float
    scale: float  #: mm3, what a miss is held against

    def begin(self, state: State) -> State:
        return state

    def miss(self, system: System, state: State) -> float:
        return (enclosed_volume(self.faces, system.space.points + state.displacement) - self.volume) / self.scale

    def change(
        self, system: System, state: State, assembly: Assembly, linearised: Linearised, jump: Array, terms: Terms
    ) -> tuple[Change, int]:
        growth = volume_gradient(self.faces, system.space.points + state.displacement)
        free = _to_equilibrium(assembly, linearised)
        loaded = _loaded(system, state, linearised, terms)
        compliance = float(np.vdot(growth, loaded.displacement))
        if compliance == 0.0:
            raise SingularMatrix("the load does not change the prescribed volume")
        missing = self.miss(system, state) * self.scale + float(np.vdot(growth, free.displacement + jump))
        factor = -missing / compliance
        # by Sylvester's law for the bordered matrix: a volume held takes one negative direction away
        unstable = linearised.negative_pivots - (1 if compliance < 0 else 0)
        return free + replace(loaded.scaled(factor), factor=factor), unstable

    def rate(self, system: System, state: State, linearised: Linearised, terms: Terms) -> Change | None:
        growth = volume_gradient(self.faces, system.space.points + state.displacement)
        loaded = _loaded(system, state, linearised, terms)
        compliance = float(np.vdot(growth, loaded.displacement))
        return replace(loaded.scaled(1 / compliance), factor=1 / compliance) if compliance else None


def _to_equilibrium(assembly: Assembly, linearised: Linearised) -> Change:
    """Newton's change of the unknowns under the present load, the prescribed components taking their increment."""
    coupling = linearised.coupling
    return linearised.solve(assembly.gradient + coupling.displacement, assembly.pressure_residual + coupling.pressure)


def _loaded(system: System, state: State, linearised: Linearised, terms: Terms) -> Change:
    """Change of displacement and pressures per unit of the load factor."""
    # the loads are linear in the load factor
    more, less = (system.loads(state.displacement, state.factor + step, terms) for step in (0.5, -0.5))
    return linearised.solve(more - less)


def size_of(faces: Faces, x: Array) -> float:
    """A volume (mm3) of the size that the faces could enclose at positions x (n, 3): their area to the power 3/2."""
    return float(np.linalg.norm(volume_gradient(faces, x), axis=1).sum() ** 1.5)
