"""The range of pressures in which the parameters are linear in the pressure, and pressures added by bisection."""

from collections.abc import Sequence
from dataclasses import dataclass

from geometry import Reason
from pipeline.identify.parameters import Parameters, counts_as_equal_cells, decide_together, identify_all
from pipeline.simulate.loadcase import case_up_to
from pipeline.simulate.outcome import Outcomes
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import experiments_of, simulate
from pipeline.simulate.too_short import too_coarse, too_short
from pipeline.store.context import RunContext
from rod import LinearRange, Quantity, linear_range, next_pressure


@dataclass(frozen=True)
class Identified:
    """The parameters of a run, and its outcomes with the pressures that were added."""

    outcomes: Outcomes
    parameters: tuple[Parameters, ...]  #: by ascending pressure
    refused: tuple[Reason, ...] = ()  #: why there are no parameters, or none at a pressure
    not_added: tuple[Reason, ...] = ()  #: why pressures could not be added

    def failures(self, other_rod: bool) -> tuple[Reason, ...]:
        """What makes the run fail: a pressure without parameters only where there are no others and no other rod."""
        return self.not_added if self.parameters or other_rod else (*self.refused, *self.not_added)

    def remarks(self, other_rod: bool) -> tuple[Reason, ...]:
        """The other reasons."""
        return self.refused if self.parameters or other_rod else ()


def identify_run(scene: Scene, context: RunContext, outcomes: Outcomes) -> Identified:
    """The parameters at all pressures and at those to be added.

    Raises RunFailed as `simulate`.
    """
    if reason := too_short(scene.config) or too_coarse(scene.config, scene.body):
        return Identified(outcomes, (), (reason,))
    parameters, refused = _identified(scene, context, outcomes)
    outcomes, parameters, not_added = with_added_pressures(scene, context, outcomes, parameters)
    return Identified(outcomes, parameters, refused, not_added)


def _identified(
    scene: Scene, context: RunContext, outcomes: Outcomes
) -> tuple[tuple[Parameters, ...], tuple[Reason, ...]]:
    equal, d = counts_as_equal_cells(scene.config.design), scene.config.identification.d_mm
    return identify_all(outcomes, scene.body.pitch, d, equal_cells=equal, context=context)


def quantities_of(parameters: Sequence[Parameters]) -> tuple[list[float], dict[str, Quantity]]:
    """Pressures (kPa) and what is tested for linearity: alpha1, alpha2 (N mm2) and kappa_0(l/2) (1/mm) with their
    standard deviations."""
    intervals = {name: [p.numbers_without_mesh[name] for p in parameters] for name in ("alpha1", "alpha2")}
    quantities = {name: Quantity([i.value for i in row], [i.std for i in row]) for name, row in intervals.items()}
    middles = [p.kappa_0.middle for p in parameters]
    quantities["kappa_0"] = Quantity(middles, [p.kappa_0.middle_std for p in parameters])
    return [p.pressure_kPa for p in parameters], quantities


def covered_range(parameters: Sequence[Parameters]) -> LinearRange | None:
    """The range of pressures in which straight lines hold; None where there is none."""
    pressures, quantities = quantities_of(parameters)
    return linear_range(pressures, quantities)


def with_added_pressures(
    scene: Scene,
    context: RunContext,
    outcomes: Outcomes,
    parameters: tuple[Parameters, ...],
) -> tuple[Outcomes, tuple[Parameters, ...], tuple[Reason, ...]]:
    """Outcomes and parameters with up to `added_pressures` more pressures, each where it says most about the range of
    linearity, and why a pressure could not be added.

    Nothing is added to a run that stopped early, and no pressure after one that fails. Raises RunFailed as `simulate`.
    """
    for _ in range(scene.config.added_pressures):
        pressure = next_pressure([p.pressure_kPa for p in parameters], covered_range(parameters))
        if pressure is None or outcomes.failures:
            break
        cases = [case_up_to(scene.config, name, pressure) for name in experiments_of(scene.config)]
        more = simulate(scene, context, cases)
        if ended := [list(outcome.failure.reasons) for outcome in more if outcome.failure]:
            stopped = (Reason("pressure_not_added", {"pressure_kPa": pressure, "why": why}) for why in ended)
            return outcomes, parameters, tuple(stopped)
        outcomes = outcomes.merged(more)
        newest = more.newest
        new, refused = _identified(scene, context, newest)
        if refused:
            return outcomes, parameters, refused
        parameters = decide_together(sorted((*parameters, *new), key=lambda p: p.pressure_kPa))
    return outcomes, parameters, ()
