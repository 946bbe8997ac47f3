"""Checks that can tell a wrong state: each compares it with a number that another way leads to.

On experiments II and III, at the highest pressure that was reached: other load steps and the balance of work. On II, at
the lowest pressure: the whole body instead of its half, and other elements on the same mesh.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.interpolate import BPoly

import fem
from fem.effects.loads import enclosed_volume, volume_gradient
from fem.elements import ELEMENTS
from fem.path.active_set import ActiveSet
from pipeline.config.config import Config
from pipeline.simulate.loadcase import LoadCase, has_height_alone, schedule
from pipeline.simulate.outcome import Record
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.errors import InputError, RunFailed
from pipeline.values.pressure import in_MPa
from pipeline.values.reasons import render_all

#: the checks in their order, with the largest difference that is no error. Steps: the largest distance between the
#: material curves over the length; half: the difference of the end's position over the length, as in `make hard`.
#: Work: over the work; the quadrature over four pressures has 0.1 to 0.3 %. Elements: the difference of the end's
#: displacement over that displacement, or over a twentieth of the length where it moves less; elements of lower order
#: are too soft by up to 20 % on such meshes (README, limits)
ALLOWED = {
    "load steps": 1e-5,
    "work": 0.01,
    "load steps of III": 1e-5,
    "work of III": 0.01,
    "half and whole": 1e-5,
    "other elements": 0.2,
}
#: displacement of the end over the length below which the difference of elements is judged by this one
SMALL = 0.05
#: how often the steps are halved at most along which the work of the pressure is integrated
HALVINGS = 3
#: why the balance of work is not checked
WORK_ON_END = "a force or a support does work on the end"
#: a pressure near rest, over the lowest one
NEAR_REST = 0.02
#: elements that are compared with each element; without a difference at the volumetric part that of lower order
OTHER = {"mixed": "p2p0", "p2p0": "mixed", "p2": "mixed"}


@dataclass(frozen=True)
class Check:
    """A number of a state and what another way gives for it."""

    name: str  #: one of ALLOWED
    pressure_kPa: float
    value: float | None  #: the difference, as in ALLOWED; None where it could not be made
    note: str = ""  #: why it could not be made

    @property
    def passed(self) -> bool:
        """Whether the difference is allowed. A check that was not made has not passed."""
        return self.value is not None and self.value <= ALLOWED[self.name]

    @property
    def failed(self) -> bool:
        """Whether it says that the state is wrong."""
        return self.value is not None and not self.passed


def checks_of(config: Config, free: Sequence[Record], held: Sequence[Record], folder: Path) -> tuple[Check, ...]:
    """All checks of the states of II and III that a run has reached; none where it has reached none."""
    ways: list[tuple[tuple[str, ...], Record, Callable[..., tuple[float | None, ...]]]] = []
    if free:
        ways.append((("load steps", "work"), free[-1], _steps_and_work))
    if held:
        ways.append((("load steps of III", "work of III"), held[-1], _steps_and_work))
    if free:
        ways += [(("half and whole",), free[0], _whole), (("other elements",), free[0], _other_elements)]
    checks: list[Check] = []
    for names, state, way in ways:
        values: tuple[float | None, ...]
        try:
            values, note = way(config, state, folder), ""
        except (InputError, RunFailed, fem.NotConverged, _NotSolved) as failure:
            values, note = (None,) * len(names), str(failure)
        checks += [
            Check(name, state.pressure_kPa, v, note or (WORK_ON_END if v is None else ""))
            for name, v in zip(names, values, strict=True)
        ]
    return tuple(checks)


class _NotSolved(Exception):
    """The other way did not lead to the pressure."""


def _steps_and_work(config: Config, state: Record, folder: Path) -> tuple[float, float | None]:
    """The pressure by twice as many steps at least, and the work of the pressure along them.

    The end of III is held at its height at rest, so that its support does no work; the work is None where it is not.

    Where the work differs from the energy, it is integrated along twice as many steps, because thin walls bulge at a
    fraction of the lowest pressure; `HALVINGS` times at most.
    """
    has_rest_height_alone = has_height_alone(config.end) and config.end.y_mm == 0.0
    scene = Scene.meshed(config)
    below = [*(p for p in config.pressures_kPa if p < state.pressure_kPa), state.pressure_kPa]
    experiment, differences = _experiment(scene, state.experiment), []
    # the first gives the slope near rest
    path, top = [NEAR_REST * below[0], *below], config.pressures_kPa[-1]
    for _ in range(HALVINGS + 1):
        path = sorted({*path, *(0.5 * (a + b) for a, b in pairwise([0.0, *path[1:]]))})
        model, steps = followed(scene, experiment, [p / top for p in path])
        curve, of_run = experiment.centreline(steps[-1]), state.centreline
        distance = np.hypot(curve.x - of_run.x, curve.y - of_run.y)
        differences.append(float(distance.max()) / config.design.length)
        work = work_difference(model, steps, in_MPa(top), scene.body.cavities[0])
        if work <= ALLOWED["work"]:
            break
    return max(differences), work if state.experiment == "II" or has_rest_height_alone else None


def _experiment(scene: Scene, name: str) -> fem.Experiment:
    end = scene.config.end
    return fem.Experiment.of(name, scene.body, end.y_mm, end.force_N, end.x_mm)


def followed(
    scene: Scene, experiment: fem.Experiment, factors: Sequence[float]
) -> tuple[fem.Model, Sequence[fem.Step]]:
    """An experiment at load factors, without a run's knowledge of limits. Raises `fem.NotConverged`."""
    effects = scene.effects(in_MPa(scene.config.pressures_kPa[-1]))
    model = experiment.model(scene.material, effects, scene.config.mesh.formulation)
    return model, fem.follow(model, factors).steps


