"""Pressure of the air in a piece of a body whose cavities go on beyond planes of mirror symmetry."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.discretisation import Discretisation, Faces
from fem.effects.effect import Blocks, Effect, LoadTerm
from fem.effects.loads import pressure_blocks
from fem.kernels.surface import axial_flux, axial_flux_tangent
from fem.materials.material import Material
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class AirPressure(Effect):
    """Pressure in MPa at load factor 1 on a named face that is open where planes parallel to the z axis cut it.

    Pi = -p V, V the volume between the walls, those planes and the plane z = 0 of a half body. The planes may move:
    the force of the air on them is part of the derivative of V.
    """

    where: str
    value: float

    def bind(self, space: Discretisation, material: Material) -> "AirPressureTerm":
        """The potential of the pressure; raises ValueError for a face that does not exist."""
        return AirPressureTerm(space.surface(self.where), self.value)


@final
@dataclass(frozen=True, eq=False)  # arrays inside: two terms are the same one or not
class AirPressureTerm(LoadTerm):
    """-p V(x), V the flux of the field z e_z through the walls, which has none through the planes."""

    effect = "pressure"

    faces: Faces
    value: float  #: MPa at load factor 1

    def energy(self, x: Array, factor: float) -> float:
        return -self.value * self.scale(factor) * self.volume(x)

    def gradient(self, x: Array, factor: float, out: Array) -> None:
        out -= self.value * self.scale(factor) * self.volume_gradient(x)

    def blocks(self, x: Array, factor: float, convex: bool) -> Blocks:
        return pressure_blocks(self.faces, x, self.value * self.scale(factor), axial_flux_tangent)

    def volume(self, x: Array) -> float:
        """V at positions x (n, 3), mm3, of the meshed part; the normals leave the solid, so it is minus the flux."""
        return float(-self._flux(x)[1].sum())

    def volume_gradient(self, x: Array) -> Array:
        """Derivative (n, 3) of V by the positions x (n, 3), mm2."""
        return -self._flux(x)[0]

    def _flux(self, x: Array) -> tuple[Array, Array]:
        gradient, flux = np.zeros_like(x), np.empty(self.faces.nodes.shape[0])
        axial_flux(self.faces.arrays, x, gradient, flux)
        return gradient, flux
