"""The rod under loads that its parameters were not fitted to, and the laws that such loads distinguish."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from pipeline.context import RunContext
from pipeline.identification.parameters import Parameters, observed
from pipeline.simulation.loadcase import LoadCase, validation_cases
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import simulate
from pipeline.store.json_values import JsonObject
from pipeline.store.store import Store
from pipeline.validation.compare import (
    CURVE_COLUMNS,
    ComparedState,
    Comparison,
    Rods,
    compare_rods,
    not_compared,
    rows_of,
)
from rod import PressurisedRod, Rod, RodError, compare_laws, simplest

VALIDATION_COLUMNS = ("load", *CURVE_COLUMNS)


@dataclass(frozen=True)
class LawRow:
    """A moment-curvature law fitted to III at one pressure, and its errors at the validation loads."""

    pressure_kPa: float
    law: str
    numbers: int  #: how many are fitted
    in_sample: float  #: error over the data it was fitted to
    out_of_sample: float  #: error at the other loads
    simplest: bool  #: no law with fewer numbers is as good

    def row(self) -> JsonObject:
        """The row of laws.json."""
        return asdict(self)


@dataclass(frozen=True)
class Validated:
    """The results at the loads out of sample."""

    comparisons: tuple[Comparison, ...]
    failures: tuple[str, ...]  #: a sentence for each load that was not solved
    laws: tuple[LawRow, ...]

    def save(self, store: Store, in_sample: Sequence[Comparison]) -> None:
        """Write validation.json (what is in sample first), laws.json and validation_curves.csv."""
        store.save_json("validation.json", [comparison.row() for comparison in (*in_sample, *self.comparisons)])
        store.save_json("laws.json", [law.row() for law in self.laws])
        rows = [(c.state.load, *row) for c in self.comparisons for row in rows_of(c.record, c.shape, c.pitch)]
        store.save_rows("validation_curves.csv", VALIDATION_COLUMNS, rows)


def validate(scene: Scene, context: RunContext, parameters: Sequence[Parameters]) -> Validated:
    """Solve the validation loads of the configuration and compare the rod with them; nothing where there are none.

    Raises RunFailed as `simulate` does.
    """
    cases = {case.name: case for case in validation_cases(scene.config)}
    if not cases or not parameters:
        return Validated((), (), ())
    outcomes = simulate(scene, context, list(cases.values()))
    failures = tuple(
        outcome.failure_sentence(f"validation {cases[outcome.name].load or outcome.name}")
        for outcome in outcomes
        if outcome.failure
    )
    comparisons = _comparisons(scene, cases, outcomes, parameters)
    return Validated(comparisons, failures, _laws(parameters, comparisons))


def rods_between(parameters: Sequence[Parameters], pressure: float) -> Rods:
    """The identified rods at a pressure (kPa), between the identified ones by monotone cubics. Raises RodError."""
    inextensible = _between(parameters, [p.rod for p in parameters])
    extensible = _between(parameters, [p.extensible_rod for p in parameters])
    moment_range = inextensible.moment_range_at(pressure)
    if moment_range is None:
        raise RodError("The range of moments of the identification is missing.")
    return Rods(inextensible.at(pressure), extensible.at(pressure), moment_range)


def _between(parameters: Sequence[Parameters], rods: Sequence[Rod]) -> PressurisedRod:
    return PressurisedRod(
        rods[0].length,
        np.array([p.pressure_kPa for p in parameters]),
        tuple(rod.five for rod in rods),
        np.asarray(rods[0].kappa_0)[:, 0],
        np.array([np.asarray(rod.kappa_0)[:, 1] for rod in rods]),
        np.array([rod.theta0 for rod in rods]),
        rods[0].start,
        tuple(rod.extension for rod in rods if rod.extension is not None),
        tuple(p.moment_range for p in parameters),
    )


def _comparisons(
    scene: Scene,
    cases: Mapping[str, LoadCase],
    outcomes: Outcomes,
    parameters: Sequence[Parameters],
) -> tuple[Comparison, ...]:
    comparisons = []
    for outcome in outcomes:
        load = cases[outcome.name].load
        for record in outcome.records:
            if not load and record.pressure_kPa not in scene.config.validation.pressures_kPa:
                continue  # on the path to a pressure between
            if not load and record.pressure_kPa in {p.pressure_kPa for p in parameters}:
                continue  # added by bisection: in sample
            state = ComparedState(record, load, in_sample=False)
            try:
                rods = rods_between(parameters, record.pressure_kPa)
            except RodError as failure:
                comparisons.append(not_compared(state, str(failure), scene.body.pitch))
                continue
            comparisons.append(compare_rods(rods, state, scene.body.pitch))
    return tuple(sorted(comparisons, key=lambda c: (c.record.pressure_kPa, c.state.load)))


def _laws(parameters: Sequence[Parameters], comparisons: Sequence[Comparison]) -> tuple[LawRow, ...]:
    """Simpler and richer laws fitted to III and tried at the other loads of the same pressure."""
    rows: list[LawRow] = []
    for p in parameters:
        others = [c.record for c in comparisons if c.state.load and c.record.pressure_kPa == p.pressure_kPa]
        if not others:
            continue
        candidates = compare_laws(observed(p, p.loaded), [observed(p, record) for record in others])
        best = simplest(candidates)
        rows.extend(
            LawRow(p.pressure_kPa, law.name, law.parameters, law.in_sample, law.out_of_sample, law is best)
            for law in candidates
        )
    return tuple(rows)
