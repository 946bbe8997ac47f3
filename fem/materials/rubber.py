"""Rubber-like laws in the isochoric invariants.

I1bar = J^(-2/3) tr C, I2bar = J^(-4/3) ((tr C)^2 - tr C^2) / 2; source of the derivatives: G. A. Holzapfel, "Nonlinear
solid mechanics", Wiley 2000, sections 6.4 and 6.6. Nominal stress of the incompressible bar: R. S. Rivlin, D. W.
Saunders, Phil. Trans. R. Soc. A 243 (1951) 251.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, final

import numpy as np

from fem.finite import check_finite
from fem.materials.material import BulkModulus, LinearLaw, MaterialError, PositiveStress, Response, Stress
from fem.materials.rubber_law import RubberLaw, check_positive
from fem.materials.tensors import IDENTITY, CauchyGreen, Products, scaled
from geometry.arrays import Array


class IsochoricLaw(RubberLaw):
    """W = w(I1bar) + c01 (I2bar - 3) + kappa/2 (J - 1)^2."""

    @abstractmethod
    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        """w(I1bar) and its first two derivatives, MPa."""

    @property
    @abstractmethod
    def second_invariant_modulus(self) -> float:
        """c01, MPa; 0 for laws of the first invariant alone."""

    @final
    @property
    def shear_modulus(self) -> float:
        return float(2 * (self.first_invariant_energy(np.array(3.0))[1] + self.second_invariant_modulus))

    @final
    def incompressible(self, stretch: Array, across: Array | None = None) -> Array:
        derivative = self.first_invariant_energy(first_invariant(stretch, across) + 3)[1]
        second = self.second_invariant_modulus * _square_across(stretch, across)
        return np.asarray(_linear_term(stretch, across) * (derivative + second))

    @final
    def isochoric(self, c: CauchyGreen) -> Response:
        size = c.determinant ** (-1 / 3)
        energy, first, second = self.first_invariant_energy(size * c.first)
        # the gradient of I1bar by C is size (I - I1/3 C^-1)
        stress = 2 * scaled(first * size, IDENTITY - scaled(c.first / 3, c.inverse))
        first, second = 4 * first * size, 4 * second * size**2
        one_one, one_inverse = second, -first / 3 - second * c.first / 3
        inverse_inverse, derivative = first * c.first / 9 + second * c.first**2 / 9, first * c.first / 3
        if not (c01 := self.second_invariant_modulus):
            return Response(energy, stress, c.products(Products(one_one, one_inverse, inverse_inverse, derivative)))
        # that of I2bar is size^2 (I1 I - C - 2/3 I2 C^-1); the difference is exactly 0 at rest, where no load hides it
        size = c01 * size**2
        energy = energy + size * c.second - 3 * c01
        gradient = c.first[..., None] * IDENTITY - c.components - scaled(2 / 3 * c.second, c.inverse)
        stress = stress + 2 * scaled(size, gradient)
        size = 4 * size
        factors = Products(
            one_one + size,
            one_inverse - 2 / 3 * size * c.first,
            inverse_inverse + 4 / 9 * size * c.second,
            derivative + 2 / 3 * size * c.second,
            2 / 3 * size,
            -size,
        )
        return Response(energy, stress, c.products(factors))


def _linear_term(stretch: Array, across: Array | None) -> Array:
    """Nominal stress (n,) of the incompressible body over the modulus c10 of W = c10 (I1bar - 3)."""
    if across is None:
        return 2 * (stretch - stretch**-2)
    return np.asarray(2 * (stretch - (stretch * across) ** -2.0 / stretch))


def first_invariant(stretch: Array, across: Array | None) -> Array:
    """I1 - 3 (n,) of the incompressible body."""
    if across is None:
        return stretch**2 + 2 / stretch - 3
    return np.asarray(stretch**2 + across**2 + (stretch * across) ** -2.0 - 3)


def _square_across(stretch: Array, across: Array | None) -> Array:
    """Square (n,) of the second principal stretch."""
    return 1 / stretch if across is None else across**2


@final
@dataclass(frozen=True)
class NeoHooke(IsochoricLaw, LinearLaw):
    """W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2; mu, kappa in MPa, positive. Raises `MaterialError`."""

    title = "neo-Hooke"

    mu: Annotated[PositiveStress, "shear modulus"]
    kappa: BulkModulus

    def __post_init__(self) -> None:
        check_positive(NeoHooke, {"mu": self.mu, "kappa": self.kappa})

    @classmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        return {"mu": _linear_term(stretch, across) / 2}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.mu / 2)

    @property
    def second_invariant_modulus(self) -> float:
        return 0.0


@final
@dataclass(frozen=True)
class MooneyRivlin(IsochoricLaw, LinearLaw):
    """W = c10 (I1bar - 3) + c01 (I2bar - 3) + kappa/2 (J - 1)^2; MPa, c10 + c01 and kappa positive.

    Raises `MaterialError`.
    """

    title = "Mooney-Rivlin"

    c10: Annotated[Stress, "first constant, of the first invariant"]
    c01: Annotated[Stress, "second constant, of the second invariant"]
    kappa: BulkModulus

    def __post_init__(self) -> None:
        check_positive(MooneyRivlin, {"c10 + c01": self.c10 + self.c01, "kappa": self.kappa})

    @classmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        linear = _linear_term(stretch, across)
        return {"c10": linear, "c01": linear * _square_across(stretch, across)}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10)

    @property
    def second_invariant_modulus(self) -> float:
        return self.c01


@final
@dataclass(frozen=True)
class Yeoh(IsochoricLaw, LinearLaw):
    """W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + kappa/2 (J - 1)^2; MPa, c10 and kappa positive.

    Raises `MaterialError`. Elastosil M4601: c10 = 0.11, c20 = 0.02 MPa.
    """

    title = "Yeoh"

    c10: Annotated[Stress, "first constant, of the first invariant"]
    c20: Annotated[Stress, "constant of the square of the first invariant"]
    c30: Annotated[Stress, "constant of its cube"]
    kappa: BulkModulus

    def __post_init__(self) -> None:
        check_positive(Yeoh, {"c10": self.c10, "kappa": self.kappa})
        check_finite("Yeoh: c20 (MPa)", self.c20, MaterialError)
        check_finite("Yeoh: c30 (MPa)", self.c30, MaterialError)

    @classmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        linear, invariant = _linear_term(stretch, across), first_invariant(stretch, across)
        return {"c10": linear, "c20": 2 * linear * invariant, "c30": 3 * linear * invariant**2}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10, self.c20, self.c30)

    @property
    def second_invariant_modulus(self) -> float:
        return 0.0


def _polynomial(invariant: Array, *coefficients: float) -> tuple[Array, Array, Array]:
    """sum_k coefficients_k (I - 3)^k from k = 1 on, with its first two derivatives."""
    x = invariant - 3
    energy, first, half = np.zeros((3, *np.shape(x)))
    for coefficient in (*reversed(coefficients), 0.0):  # Horner's rule and its derivatives
        half = half * x + first
        first = first * x + energy
        energy = energy * x + coefficient
    return energy, first, 2 * half
