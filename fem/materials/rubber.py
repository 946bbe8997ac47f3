"""Rubber-like laws in the isochoric invariants.

I1bar = J^(-2/3) tr C, I2bar = J^(-4/3) ((tr C)^2 - tr C^2) / 2; source of the derivatives: G. A. Holzapfel, "Nonlinear
solid mechanics", Wiley 2000, sections 6.4 and 6.6. Nominal stress of the incompressible bar: R. S. Rivlin, D. W.
Saunders, Phil. Trans. R. Soc. A 243 (1951) 251.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from fem.materials.material import LinearLaw, PositiveStress, Response, Stress
from fem.materials.rubber_law import RubberLaw, check_positive
from fem.materials.tensors import IDENTITY, SYMMETRIC, CauchyGreen, outer, scaled, voigt
from geometry.arrays import Array


class IsochoricLaw(RubberLaw, LinearLaw):
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
    def incompressible(self, stretch: Array) -> Array:
        derivative = self.first_invariant_energy(stretch**2 + 2 / stretch)[1]
        return np.asarray(2 * (stretch - stretch**-2) * (derivative + self.second_invariant_modulus / stretch))

    @final
    def isochoric(self, c: CauchyGreen) -> Response:
        size = c.determinant ** (-1 / 3)
        invariant = size * c.first
        energy, derivative, second_derivative = self.first_invariant_energy(invariant)
        gradient = scaled(size, IDENTITY - scaled(c.first / 3, c.inverse))
        cross = outer(np.broadcast_to(IDENTITY, c.inverse.shape), c.inverse)
        square = outer(c.inverse, c.inverse)
        hessian = scaled(c.first / 9, square) + scaled(c.first / 3, c.inverse_derivative)
        hessian = hessian - (cross + _transposed(cross)) / 3
        stress = 2 * scaled(derivative, gradient)
        tangent = 4 * (scaled(derivative * size, hessian) + scaled(second_derivative, outer(gradient, gradient)))
        if c01 := self.second_invariant_modulus:
            second = _second_invariant(c, size**2)
            energy = energy + c01 * (second.energy - 3)
            stress = stress + 2 * c01 * second.stress
            tangent = tangent + 4 * c01 * second.tangent
        return Response(energy, stress, tangent)


def _second_invariant(c: CauchyGreen, size: Array) -> Response:
    """I2bar = size I2 with its first two derivatives by C."""
    unscaled = scaled(c.first, np.broadcast_to(IDENTITY, c.inverse.shape)) - voigt(c.tensor)
    gradient = unscaled - scaled(2 * c.second / 3, c.inverse)
    hessian = np.outer(IDENTITY, IDENTITY) - SYMMETRIC + scaled(2 * c.second / 3, c.inverse_derivative)
    hessian = hessian - 2 / 3 * (outer(gradient, c.inverse) + outer(c.inverse, unscaled))
    return Response(size * c.second, scaled(size, gradient), scaled(size, hessian))


def _transposed(tensor: Array) -> Array:
    return np.swapaxes(tensor, -1, -2)


def _linear_term(stretch: Array) -> Array:
    """Nominal stress (n,) of the incompressible bar over the modulus c10 of W = c10 (I1bar - 3)."""
    return 2 * (stretch - stretch**-2)


@final
@dataclass(frozen=True)
class NeoHooke(IsochoricLaw):
    """W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2; mu, kappa in MPa, positive. Raises `MaterialError`."""

    title = "neo-Hooke"

    mu: PositiveStress
    kappa: PositiveStress

    def __post_init__(self) -> None:
        check_positive(NeoHooke, {"mu": self.mu, "kappa": self.kappa})

    @classmethod
    def uniaxial_terms(cls, stretch: Array) -> dict[str, Array]:
        return {"mu": _linear_term(stretch) / 2}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.mu / 2)

    @property
    def second_invariant_modulus(self) -> float:
        return 0.0


@final
@dataclass(frozen=True)
class MooneyRivlin(IsochoricLaw):
    """W = c10 (I1bar - 3) + c01 (I2bar - 3) + kappa/2 (J - 1)^2; MPa, c10 + c01 and kappa positive.

    Raises `MaterialError`.
    """

    title = "Mooney-Rivlin"

    c10: Stress
    c01: Stress
    kappa: PositiveStress

    def __post_init__(self) -> None:
        check_positive(MooneyRivlin, {"c10 + c01": self.c10 + self.c01, "kappa": self.kappa})

    @classmethod
    def uniaxial_terms(cls, stretch: Array) -> dict[str, Array]:
        return {"c10": _linear_term(stretch), "c01": _linear_term(stretch) / stretch}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10)

    @property
    def second_invariant_modulus(self) -> float:
        return self.c01


@final
@dataclass(frozen=True)
class Yeoh(IsochoricLaw):
    """W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + kappa/2 (J - 1)^2; MPa, c10 and kappa positive.

    Raises `MaterialError`. Elastosil M4601: c10 = 0.11, c20 = 0.02 MPa.
    """

    title = "Yeoh"

    c10: Stress
    c20: Stress
    c30: Stress
    kappa: PositiveStress

    def __post_init__(self) -> None:
        check_positive(Yeoh, {"c10": self.c10, "kappa": self.kappa})

    @classmethod
    def uniaxial_terms(cls, stretch: Array) -> dict[str, Array]:
        linear, invariant = _linear_term(stretch), stretch**2 + 2 / stretch - 3
        return {"c10": linear, "c20": 2 * linear * invariant, "c30": 3 * linear * invariant**2}

    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10, self.c20, self.c30)

    @property
    def second_invariant_modulus(self) -> float:
        return 0.0


def _polynomial(invariant: Array, *coefficients: float) -> tuple[Array, Array, Array]:
    """sum_k coefficients_k (I - 3)^k from k = 1 on, with its first two derivatives."""
    energy = np.polynomial.Polynomial([0.0, *coefficients])
    x = invariant - 3
    return energy(x), energy.deriv()(x), energy.deriv(2)(x)
