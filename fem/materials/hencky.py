"""Hencky's law: linear elasticity in the logarithmic strain."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.materials.material import Dilatation, Response, TwoModuli, Uniaxial
from fem.materials.tensors import PAIRS, CauchyGreen, Products, from_principal_axes, scaled
from geometry.arrays import Array

#: eigenvalues of C closer than this are treated as one in divided differences (error 1e-13 there)
CLOSE = 1e-3


@final
@dataclass(frozen=True)
class Hencky(TwoModuli):
    """W = lambda/2 (ln J)^2 + mu h:h with the logarithmic strain h = ln(C)/2; Kirchhoff stress linear in h.

    E in MPa, 0 < E; -1 < nu < 0.5. Raises `MaterialError` outside. In uniaxial tension P = E ln(stretch) / stretch,
    which has a maximum at stretch e. What commercial codes do with a linear elastic material in large displacements.
    """

    title = "Hencky"

    @classmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        if across is None:
            return {"E": np.log(stretch) / stretch}
        return {"E": 2 / 3 * np.log(stretch**2 * across) / stretch}

    def uniaxial(self, stretch: Array) -> Uniaxial:
        """t = s^-nu, P = E ln(s) / s."""
        return Uniaxial.of(stretch, stretch**-self.nu, self.E * self.uniaxial_terms(stretch)["E"])

    @property
    def stretch_limits(self) -> tuple[float, float]:
        return 0.0, float(np.e)

    def shear(self, strain: Array) -> Response:
        mu = self.lame[1]
        value, axes = CauchyGreen.of(strain).principal_values()
        log = np.log(value)
        # S = sum_a S_a N_a N_a^T; dS follows from the principal stresses and their divided differences (Ogden 1984)
        diagonal = (2 * mu * (1 - log) / value**2)[..., None] * np.eye(3)
        rotation = np.stack([mu * divided_difference(value[..., a], value[..., b]) for a, b in PAIRS], axis=-1)
        stress, tangent = from_principal_axes(axes, mu * log / value, diagonal, rotation)
        return Response(0.25 * mu * np.sum(log**2, axis=-1), stress, tangent)

    def volumetric(self, strain: Array) -> Response:
        c, modulus = CauchyGreen.of(strain), self.lame[0]
        theta = 0.5 * np.log(c.determinant)
        tangent = c.products(Products(inverse_inverse=modulus, derivative=-2 * modulus * theta))
        return Response(0.5 * modulus * theta**2, scaled(modulus * theta, c.inverse), tangent)

    def dilatation(self, strain: Array) -> Dilatation:
        c = CauchyGreen.of(strain)
        return Dilatation(0.5 * np.log(c.determinant), c.inverse, c.products(Products(derivative=-2.0)))


def divided_difference(first: Array, second: Array) -> Array:
    """(f(x) - f(y)) / (x - y) of f(x) = ln(x) / x; by its Taylor series where x and y are close."""
    difference = first - second
    close = np.abs(difference) < CLOSE * (first + second)
    divisor = np.where(close, 1.0, difference)
    middle = 0.5 * (first + second)
    log = np.log(middle)
    derivative, third_derivative = (1 - log) / middle**2, (11 - 6 * log) / middle**4
    quotient = (np.log(first) / first - np.log(second) / second) / divisor
    return np.where(close, derivative + third_derivative * difference**2 / 24, quotient)
