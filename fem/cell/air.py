"""Pressure of the air in a piece of a body whose cavities go on beyond planes of mirror symmetry."""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.discretisation import Discretisation
from fem.effects.effect import Effect
from fem.effects.loads import PressureTerm, enclosed_volume
from fem.kernels.surface import axial_flux, axial_flux_tangent
from fem.materials.material import Material
from geometry import Body
from geometry.arrays import Array


@final
@dataclass(frozen=True)
class AirPressure(Effect):
    """Pressure in MPa at load factor 1 on a named face that is open where planes parallel to the z axis cut it.

    Pi = -p V, V the volume between the walls, those planes and the plane z = 0 of a half body: minus the flux of the
    field z e_z through the walls, which has none through the planes. The planes may move: the force of the air on them
    is part of the derivative of V.
    """

    where: str
    value: float

    def bind(self, space: Discretisation, material: Material) -> PressureTerm:
        """The potential of the pressure; raises ValueError for a face that does not exist."""
        return PressureTerm(space.surface(self.where), self.value, flux=axial_flux, tangent=axial_flux_tangent)


def air_volumes(body: Body, space: Discretisation, displacement: Array) -> Array:
    """Air (c,) in mm3 in each cavity of a piece of a body, between its planes; of both halves of a half body.

    displacement: (n, 3) of its nodes, mm.
    """
    whole, x = 2.0 if body.half else 1.0, space.points + displacement
    return np.array([whole * enclosed_volume(space.surface(name), x, axial_flux) for name in body.cavities])
