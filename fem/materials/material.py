"""Hyperelastic laws: energy per reference volume, second Piola-Kirchhoff stress and its tangent.

Every law is a sum of a *shear* and a *volumetric* part, because near incompressibility the two are integrated by
different rules (`fem.discretisation`). Both parts take the Green-Lagrange strain in Voigt notation (11, 22, 33, 12,
23, 13 with engineering shear, the factor 2) and return stress in the same order (no factor).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from geometry.arrays import Array


class MaterialError(ValueError):
    """A material constant outside what the law allows; the sentence says what is allowed."""


@dataclass(frozen=True)
class Response:
    """What a law answers at n points."""

    energy: Array  #: (...,), MPa = N mm / mm3
    stress: Array  #: (..., 6), second Piola-Kirchhoff, MPa
    tangent: Array  #: (..., 6, 6) dS/dE, MPa; (1, ..., 1, 6, 6) where it is the same everywhere


@dataclass(frozen=True)
class Dilatation:
    """The measure theta of the volume change in which a volumetric energy is m/2 theta^2."""

    value: Array  #: (...,)
    slope: Array  #: (..., 6) d theta / d E; (1, ..., 1, 6) where it is the same everywhere
    bend: Array  #: (..., 6, 6) its second derivative; (1, ..., 1, 6, 6) where it is the same everywhere


class Material(ABC):
    """A hyperelastic law as the sum of a shear and a volumetric part, the latter m/2 theta^2."""

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
    def stretch_limits(self) -> tuple[float, float]:
        """Uniaxial stretches between which the law can be trusted to be stable."""


def check_moduli(E: float, nu: float) -> None:
    """Refuse moduli for which the linearised law is not positive definite."""
    if not E > 0:
        raise MaterialError(f"E = {E:g} MPa: Young's modulus must be positive")
    if not -1.0 < nu < 0.5:
        raise MaterialError(f"nu = {nu:g}: Poisson's ratio must lie between -1 and 0.5 (0.5 itself excluded)")


@dataclass(frozen=True)
class TwoModuli(Material):
    """A law that is given by Young's modulus E in MPa and Poisson's ratio nu. Raises `MaterialError`."""

    E: float
    nu: float

    def __post_init__(self) -> None:
        check_moduli(self.E, self.nu)

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


@final
@dataclass(frozen=True)
class StVenantKirchhoff(TwoModuli):
    """W = lambda/2 tr(E)^2 + mu E:E, S = lambda tr(E) I + 2 mu E (E the Green-Lagrange strain).

    E in MPa, 0 < E; -1 < nu < 0.5. Raises `MaterialError` outside. The law is not stable at all strains: in uniaxial
    compression the force has a limit point at stretch 1/sqrt(3), in tension J vanishes at sqrt(1 + 1/nu).
    """

    @property
    def stretch_limits(self) -> tuple[float, float]:
        upper = np.sqrt(1 + 1 / self.nu) if self.nu > 0 else np.inf
        return float(1 / np.sqrt(3)), float(upper)

    def shear(self, strain: Array) -> Response:
        mu = self.lame[1]
        stress = 2 * mu * strain
        stress[..., 3:] *= 0.5
        energy = 0.5 * np.einsum("...v,...v", stress, strain)
        tangent = np.diag(mu * np.array([2.0, 2.0, 2.0, 1.0, 1.0, 1.0]))
        return Response(energy, stress, tangent.reshape((1,) * (strain.ndim - 1) + (6, 6)))

    def volumetric(self, strain: Array) -> Response:
        lam = self.lame[0]
        trace = strain[..., :3].sum(axis=-1)
        stress = np.zeros_like(strain)
        stress[..., :3] = (lam * trace)[..., None]
        tangent = np.zeros((6, 6))
        tangent[:3, :3] = lam
        return Response(0.5 * lam * trace**2, stress, tangent.reshape((1,) * (strain.ndim - 1) + (6, 6)))

    def dilatation(self, strain: Array) -> Dilatation:
        flat = (1,) * (strain.ndim - 1)
        slope = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).reshape((*flat, 6))
        return Dilatation(strain[..., :3].sum(axis=-1), slope, np.zeros((*flat, 6, 6)))


def quadratic(modulus: float, theta: Dilatation) -> Response:
    """W = modulus/2 theta^2."""
    slope = theta.slope
    square = slope[..., :, None] * slope[..., None, :]
    return Response(
        0.5 * modulus * theta.value**2,
        modulus * theta.value[..., None] * slope,
        modulus * (square + theta.value[..., None, None] * theta.bend),
    )
