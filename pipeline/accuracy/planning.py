"""Mesh, tolerance and contact distance for a requested accuracy, before anything else is solved.

The error of the mesh is estimated from two pilots, II and III at the lowest pressure of the run on two coarse meshes,
and from their error indicators (`pipeline.accuracy.error_model`). The error of contact follows from its activation
distance with a ratio measured in studies/accuracy.md.
"""

from dataclasses import dataclass, replace

import fem
from fem.elements import MOST_ACCURATE
from geometry import Reason
from pipeline.accuracy.error_model import MeshErrorModel, Pilot, Sizes
from pipeline.accuracy.measure import measure
from pipeline.accuracy.plan import Plan
from pipeline.config.automatic_mesh import COARSER, GivenMesh, chosen_mesh, not_too_many
from pipeline.config.config import AUTO, USUAL_TOLERANCE, Config
from pipeline.errors import InputError, RunFailed
from pipeline.identification.too_short import too_short
from pipeline.notes import render, render_all
from pipeline.progress import Progress
from pipeline.simulation.scene import Scene
from pipeline.store.kept import kept
from pipeline.store.state_key import NUMBER_SOURCES, result_key
from pipeline.store.store import Store

#: element and grading that reach an accuracy with the fewest degrees of freedom
FORMULATION, GRADING = MOST_ACCURATE, "walls"
#: sizes of the pilots over the smallest side of the body
PILOTS = (0.4, 0.27)
#: Newton's tolerance over the requested error
NEWTON_FRACTION = 1e-3
#: smallest mesh size over that of the finer pilot
FINEST = 0.35


@dataclass(frozen=True)
class Planned:
    """The configuration to solve, and the plan it follows."""

    config: Config
    plan: Plan | None = None  #: None where no accuracy is requested, or its errors cannot be estimated
    remarks: tuple[Reason, ...] = ()  #: on the request, for the report


def plan_discretisation(config: Config, store: Store, progress: Progress) -> Planned:
    """The configuration with the discretisation for its accuracy; unchanged where none is requested.

    Pilots that were solved earlier in the same folder are kept. Where they give no numbers, the mesh is that without a
    requested accuracy, and a remark says so. Raises InputError where no size that is tried reaches the accuracy, and
    for a configuration with which it has no meaning.
    """
    if config.accuracy is None:
        return Planned(config)
    try:
        return _planned(config, config.accuracy, store, progress)
    except InputError:
        store.disown()  # the corrected command may use the folder
        raise


def _planned(config: Config, requested: float, store: Store, progress: Progress) -> Planned:
    _refuse(config, requested)
    if too_short(config):
        return _unplanned(config, "the arm is too short for five parameters, whose errors count", progress)
    # the arm of the paper ends at 23 to 31 kPa
    ends_early = config.material.law == "svk" and config.design.outer_corners
    remarks = (Reason("accuracy_ends_early"),) if ends_early else ()
    for remark in remarks:
        progress.remark(render(remark))
    try:
        pilots = _pilots(config, store, progress)
    except RunFailed as failure:
        return _unplanned(config, str(failure), progress)
    plan = _plan(config, requested, pilots)
    plan.check(config)
    progress.remark(render_all((*plan.remarks(None), *plan.costs(config))))
    return Planned(plan.applied(config), plan, remarks)


def _refuse(config: Config, requested: float) -> None:
    """Raise InputError for what a run with a requested accuracy cannot do."""
    if config.law == "cell":
        raise InputError(
            f"{config.source}: law, accuracy: law: cell does not make κ₀(l/2), α₂ and F, whose errors count; use "
            f"`pneurod cell CONFIG --accuracy {100 * requested:g}%`, or leave one of them out"
        )
    if config.effects.incompressibility.off:
        raise InputError(
            f"{config.source}: effects.incompressibility, accuracy: a requested accuracy takes mixed elements, and "
            "incompressibility off contradicts them; leave one of them out"
        )


