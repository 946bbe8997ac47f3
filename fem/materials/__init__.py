"""Hyperelastic laws: energy, stress and tangent. Importing this needs numpy alone."""

from fem.materials.hencky import Hencky
from fem.materials.material import Constant, LinearLaw, Material, MaterialError
from fem.materials.ogden import Ogden
from fem.materials.rubber import MooneyRivlin, NeoHooke, Yeoh
from fem.materials.st_venant_kirchhoff import StVenantKirchhoff

__all__ = [
    "LAWS",
    "Constant",
    "Hencky",
    "LinearLaw",
    "Material",
    "MaterialError",
    "MooneyRivlin",
    "NeoHooke",
    "Ogden",
    "StVenantKirchhoff",
    "Yeoh",
]

#: the laws by their names in a configuration
LAWS: dict[str, type[Material]] = {
    "svk": StVenantKirchhoff,
    "hencky": Hencky,
    "neo_hooke": NeoHooke,
    "mooney_rivlin": MooneyRivlin,
    "yeoh": Yeoh,
    "ogden": Ogden,
}
