"""States below its limit for an arm of which II and III reach no pressure of the configuration together."""

from math import inf
from typing import TypeAlias

from geometry import Reason
from pipeline.context import RunContext
from pipeline.parallel import Pending
from pipeline.simulation.known_limit import FIRST
from pipeline.simulation.loadcase import LoadCase, schedule
from pipeline.simulation.outcome import Outcome, Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import experiments_of, simulate
from rod import too_few_pitches

#: the outcomes of the experiments with states below the limit, and a remark on these
Completed: TypeAlias = tuple[Outcomes, Reason | None]

#: pressures over the lower limit of II and III: high enough to say something about the arm as it was to be loaded
PARTS = (0.4, 0.8)
#: digits of these pressures, so that they can be typed
DIGITS = 3


def with_states_below_limit(scene: Scene, context: RunContext, outcomes: Outcomes) -> Completed:
    """The outcomes with states at pressures below the limit, and a remark on them.

    The limit is where one of II and III ended (`Failure.end_kPa`). Unchanged, without a remark, where both have
    reached a pressure of the configuration or neither has an equilibrium but that at rest, and where there would be no
    five parameters (`law: cell`, a short arm), for which alone these states are solved. Raises RunFailed as `simulate`.
    """
    limit = inf if outcomes.pairs else outcomes.lowest_end_kPa("II", "III")
    without_five = scene.config.law == "cell" or too_few_pitches(scene.body.length, scene.body.pitch)
    if limit == inf or without_five:
        return outcomes, None
    pressures = tuple(_rounded(part * limit) for part in PARTS)
    names = experiments_of(scene.config)
    cases = [LoadCase(name, name, schedule(scene.config, pressures), scene.config.end) for name in names]
    more = simulate(scene, context, cases)
    if not more.pairs:
        return outcomes, None
    return outcomes.merged(more), Reason(
        "solved_below_limit", {"reached_kPa": list(more.reached_kPa), "limit_kPa": float(f"{limit:.{DIGITS}g}")}
    )


def complete_experiments(scene: Scene, context: RunContext, second: Pending[Outcome] | None) -> Completed:
    """The outcomes of the experiments of a run, II of which is submitted, with states below the limit, as above."""
    return with_states_below_limit(scene, context, simulate(scene, context, second=second))


def highest_of_use(scene: Scene, second: Pending[Outcome] | None, complete: Pending[Completed]) -> float:
    """Highest pressure in kPa at which a rod of the arm can be compared with experiment II: the largest of its states
    and of the validation loads below its end, or a part of that end where there are none.

    Infinite where II reaches all pressures of the run, has no equilibrium but that at rest, or is not simulated. Waits
    until that is known.

    second: experiment II. complete: the outcomes with states below the limit.
    """
    failure = second.result().failure if second else None
    if failure is None:
        return inf
    outcomes, _ = complete.result()
    end, loads = failure.end_kPa, scene.config.validation
    given = [pressure for pressure in loads.pressures_kPa if pressure < end and loads.with_experiments]
    states = [record.pressure_kPa for record in outcomes[FIRST].records]
    return max((*states, *given), default=_rounded(PARTS[-1] * end) or inf)


def _rounded(pressure_kPa: float) -> float:
    return float(f"{pressure_kPa:.{DIGITS}g}")