def work_difference(model: fem.Model, steps: Sequence[fem.Step], pressure_MPa: float, cavity: str) -> float:
    """The stored energy of the last step less the work of the pressure along all of them, over that work.

    The work is the integral of p dV = [p V] - integral of V dp; V(p) has the values and the slopes of all steps. The
    energy is that of the elements, with the potential of contact. The end is free or held in place, so no other force
    works.
    """
    system = model.system()
    try:
        last, pressures, volumes = steps[-1], [0.0], [[_volume_at_rest(model, cavity)]]
        for step in steps:
            slope = [] if step.rate is None else [_volume_rate(step, cavity)]
            pressures.append(step.factor)
            volumes.append([step.cavity_volume(cavity), *slope])
        below = float(BPoly.from_derivatives(pressures, volumes).integrate(0.0, last.factor))
        work = pressure_MPa * (last.factor * volumes[-1][0] - below)
        active_set = ActiveSet.of_step(system.terms, last)
        # without a load factor the pressure has no potential, and what is left is stored in the body
        stored = system.energy(last.displacement, 0.0, active_set.active)
        return abs(stored - work) / abs(work)
    finally:
        system.solver.close()


def _volume_at_rest(model: fem.Model, cavity: str) -> float:
    return enclosed_volume(model.space.surface(cavity), model.space.points)


def _volume_rate(step: fem.Step, cavity: str) -> float:
    """mm3 per load factor."""
    assert step.rate is not None
    gradient = volume_gradient(step.space.surface(cavity), step.positions)
    return float(np.vdot(gradient, step.rate.displacement)) / step.rate.factor


def _whole(config: Config, state: Record, folder: Path) -> tuple[float]:
    """The whole body without its plane of symmetry."""
    other = _solved(config.with_effect("symmetry", "off"), state.pressure_kPa, folder / "whole")
    return (_moved(other.state.end_mm, state) / config.design.length,)


def _other_elements(config: Config, state: Record, folder: Path) -> tuple[float]:
    """Other elements on the same mesh."""
    other_name = OTHER[ELEMENTS[config.mesh.formulation].name]
    mesh = replace(config.mesh, formulation=other_name)
    other = _solved(replace(config, mesh=mesh), state.pressure_kPa, folder / other_name)
    rest = (config.design.length, config.design.curve_y)
    displacement = float(np.hypot(*np.subtract(state.state.end_mm, rest)))
    return (_moved(other.state.end_mm, state) / max(displacement, SMALL * config.design.length),)


def _solved(config: Config, pressure_kPa: float, folder: Path) -> Record:
    """Experiment II of a changed configuration at one pressure, in one step from rest."""
    case = LoadCase("II", "II", schedule(config, (pressure_kPa,)), config.end)
    with open_store(folder, config) as store:
        outcome = simulate(Scene.meshed(config), RunContext.alone(store, Silent()), [case])["II"]
    if outcome.failure:
        raise _NotSolved(render_all(outcome.failure.reasons))
    return outcome.records[0]


def _moved(end_mm: tuple[float, ...], state: Record) -> float:
    """Distance (mm) between the ends of two states."""
    return float(np.hypot(*np.subtract(end_mm, state.state.end_mm)))
