"""Values of the equations: a state of the body, a change of its unknowns, and the potential's gradient there."""

from dataclasses import dataclass

from fem.equations.formulation import LawValues
from geometry.arrays import Array


@dataclass(frozen=True)
class State:
    """A point on the load path: displacement, and strain and stress, which Newton carries as unknowns of their own.

    In equilibrium both are those of the displacement. During the iteration the law is evaluated at the carried strain,
    and the geometric stiffness takes the carried stress, which the law to first order gave (`fem.path.newton`).
    """

    factor: float  #: load factor
    displacement: Array  #: (n, 3), mm
    pressure: Array  #: (v,) unknowns of the mixed formulation, pressure over shear modulus; (0,) in the others
    strain: Array  #: (e, q, 6), Green-Lagrange
    stress: Array  #: (e, q, 6), second Piola-Kirchhoff, MPa

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing is displaced."""
        return not self.displacement.any()

    @property
    def change(self) -> "Change":
        """The rate of the unknowns alone, of a rate of states."""
        return Change(self.factor, self.displacement, self.pressure)


@dataclass(frozen=True)
class Change:
    """A change of the unknowns."""

    factor: float
    displacement: Array  #: (n, 3), mm
    pressure: Array  #: (v,)

    def scaled(self, fraction: float) -> "Change":
        """The given fraction of it."""
        return Change(fraction * self.factor, fraction * self.displacement, fraction * self.pressure)

    def __add__(self, other: "Change") -> "Change":
        return Change(
            self.factor + other.factor, self.displacement + other.displacement, self.pressure + other.pressure
        )


@dataclass(frozen=True)
class Assembly:
    """What one evaluation of the potential's gradient gives."""

    strain: Array  #: (e, q, 6) Green-Lagrange strain of the displacement
    law_values: LawValues  #: the law at the carried strain and pressure
    stress: Array  #: (e, q, 6) the law at the displacement's strain to first order from the carried one, MPa
    jacobian: Array  #: (e, q) det F
    gradient: Array  #: (n, 3) d Pi / d x, N; zero on the free components in equilibrium
    pressure_residual: Array  #: (v,) d Pi / d p; zero where the pressures are those of the displacement
    scale: float  #: norm of the nodal forces that balance, N
    #: bound of the norm of the nodal forces that the rounding of the displacement and of the strain makes, N
    roundoff: float
