"""What every hyperelastic law gives: energy per reference volume, second Piola-Kirchhoff stress and its tangent.

Every law is a sum of a *shear* and a *volumetric* part, because near incompressibility the two are integrated by
different rules (`fem.elements`). Both parts take the Green-Lagrange strain in Voigt notation (11, 22, 33, 12,
23, 13 with engineering shear, the factor 2) and return stress in the same order (no factor).

A law is a frozen dataclass of a module of its own. Its fields are its constants, each annotated with its kind and its
meaning. Together with an entry in `fem.materials.LAWS` that is all a new law needs.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from enum import Enum
from typing import Annotated, ClassVar, Self, get_type_hints

import numpy as np

from geometry import PneurodError
from geometry.arrays import Array


class MaterialError(PneurodError, ValueError):
    """A material constant outside what the law allows; the sentence says what is allowed."""


class Constant(Enum):
    """The kinds of constants that laws have."""

    STRESS = "stress, MPa"
    POSITIVE_STRESS = "stress above zero, MPa"
    POSITIVE = "above zero, dimensionless"
    POISSON_RATIO = "Poisson's ratio, dimensionless"
    STRESSES = "a stress for each term, MPa"
    EXPONENTS = "an exponent for each term, dimensionless"

    @property
    def unit(self) -> str:
        """The unit that follows each number in a configuration; empty for a dimensionless constant."""
        dimensionless = (Constant.POSITIVE, Constant.POISSON_RATIO, Constant.EXPONENTS)
        return "" if self in dimensionless else " MPa"


Stress = Annotated[float, Constant.STRESS]
Stresses = Annotated[tuple[float, ...], Constant.STRESSES]
Exponents = Annotated[tuple[float, ...], Constant.EXPONENTS]
PositiveStress = Annotated[float, Constant.POSITIVE_STRESS]
Positive = Annotated[float, Constant.POSITIVE]
PoissonRatio = Annotated[float, Constant.POISSON_RATIO, "Poisson's ratio"]
BulkModulus = Annotated[PositiveStress, "bulk modulus"]


@dataclass(frozen=True)
class Response:
    """Energy and its first two derivatives by the strain at any number of points."""

    energy: Array  #: (...,), MPa = N mm / mm3
    stress: Array  #: (..., 6), second Piola-Kirchhoff, MPa
    tangent: Array  #: (..., 6, 6) dS/dE, MPa; (1, ..., 1, 6, 6) where it is the same everywhere


@dataclass(frozen=True)
class Dilatation:
    """The measure theta of the volume change in which a volumetric energy is m/2 theta^2."""

    value: Array  #: (...,)
    gradient: Array  #: (..., 6) d theta / d E; (1, ..., 1, 6) where it is the same everywhere
    hessian: Array  #: (..., 6, 6) its second derivative; (1, ..., 1, 6, 6) where it is the same everywhere


@dataclass(frozen=True)
class Uniaxial:
    """A bar pulled or compressed along its axis with its sides free, at n stretches; NaN where no such bar exists.

    With the stretch s along the axis and t across it, the sides being free of stress, dW/dt = 0 and P = dW/ds.
    """

    stretch: Array  #: (n,) along the axis
    lateral: Array  #: (n,) stretch across it
    nominal: Array  #: (n,) MPa, force over area at rest

    @classmethod
    def of(cls, stretch: Array, lateral: Array, nominal: Array) -> Self:
        """The bar whose nominal stress (n,) counts only where its lateral stretch (n,) is finite."""
        return cls(stretch, lateral, np.where(np.isfinite(lateral), nominal, np.nan))


@dataclass(frozen=True)
class Material(ABC):
    """A hyperelastic law as the sum of a shear and a volumetric part, the latter m/2 theta^2."""

    title: ClassVar[str]  #: the law's name in a sentence

    @classmethod
    def constants(cls) -> dict[str, Constant]:
        """The kind of each constant, by name in the order of the arguments."""
        kinds = get_type_hints(cls, include_extras=True)
        return {field.name: kinds[field.name].__metadata__[0] for field in fields(cls)}

    @classmethod
    def meanings(cls) -> dict[str, str]:
        """What each constant is: the text beside its kind, or else the kind."""
        hints = get_type_hints(cls, include_extras=True)
        return {name: [kind.value, *hints[name].__metadata__[1:]][-1] for name, kind in cls.constants().items()}

    @classmethod
    @abstractmethod
    def from_uniaxial(cls, constants: Mapping[str, float | tuple[float, ...]], nu: float) -> Self:
        """The law with the constants that a tensile test determines, and the Poisson ratio nu at small strain.

        Raises `MaterialError`.
        """

    @abstractmethod
    def uniaxial(self, stretch: Array) -> Uniaxial:
        """The bar at stretches (n,), above 0, in closed form, with the law's own Poisson ratio or kappa."""

    @abstractmethod
    def incompressible(self, stretch: Array, across: Array | None = None) -> Array:
        """Nominal stress (n,) along the first axis of the incompressible body at stretches (n,), MPa.

        The second principal stretch is `across` (n,), the third side being free; None for a bar with free sides.
        """

    @abstractmethod
    def shear(self, strain: Array) -> Response:
        """Response of the shear part to strain (..., 6)."""

    @abstractmethod
    def volumetric(self, strain: Array) -> Response:
        """Response of the volumetric part to strain (..., 6)."""

    @abstractmethod
    def dilatation(self, strain: Array) -> Dilatation:
        """theta at strain (..., 6)."""

    @property
    @abstractmethod
    def volumetric_modulus(self) -> float:
        """m, MPa."""

    @property
    @abstractmethod
    def shear_modulus(self) -> float:
        """Initial shear modulus, MPa."""

    @property
    @abstractmethod
    def poisson_ratio(self) -> float:
        """Poisson's ratio at small strain."""

    @property
    def young_modulus(self) -> float:
        """Young's modulus at small strain, MPa."""
        return 2.0 * self.shear_modulus * (1.0 + self.poisson_ratio)

    @property
    @abstractmethod
    def stretch_limits(self) -> tuple[float, float]:
        """Uniaxial stretches between which the law can be trusted to be stable."""


