"""The configurations of the convergence study: a ladder of meshes per element and grading, and variations of the
Newton tolerance and of the contact distance."""

from dataclasses import dataclass, replace

from fem.elements import ELEMENTS, MOST_ACCURATE
from pipeline.config.config import Config, Newton

#: mesh sizes over that of the configuration by grading
SIZES = {"off": (1.5, 1.25, 1.0, 0.75, 0.6), "walls": (1.5, 1.25, 1.0, 0.75, 0.5)}
#: sizes for elements that lock on every mesh: fewer, without grading. p1 has a sixth of the unknowns of p2 on a mesh
#: and half the nodes on the material curve, too few for the cells of the arms at 1.5
LOCKING: dict[int, tuple[float, ...]] = {2: (1.5, 1.0, 0.6), 1: (1.0, 0.5, 0.25)}
#: further sizes of the series that converges fastest, from which the reference is extrapolated
FINEST = {(MOST_ACCURATE, "walls"): (0.4, 0.325)}
#: series beside those of meshes; their rungs have everything else as configured
TOLERANCE, CONTACT = "Newton tolerance", "contact distance"
TOLERANCES = (1e-3, 1e-4, 1e-8)
#: activation distances of contact over the configured one
DISTANCES = (4.0, 2.0, 0.5)


@dataclass(frozen=True)
class Rung:
    """One configuration of the study, and what varies along its series."""

    series: str  #: "p2p0", "mixed, graded to walls", TOLERANCE, CONTACT
    value: float  #: what varies along the series: mesh size (mm), tolerance, distance (mm)
    config: Config

    @property
    def is_mesh(self) -> bool:
        """Whether the mesh size varies along its series."""
        return self.series == mesh_series(self.config)

    @property
    def name(self) -> str:
        """For a file: mixed_graded_to_walls_3."""
        series = "".join(letter for letter in self.series.replace(" ", "_") if letter.isalnum() or letter == "_")
        return f"{series}_{self.value:.6g}"


def mesh_series(config: Config) -> str:
    """The name of the series of meshes with the element and grading of a configuration."""
    formulation, grading = config.mesh.formulation, config.mesh.grading
    return formulation if grading == "off" else f"{formulation}, graded to {grading}"


def ladder(config: Config, contact_mm: float | None) -> list[Rung]:
    """The rungs for a configuration: the series of meshes, and one each for tolerance and contact distance.

    contact_mm: the configured activation distance of contact; None where no faces can meet.
    """
    rungs = []
    for element in ELEMENTS.values():
        sizes = {"off": LOCKING[element.shape.degree]} if element.fully_integrated else SIZES
        for grading, factors in sizes.items():
            for factor in (*factors, *FINEST.get((element.name, grading), ())):
                size = round(factor * config.mesh.size_mm, 6)
                mesh = replace(config.mesh, size_mm=size, formulation=element.name, grading=grading)
                changed = replace(config, mesh=mesh)
                rungs.append(Rung(mesh_series(changed), size, changed))
    rungs += [Rung(TOLERANCE, value, replace(config, newton=Newton(value))) for value in TOLERANCES]
    if contact_mm is not None:
        for distance in (round(factor * contact_mm, 6) for factor in DISTANCES):
            contact = replace(config.effects.self_contact, dhat_mm=distance)
            changed = replace(config, effects=replace(config.effects, self_contact=contact))
            rungs.append(Rung(CONTACT, distance, changed))
    return rungs
