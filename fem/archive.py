"""A step as plain arrays and back, so that a finished one can be kept on disk and the path taken up from it."""

from collections.abc import Mapping
from dataclasses import astuple
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.discretisation import Discretisation
from fem.equations.state import Change
from fem.solution import Extremes, Seconds, Step

ArrayMap = Mapping[str, NDArray[Any]]

COUNTS = ("negative_pivots", "newton_iterations", "factorizations", "cutbacks")


def step_to_arrays(step: Step) -> dict[str, NDArray[Any]]:
    """Everything of a step but its discretisation, by name."""
    spent = step.spent
    return {
        "displacement": step.displacement,
        "stress": step.stress,
        **_rate_to_arrays(step.rate),
        "gradient": step.gradient,
        "numbers": np.array([step.factor, step.min_gap, step.seconds]),
        "counts": np.array([getattr(step, name) for name in COUNTS]),
        "extremes": np.concatenate([np.atleast_1d(value) for value in astuple(step.extremes)]),
        "effects": np.array(step.effects, dtype=str),
        "active": np.array(step.active, dtype=bool),
        "instability": np.array(step.instability),
        "stages": np.array([spent.assembly, spent.analysis, spent.factorization, spent.solve]),
        "timed_effects": np.array(list(spent.effects), dtype=str),
        "effect_seconds": np.array(list(spent.effects.values())),
    }


def step_from_arrays(space: Discretisation, arrays: ArrayMap) -> Step:
    """The step that `step_to_arrays` took apart, on an equal discretisation."""
    min_J, longest, shortest = arrays["extremes"][:3].tolist()
    J_at, longest_at, shortest_at = ((float(x), float(y), float(z)) for x, y, z in arrays["extremes"][3:].reshape(3, 3))
    assembly, analysis, factorization, solve = arrays["stages"].tolist()
    factor, min_gap, seconds = arrays["numbers"].tolist()
    timed = dict(zip(arrays["timed_effects"].tolist(), arrays["effect_seconds"].tolist(), strict=True))
    return Step(
        space=space,
        factor=factor,
        displacement=arrays["displacement"],
        stress=arrays["stress"],
        rate=_rate_from_arrays(arrays),
        gradient=arrays["gradient"],
        extremes=Extremes(min_J, longest, shortest, J_at, longest_at, shortest_at),
        min_gap=min_gap,
        **dict(zip(COUNTS, arrays["counts"].tolist(), strict=True)),
        instability=str(arrays["instability"]),
        effects=tuple(arrays["effects"].tolist()),
        active=tuple(arrays["active"].tolist()),
        seconds=seconds,
        spent=Seconds(0.0, assembly, analysis, factorization, solve, timed),
    )


def _rate_to_arrays(rate: Change | None) -> dict[str, NDArray[Any]]:
    if rate is None:
        return {}
    return {"rate": rate.displacement, "rate_of_pressures": rate.pressure, "rate_of_factor": np.array(rate.factor)}


def _rate_from_arrays(arrays: ArrayMap) -> Change | None:
    if "rate" not in arrays:
        return None
    return Change(float(arrays["rate_of_factor"]), arrays["rate"], arrays["rate_of_pressures"])