class LinearLaw(Material):
    """A law whose stress in a tensile test is linear in its constants."""

    @classmethod
    @abstractmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        """The nominal stress at stretches (n,) is the sum of these terms (n,), each times its constant.

        Rubber-like laws are incompressible here, because a tensile test does not determine kappa. `across` (n,) is the
        second principal stretch, the third side being free, in an incompressible body; None for free sides.
        """


def check_moduli(E: float, nu: float) -> None:
    """Refuse moduli for which the linearised law is not positive definite and finite."""
    if not 0 < E < np.inf:
        raise MaterialError(f"E = {E:g} MPa: Young's modulus must be positive and finite")
    if not -1.0 < nu < 0.5:
        raise MaterialError(f"nu = {nu:g}: Poisson's ratio must lie between -1 and 0.5 (0.5 itself excluded)")


@dataclass(frozen=True)
class TwoModuli(LinearLaw):
    """A law that is given by Young's modulus E in MPa and Poisson's ratio nu. Raises `MaterialError`."""

    E: Annotated[PositiveStress, "Young's modulus"]
    nu: PoissonRatio

    def __post_init__(self) -> None:
        check_moduli(self.E, self.nu)

    @classmethod
    def from_uniaxial(cls, constants: Mapping[str, float | tuple[float, ...]], nu: float) -> Self:
        law: Callable[..., Self] = cls
        return law(**constants, nu=nu)

    def incompressible(self, stretch: Array, across: Array | None = None) -> Array:
        return np.asarray(self.E * self.uniaxial_terms(stretch, across)["E"])

    @property
    def lame(self) -> tuple[float, float]:
        """(lambda, mu), MPa."""
        E, nu = self.E, self.nu
        return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))

    @property
    def shear_modulus(self) -> float:
        return self.lame[1]

    @property
    def volumetric_modulus(self) -> float:
        return self.lame[0]

    @property
    def poisson_ratio(self) -> float:
        return self.nu
