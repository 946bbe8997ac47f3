"""Whether a limit that a run has named is one: by a prescribed volume, or by a second law.

With the volume of the cavity prescribed the pressure is an unknown, and the path goes through a limit point of it. If
the pressure on this path has a maximum near the end of the run and falls behind it, there is no equilibrium beyond on
that path; if it rises well above that end, the end is no limit. Where the volume cannot be driven that far either, the
same body of another law is solved up to the pressure that was not reached: it either names a limit as well, near the
same pressure, or goes on, at least well beyond the limit, where its reasons name the law itself as the cause. A
second law says nothing about an end at which the run itself names no limit.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import fem
from pipeline.config.config import Config, Material
from pipeline.simulate.loadcase import LoadCase, schedule
from pipeline.simulate.outcome import Failure, Outcome
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import simulate
from pipeline.store.context import RunContext
from pipeline.store.progress import Silent
from pipeline.store.store import open_store
from pipeline.values.pressure import in_MPa

#: largest difference between the highest pressure with a prescribed volume and the end of the run, over the latter
NEAR = 0.05
#: two laws with the same moduli have their limits this close where the body and not the law is the cause
NEAR_OF_LAWS = 0.25
#: volumes that are prescribed beyond the last state, each larger by this part of what the first order expects up to the
#: limit; the slope of the volume grows towards a limit point
VOLUMES, STEP = 24, 0.35
#: begin of what a prescribed volume says where it confirms a limit
BY_VOLUME = "with a prescribed volume the pressure has its maximum"

#: code of the reason that nothing explains the end
UNEXPLAINED = "unexplained"
#: codes that name the law, in compression and in tension
OF_LAW = ("stretch_too_small", "stretch_too_large")
#: codes that name a limit: its pressure, a limit point near the last equilibrium, a body that passes through itself
OF_BODY = ("has_limit", "limit_point", "singular_limit_point", "crosses_itself", "crosses_mirror_image")
#: codes of an experiment that ends because II does, whose own reasons decide
BECAUSE_OF_II = ("end_of_II", "followed_near_end_of_II")


@dataclass(frozen=True)
class Confirmation:
    """What a second way says about a limit."""

    experiment: str
    limit_kPa: float  #: as the run names it, or its last equilibrium; 0 where the body passes through itself
    confirmed: bool
    sentence: str  #: by what, or why not


def end_of(failure: Failure) -> float:
    """The pressure (kPa) of the named limit, or of the last equilibrium; 0 where the body passes through itself."""
    return 0.0 if failure.passes_through_itself else failure.limit_kPa or failure.reached_kPa


def confirmed(config: Config, outcome: Outcome, folder: Path) -> Confirmation:
    """Whether the end of an experiment is a limit."""
    failure = outcome.failure
    assert failure is not None
    end = end_of(failure)
    said, agrees = by_prescribed_volume(config, outcome, end) if end else ("no pressure of a limit is named", None)
    if agrees is not None:
        return Confirmation(outcome.name, end, agrees, said)
    by_law, agrees = by_second_law(config, failure, end, outcome.name, folder)
    return Confirmation(outcome.name, end, agrees, f"{by_law}; prescribed volume: {said}")


def by_prescribed_volume(config: Config, outcome: Outcome, limit_kPa: float) -> tuple[str, bool | None]:
    """What the path of a prescribed volume says about a limit, as `turned` has it."""
    scene = Scene.meshed(config)
    reference = config.pressures_kPa[-1]
    at_end = config.end
    experiment = fem.Experiment.of(outcome.name, scene.body, at_end.y_mm, at_end.force_N, at_end.x_mm)
    model = experiment.model(scene.material, scene.effects(in_MPa(reference)), config.mesh.formulation)
    cavity = scene.body.cavities[0]
    # a state shortly before the limit, on the way of the run
    begin = 0.9 * limit_kPa / reference
    try:
        start = fem.follow(model, [0.5 * begin, begin]).steps
    except fem.NotConverged as failed:
        return f"no state at 90 % of the limit ({failed.reason})", None
    volumes = [step.cavity_volume(cavity) for step in start]
    slope = (volumes[1] - volumes[0]) / (start[1].factor - start[0].factor)
    change = STEP * slope * (limit_kPa / reference - begin)
    targets = [volumes[1] + change * (1 + k / 8) * k for k in range(1, VOLUMES + 1)]
    path: list[fem.Step] = []
    first = replace(start[-1], rate=None)  # its rate is one by the load factor
    try:
        _until_turned(model, cavity, volumes[1], targets, first, path)
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
    path: list[fem.Step],
) -> None:
    """Drive the volume in parts of four, and stop when the pressure has fallen behind its maximum."""
    observer = fem.PathObserver(step_done=path.append)
    for k in range(0, len(targets), 4):
        fem.follow_volume(model, cavity, [volume, *targets[: k + 4]], None, observer, resume=[first, *path])
        highest = max(step.factor for step in path)
        if path[-1].factor < 0.998 * highest:
            return


def turned(pressures_kPa: Sequence[float], limit_kPa: float, otherwise: str) -> tuple[str, bool | None]:
    """What pressures along growing volumes say about a limit, and whether that confirms or refutes it, or neither."""
    highest = max(pressures_kPa)
    if _is_beyond(highest, limit_kPa):
        return _refuted(highest), False
    if pressures_kPa[-1] >= highest:
        return f"no maximum of the pressure up to {highest:.4g} kPa: {otherwise}", None
    if highest < (1.0 - NEAR) * limit_kPa:
        return f"no agreement: with a prescribed volume the pressure has its maximum at {highest:.4g} kPa", None
    return f"{BY_VOLUME} at {highest:.4g} kPa and falls behind it", True


def _is_beyond(highest_kPa: float, limit_kPa: float) -> bool:
    """Whether a pressure is too high for a limit; there is none at 0, where no pressure is known."""
    return highest_kPa > (1.0 + NEAR) * limit_kPa > 0.0


def _refuted(highest_kPa: float) -> str:
    return f"with a prescribed volume there are equilibria up to {highest_kPa:.4g} kPa"


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
    is_named, of_law = names_a_limit(failure.codes), names_the_law(failure.codes)
    if of_second is None:
        return f"with {law} the pressure is reached" + (", so the law is the cause" if of_law else ""), of_law
    if failure.passes_through_itself and of_second.passes_through_itself:
        return f"with {law} the body passes through itself as well", True
    other = end_of(of_second)
    if of_law and other > (1.0 + NEAR_OF_LAWS) * limit_kPa > 0.0:
        return f"with {law} the path goes on to {other:.4g} kPa, so the law is the cause", True
    if not other:
        what = "the body passes through itself" if of_second.passes_through_itself else "no pressure is reached"
        return f"with {law} {what}", False
    if not names_a_limit(of_second.codes):
        return f"with {law} the path ends at {other:.4g} kPa, and no limit is named there", False
    there = f"with {law} a limit is named as well, at {other:.4g} kPa"
    if not of_second.limit_kPa:
        there = f"with {law} the path ends at {other:.4g} kPa, and a limit is named there as well"
    if abs(other - limit_kPa) > NEAR_OF_LAWS * limit_kPa:
        return there, False
    return (there, True) if is_named else (f"the run names no limit; {there}", False)


def names_a_limit(codes: Collection[str]) -> bool:
    """Whether reasons say which limit was met, or that the experiment was not followed because of the end of II."""
    return UNEXPLAINED not in codes and any(code in codes for code in (*OF_LAW, *OF_BODY, *BECAUSE_OF_II))


def names_the_law(codes: Collection[str]) -> bool:
    """Whether reasons name the material law as the cause."""
    return any(code in codes for code in OF_LAW)
