"""Mesh, tolerance and contact distance for a requested accuracy, before anything else is solved.

The error of the mesh is estimated from two pilots, II and III at the lowest pressure of the run on two coarse meshes,
and from their error indicators (`pipeline.accuracy.error_model`). The error of contact follows from its activation
distance with a ratio measured in docs/accuracy.md. Sizes, their bounds and their cost are in `pipeline.accuracy.sizes`.
"""

from dataclasses import asdict, dataclass, replace

from fem.elements import MOST_ACCURATE
from pipeline.accuracy.error_model import MeshErrorModel, Pilot, SolvedMesh
from pipeline.accuracy.ladder import Rung, mesh_series
from pipeline.accuracy.measure import measure
from pipeline.accuracy.plan import Plan
from pipeline.accuracy.request import grading_of, of_law, refuse, why_not_estimated, without_accuracy
from pipeline.accuracy.sizes import ContactDistance, Sizes
from pipeline.config.automatic_mesh import not_too_many
from pipeline.config.config import AUTO, USUAL_TOLERANCE, Config
from pipeline.errors import InputError
from pipeline.progress import Progress
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
    remarks: tuple[str, ...] = ()  #: sentences on the request, for the report


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
    """As `plan_discretisation`, for a requested relative error."""
    refuse(config)
    if reason := why_not_estimated(config):
        return _unplanned(config, reason, progress)
    remark = of_law(config)
    remarks = (remark,) if remark else ()
    for sentence in remarks:
        progress.remark(sentence)
    try:
        pilots = _pilots(config, store, progress)
    except _NoNumbers as failure:
        return _unplanned(config, str(failure), progress)
    plan = _plan(config, requested, pilots)
    plan.check(config)
    progress.remark(plan.announcement(config))
    return Planned(plan.applied(config), plan, remarks)


def _unplanned(config: Config, reason: str, progress: Progress) -> Planned:
    """The configuration without the request, and a remark why."""
    config = without_accuracy(config)
    given = "given one" if "size" not in config.mesh.chosen else "one that the program chooses without a request"
    sentence = (
        f"accuracy not estimated: {reason}; the mesh is the {given}, {config.mesh.element_size_mm:.3g} mm, with "
        f"{config.mesh.formulation} elements"
    )
    progress.remark(sentence)
    return Planned(config, None, (sentence,))


class _NoNumbers(Exception):
    """The pilots give no numbers; why, in a clause."""


def _pilots(config: Config, store: Store, progress: Progress) -> tuple[Pilot, Pilot]:
    """The coarser and the finer pilot, which serve for every accuracy. Raises _NoNumbers."""
    name, key = "states/pilots.json", result_key(replace(config, accuracy=None).hash, NUMBER_SOURCES)
    kept = store.read_json(name)
    if kept is None or kept["key"] != key:
        progress.stage("pilots for the requested accuracy")
        piloted, smallest_side = _of_pilots(config), min(config.design.extent)
        solved = [_pilot(piloted, fraction * smallest_side) for fraction in PILOTS]
        kept = {"key": key, "pilots": [asdict(pilot) for pilot in solved]}
        store.save_json(name, kept)
    coarse, fine = (Pilot.read(record) for record in kept["pilots"])
    return coarse, fine


def _of_pilots(config: Config) -> Config:
    """The configuration with the elements of the estimates and the lowest pressure alone."""
    elements = replace(config.mesh, formulation=FORMULATION, grading=grading_of(config, GRADING))
    return replace(config, mesh=elements, pressures_kPa=config.pressures_kPa[:1])


def _pilot(config: Config, size: float) -> Pilot:
    """II and III on a coarse mesh. Raises _NoNumbers."""
    config = config.with_mesh_size(size)
    result = measure(Rung(mesh_series(config), size, config))
    if result.cost is None or not result.numbers:
        why = result.failure.partition("; ")[0]
        raise _NoNumbers(f"the pilot with a mesh of {size:.3g} mm gave no numbers ({why})")
    solved = SolvedMesh.of(result.numbers[0])
    return Pilot(size, result.cost.degrees_of_freedom, result.cost.cpu_seconds, solved)


def _plan(config: Config, requested: float, pilots: tuple[Pilot, Pilot]) -> Plan:
    """Raises InputError as `Scene.meshed`."""
    coarse, fine = pilots
    piloted, is_given = _of_pilots(config), config.mesh.size_mm is not AUTO
    contact = ContactDistance.of(piloted if is_given else piloted.with_mesh_size(coarse.size_mm))
    smallest = min(not_too_many(config.design, FINEST * fine.size_mm), coarse.size_mm)
    sizes = Sizes(MeshErrorModel.fit(coarse, fine), pilots, contact, smallest, coarse.size_mm)
    planned_tolerance, given = min(1e-4, NEWTON_FRACTION * requested), config.newton.tolerance
    has_tolerance = given != USUAL_TOLERANCE
    return Plan(
        size_was_given=is_given,
        replaced=config.mesh.given_unlike(formulation=FORMULATION, grading=piloted.mesh.grading),
        formulation=FORMULATION,
        grading=piloted.mesh.grading,
        newton_tolerance=min(planned_tolerance, given) if has_tolerance else planned_tolerance,
        newton_given=given if has_tolerance else None,
        sizes=sizes,
        choice=sizes.with_size(config.mesh.element_size_mm, requested) if is_given else sizes.choice(requested),
        pilots_kPa=piloted.pressures_kPa[0],
        turn_rad=abs(fine.solved.numbers.kappa_0_per_mm) * config.design.length,
    )
