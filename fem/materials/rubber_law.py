"""Rubber-like laws: an energy of the isochoric deformation plus kappa/2 (J - 1)^2.

The bar under uniaxial stress: with the isochoric stretch r = s J^(-1/3) the energy is psi(r) + kappa/2 (J - 1)^2. Free
sides, dW/dt = 0, give J (J - 1) = r psi'(r) / (3 kappa), with it P = r psi'(r) / s, and r psi'(r) is the stretch times
the nominal stress of the incompressible bar at r. So s is known for each r.
"""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from typing import Self, final

import numpy as np

from fem.materials.material import BulkModulus, Dilatation, Material, MaterialError, Response, Uniaxial
from fem.materials.tensors import CauchyGreen, Products, scaled
from geometry.arrays import Array


class RubberLaw(Material):
    """W = psi(isochoric part of C) + kappa/2 (J - 1)^2.

    The shear part takes mu/3 (J - 1)^2 of the last term, as mu E:E does in the St. Venant-Kirchhoff law: without any
    stiffness against volume changes an element whose volumetric part has one point may swell at one corner and shrink
    at another, and tangents on the way are indefinite.
    """

    kappa: BulkModulus  #: MPa

    @abstractmethod
    def isochoric(self, c: CauchyGreen) -> Response:
        """psi and its first two derivatives by the strain; the tangent is contiguous and belongs to the caller."""

    @final
    @classmethod
    def from_uniaxial(cls, constants: Mapping[str, float | tuple[float, ...]], nu: float) -> Self:
        law: Callable[..., Self] = cls
        mu = law(**constants, kappa=1.0).shear_modulus
        return law(**constants, kappa=2 * mu * (1 + nu) / (3 * (1 - 2 * nu)))

    @final
    def uniaxial(self, stretch: Array) -> Uniaxial:
        """The isochoric stretch is between 1 and the stretch: tension increases the volume, compression reduces it."""
        from scipy.optimize.elementwise import find_root  # here: reading a configuration imports the laws, not scipy

        root = find_root(
            lambda r, s: r * self._volume(r) ** (1 / 3) - s, (np.ones_like(stretch), stretch), args=(stretch,)
        )
        isochoric = np.where(root.success & (self._discriminant(root.x) >= 0), root.x, np.nan)
        lateral = np.sqrt(self._volume(isochoric) / stretch)
        return Uniaxial.of(stretch, lateral, self._kirchhoff(isochoric) / stretch)

    def _kirchhoff(self, isochoric: Array) -> Array:
        """r psi'(r), MPa."""
        return isochoric * self.incompressible(isochoric)

    def _volume(self, isochoric: Array) -> Array:
        """J; 1/2 where kappa/2 (J - 1)^2 cannot balance the pressure at any J."""
        return np.asarray((1 + np.sqrt(np.maximum(self._discriminant(isochoric), 0))) / 2)

    def _discriminant(self, isochoric: Array) -> Array:
        """(2 J - 1)^2; below zero where there is no J."""
        return np.asarray(1 + 4 / 3 * self._kirchhoff(isochoric) / self.kappa)

    @final
    @property
    def poisson_ratio(self) -> float:
        mu = self.shear_modulus
        return (3 * self.kappa - 2 * mu) / (2 * (3 * self.kappa + mu))

    @property
    def stretch_limits(self) -> tuple[float, float]:
        return stable_range(self.incompressible)

    @final
    def shear(self, strain: Array) -> Response:
        c = CauchyGreen.of(strain)
        response, (energy, stress, factors) = self.isochoric(c), _volume_energy(c, 2 / 3 * self.shear_modulus)
        c.add_products(factors, response.tangent)
        return Response(response.energy + energy, response.stress + stress, response.tangent)

    @final
    def volumetric(self, strain: Array) -> Response:
        c = CauchyGreen.of(strain)
        energy, stress, factors = _volume_energy(c, self.volumetric_modulus)
        return Response(energy, stress, c.products(factors))

    @final
    def dilatation(self, strain: Array) -> Dilatation:
        c = CauchyGreen.of(strain)
        j = np.sqrt(c.determinant)
        return Dilatation(j - 1, scaled(j, c.inverse), c.products(Products(inverse_inverse=j, derivative=-2 * j)))

    @final
    @property
    def volumetric_modulus(self) -> float:
        return self.kappa - 2 / 3 * self.shear_modulus


def _volume_energy(c: CauchyGreen, modulus: float) -> tuple[Array, Array, Products]:
    """modulus/2 (J - 1)^2, its stress (..., 6), and the factors of its tangent."""
    j = np.sqrt(c.determinant)
    pressure = modulus * (j - 1) * j
    factors = Products(inverse_inverse=modulus * j**2 + pressure, derivative=-2 * pressure)
    return 0.5 * modulus * (j - 1) ** 2, scaled(pressure, c.inverse), factors


def stable_range(nominal: Callable[[Array], Array]) -> tuple[float, float]:
    """Stretches around 1 within which the nominal stress keeps rising; 0 and infinity where it does from 0.1 to 10."""
    ends = []
    for last, unlimited in ((0.1, 0.0), (10.0, np.inf)):
        stretch = np.geomspace(1.0, last, 2001)
        held = np.append(np.diff(nominal(stretch)) * np.diff(stretch) > 0, True)
        ends.append(unlimited if held.all() else float(stretch[np.argmin(held)]))
    return ends[0], ends[1]


def check_positive(law: type[Material], positive: Mapping[str, float]) -> None:
    """Raise `MaterialError` unless all values (MPa) are positive and finite."""
    for name, value in positive.items():
        if not 0 < value < np.inf:
            raise MaterialError(f"{law.title}: {name} = {value:g} MPa must be positive and finite")
