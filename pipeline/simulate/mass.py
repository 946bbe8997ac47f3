"""The mass of a meshed body: of its elements, and how it is spread along an arm."""

import numpy as np

from geometry import Body
from geometry.arrays import Array
from pipeline.config.config import Config
from rod.weight import Mass

#: places at which the mass beyond is written, equally spaced from the end to the clamp
PLACES = 65
#: part of one corner in each of the four points that stand for a tetrahedron; of the others a third of the rest
CORNER = 0.58541020
#: g per tonne
GRAMS = 1e6


def element_masses(body: Body, config: Config) -> Array | None:
    """(m,) g, of the elements of both halves; None where a density is missing."""
    materials = {name: config.materials[name] for name in body.mesh.regions if name in config.materials}
    densities = {name: material.density_tonne_mm3 for name, material in materials.items()}
    density = config.material.density_tonne_mm3
    if density is None or None in densities.values():
        return None
    grams = np.asarray(GRAMS * density * body.mesh.volumes * (2.0 if body.half else 1.0))
    for name, of_region in densities.items():
        grams[body.mesh.regions[name]] *= (of_region or 0.0) / density
    return grams


def mass_along(body: Body, config: Config) -> Mass | None:
    """How the mass of a whole arm is spread along it; None where a density is missing."""
    masses = element_masses(body, config)
    if masses is None:
        return None
    corners = body.mesh.points[body.mesh.tets]
    other = (1.0 - CORNER) / 3.0
    points = (CORNER - other) * corners + 4.0 * other * corners.mean(axis=1, keepdims=True)
    from_end = (body.length - points[..., 0]).ravel()
    order = np.argsort(from_end)
    grams = np.repeat(masses / 4.0, 4)[order]
    heights = grams * (points[..., 1].ravel()[order] - body.curve_y)
    places = np.linspace(0.0, body.length, PLACES)
    count = np.searchsorted(from_end[order], places)
    count[-1] = len(order)
    beyond = [np.append(0.0, np.cumsum(values))[count] for values in (grams, heights)]
    return Mass(places, *beyond)


def weight_per_length(mass: Mass | None, config: Config) -> tuple[float, float]:
    """N/mm, x and y of the weight of an arm in its plane per rest length; zero without gravity."""
    gravity = config.effects.gravity
    if mass is None or not gravity.on:
        return 0.0, 0.0
    x, y, _ = (float(mass.grams[-1]) / GRAMS / float(mass.from_end[-1]) * a for a in gravity.acceleration_mm_s2)
    return x, y
