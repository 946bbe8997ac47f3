"""St. Venant-Kirchhoff's law: linear elasticity in the Green-Lagrange strain."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.materials.material import Dilatation, Response, TwoModuli, Uniaxial
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class StVenantKirchhoff(TwoModuli):
    """W = lambda/2 tr(E)^2 + mu E:E, S = lambda tr(E) I + 2 mu E (E the Green-Lagrange strain).

    E in MPa, 0 < E; -1 < nu < 0.5. Raises `MaterialError` outside. The law is not stable at all strains: in uniaxial
    compression the force has a limit point at stretch 1/sqrt(3), in tension J vanishes at sqrt(1 + 1/nu).
    """

    title = "St. Venant-Kirchhoff"

    @classmethod
    def uniaxial_terms(cls, stretch: Array, across: Array | None = None) -> dict[str, Array]:
        if across is None:
            return {"E": stretch * (stretch**2 - 1) / 2}
        first, third = stretch**2, (stretch * across) ** -2.0
        return {"E": (first * (first - 1) - third * (third - 1)) / (3 * stretch)}

    def uniaxial(self, stretch: Array) -> Uniaxial:
        """t^2 = 1 - nu (s^2 - 1), P = E s (s^2 - 1) / 2."""
        square = 1 - self.nu * (stretch**2 - 1)
        lateral = np.sqrt(np.where(square > 0, square, np.nan))
        return Uniaxial.of(stretch, lateral, self.E * self.uniaxial_terms(stretch)["E"])

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
        gradient = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).reshape((*flat, 6))
        return Dilatation(strain[..., :3].sum(axis=-1), gradient, np.zeros((*flat, 6, 6)))
