"""The rod under loads that its parameters were not fitted to."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import dist, isfinite

import numpy as np

from geometry import Reason, Values
from pipeline.config.config import Config
from pipeline.identify.compare import ArmRods, Comparison, compare_rods, curve_of
from pipeline.simulate.loadcase import LoadCase, validation_cases
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.values.run import Curve
from rod.same_pressure import is_among


@dataclass(frozen=True)
class Validated:
    """The results at the loads out of sample."""

    comparisons: tuple[Comparison, ...] = ()
    failures: tuple[Reason, ...] = ()  #: one for each load that was not solved

    @property
    def curves(self) -> tuple[Curve, ...]:
        """The curves of validation_curves.csv."""
        return tuple(curve_of(c.record, c, c.pitch) for c in self.comparisons)


def keep_reached_loads(scene: Scene, outcomes: Outcomes) -> Scene:
    """The scene with the validation load that the program chooses among the pressures that II and III have reached, or
    with those of the configuration up to the highest pressure that II has reached.

    Behind a limit they would take long to end without a result, and there is no rod to compare them with.
    """
    validation = scene.config.validation.among(outcomes.reached_kPa).up_to(_highest_of_II(outcomes))
    held, curves = scene.config.end.y_mm or 0.0, [record.centreline for record in outcomes["II"].records[:1]]
    # whether the end of the free arm has moved above the height at which it is held in III
    is_held_down = any(curve.y[-1] - curve.y[0] > held for curve in curves)
    validation = validation.beyond(held, is_held_down=is_held_down)
    validation = validation.with_small_forces(_force_of_rigidity(outcomes, validation.pressures_kPa))
    return replace(scene, config=replace(scene.config, validation=validation))


def find_loads_beyond_II(config: Config, outcomes: Outcomes) -> tuple[Reason, ...]:
    """The requested loads that `keep_reached_loads` leaves out; the one that the program chooses is not requested."""
    if config.law == "cell" or not config.validation.with_experiments:
        return ()
    highest, end = _highest_of_II(outcomes), outcomes.lowest_end_kPa("II")
    reasons = []
    for case in validation_cases(config):
        of_run = () if case.load else config.pressures_kPa  # on the path to a pressure between
        left_out = [p for p in case.schedule.pressures_kPa if p > highest and not is_among(of_run, p)]
        if left_out:
            end_kPa = end if isfinite(end) else highest
            values: Values = {"load": case.load or case.name, "pressures_kPa": left_out, "end_kPa": end_kPa}
            reasons.append(Reason("load_left_out", values))
    return tuple(reasons)


def _force_of_rigidity(outcomes: Outcomes, pressures_kPa: tuple[float, ...]) -> float:
    """EI / l^2 in N from the force and the displacement of the end in III against II, as of a straight cantilever.

    At the pressure of both experiments nearest to the first of these, the lower of two; 0 where there is none.
    """
    if not (pressures_kPa and outcomes.pairs):
        return 0.0
    # rounded, so that the last digit of a pressure does not choose between two that are equally near
    free, loaded = min(outcomes.pairs, key=lambda pair: round(abs(pair[0].pressure_kPa - pressures_kPa[0]), 6))
    ends = (np.array([record.centreline.x[-1], record.centreline.y[-1]]) for record in (free, loaded))
    moved = dist(*ends)
    force = float(np.linalg.norm(loaded.load.force))
    return force * free.centreline.length / (3.0 * moved) if moved > 0.0 else 0.0


def _highest_of_II(outcomes: Outcomes) -> float:
    """The highest pressure that II has reached, 0 where none, kPa."""
    return max((record.pressure_kPa for record in outcomes["II"].records), default=0.0)


def validate(scene: Scene, outcomes: Outcomes, rods: ArmRods) -> Validated:
    """Compare the rods with the solved validation loads."""
    cases = {case.name: case for case in validation_cases(scene.config)}
    stopped = (outcome.why_stopped(cases[outcome.name].load or outcome.name) for outcome in outcomes)
    comparisons = _comparisons(scene, cases, outcomes, rods)
    return Validated(comparisons, tuple(filter(None, stopped)))


def _comparisons(
    scene: Scene,
    cases: Mapping[str, LoadCase],
    outcomes: Outcomes,
    rods: ArmRods,
) -> tuple[Comparison, ...]:
    comparisons = []
    for outcome in outcomes:
        load = cases[outcome.name].load
        for record in outcome.records:
            if not load and not is_among(scene.config.validation.pressures_kPa, record.pressure_kPa):
                continue  # on the path to a pressure between
            if not load and is_among(rods.identified_kPa, record.pressure_kPa):
                continue  # in sample
            at_pressure = rods.at(record.pressure_kPa)
            comparisons.append(compare_rods(at_pressure, record, scene.body.pitch, load, in_sample=False))
    return tuple(sorted(comparisons, key=lambda c: (c.record.pressure_kPa, c.load)))
