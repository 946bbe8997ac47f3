"""The parameters of a configuration by which its law has derivatives: dimensions, and constants of the materials."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import fem
from fem.materials import LAWS, Constant
from pipeline.config.config import Config
from pipeline.config.material import Material

#: change of a constant of a material in difference quotients, over it or, of a stress, over the shear modulus
STEP_OF_CONSTANT = 1e-4
#: relative changes of the size of a body from a file, by the name of the parameter
SCALES = ("geometry.scale_x", "geometry.scale_y", "geometry.scale_z")


@dataclass(frozen=True)
class MaterialStep:
    """The materials of a body with a constant smaller and larger by half a step."""

    value: float
    unit: str  #: MPa, or 1
    step: float
    less: fem.Solid
    more: fem.Solid


def material_steps(config: Config) -> dict[str, MaterialStep]:
    """By the key of the constant, such as material.E, materials.base.mu, or material.mu.2 for the second of a list."""
    steps = {}
    for region, material in {"": config.material, **config.materials}.items():
        section = f"materials.{region}" if region else "material"
        for name, value, unit, half, less, more in _constants(material):
            solids = (_solid(config, region, changed) for changed in (less, more))
            steps[f"{section}.{name}"] = MaterialStep(value, unit, 2.0 * half, *solids)
    return steps


def _constants(material: Material) -> Iterator[tuple[str, float, str, float, Material, Material]]:
    """Name, value, unit, half the step, and the material with less and with more of it."""
    for name, kind in LAWS[material.law].constants().items():
        given = material.constants[name]
        values = given if isinstance(given, tuple) else (given,)
        for k, value in enumerate(values):
            half = _change(material, kind, value)
            several = [(*values[:k], value + change, *values[k + 1 :]) for change in (-half, half)]
            less, more = (
                replace(material, constants={**material.constants, name: new if isinstance(given, tuple) else new[0]})
                for new in several
            )
            key = f"{name}.{k + 1}" if isinstance(given, tuple) else name
            yield key, value, kind.unit.strip() or "1", half, less, more


def _change(material: Material, kind: Constant, value: float) -> float:
    if kind is Constant.POISSON_RATIO:
        return STEP_OF_CONSTANT * min(abs(value) or 0.5, 0.5 - value)
    if kind in (Constant.STRESS, Constant.STRESSES):
        return STEP_OF_CONSTANT * material.built().shear_modulus
    return STEP_OF_CONSTANT * abs(value)


def _solid(config: Config, region: str, material: Material) -> fem.Solid:
    materials = {name: other.built() for name, other in config.materials.items()}
    body = config.material.built()
    if region:
        return fem.ByRegion(body, {**materials, region: material.built()})
    return fem.ByRegion(material.built(), materials) if materials else material.built()
