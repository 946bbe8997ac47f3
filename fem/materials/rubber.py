"""Rubber-like laws: a function of the isochoric invariants plus kappa/2 (J - 1)^2.

I1bar = J^(-2/3) tr C, I2bar = J^(-4/3) ((tr C)^2 - tr C^2) / 2; source of the derivatives: G. A. Holzapfel, "Nonlinear
solid mechanics", Wiley 2000, sections 6.4 and 6.6.

The bar under uniaxial stress: with the isochoric stretch r = s J^(-1/3) the energy is psi(r) + kappa/2 (J - 1)^2. Free
sides, dW/dt = 0, give J (J - 1) = r psi'(r) / (3 kappa), with it P = r psi'(r) / s, and r psi'(r) = 2 (r^2 - 1/r)
(w' + c01 / r) as in the incompressible bar (R. S. Rivlin, D. W. Saunders, Phil. Trans. R. Soc. A 243 (1951) 251). So s
is known for each r.
"""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Self, final

import numpy as np

from fem.materials.material import (
    Dilatation,
    Material,
    MaterialError,
    PositiveStress,
    Response,
    Stress,
    Uniaxial,
    quadratic,
)
from fem.materials.tensors import IDENTITY, SYMMETRIC, CauchyGreen, outer, scaled, voigt
from geometry.arrays import Array


class IsochoricLaw(Material):
    """W = w(I1bar) + c01 (I2bar - 3) + kappa/2 (J - 1)^2.

    The shear part takes mu/3 (J - 1)^2 of the last term, as mu E:E does in the St. Venant-Kirchhoff law: without any
    stiffness against volume changes an element whose volumetric part has one point may swell at one corner and shrink
    at another, and tangents on the way are indefinite.
    """

    kappa: PositiveStress  #: bulk modulus, MPa

    @abstractmethod
    def first_invariant_energy(self, invariant: Array) -> tuple[Array, Array, Array]:
        """w(I1bar) and its first two derivatives, MPa."""

    @property
    @abstractmethod
    def second_invariant_modulus(self) -> float:
        """c01, MPa; 0 for laws of the first invariant alone."""

    @final
    @classmethod
    def from_uniaxial(cls, constants: Mapping[str, float], nu: float) -> Self:
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
        derivative = self.first_invariant_energy(isochoric**2 + 2 / isochoric)[1]
        modulus = derivative + self.second_invariant_modulus / isochoric
        return np.asarray(2 * (isochoric**2 - 1 / isochoric) * modulus)

    def _volume(self, isochoric: Array) -> Array:
        """J; 1/2 where kappa/2 (J - 1)^2 cannot balance the pressure at any J."""
        return np.asarray((1 + np.sqrt(np.maximum(self._discriminant(isochoric), 0))) / 2)

    def _discriminant(self, isochoric: Array) -> Array:
        """(2 J - 1)^2; below zero where there is no J."""
        return np.asarray(1 + 4 / 3 * self._kirchhoff(isochoric) / self.kappa)

    @final
    @property
    def shear_modulus(self) -> float:
        return float(2 * (self.first_invariant_energy(np.array(3.0))[1] + self.second_invariant_modulus))

    @final
    @property
    def poisson_ratio(self) -> float:
        mu = self.shear_modulus
        return (3 * self.kappa - 2 * mu) / (2 * (3 * self.kappa + mu))

    @final
    @property
    def stretch_limits(self) -> tuple[float, float]:
        return stable_range(self._incompressible)

    def _incompressible(self, stretch: Array) -> Array:
        """Nominal stress of the incompressible law in uniaxial tension, MPa."""
        derivative = self.first_invariant_energy(stretch**2 + 2 / stretch)[1]
        return 2 * (stretch - stretch**-2) * (derivative + self.second_invariant_modulus / stretch)

    @final
    def shear(self, strain: Array) -> Response:
        c = CauchyGreen.of(strain)
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
        volume = quadratic(2 / 3 * self.shear_modulus, _volume_change(c))
        return Response(energy + volume.energy, stress + volume.stress, tangent + volume.tangent)

    @final
    def volumetric(self, strain: Array) -> Response:
        return quadratic(self.volumetric_modulus, self.dilatation(strain))

    @final
    def dilatation(self, strain: Array) -> Dilatation:
        return _volume_change(CauchyGreen.of(strain))

    @final
    @property
    def volumetric_modulus(self) -> float:
        return self.kappa - 2 / 3 * self.shear_modulus


def _volume_change(c: CauchyGreen) -> Dilatation:
    """J - 1."""
    j = np.sqrt(c.determinant)
    square = outer(c.inverse, c.inverse)
    return Dilatation(j - 1, scaled(j, c.inverse), scaled(j, square - 2 * c.inverse_derivative))


def _second_invariant(c: CauchyGreen, size: Array) -> Response:
    """I2bar = size I2 with its first two derivatives by C."""
    unscaled = scaled(c.first, np.broadcast_to(IDENTITY, c.inverse.shape)) - voigt(c.tensor)
    gradient = unscaled - scaled(2 * c.second / 3, c.inverse)
    hessian = np.outer(IDENTITY, IDENTITY) - SYMMETRIC + scaled(2 * c.second / 3, c.inverse_derivative)
    hessian = hessian - 2 / 3 * (outer(gradient, c.inverse) + outer(c.inverse, unscaled))
    return Response(size * c.second, scaled(size, gradient), scaled(size, hessian))


def _transposed(tensor: Array) -> Array:
    return np.swapaxes(tensor, -1, -2)


def stable_range(nominal: Callable[[Array], Array]) -> tuple[float, float]:
    """Stretches around 1 within which the nominal stress keeps rising; 0 and infinity where it does from 0.1 to 10."""
    below, above = np.geomspace(1.0, 0.1, 2001), np.geomspace(1.0, 10.0, 2001)
    ends = []
    for stretch, unlimited in ((below, 0.0), (above, np.inf)):
        rising = np.diff(nominal(stretch)) * np.diff(stretch) > 0
        ends.append(unlimited if rising.all() else float(stretch[np.argmin(rising)]))
    return ends[0], ends[1]


def _check(law: type[Material], positive: Mapping[str, float]) -> None:
    for name, value in positive.items():
        if not value > 0:
            raise MaterialError(f"{law.title}: {name} = {value:g} MPa must be positive")


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
        _check(NeoHooke, {"mu": self.mu, "kappa": self.kappa})

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
        _check(MooneyRivlin, {"c10 + c01": self.c10 + self.c01, "kappa": self.kappa})

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
        _check(Yeoh, {"c10": self.c10, "kappa": self.kappa})

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
