"""What a requested accuracy does not go together with, known from the configuration, and the run without it."""

from dataclasses import replace

from pipeline.config.automatic_mesh import COARSER, GivenMesh, chosen_mesh
from pipeline.config.config import AUTO, Config, MeshSettings
from pipeline.errors import InputError
from pipeline.identification.too_short import too_short


def refuse(config: Config) -> None:
    """Raise InputError for what a run with a requested accuracy cannot do."""
    if config.law == "cell":
        raise InputError(
            f"{config.source}: law, accuracy: the accuracy of a run is that of κ₀(l/2), α₂ and F, which are not "
            f"made with law: cell; use `pneurod cell CONFIG --accuracy {100 * (config.accuracy or 0.0):g}%`, which "
            "refines the mesh of the cell, or leave one of them out"
        )
    if config.effects.incompressibility.off:
        raise InputError(
            f"{config.source}: effects.incompressibility, accuracy: a requested accuracy takes mixed elements, and "
            "incompressibility off contradicts them; leave one of them out"
        )


def of_law(config: Config) -> str:
    """The sentence on mixed elements of a law that ends early with them; else empty."""
    if config.material.law != "svk" or not config.design.outer_corners:
        return ""
    return (
        "a requested accuracy takes mixed elements, with which an arm with gaps of the St. Venant-Kirchhoff law (svk) "
        "ends early in the corner at the clamp, with fillets too (experiment III of the arm of the paper at 22.8 kPa "
        "on a mesh of 2 mm, between 28 and 31 kPa on one of 4 mm); give lower pressures, another law (material.law: "
        "hencky for example), or leave accuracy out"
    )


def why_not_estimated(config: Config) -> str:
    """Why the errors of the mesh cannot be estimated, known before the pilots; else empty."""
    return "the arm is too short for five parameters, whose errors count" if too_short(config) else ""


def grading_of(config: Config, grading: str) -> str:
    """The grading for the estimates; a closed surface, which has no walls to be found, stays without."""
    return grading if config.design.has_drawing else config.mesh.grading


def without_accuracy(config: Config) -> Config:
    """The configuration with the mesh that it has where no accuracy is requested."""
    mesh, state = config.mesh, config.effects.incompressibility.state
    given = GivenMesh(
        None if mesh.size_mm is AUTO else mesh.element_size_mm,
        None if "formulation" in mesh.chosen else mesh.formulation,
        None if "grading" in mesh.chosen else mesh.grading,
    )
    against_locking = None if state == "auto" else state == "on"
    chosen = chosen_mesh(config.design, config.material.law, config.poisson_ratio, against_locking, given)
    coarser = COARSER if "coarser" in mesh.chosen else mesh.coarser
    settings = MeshSettings(chosen.size_mm, chosen.formulation, coarser, chosen.grading, chosen.reasons)
    return replace(config, mesh=settings)
