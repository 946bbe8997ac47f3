"""The rod under loads that its numbers were not fitted to, and the laws that such loads tell apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.context import RunContext
from pipeline.identification.parameters import Parameters, observed
from pipeline.simulation.loadcase import LoadCase, validation_cases
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.store import Store
from pipeline.validation.compare import CURVE_COLUMNS, Comparison, Rods, held_against, rows_of
from rod import PressurisedRod, Rod, RodError, compare_laws, simplest

VALIDATION_COLUMNS = ("load", *CURVE_COLUMNS)


@dataclass(frozen=True)
class Validated:
    """What the loads out of sample say."""

    comparisons: tuple[Comparison, ...]
    failures: tuple[str, ...]  #: a sentence for each load that was not solved
    laws: tuple[Mapping[str, Any], ...]  #: rows: pressure, law, its numbers, errors, whether it is the simplest

    def save(self, store: Store, in_sample: Sequence[Comparison]) -> None:
        """Write validation.json (what is in sample first), laws.json and validation_curves.csv."""
        store.save_json("validation.json", [one.row() for one in (*in_sample, *self.comparisons)])
        store.save_json("laws.json", self.laws)
        rows = [(one.load, *row) for one in self.comparisons for row in rows_of(one.record, one.shape, one.pitch)]
        store.save_rows("validation_curves.csv", VALIDATION_COLUMNS, rows)


def validate(scene: Scene, context: RunContext, found: Sequence[Parameters]) -> Validated:
    """Solve the validation loads of the configuration and compare the rod with them; nothing where there are none.

    Raises RunFailed as `simulate` does.
    """
    cases = {case.name: case for case in validation_cases(scene.config)}
    if not cases or not found:
        return Validated((), (), ())
    outcomes = simulate(scene, context, list(cases.values()))
    failures = tuple(
        outcome.failure_sentence(f"validation {cases[outcome.name].load or outcome.name}")
        for outcome in outcomes
        if outcome.failure
    )
    comparisons = _comparisons(scene, cases, outcomes, found)
    return Validated(comparisons, failures, _laws(found, comparisons))


def rods_between(found: Sequence[Parameters], pressure: float) -> Rods:
    """The identified rods at a pressure (kPa), between the identified ones by straight lines. Raises RodError."""
    inextensible = _between(found, [one.rod for one in found])
    extensible = _between(found, [one.extensible_rod for one in found])
    moment_range = inextensible.moment_range_at(pressure)
    if moment_range is None:
        raise RodError("The range of moments of the identification is missing.")
    return Rods(inextensible.at(pressure), extensible.at(pressure), moment_range)


def _between(found: Sequence[Parameters], rods: Sequence[Rod]) -> PressurisedRod:
    return PressurisedRod(
        rods[0].length,
        np.array([one.pressure_kPa for one in found]),
        tuple(rod.law for rod in rods),
        np.asarray(rods[0].kappa_0)[:, 0],
        np.array([np.asarray(rod.kappa_0)[:, 1] for rod in rods]),
        np.array([rod.theta0 for rod in rods]),
        rods[0].start,
        tuple(rod.extension for rod in rods if rod.extension is not None),
        tuple(one.moment_range for one in found),
    )


def _comparisons(
    scene: Scene,
    cases: Mapping[str, LoadCase],
    outcomes: Outcomes,
    found: Sequence[Parameters],
) -> tuple[Comparison, ...]:
    rows = []
    for outcome in outcomes:
        load = cases[outcome.name].load
        for record in outcome.records:
            if not load and record.pressure_kPa not in scene.config.validation.pressures_kPa:
                continue  # the way to a pressure between
            if not load and record.pressure_kPa in {one.pressure_kPa for one in found}:
                continue  # added by bisection: in sample
            try:
                rods = rods_between(found, record.pressure_kPa)
            except RodError as failure:
                rows.append(Comparison(record, None, str(failure), scene.body.pitch, load=load, in_sample=False))
                continue
            rows.append(held_against(rods, record, scene.body.pitch, load, in_sample=False))
    return tuple(sorted(rows, key=lambda one: (one.record.pressure_kPa, one.load)))


def _laws(found: Sequence[Parameters], comparisons: Sequence[Comparison]) -> tuple[Mapping[str, Any], ...]:
    """Simpler and richer laws fitted to III and asked for the other loads at the same pressure."""
    rows: list[Mapping[str, Any]] = []
    for one in found:
        others = [c.record for c in comparisons if c.load and c.record.pressure_kPa == one.pressure_kPa]
        if not others:
            continue
        candidates = compare_laws(observed(one, one.loaded), [observed(one, record) for record in others])
        best = simplest(candidates)
        rows.extend(
            {
                "pressure_kPa": one.pressure_kPa,
                "law": candidate.name,
                "numbers": candidate.numbers,
                "in_sample": candidate.in_sample,
                "out_of_sample": candidate.out_of_sample,
                "simplest": candidate is best,
            }
            for candidate in candidates
        )
    return tuple(rows)
