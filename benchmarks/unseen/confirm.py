"""Whether a limit that a run has named is one: by a prescribed volume, or by a second law.

With the volume of the cavity prescribed the pressure is an unknown, and the path goes through a limit point of it. If
the pressure on this path has a maximum near the named limit and falls behind it, there is no equilibrium beyond on that
path. Where the volume cannot be driven that far either, the same body of another law is solved up to the pressure that
was not reached: it either ends near the same pressure, or goes on, at least well beyond the limit, where the sentence
names the law itself as the cause.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import fem
from pipeline.config.config import Config, Material
from pipeline.context import RunContext
from pipeline.progress import Silent
from pipeline.simulation.failure import Failure
from pipeline.simulation.loadcase import LoadCase, schedule
from pipeline.simulation.outcome import Outcome
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import open_store

#: largest difference between the highest pressure with a prescribed volume and the named limit, or the last equilibrium
NEAR = 0.05
#: two laws with the same moduli have their limits this close where the body and not the law is the cause
NEAR_OF_LAWS = 0.25
#: volumes that are prescribed beyond the last state, each larger by this part of what the first order expects up to the
#: limit; the slope of the volume grows towards a limit point
VOLUMES, STEP = 24, 0.35
#: what in the sentence of a limit names the law, in compression and in tension (`fem.outside_stable_range`)
OF_LAW = ("is no longer stable", "the largest at which the law")


@dataclass(frozen=True)
class Confirmation:
    """What a second way says about a limit."""

    experiment: str
    limit_kPa: float  #: as the run names it, or its last equilibrium
    confirmed: bool
    sentence: str  #: by what, or why not

    def record(self) -> dict[str, Any]:
        """For a JSON file."""
        return asdict(self)


def named_limit(failure: Failure) -> float:
    """The pressure (kPa) of the named limit, or of the last equilibrium; 0 where the body passes through itself."""
    return 0.0 if failure.passes_through_itself else failure.limit_kPa or failure.reached_kPa


def confirmed(config: Config, outcome: Outcome, folder: Path) -> Confirmation:
    """Whether the limit at which an experiment ended is one."""
    failure = outcome.failure
    assert failure is not None
    limit = named_limit(failure)
    by_volume = by_prescribed_volume(config, outcome, limit) if limit else "no pressure of a limit is named"
    if not by_volume.startswith("no"):
        return Confirmation(outcome.name, limit, True, by_volume)
    by_law, agrees = by_second_law(config, failure, limit, outcome.name, folder)
    return Confirmation(outcome.name, limit, agrees, f"{by_law}; prescribed volume: {by_volume}")


def by_prescribed_volume(config: Config, outcome: Outcome, limit_kPa: float) -> str:
    """How the pressure turns on the path of a prescribed volume; begins with "no" where it does not near the limit."""
    scene = Scene.meshed(config)
    reference = config.pressures_kPa[-1]
    at_end = config.end
    experiment = fem.Experiment.of(outcome.name, scene.body, at_end.y_mm, at_end.force_N, at_end.x_mm)
    model = experiment.model(scene.material, scene.effects(reference / 1000.0), config.mesh.formulation)
    cavity = scene.body.cavities[0]
    # a state shortly before the limit, on the way of the run
    begin = 0.9 * limit_kPa / reference
    try:
        start = fem.follow(model, [0.5 * begin, begin]).steps
    except fem.NotConverged as failed:
        return f"no state at 90 % of the limit ({failed.reason})"
    volumes = [step.cavity_volume(cavity) for step in start]
    slope = (volumes[1] - volumes[0]) / (start[1].factor - start[0].factor)
    change = STEP * slope * (limit_kPa / reference - begin)
    targets = [volumes[1] + change * (1 + k / 8) * k for k in range(1, VOLUMES + 1)]
    path: list[fem.Step] = []
    observer = fem.PathObserver(step_done=path.append)
    first = replace(start[-1], rate=None)  # its rate is one by the load factor
    try:
        _until_turned(model, cavity, volumes[1], targets, first, observer, path)
        why = f"it still rises at {reference * path[-1].factor:.4g} kPa" if path else "nothing was solved"
    except fem.NotConverged as failed:
        why = f"it ended: {failed.reason}"
    return turned([reference * step.factor for step in (first, *path)], limit_kPa, why)


def _until_turned(
    model: fem.Model,
    cavity: str,
    volume: float,
    targets: Sequence[float],
    first: fem.Step,
    observer: fem.PathObserver,
    path: list[fem.Step],
) -> None:
    """Drive the volume in parts of four, and stop when the pressure has fallen behind its maximum."""
    for k in range(0, len(targets), 4):
        fem.follow_volume(model, cavity, [volume, *targets[: k + 4]], None, observer, resume=[first, *path])
        highest = max(step.factor for step in path)
        if path[-1].factor < 0.998 * highest:
            return


def turned(pressures_kPa: Sequence[float], limit_kPa: float, otherwise: str) -> str:
    """What pressures along growing volumes say about a limit; begins with "no" where they do not confirm it."""
    highest = max(pressures_kPa)
    if pressures_kPa[-1] >= highest:
        return f"no maximum of the pressure up to {highest:.4g} kPa: {otherwise}"
    if abs(highest - limit_kPa) > NEAR * limit_kPa:
        return f"no agreement: with a prescribed volume the pressure has its maximum at {highest:.4g} kPa"
    return f"with a prescribed volume the pressure has its maximum at {highest:.4g} kPa and falls behind it"


def second_law(config: Config) -> Config:
    """The same design of another law with the same moduli at small strain: Hencky for neo-Hooke, else neo-Hooke."""
    law = config.material.built()
    mu, nu = law.shear_modulus, law.poisson_ratio
    if config.material.law == "neo_hooke":
        constants, name = {"E": 2.0 * mu * (1.0 + nu), "nu": nu}, "hencky"
    else:
        constants, name = {"mu": mu, "kappa": 2.0 * mu * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))}, "neo_hooke"
    return replace(config, material=Material(name, constants, config.material.density_tonne_mm3))


def by_second_law(
    config: Config, failure: Failure, limit_kPa: float, experiment: str, folder: Path
) -> tuple[str, bool]:
    """What a second law does at the pressure that was not reached, and whether that confirms the limit."""
    other = second_law(config)
    reached = tuple(p for p in config.pressures_kPa if p <= failure.pressure_kPa)
    case = LoadCase(experiment, experiment, schedule(other, reached), other.end)
    with open_store(folder / other.material.law, other) as store:
        outcome = simulate(Scene.meshed(other), RunContext.alone(store, Silent()), [case])[experiment]
    return judged(failure, limit_kPa, other.material.law, outcome.failure)


def judged(failure: Failure, limit_kPa: float, law: str, of_second: Failure | None) -> tuple[str, bool]:
    """Whether the outcome of a second law confirms a limit, in words and as a truth value.

    of_second: why the second law did not reach the pressure; None where it did.
    """
    of_law = any(words in failure.reason for words in OF_LAW)
    if of_second is None:
        return f"with {law} the pressure is reached" + (", so the law is the cause" if of_law else ""), of_law
    if failure.passes_through_itself and of_second.passes_through_itself:
        return f"with {law} the body passes through itself as well", True
    other = named_limit(of_second)
    if other and limit_kPa and abs(other - limit_kPa) <= NEAR_OF_LAWS * limit_kPa:
        return f"with {law} the limit is at {other:.4g} kPa", True
    if of_law and limit_kPa and other > (1.0 + NEAR_OF_LAWS) * limit_kPa:
        return f"with {law} the path goes on to {other:.4g} kPa, so the law is the cause", True
    where = f"at {other:.4g} kPa" if other else "without a pressure of a limit"
    return f"with {law} the path ends {where}", False
