"""What the arm's own law says of the arm without a load: the first numbers of a run."""

from collections.abc import Sequence

import numpy as np

from pipeline.results.law import Unloaded
from pipeline.results.values import bending_deg
from rod.arm_law.law import ArmLaw
from rod.errors import RodError
from rod.mechanics.equilibrium import Rod


def unloaded_states(law: ArmLaw, pressures_kPa: Sequence[float]) -> tuple[Unloaded, ...]:
    """The clamped arm without a load at those of the pressures that the law has; without one that has no rod."""
    states: list[Unloaded] = []
    for pressure in (p for p in pressures_kPa if law.pressures[0] <= p <= law.pressures[-1]):
        at = law.at(pressure)
        try:
            shape = Rod(law.length, law=at).solve()
        except RodError:
            continue
        rigidity = 1.0 / float(np.interp(0.0, at.section.moment, at.section.kappa_slope))
        tip = (float(shape.x[-1]), float(shape.y[-1]))
        states.append(Unloaded(pressure, at.section.kappa_0, rigidity, bending_deg(tip), tip))
    return tuple(states)
