"""States below its limit for an arm that bears none of the pressures of its configuration."""

from pipeline.context import RunContext
from pipeline.simulation.loadcase import LoadCase, schedule
from pipeline.simulation.outcome import Outcomes
from pipeline.simulation.scene import Scene
from pipeline.simulation.simulate import experiments_of, simulate

#: pressures over the lowest limit of II and III: high enough to say something about the arm as it was to be loaded
PARTS = (0.4, 0.8)
#: digits of these pressures, so that they can be typed
DIGITS = 3


def with_states_below_limit(scene: Scene, context: RunContext, outcomes: Outcomes) -> tuple[Outcomes, str]:
    """The outcomes with states at pressures below the limit, and a sentence about them, without full stop.

    Unchanged, and an empty sentence, where II and III have reached a pressure of the configuration together or where
    neither names a limit, and without the five parameters (`law: cell`), for which alone these states are solved.
    Raises RunFailed as `simulate`.
    """
    pressures = _pressures(outcomes)
    if scene.config.law == "cell" or not pressures:
        return outcomes, ""
    cases = [
        LoadCase(name, name, schedule(scene.config, pressures), scene.config.end)
        for name in experiments_of(scene.config)
    ]
    more = simulate(scene, context, cases)
    reached = [pressure for pressure in pressures if more["II"].at(pressure) and more["III"].at(pressure)]
    if not reached:
        return outcomes, ""
    at = " and ".join(f"{pressure:g} kPa" for pressure in reached)
    return outcomes.merged(more), (
        f"the arm bears none of the pressures of the configuration, the lowest of which is "
        f"{scene.config.pressures_kPa[0]:g} kPa; its parameters are those at {at}, below its limit"
    )


def _pressures(outcomes: Outcomes) -> tuple[float, ...]:
    """The pressures in kPa to be solved; none where they are not needed or no limit is known."""
    if any(name not in outcomes.by_name for name in ("II", "III")):
        return ()
    free, loaded = outcomes["II"], outcomes["III"]
    if any(loaded.at(record.pressure_kPa) for record in free.records):
        return ()
    limits = [o.failure.limit_kPa for o in (free, loaded) if o.failure and o.failure.limit_kPa]
    if not limits:
        return ()
    limit = min(limits, key=abs)
    return tuple(float(f"{part * limit:.{DIGITS}g}") for part in PARTS)
