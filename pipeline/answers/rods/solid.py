"""The body of an arm for other programs: mass, section and stiffness from the files of its run."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fem.materials import LAWS
from geometry.arrays import Array
from geometry.mesh_content import read_tetrahedra
from pipeline.config.material import LOSS_FACTOR
from pipeline.values.formats import BODY
from pipeline.values.run import Run
from rod import RodError, Solid
from rod.export.robot import Section


def solid_of(run: Run) -> Solid | None:
    """The body of a run; None where its mass is not known. Without the mesh of the run its section is round.

    Raises `RodError` for a material that is no law with its constants.
    """
    parameters, path = run.parameters, run.directory / BODY
    points, tets = read_tetrahedra(path) if path.is_file() else (None, None)
    corners = None if points is None else points[tets]
    volume, mass = parameters.solid_volume_mm3, parameters.mass_g
    if volume is None and corners is not None:  # no five parameters: `law: cell`, `pneurod cell`, or calibrated
        volume = float(_volumes(corners).sum()) * (1.0 if corners[..., 2].min() < 0.0 else 2.0)
        known = None if run.law is None else run.law.law.mass
        mass = None if known is None else float(known.grams[-1])
    if mass is None or volume is None:
        return None
    area = volume / run.length_mm
    if corners is None or run.mesh is None:
        radius = math.sqrt(area / math.pi)
        section = Section(-radius, radius, 2.0 * radius, 0.0, (0.25 * radius**2, 0.25 * radius**2))
    else:
        section = _section(corners, run.mesh.curve_height_mm)
    return Solid(mass, young_modulus(run.material), area, section, float(run.material.get("loss_factor", LOSS_FACTOR)))


def young_modulus(material: Mapping[str, Any]) -> float:
    """MPa, at small strain, of a material as files have it. Raises `RodError` where it is no law with its constants."""
    try:
        law = LAWS[material["law"]]
        return law(**{name: material[name] for name in law.constants()}).young_modulus
    except (KeyError, TypeError, ValueError) as failure:
        raise RodError(f"The material of the file is not a law with its constants: {failure}.") from None


def _volumes(corners: Array) -> Array:
    """(n,) of tetrahedra with corners (n, 4, 3)."""
    return np.asarray(np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6.0)


def _section(corners: Array, height: float) -> Section:
    """That of tetrahedra (n, 4, 3) mm whose material curve has a height in mm."""
    volumes, y, z = _volumes(corners), corners[..., 1], corners[..., 2]
    centre = float(volumes @ y.mean(axis=1) / volumes.sum())
    spread = _mean_square(volumes, y - centre), _mean_square(volumes, z)
    low, high, width = float(y.min()), float(y.max()), 2.0 * float(np.abs(z).max())
    return Section(low - height, high - height, width, centre - height, spread)


def _mean_square(volumes: Array, at_corners: Array) -> float:
    """Of a function that is linear in each tetrahedron, by its values at the corners (n, 4)."""
    squares = ((at_corners**2).sum(axis=1) + at_corners.sum(axis=1) ** 2) / 20.0
    return float(volumes @ squares / volumes.sum())
