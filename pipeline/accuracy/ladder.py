"""The rungs of the ladder of accuracy: one configuration each, in one respect finer or coarser than the others."""

from dataclasses import dataclass, replace

from pipeline.config.config import Config
from pipeline.config.schema import FORMULATIONS

#: mesh sizes over that of the configuration by grading
SIZES = {"off": (1.5, 1.25, 1.0, 0.75, 0.6), "walls": (1.5, 1.25, 1.0, 0.75, 0.5)}
#: the same of elements that lock whatever the mesh: fewer and even ones. p1 has a sixth to a seventh of the unknowns of
#: p2 on a mesh, and half the nodes on the material curve: at 1.5 they do not resolve the cells of the arms
LOCKING: dict[str, tuple[float, ...]] = {"p2": (1.5, 1.0, 0.6), "p1": (1.0, 0.5, 0.25)}
#: further sizes of the line that converges best, for the limit that all others are held against
FINEST = {("mixed", "walls"): (0.4, 0.325)}
#: lines beside those of the meshes; a rung of one has everything else as configured
TOLERANCE, CONTACT, POINTS = "Newton tolerance", "contact distance", "points of the curve"
TOLERANCES = (1e-3, 1e-4, 1e-8)
#: activation distances of contact over the configured one
DISTANCES = (4.0, 2.0, 0.5)
#: the mesh size over the configured one at which nodes of the material curve are left out, and what is kept: every
#: second, third, ...
DENSE, STRIDES = 0.6, (2, 3, 4)


@dataclass(frozen=True)
class Rung:
    """What is solved, and what of it varies along its line of the picture."""

    choice: str  #: name of the line: "p2p0", "mixed, graded to walls", TOLERANCE, CONTACT
    value: float  #: what varies along the line: mesh size (mm), tolerance, distance (mm)
    config: Config
    strides: tuple[int, ...] = (1,)  #: the numbers of the rod are found from every so many-th node of the curve

    @property
    def is_mesh(self) -> bool:
        """Whether it stands on a line of meshes."""
        return self.choice == mesh_choice(self.config)

    @property
    def folder(self) -> str:
        """Where its results stand: mixed_graded_to_walls_3."""
        name = "".join(letter for letter in self.choice.replace(" ", "_") if letter.isalnum() or letter == "_")
        return f"{name}_{self.value:.6g}"


def mesh_choice(config: Config) -> str:
    """The name of the line of meshes with the elements of a configuration."""
    formulation, grading = config.mesh.formulation, config.mesh.grading
    return formulation if grading == "off" else f"{formulation}, graded to {grading}"


def ladder(config: Config, touching_mm: float | None) -> list[Rung]:
    """The rungs for a configuration: the lines of meshes, and one line each for tolerance and contact.

    touching_mm: the configured activation distance of contact; None where no faces can meet.
    """
    rungs = []
    for formulation in FORMULATIONS:
        for grading, shares in ({"off": LOCKING[formulation]} if formulation in LOCKING else SIZES).items():
            for share in (*shares, *FINEST.get((formulation, grading), ())):
                size = round(share * config.mesh.size_mm, 6)
                mesh = replace(config.mesh, size_mm=size, formulation=formulation, grading=grading)
                dense = share == DENSE and replace(mesh, size_mm=config.mesh.size_mm) == config.mesh
                changed = replace(config, mesh=mesh)
                rungs.append(Rung(mesh_choice(changed), size, changed, (1, *STRIDES) if dense else (1,)))
    rungs += [Rung(TOLERANCE, value, replace(config, newton_tolerance=value)) for value in TOLERANCES]
    if touching_mm is not None:
        distances = [round(share * touching_mm, 6) for share in DISTANCES]
        rungs += [Rung(CONTACT, value, replace(config, contact_dhat_mm=value)) for value in distances]
    return rungs
