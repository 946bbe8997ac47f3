"""What is prescribed along a path: load factors, or volumes of a cavity."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import final

from fem.discretisation import Faces
from fem.effects.effect import Terms, at_constant_fraction
from fem.effects.loads import enclosed_volume
from fem.equations.state import State
from fem.equations.system import System
from fem.path.control import Control, LoadControl, VolumeControl, size_of
from fem.solution import Step


class Course(ABC):
    """A quantity that is driven from its value at rest to the asked ones."""

    name: str  #: of the quantity, for sentences

    @property
    @abstractmethod
    def rest(self) -> float:
        """Its value in the body at rest."""

    @abstractmethod
    def at(self, step: Step) -> float:
        """Its value at a finished step."""

    @abstractmethod
    def control(self, system: System, value: float, share: float) -> Control:
        """What prescribes `value`, the constant prescribed displacements having come to `share` of their size."""

    @abstractmethod
    def rate_at_rest(self, system: System, rest: State, terms: Terms, share: float) -> State | None:
        """Change of the state per unit of the value, what does not grow with it coming to `share` of its size per unit.

        Factorizes the tangent. None where it is not needed. Raises `SingularMatrix`.
        """


@final
@dataclass(frozen=True)
class LoadCourse(Course):
    """The load factor, 0 at rest."""

    name = "load factor"

    @property
    def rest(self) -> float:
        return 0.0

    def at(self, step: Step) -> float:
        return step.factor

    def control(self, system: System, value: float, share: float) -> Control:
        return LoadControl(system.constraints.prescribed(value, share), value)

    def rate_at_rest(self, system: System, rest: State, terms: Terms, share: float) -> State | None:
        still, moved = at_constant_fraction(terms, 0.0), system.constraints.prescribed(1.0, share)
        assembly = system.assemble(rest, still)
        linearised = system.linearise(rest, assembly, still, moved)
        whole = system.loads(rest.displacement, 1.0, at_constant_fraction(terms, share))
        loads = whole - system.loads(rest.displacement, 0.0, still)
        coupling = linearised.coupling
        change = linearised.solve(loads + coupling.displacement, coupling.pressure)
        return system.rate(rest, assembly, replace(change, factor=1.0, displacement=change.displacement + moved))


@final
@dataclass(frozen=True)
class VolumeCourse(Course):
    """The volume enclosed by named faces, mm3; the load factor follows."""

    faces: Faces = field(repr=False)
    rest_volume: float
    size: float  #: mm3, what a miss is held against

    name = "volume in mm3"

    @classmethod
    def of(cls, system: System, where: str) -> "VolumeCourse":
        """Behind the named faces.

        Raises ValueError for faces that do not exist and for prescribed displacements that grow with the load factor.
        """
        if system.constraints.ramped.any():
            raise ValueError("with a prescribed volume no displacement can grow with the load factor; set ramp=False")
        faces, x = system.space.surface(where), system.space.points
        return cls(faces, enclosed_volume(faces, x), size_of(faces, x))

    @property
    def rest(self) -> float:
        return self.rest_volume

    def at(self, step: Step) -> float:
        return enclosed_volume(self.faces, step.positions)

    def control(self, system: System, value: float, share: float) -> Control:
        return VolumeControl(system.constraints.prescribed(0.0, share), self.faces, value, self.size)

    def rate_at_rest(self, system: System, rest: State, terms: Terms, share: float) -> State | None:
        return None
