"""Ogden's law: a sum of powers of the isochoric principal stretches.

R. W. Ogden, Proc. R. Soc. A 326 (1972) 565; in isochoric stretches J. C. Simo, R. L. Taylor, Comput. Methods Appl.
Mech. Eng. 85 (1991) 273. With the eigenvalues c_a and eigenvectors N_a of C the stress is sum_a S_a N_a N_a^T, and its
derivative has the divided differences (S_a - S_b) / (c_a - c_b), whose limit for equal stretches is the derivative.
"""

from dataclasses import dataclass
from typing import Annotated, final

import numpy as np

from fem.materials.material import BulkModulus, Exponents, MaterialError, Response, Stresses
from fem.materials.rubber_law import RubberLaw, check_positive
from fem.materials.tensors import MIN_DETERMINANT, PAIRS, CauchyGreen, from_principal_axes
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class Ogden(RubberLaw):
    """W = sum_i mu_i / alpha_i (a^alpha_i + b^alpha_i + c^alpha_i - 3) + kappa/2 (J - 1)^2, a, b, c the isochoric
    principal stretches.

    mu in MPa and alpha without unit have one entry per term, alpha none that is 0. The sum of mu_i alpha_i, which is
    twice the shear modulus, and kappa (MPa) are positive. Raises `MaterialError`. With mu_i alpha_i > 0 in every term
    the law is stable at every strain. alpha = (2,) is the neo-Hookean law, alpha = (2, -2) with mu = (2 c10, -2 c01)
    that of Mooney and Rivlin. Programs that write 2 mu_i / alpha_i^2 (Abaqus) have other moduli: theirs times
    2 / alpha_i.
    """

    title = "Ogden"

    mu: Annotated[Stresses, "modulus μ_i of each term; the shear modulus is half the sum of μ_i α_i"]
    alpha: Annotated[Exponents, "exponent α_i of each term"]
    kappa: BulkModulus

    def __post_init__(self) -> None:
        if not self.mu or len(self.mu) != len(self.alpha):
            raise MaterialError(
                f"Ogden: mu has {len(self.mu)} and alpha {len(self.alpha)} entries; both need one for each term"
            )
        if not all(np.isfinite(self.alpha)) or 0 in self.alpha:
            raise MaterialError(f"Ogden: alpha = {list(self.alpha)} must be finite numbers other than 0")
        check_positive(Ogden, {"half the sum of mu times alpha": self.shear_modulus, "kappa": self.kappa})

    @property
    def terms(self) -> list[tuple[float, float]]:
        """mu (MPa) and alpha of each term."""
        return list(zip(self.mu, self.alpha, strict=True))

    @property
    def shear_modulus(self) -> float:
        return sum(mu * alpha for mu, alpha in self.terms) / 2

    def incompressible(self, stretch: Array, across: Array | None = None) -> Array:
        third = stretch**-0.5 if across is None else 1 / (stretch * across)
        return np.asarray(sum(mu * (stretch**a - third**a) for mu, a in self.terms) / stretch)

    def isochoric(self, c: CauchyGreen) -> Response:
        value, axes = c.principal_values()
        size = np.maximum(value.prod(axis=-1), MIN_DETERMINANT) ** (-1 / 3)
        energy = np.zeros(value.shape[:-1])
        kirchhoff, rotation = np.zeros(value.shape), np.zeros(value.shape)  # (..., a), (..., pair)
        slope = np.zeros((*value.shape, 3))  # d kirchhoff_a / d ln c_b
        for mu, alpha in self.terms:
            power = (size[..., None] * value) ** (alpha / 2)
            mean = power.mean(axis=-1)
            energy += mu / alpha * 3 * (mean - 1)
            kirchhoff += mu * (power - mean[..., None])
            slope += _slope(mu * alpha / 6, power, mean)
            scale = mu * size ** (alpha / 2)
            for number, (a, b) in enumerate(PAIRS):
                first, second = value[..., a], value[..., b]
                quotient = scale * difference_of_powers(first, second, alpha / 2 - 1) + mu * mean / (first * second)
                rotation[..., number] += quotient
        principal = kirchhoff / value
        diagonal = 2 * slope / (value[..., :, None] * value[..., None, :])
        index = np.arange(3)
        diagonal[..., index, index] -= 2 * principal / value
        return Response(energy, *from_principal_axes(axes, principal, diagonal, rotation))


def _slope(factor: float, power: Array, mean: Array) -> Array:
    """factor (3 power_a delta_ab - power_a - power_b + mean), (..., 3, 3), from the powers (..., 3) and their mean."""
    slope = mean[..., None, None] - power[..., :, None] - power[..., None, :]
    index = np.arange(3)
    slope[..., index, index] += 3 * power
    return np.asarray(factor * slope)


def difference_of_powers(first: Array, second: Array, exponent: float) -> Array:
    """(x^p - y^p) / (x - y) of positive x and y, p x^(p-1) where they are equal; accurate where they are close."""
    difference = first - second
    equal, close = difference == 0, np.abs(difference) < 0.5 * second
    log = np.where(close, np.log1p(np.where(close, difference / second, 0.0)), np.log(first / second))
    ratio = np.expm1(exponent * log) / np.where(equal, 1.0, difference)
    return np.asarray(second**exponent * np.where(equal, exponent / second, ratio))