def _unplanned(config: Config, reason: str, progress: Progress) -> Planned:
    """The configuration with the mesh that it has where no accuracy is requested, and a remark why."""
    mesh, against_locking = config.mesh, config.effects.incompressibility.decided
    given = GivenMesh(
        None if mesh.size_mm is AUTO else mesh.element_size_mm,
        "auto" if "formulation" in mesh.chosen else mesh.formulation,
        "auto" if "grading" in mesh.chosen else mesh.grading,
    )
    chosen = chosen_mesh(config.design, config.material.law, config.poisson_ratio, against_locking, given)
    coarser = COARSER if "coarser" in mesh.chosen else mesh.coarser
    settings = replace(chosen, coarser=coarser)
    size, formulation = settings.element_size_mm, settings.formulation
    remark = Reason("accuracy_unknown", {"why": reason, "size_mm": size, "formulation": formulation})
    progress.remark(render(remark))
    return Planned(replace(config, mesh=settings), None, (remark,))


def _pilots(config: Config, store: Store, progress: Progress) -> tuple[Pilot, Pilot]:
    """The coarser and the finer pilot, which serve for every accuracy. Raises RunFailed without numbers."""

    def solve() -> tuple[Pilot, Pilot]:
        progress.stage("pilots for the requested accuracy")
        piloted, smallest_side = _of_pilots(config), min(config.design.extent)
        coarse, fine = (_pilot(piloted, fraction * smallest_side) for fraction in PILOTS)
        return coarse, fine

    key = result_key(replace(config, accuracy=None).hash, NUMBER_SOURCES)
    return kept(store, "states/pilots.json", tuple[Pilot, Pilot], solve, key)


def _of_pilots(config: Config) -> Config:
    """The configuration with the elements of the estimates and the lowest pressure alone.

    A closed surface, which has no walls to be found, stays without grading.
    """
    grading = GRADING if config.design.has_drawing else config.mesh.grading
    elements = replace(config.mesh, formulation=FORMULATION, grading=grading)
    return replace(config, mesh=elements, pressures_kPa=config.pressures_kPa[:1])


def _pilot(config: Config, size: float) -> Pilot:
    """II and III on a coarse mesh. Raises RunFailed without numbers."""
    result = measure(config.with_mesh_size(size))
    if result.cost is None or not result.numbers:
        raise RunFailed(f"the pilot with a mesh of {size:.3g} mm gave no numbers ({result.failure})")
    return Pilot(size, result.cost.degrees_of_freedom, result.cost.cpu_seconds, result.numbers[0])


def _plan(config: Config, requested: float, pilots: tuple[Pilot, Pilot]) -> Plan:
    """Raises InputError as `Scene.meshed`."""
    coarse, fine = pilots
    piloted, is_given = _of_pilots(config), config.mesh.size_mm is not AUTO
    sized = piloted if is_given else piloted.with_mesh_size(coarse.size_mm)
    default = Scene.meshed(sized.with_contact_distance(None)).activation_distance
    sizes = Sizes(
        model=MeshErrorModel.fit(coarse, fine),
        pilots=pilots,
        gap_mm=None if default is None else default / fem.ACTIVATION,
        given_dhat_mm=config.effects.self_contact.dhat_mm,
        smallest_mm=min(not_too_many(config.design, FINEST * fine.size_mm), coarse.size_mm),
        largest_mm=coarse.size_mm,
    )
    planned, given = min(1e-4, NEWTON_FRACTION * requested), config.newton.tolerance
    return Plan(
        size_was_given=is_given,
        replaced=config.mesh.given_unlike(formulation=FORMULATION, grading=piloted.mesh.grading),
        formulation=FORMULATION,
        grading=piloted.mesh.grading,
        newton_tolerance=planned if given == USUAL_TOLERANCE else min(planned, given),
        sizes=sizes,
        choice=sizes.with_size(config.mesh.element_size_mm, requested) if is_given else sizes.choice(requested),
        pilots_kPa=piloted.pressures_kPa[0],
        turn_rad=abs(fine.numbers.kappa_0_per_mm) * config.design.length,
    )
