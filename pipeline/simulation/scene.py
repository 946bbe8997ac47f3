"""From a configuration to its scene: the part of the body that is meshed, and the effects that act on it."""

import fem
from geometry import GRADINGS, Body, DesignError, MeshError
from pipeline.config.config import Config
from pipeline.errors import InputError

#: The name of outer faces that can meet, where the user names no others.
GAP = "gap"


def meshed_body(config: Config) -> Body:
    """The body, half of it where body, pressure and loads are mirror images about z = 0.

    Raises InputError for a body that cannot be meshed or lacks what an effect needs, and for a law that is none.
    """
    material_of(config)
    try:
        body = config.design.body(config.mesh.size_mm, GRADINGS[config.mesh.grading])
    except (DesignError, MeshError) as failure:
        raise InputError(f"{config.source}: {failure}") from None
    if config.effects["symmetry"] == "on" and not body.half:
        raise InputError(f"{config.source}: effects.symmetry: on, but this body is no half; write auto or off")
    if is_on(config, "strain_limiting_layer") and len(body.mesh.plane(1, body.curve_y)) == 0:
        raise InputError(
            f"{config.source}: effects.strain_limiting_layer: the mesh has no faces in the plane "
            f"y = {body.curve_y:g} mm of the material curve; cut the body there before meshing it"
        )
    for faces in config.contact_faces or ():
        if faces not in body.mesh.faces:
            raise InputError(
                f"{config.source}: effects.self_contact.faces: '{faces}' does not exist; "
                f"this body has {', '.join(body.mesh.faces)}"
            )
    return body.full() if config.effects["symmetry"] == "off" or pulls_aside(config) else body


def material_of(config: Config) -> fem.Material:
    """The law of the solid. Raises InputError for constants that the law cannot have together."""
    try:
        law: fem.Material = getattr(fem, config.material.model)(**config.material.constants)
    except fem.MaterialError as failure:
        raise InputError(f"{config.source}: material: {failure}") from None
    if config.mesh.formulation == "mixed" and law.volumetric_modulus <= 0:
        raise InputError(
            f"{config.source}: mesh.formulation: mixed needs a law that resists a change of volume by more than shear "
            f"does; its volumetric modulus here is {law.volumetric_modulus:g} MPa; write p2 or p2p0"
        )
    return law


def is_on(config: Config, effect: str) -> bool:
    """Whether an effect acts that must be asked for: gravity or the layer, which auto leaves out as the paper does."""
    return config.effects[effect] == "on"


def pulls_aside(config: Config) -> bool:
    """Whether gravity acts across the plane of symmetry."""
    return is_on(config, "gravity") and config.gravity_mm_s2[2] != 0.0


def contact_faces(config: Config, body: Body) -> tuple[str, ...]:
    """The faces each of which may meet itself: those the user names, gap, and the walls of the cavities.

    Empty where contact is switched off.
    """
    if config.effects["self_contact"] == "off":
        return ()
    known = (*(config.contact_faces or ()), GAP, *body.cavities)
    return tuple(dict.fromkeys(name for name in known if name in body.mesh.faces))


def effects_of(config: Config, body: Body, largest_MPa: float) -> list[fem.Effect]:
    """The effects a scene asks for, the pressure of the run being the largest at load factor 1."""
    effects: list[fem.Effect] = []
    if config.effects["pressure"] != "off":
        for name, pressure in config.cavities.items():
            if pressure.share:
                effects.append(fem.Pressure(name, pressure.share * largest_MPa))
            if pressure.held_kPa:
                effects.append(fem.Pressure(name, pressure.held_kPa / 1000.0, ramp=False))
    meant = config.contact_faces or (GAP,)
    for faces in contact_faces(config, body):
        # faces that nobody named wait, even where contact is switched on: they cost nothing until they meet
        waits = config.effects["self_contact"] == "auto" or faces not in meant
        # the walls of a cavity collapse under a vacuum, and press on spots
        behind = 0.0 if faces in body.cavities else fem.BEHIND
        effects.append(fem.SelfContact(faces, config.contact_dhat_mm if faces in meant else None, waits, behind))
    if is_on(config, "gravity"):
        effects.append(fem.Gravity(config.material.density_tonne_mm3, config.gravity_mm_s2, ramp=False))
    if is_on(config, "strain_limiting_layer"):
        layer = config.layer
        triangles = body.mesh.plane(1, body.curve_y)
        effects.append(fem.StrainLimitingLayer(triangles, layer.thickness_mm, layer.E_MPa, layer.nu))
    return effects
