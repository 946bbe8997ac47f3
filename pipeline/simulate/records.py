"""The record of a state: what later stages need of an equilibrium of the finite elements."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import degrees, isinf, nan

import numpy as np

import fem
from geometry import Reason
from pipeline.simulate.loadcase import LoadCase
from pipeline.simulate.outcome import Record
from pipeline.simulate.scene import Scene
from pipeline.values.reasons import render_all
from pipeline.values.run import State


def steps_before_crossing(scene: Scene, steps: Sequence[fem.Step]) -> tuple[Sequence[fem.Step], tuple[Reason, ...]]:
    """The steps before the body passes through itself where no contact is simulated, and where it does, if so.

    Where contact is switched off it may.
    """
    if scene.config.effects.self_contact.off:
        return steps, ()
    for count, step in enumerate(steps):
        if reason := fem.self_intersection(step.space, step.positions, scene.body.half):
            return steps[:count], (reason,)
    return steps, ()


def with_falls_sideways(
    scene: Scene, experiment: fem.Experiment, model: fem.Model, steps: Sequence[fem.Step]
) -> Sequence[fem.Step]:
    """The steps with what makes half a body under its weight or a force fall out of its plane."""
    if not (scene.body.half and (scene.config.effects.gravity.on or any(experiment.force))):
        return steps
    sideways = experiment.falls_sideways(model, steps)
    return [replace(step, instability=(*step.instability, *why)) for step, why in zip(steps, sideways, strict=True)]


def record_of(
    scene: Scene, experiment: fem.Experiment, case: LoadCase, pressure_kPa: float, step: fem.Step, cpu_seconds: float
) -> Record:
    """The state of an experiment at a pressure."""
    force = experiment.end_force(step)
    return Record(
        state=_state(scene, experiment, pressure_kPa, step),
        centreline=experiment.centreline(step),
        load=replace(scene.weight, force=(float(force[0]), float(force[1])), couple=experiment.end_couple(step)),
        displacement=step.displacement,
        fields=fem.element_fields(step, scene.material),
        effects=step.effects,
        spent=step.spent,
        held=case.held,
        cpu_seconds=cpu_seconds,
        inexact=step.inexact,
        path_dependence=step.path_dependence,
        instability=step.instability,
    )


def _state(scene: Scene, experiment: fem.Experiment, pressure_kPa: float, step: fem.Step) -> State:
    """The row of a state; forces, moments and volumes are those of the full body."""
    material, extremes = scene.material, step.extremes
    end, force, clamp = experiment.end(step), experiment.end_force(step), experiment.clamp_force(step)
    error = fem.stress_error(step, material)
    cavities = scene.config.effects.pressure.following or experiment.body.cavities[:1]
    air = sum(step.cavity_volume(name) for name in cavities)
    contact_mm, contact_N = contact_error(experiment, step)
    doubts = (*fem.unstable_stretches(step.space, step.displacement, material), *step.instability)
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
        end_rotation_deg=degrees(experiment.end_rotation(step)),
        curve_z_mm=experiment.distance_from_plane(step),
        min_J=extremes.min_J,
        max_stretch=extremes.max_stretch,
        min_stretch=extremes.min_stretch,
        min_J_at_mm=extremes.min_J_at,
        max_stretch_at_mm=extremes.max_stretch_at,
        min_stretch_at_mm=extremes.min_stretch_at,
        min_gap_mm=nan if isinf(step.min_gap) else step.min_gap,
        contact_error_mm=contact_mm,
        contact_error_N=contact_N,
        stress_error=error.energy,
        stress_error_at_mm=error.worst_at,
        negative_pivots=step.negative_pivots,
        newton_iterations=step.newton_iterations,
        factorizations=step.factorizations,
        cutbacks=step.cutbacks,
        seconds=step.seconds,
        reason=render_all((*doubts, *_doubts_on_contact(step, contact_mm, contact_N))),
    )


def contact_error(experiment: fem.Experiment, step: fem.Step) -> tuple[float, float]:
    """How far a state is from the equilibrium with exact distances between walls (`fem.Step.exact`): distance of the
    two ends in mm, difference of the two forces on the end in N; NaN where there is no such equilibrium or no need of
    it."""
    if step.exact is None:
        return nan, nan
    exact = replace(step, displacement=step.exact.displacement, gradient=step.exact.gradient)
    end = np.linalg.norm(np.subtract(experiment.end(exact), experiment.end(step)))
    force = np.linalg.norm(np.subtract(experiment.end_force(exact), experiment.end_force(step)))
    return float(end), float(force)


def _doubts_on_contact(step: fem.Step, error_mm: float, error_N: float) -> Iterator[Reason]:
    """Contact that is approximate, and contact in creases that depends on the load steps."""
    if step.inexact:
        yield Reason("contact_error_unknown", {"why": list(step.inexact)})
    elif step.exact is not None:
        yield Reason("contact_error", {"end_mm": error_mm, "end_N": error_N})
    if isinf(step.path_dependence):
        yield Reason("may_depend_on_load_steps")
    elif step.path_dependence:
        yield Reason("depends_on_load_steps", {"percent": 100 * step.path_dependence})
