"""A model: body, law, supports and effects, before anything is solved."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import final

from fem.discretisation import Discretisation
from fem.effects.effect import Effect
from fem.elements import element_of
from fem.equations.constraints import Constraints
from fem.equations.linear import LinearSolver
from fem.equations.pardiso import available_solver
from fem.equations.system import System
from fem.materials.regions import Solid, laws_of
from fem.supports import Support
from geometry import Mesh


@final
@dataclass(frozen=True)
class Model:
    """Body, law or laws by region, supports and effects.

    formulation: a name of `fem.elements.ELEMENTS`; by default "p2p0", quadratic tetrahedra with the volumetric part of
    the law at one point. Raises ValueError for another one.
    """

    mesh: Mesh = field(repr=False)
    material: Solid
    supports: Sequence[Support]
    effects: Sequence[Effect]
    formulation: str = "p2p0"

    def __post_init__(self) -> None:
        element_of(self.formulation)

    @cached_property
    def space(self) -> Discretisation:
        """The mesh as elements, made once."""
        return Discretisation.of(self.mesh, self.formulation)

    def system(self, solver: Callable[[], LinearSolver] | None = None) -> System:
        """The assembled equations, with the given linear solver or the best one installed."""
        terms = tuple(effect.bind(self.space, laws_of(self.material)[""]) for effect in self.effects)
        constraints = Constraints.of(self.supports, self.space)
        return System(self.space, self.material, terms, constraints, (solver or available_solver())())
