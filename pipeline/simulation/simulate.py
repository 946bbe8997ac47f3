"""The load cases on one body, each a task; each state is stored as soon as it is reached."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import isinf, nan

import fem
from geometry import Reason
from pipeline.config.config import Config
from pipeline.context import RunContext
from pipeline.errors import RunFailed
from pipeline.parallel import Pending, TaskContext
from pipeline.progress import Progress
from pipeline.results.values import State
from pipeline.simulation.case_path import CasePath
from pipeline.simulation.contact_check import ContactCheck
from pipeline.simulation.failure import Failure
from pipeline.simulation.kernels import load_kernels
from pipeline.simulation.known_limit import FIRST, EndOfII, waits_for_II
from pipeline.simulation.loadcase import LoadCase, identification_case
from pipeline.simulation.outcome import Outcome, Outcomes, Record
from pipeline.simulation.scene import Scene
from pipeline.store.store import Store

#: II first, because the others are told where it ends; then the loaded one, which takes longest
EXPERIMENTS = ("II", "III", "I")


def experiments_of(config: Config) -> tuple[str, ...]:
    """The experiments of a run, without what `why_not_free` leaves out."""
    return in_balance(config, [name for name in EXPERIMENTS if name in config.experiments])


def in_balance(config: Config, names: Iterable[str]) -> tuple[str, ...]:
    """These experiments, without I where it is not simulated."""
    return tuple(name for name in names if name != "I" or not why_not_free(config))


def why_not_free(config: Config) -> str:
    """Why experiment I is not simulated, because forces on a free body are not in balance; empty where it is."""
    reasons = {
        "nothing holds the weight of a free body": config.effects.gravity.on,
        "the clamp carries the pressure on the opening": config.design.is_open_at_clamp,
    }
    causes = [reason for reason, holds in reasons.items() if holds]
    return f"experiment I is not simulated, because {' and '.join(causes)}" if causes else ""


def begin_II(scene: Scene, context: RunContext) -> Pending[Outcome] | None:
    """Experiment II of a run, submitted; None where it is not simulated."""
    if FIRST not in experiments_of(scene.config):
        return None
    case = identification_case(scene.config, FIRST)
    context.progress.experiment(case.name, case.schedule.pressures_kPa)
    return context.submit(_solve, case, scene, context.store, None)


def simulate(
    scene: Scene,
    context: RunContext,
    experiments: Sequence[str | LoadCase] | None = None,
    second: Pending[Outcome] | None = None,
) -> Outcomes:
    """Solve the load cases, by default `experiments_of`; one that fails does not stop others.

    A name stands for that experiment at the pressures of the run. Cases that the end of II concerns are begun when II,
    if it is among them, has ended. second: II, where it was submitted before. Raises RunFailed where the faces that are
    to touch cannot.
    """
    requested = experiments_of(scene.config) if experiments is None else experiments
    cases = [c if isinstance(c, LoadCase) else identification_case(scene.config, c) for c in requested]
    pending = {} if second is None else {FIRST: second}
    new = sorted((case for case in cases if case.name not in pending), key=lambda case: case.name)
    for case in new:
        context.progress.experiment(case.name, case.schedule.pressures_kPa)
    has_II = any(case.name == FIRST for case in cases)
    later = [case for case in cases if has_II and waits_for_II(case)]
    for case in sorted((case for case in new if case not in later), key=lambda case: case.name != FIRST):
        pending[case.name] = context.submit(_solve, case, scene, context.store, None)
    try:
        if later:
            end = EndOfII.of(pending[FIRST].result())
            pending |= {case.name: context.submit(_solve, case, scene, context.store, end) for case in later}
        return Outcomes({name: pending[name].result() for name in sorted(pending)})
    except fem.ContactError as failure:
        raise RunFailed(str(failure)) from None


def _solve(context: TaskContext, case: LoadCase, scene: Scene, store: Store, end_of_II: EndOfII | None) -> Outcome:
    """Follow the load path of one case from its stored states on."""
    load_kernels(context, scene.config)
    return _followed(case, scene, store, context.progress, end_of_II)


def _followed(case: LoadCase, scene: Scene, store: Store, progress: Progress, end_of_II: EndOfII | None) -> Outcome:
    at_end = case.end
    experiment = fem.Experiment.of(case.experiment, scene.body, at_end.y_mm, at_end.force_N, at_end.x_mm)
    material = scene.material
    effects = scene.effects(case.schedule.reference_MPa)
    model = experiment.model(material, effects, scene.config.mesh.formulation)
    newton = fem.NewtonOptions(tolerance=scene.config.newton.tolerance)
    path = CasePath(case, model, newton, store, progress, end_of_II)
    solution, failure = path.followed()
    steps, intersection = _before_intersection(scene, solution.steps)
    if intersection:
        reached_kPa = case.schedule.pressures_kPa[len(steps) - 1] if steps else 0.0
        rejected_kPa = case.schedule.pressures_kPa[len(steps)]
        failure = Failure(
            *(rejected_kPa, fem.sentence(intersection), 0, 0),
            reached_kPa=reached_kPa,
            passes_through_itself=True,
            causes=intersection,
        )
    if failure:
        progress.stopped(case.name, case.schedule.pressures_kPa[len(steps) :], failure.brief)
    seconds = sum((step.spent for step in solution.steps), fem.Seconds(set_up=solution.seconds.set_up))
    pressures, rejected = case.schedule.pressures_kPa[: len(steps)], path.cpu_seconds[len(steps) :]
    states = zip(pressures, steps, path.cpu_seconds[: len(steps)], strict=True)
    return Outcome(
        name=case.name,
        records=tuple(_record(scene, experiment, case, *state) for state in states),
        failure=failure,
        seconds=seconds,
        factorizations=sum(step.factorizations for step in solution.steps),
        degrees_of_freedom=solution.degrees_of_freedom,
        solver=solution.solver,
        points=model.space.points,
        nodes=model.space.nodes,
        unused_cpu_seconds=sum(rejected) + path.cpu_seconds_since,
    )


def _before_intersection(scene: Scene, steps: Sequence[fem.Step]) -> tuple[Sequence[fem.Step], tuple[Reason, ...]]:
    """The steps before the body passes through itself where no contact is simulated, and where it does, if so.

    Where contact is switched off it may.
    """
    if scene.config.effects.self_contact.off:
        return steps, ()
    for count, step in enumerate(steps):
        if reason := fem.self_intersection(step.space, step.positions, scene.body.half):
            return steps[:count], (reason,)
    return steps, ()


def _record(
    scene: Scene, experiment: fem.Experiment, case: LoadCase, pressure_kPa: float, step: fem.Step, cpu_seconds: float
) -> Record:
    force, contact = experiment.end_force(step), ContactCheck.of(experiment, step)
    curve = experiment.centreline(step)
    return Record(
        state=_state(scene, experiment, pressure_kPa, step, contact),
        centreline=curve,
        load=replace(scene.weight, force=(float(force[0]), float(force[1])), couple=experiment.end_couple(step)),
        displacement=step.displacement,
        fields=fem.element_fields(step, scene.material),
        effects=step.effects,
        spent=step.spent,
        held=case.held,
        cpu_seconds=cpu_seconds,
        contact_check=contact,
        path_dependence=step.path_dependence,
    )


def _state(
    scene: Scene, experiment: fem.Experiment, pressure_kPa: float, step: fem.Step, contact: ContactCheck | None
) -> State:
    """The row of a state; forces, moments and volumes are those of the full body."""
    material, extremes = scene.material, step.extremes
    end, force, clamp = experiment.end(step), experiment.end_force(step), experiment.clamp_force(step)
    error = fem.stress_error(step, material)
    cavities = scene.config.effects.pressure.following or experiment.body.cavities[:1]
    air = sum(step.cavity_volume(name) for name in cavities)
    remarks = (
        fem.sentence((*fem.unstable_stretches(step.space, step.displacement, material), *step.instability)),
        contact.clause if contact else "",
        _on_load_steps(step.path_dependence),
    )
    return State(
        experiment=experiment.name,
        pressure_kPa=pressure_kPa,
        end_x_mm=float(end[0]),
        end_y_mm=float(end[1]),
        reaction_N=(float(force[0]), float(force[1])),
        clamp_reaction_N=(float(clamp[0]), float(clamp[1])),
        clamp_moment_N_mm=experiment.clamp_moment(step),
        cavity_volume_mm3=experiment.symmetry_factor * air,
        stretch_of_curve=experiment.stretch_of_curve(step),
        curve_z_mm=experiment.distance_from_plane(step),
        min_J=extremes.min_J,
        max_stretch=extremes.max_stretch,
        min_stretch=extremes.min_stretch,
        min_J_at_mm=extremes.min_J_at,
        max_stretch_at_mm=extremes.max_stretch_at,
        min_stretch_at_mm=extremes.min_stretch_at,
        min_gap_mm=nan if isinf(step.min_gap) else step.min_gap,
        contact_error_mm=nan if contact is None or contact.end_mm is None else contact.end_mm,
        contact_error_N=nan if contact is None or contact.end_N is None else contact.end_N,
        stress_error=error.energy,
        stress_error_at_mm=error.worst_at,
        negative_pivots=step.negative_pivots,
        newton_iterations=step.newton_iterations,
        factorizations=step.factorizations,
        cutbacks=step.cutbacks,
        seconds=step.seconds,
        reason="; ".join(filter(None, remarks)),
    )


def _on_load_steps(path_dependence: float) -> str:
    """By how much the contact of a state in creases depends on the load steps; empty where it does not."""
    if not path_dependence:
        return ""
    how = "may depend" if isinf(path_dependence) else f"depends by {path_dependence:.2%}"
    return f"walls fold, and the state found {how} on the load steps"
