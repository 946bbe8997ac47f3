"""Rubber-like laws: a function of the isochoric invariants plus kappa/2 (J - 1)^2.

I1bar = J^(-2/3) tr C, I2bar = J^(-4/3) ((tr C)^2 - tr C^2) / 2; source of the derivatives: G. A. Holzapfel, "Nonlinear
solid mechanics", Wiley 2000, sections 6.4 and 6.6.
"""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from fem.materials.material import Dilatation, Material, MaterialError, Response, quadratic
from fem.materials.tensors import IDENTITY, SYMMETRIC, CauchyGreen, outer, scaled, voigt
from geometry.arrays import Array


class IsochoricLaw(Material):
    """W = w(I1bar) + c (I2bar - 3) + kappa/2 (J - 1)^2.

    The shear part takes mu/3 (J - 1)^2 of the last term, as mu E:E does in the St. Venant-Kirchhoff law: without any
    stiffness against volume changes an element whose volumetric part has one point may swell at one corner and shrink
    at another (measured: indefinite tangents on the way, 29 factorizations instead of 14 in a step of arm (a)).
    """

    kappa: float  #: bulk modulus, MPa

    @abstractmethod
    def first(self, invariant: Array) -> tuple[Array, Array, Array]:
        """w(I1bar) and its first two derivatives, MPa."""

    @property
    @abstractmethod
    def second(self) -> float:
        """c, MPa."""

    @final
    @property
    def shear_modulus(self) -> float:
        return float(2 * (self.first(np.array(3.0))[1] + self.second))

    @final
    @property
    def stretch_limits(self) -> tuple[float, float]:
        return stable_range(self._uniaxial)

    def _uniaxial(self, stretch: Array) -> Array:
        """Nominal stress of the incompressible law in uniaxial tension, MPa."""
        slope = self.first(stretch**2 + 2 / stretch)[1]
        return 2 * (stretch - stretch**-2) * (slope + self.second / stretch)

    @final
    def shear(self, strain: Array) -> Response:
        c = CauchyGreen.of(strain)
        size = c.determinant ** (-1 / 3)
        invariant = size * c.first
        energy, slope, bend = self.first(invariant)
        along = scaled(size, IDENTITY - scaled(c.first / 3, c.inverse))
        cross = outer(np.broadcast_to(IDENTITY, c.inverse.shape), c.inverse)
        square = outer(c.inverse, c.inverse)
        turn = scaled(c.first / 9, square) + scaled(c.first / 3, c.inverse_slope) - (cross + _transposed(cross)) / 3
        stress = 2 * scaled(slope, along)
        tangent = 4 * (scaled(slope * size, turn) + scaled(bend, outer(along, along)))
        if self.second:
            more = _second_invariant(c, size**2)
            energy = energy + self.second * (more.energy - 3)
            stress = stress + 2 * self.second * more.stress
            tangent = tangent + 4 * self.second * more.tangent
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
    return Dilatation(j - 1, scaled(j, c.inverse), scaled(j, square - 2 * c.inverse_slope))


def _second_invariant(c: CauchyGreen, size: Array) -> Response:
    """I2bar = size I2 with its first two derivatives by C."""
    bare = scaled(c.first, np.broadcast_to(IDENTITY, c.inverse.shape)) - voigt(c.tensor)
    along = bare - scaled(2 * c.second / 3, c.inverse)
    turn = np.outer(IDENTITY, IDENTITY) - SYMMETRIC + scaled(2 * c.second / 3, c.inverse_slope)
    turn = turn - 2 / 3 * (outer(along, c.inverse) + outer(c.inverse, bare))
    return Response(size * c.second, scaled(size, along), scaled(size, turn))


def _transposed(tensor: Array) -> Array:
    return np.swapaxes(tensor, -1, -2)


def stable_range(nominal: Callable[[Array], Array]) -> tuple[float, float]:
    """Stretches around 1 within which the nominal stress keeps rising; 0 and infinity where it does from 0.1 to 10."""
    below, above = np.geomspace(1.0, 0.1, 2001), np.geomspace(1.0, 10.0, 2001)
    ends = []
    for stretch, open_end in ((below, 0.0), (above, np.inf)):
        rising = np.diff(nominal(stretch)) * np.diff(stretch) > 0
        ends.append(open_end if rising.all() else float(stretch[np.argmin(rising)]))
    return ends[0], ends[1]


def _check(law: str, **positive: float) -> None:
    for name, value in positive.items():
        if not value > 0:
            raise MaterialError(f"{law}: {name} = {value:g} MPa must be positive")


@final
@dataclass(frozen=True)
class NeoHooke(IsochoricLaw):
    """W = mu/2 (I1bar - 3) + kappa/2 (J - 1)^2; mu, kappa in MPa, positive. Raises `MaterialError`."""

    mu: float
    kappa: float

    def __post_init__(self) -> None:
        _check("neo-Hooke", mu=self.mu, kappa=self.kappa)

    def first(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.mu / 2)

    @property
    def second(self) -> float:
        return 0.0


@final
@dataclass(frozen=True)
class MooneyRivlin(IsochoricLaw):
    """W = c10 (I1bar - 3) + c01 (I2bar - 3) + kappa/2 (J - 1)^2; MPa, c10 + c01 and kappa positive.

    Raises `MaterialError`.
    """

    c10: float
    c01: float
    kappa: float

    def __post_init__(self) -> None:
        _check("Mooney-Rivlin", **{"c10 + c01": self.c10 + self.c01, "kappa": self.kappa})

    def first(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10)

    @property
    def second(self) -> float:
        return self.c01


@final
@dataclass(frozen=True)
class Yeoh(IsochoricLaw):
    """W = c10 (I1bar - 3) + c20 (I1bar - 3)^2 + c30 (I1bar - 3)^3 + kappa/2 (J - 1)^2; MPa, c10 and kappa positive.

    Raises `MaterialError`. Elastosil M4601: c10 = 0.11, c20 = 0.02 MPa.
    """

    c10: float
    c20: float
    c30: float
    kappa: float

    def __post_init__(self) -> None:
        _check("Yeoh", c10=self.c10, kappa=self.kappa)

    def first(self, invariant: Array) -> tuple[Array, Array, Array]:
        return _polynomial(invariant, self.c10, self.c20, self.c30)

    @property
    def second(self) -> float:
        return 0.0


def _polynomial(invariant: Array, *coefficients: float) -> tuple[Array, Array, Array]:
    """sum_k coefficients_k (I - 3)^k from k = 1 on, with its first two derivatives."""
    w = np.polynomial.Polynomial([0.0, *coefficients])
    x = invariant - 3
    return w(x), w.deriv()(x), w.deriv(2)(x)
