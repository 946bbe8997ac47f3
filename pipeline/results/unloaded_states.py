"""The arm without a load at the pressures of its own law."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from geometry.centreline import bending_deg
from pipeline.values.law import Unloaded
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod


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
    shape = Rod(law.length, law=at).solve()
    rigidity = 1.0 / float(np.interp(0.0, at.section.moment, at.section.kappa_slope))
    return Unloaded(pressure, at.section.kappa_0, rigidity, bending_deg(shape.end), shape.end)
