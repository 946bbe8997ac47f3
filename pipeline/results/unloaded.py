"""The arm without a load, by its own law, and in words."""

from collections.abc import Sequence
from contextlib import suppress
from typing import TypeVar

import numpy as np

from pipeline.results.rod_errors import law_mesh_errors
from pipeline.values.formatting import percent
from pipeline.values.law import DRAFT, DeliveredLaw, Unloaded
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.load import Load
from rod.mechanics.equilibrium import Rod

State = TypeVar("State")

#: pressures that are named; of more the lowest, the middle and the highest one
MOST_NAMED = 3


def unloaded_states(law: ArmLaw, pressures_kPa: Sequence[float]) -> tuple[Unloaded, ...]:
    """The clamped arm without a load at those of the pressures that the law has; without one that has no rod."""
    states: list[Unloaded] = []
    for pressure in (p for p in pressures_kPa if law.pressures[0] <= p <= law.pressures[-1]):
        with suppress(RodError):
            states.append(unloaded_state(law, pressure))
    return tuple(states)


def unloaded_state(law: ArmLaw, pressure: float) -> Unloaded:
    """At a pressure of the law in kPa. Raises `RodError`."""
    at = law.at(pressure)
    shape = Rod(law.length, law=at).under(Load())
    rigidity = 1.0 / float(np.interp(0.0, at.section.moment, at.section.kappa_slope))
    return Unloaded(pressure, at.section.kappa_0, rigidity, abs(shape.bending_deg), shape.end)


def named_states(states: Sequence[State]) -> tuple[State, ...]:
    """At most `MOST_NAMED` of the states."""
    return tuple(states) if len(states) <= MOST_NAMED else (states[0], states[len(states) // 2], states[-1])


def first_numbers(states: Sequence[Unloaded], size_mm: float) -> str:
    """The arm without a load in one sentence, before the error of its mesh is known; size_mm: of that mesh."""
    return f"first numbers, on a mesh of {size_mm:.3g} mm whose error is not known yet: {_numbers(states)}"


def delivered_numbers(law: DeliveredLaw) -> str:
    """The arm without a load in one sentence, with the error of the mesh where it is known."""
    error = law_mesh_errors(law).largest
    known = "" if error is None else f", known to {percent(error)} for the mesh"
    return f"{DRAFT if law.draft else f'numbers of the law{known}'}: {_numbers(law.unloaded)}"


def _numbers(states: Sequence[Unloaded]) -> str:
    """Bending angle, tip, curvature and rigidity."""
    named = named_states(states)
    pressures = ", ".join(f"{state.pressure_kPa:g}" for state in named)
    parts = (
        f"the arm bends by {', '.join(f'{state.bending_deg:.0f}°' for state in named)} at {pressures} kPa",
        f"its tip is at {', '.join('({:.1f}, {:.1f})'.format(*state.tip_mm) for state in named)} mm",
        f"κ₀ = {', '.join(f'{1000.0 * state.kappa_0_per_mm:.3g}' for state in named)} 1/m",
        f"rigidity {', '.join(f'{state.rigidity_N_mm2:.3g}' for state in named)} N mm²",
    )
    return "; ".join(parts)
