"""The arm without a load in words, by its own law."""

from collections.abc import Sequence
from typing import TypeVar

from pipeline.results.rod_errors import law_mesh_errors
from pipeline.values.formatting import percent
from pipeline.values.law import DeliveredLaw, Unloaded

State = TypeVar("State")

#: pressures that are named; of more the lowest, the middle and the highest one
MOST_NAMED = 3


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
    return f"numbers of the law{known}: {_numbers(law.beside.unloaded)}"


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
