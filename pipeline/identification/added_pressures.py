"""Where the numbers are linear in the pressure, and pressures added by bisection where they are not."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import fem
from pipeline.context import RunContext
from pipeline.identification.parameters import Parameters, identify_all
from pipeline.simulation.loadcase import up_to
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import EXPERIMENTS, Outcome, simulate
from rod import LinearRange, linear_range, next_pressure

Quantities = dict[str, tuple[list[float], list[float]]]


def quantities_of(found: Sequence[Parameters]) -> tuple[list[float], Quantities]:
    """Pressures (kPa) and what is tested for linearity: alpha1, alpha2 (N mm2) and kappa_0(l/2) (1/mm) with their
    standard deviations."""
    quantities: Quantities = {"alpha1": ([], []), "alpha2": ([], []), "kappa_0": ([], [])}
    for p in found:
        for name in ("alpha1", "alpha2"):
            quantities[name][0].append(p.numbers_without_mesh[name].value)
            quantities[name][1].append(p.numbers_without_mesh[name].std)
        middle = abs(p.kappa_0.s - p.kappa_0.length / 2).argmin()
        quantities["kappa_0"][0].append(float(p.kappa_0.kappa[middle]))
        quantities["kappa_0"][1].append(float(p.kappa_0.kappa_std[middle]))
    return [p.pressure_kPa for p in found], quantities


def covered_range(found: Sequence[Parameters]) -> LinearRange | None:
    """The pressures that straight lines cover, or None."""
    pressures, quantities = quantities_of(found)
    return linear_range(pressures, quantities)


def with_added_pressures(
    scene: Scene,
    context: RunContext,
    outcomes: Mapping[str, Outcome],
    found: tuple[Parameters, ...],
) -> tuple[dict[str, Outcome], tuple[Parameters, ...], tuple[str, ...]]:
    """Outcomes and numbers with up to `added_pressures` more pressures, each where it says most about the range,
    and a sentence where one could not be had.

    Nothing is added to a run that stopped early, and no pressure after one that fails. Raises RunFailed as `simulate`.
    """
    outcomes = dict(outcomes)
    for _ in range(scene.config.added_pressures):
        pressure = next_pressure([p.pressure_kPa for p in found], covered_range(found))
        if pressure is None or any(outcome.failure for outcome in outcomes.values()):
            break
        cases = [up_to(scene.config, name, pressure) for name in EXPERIMENTS]
        more = simulate(scene, context, cases)
        stopped = [f"no pressure was added at {pressure:g} kPa: {one.failure}" for one in more.values() if one.failure]
        if stopped:
            return outcomes, found, tuple(stopped)
        outcomes = {name: merged(outcomes[name], more[name]) for name in outcomes}
        only = {name: replace(one, records=one.records[-1:]) for name, one in more.items()}
        new, refused = identify_all(only, scene.body.pitch)
        if refused:
            return outcomes, found, refused
        found = tuple(sorted((*found, *new), key=lambda p: p.pressure_kPa))
    return outcomes, found, ()


def merged(first: Outcome, more: Outcome) -> Outcome:
    """One outcome with the records of both; what `more` took up from `first` counts once."""
    known = {record.pressure_kPa for record in first.records}
    new = [record for record in more.records if record.pressure_kPa not in known]
    spent = sum((record.spent for record in new), fem.Seconds(set_up=more.seconds.set_up))
    return replace(
        first,
        records=tuple(sorted((*first.records, *new), key=lambda record: record.pressure_kPa)),
        seconds=first.seconds + spent,
        factorizations=first.factorizations + sum(record.row["factorizations"] for record in new),
    )
