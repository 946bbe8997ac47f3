"""The arm without a load in words, by its own law."""

from collections.abc import Iterator, Sequence
from typing import TypeVar

from pipeline.results.law import Law

State = TypeVar("State")

#: pressures that are named; of more the lowest, the middle and the highest one
MOST_NAMED = 3


def named_states(states: Sequence[State]) -> tuple[State, ...]:
    """At most `MOST_NAMED` of the states."""
    return tuple(states) if len(states) <= MOST_NAMED else (states[0], states[len(states) // 2], states[-1])


def unloaded_lines(law: Law) -> Iterator[str]:
    """Bending angle, tip, curvature and rigidity of the arm without a load, a part of a sentence each."""
    named = named_states(law.unloaded)
    pressures = ", ".join(f"{state.pressure_kPa:g}" for state in named)
    yield f"the arm bends by {', '.join(f'{state.bending_deg:.0f}°' for state in named)} at {pressures} kPa"
    yield f"its tip is at {', '.join('({:.1f}, {:.1f})'.format(*state.tip_mm) for state in named)} mm"
    yield f"κ₀ = {', '.join(f'{1000.0 * state.kappa_0_per_mm:.3g}' for state in named)} 1/m"
    yield f"rigidity {', '.join(f'{state.rigidity_N_mm2:.3g}' for state in named)} N mm²"
