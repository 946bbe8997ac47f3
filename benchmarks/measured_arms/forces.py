"""The force of a tip that is held at its height, to first order, from the moment that holds the cells straight."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

from benchmarks.measured_arms.arms import Arm
from fem.cell.piece import PieceFailed
from geometry.arrays import Array
from pipeline.law.piece.pieces import ArmPieces
from pipeline.simulate.scene import Scene

#: mm more of the arm are in the clamp then
IN_CLAMP = 5.0
#: of the moment that straightens an even arm, over its length: the force at the end that keeps this at its height
PROPPED = 1.5


def straight_moments(arm: Arm, pressures: Sequence[float], folder: Path) -> Array:
    """(k, 2) kPa and N mm that hold the cell straight, from rest as far as it bears them; kept in the folder."""
    config = arm.config(pressures)
    kept = folder / f"{arm.name}_straight_{config.hash[:12]}.csv"
    if kept.exists():
        return np.loadtxt(kept, delimiter=",")
    cell = ArmPieces.of(Scene.meshed(config)).cell
    state, found = cell.rest(), [(0.0, 0.0)]
    with suppress(PieceFailed):
        for pressure in pressures:
            state = cell.solve(1e-3 * pressure, 0.0, state)
            found.append((pressure, state.moment))
    folder.mkdir(parents=True, exist_ok=True)
    np.savetxt(kept, np.array(found), fmt="%.8g", delimiter=",")
    return np.array(found)


@dataclass(frozen=True, eq=False)  # arrays inside
class HeldArm:
    """The force of an arm with its authors' silicone at its tip, which moves along but not across."""

    arm: Arm
    moments: Array  #: (k, 2) as of `straight_moments`

    def at(self, pressures: Array, factor: float) -> Array:
        """(n,) N at pressures in kPa, of moduli that are so many times as large; NaN beyond the last moment."""
        moment = PchipInterpolator(*self.moments.T, extrapolate=False)
        return np.asarray(PROPPED * factor * moment(pressures / factor) / (self.arm.length - IN_CLAMP))
