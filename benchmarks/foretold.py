"""Rows of a measured arm foretold by its law: as drawn, and after a calibration on other rows."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, hypot
from typing import Any

import numpy as np
from scipy.stats import t

from geometry.arrays import Array
from pipeline.answers.measured.fit import effects_on, fit, numbers_of
from pipeline.answers.measured.predicted import Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.answers.measured.unknowns import BuiltArm, unknowns_of
from pipeline.values.errors import InputError
from rod.arm_law.law import ArmLaw


@dataclass(frozen=True, eq=False)  # arrays inside
class Foretold:
    """Numbers of some rows."""

    numbers: Numbers
    length: float  #: mm
    modulus: float  #: factor of all moduli that was found
    before: Array  #: (n,) by the drawing; NaN where its law ends at lower pressures
    after: Array  #: (n,) after the calibration
    levels: (
        Array  #: (n,) stated probability of the smallest intervals that hold the numbers of the arm, without scatter
    )
    levels_of_readings: Array  #: (n,) the same of a reading, with its scatter

    def errors(self, line: int) -> tuple[float, float]:
        """Before and after, of a line of the file: distance of the tip over the length, or part of a reaction."""
        own = self.of(line)
        reaction = len(own) == 1 and self.numbers.names[own[0]] == "reaction"
        scale = abs(float(self.numbers.values[own[0]])) if reaction else self.length
        apart = [k for k in own if self.numbers.names[k] != "end_angle"]
        before, after = (hypot(*(v - self.numbers.values)[apart]) / scale for v in (self.before, self.after))
        return before, after

    def of(self, line: int) -> list[int]:
        """Which numbers are of a line."""
        return [k for k, row in enumerate(self.numbers.rows) if row.line == line]


def foretell(law: ArmLaw, config: Mapping[str, Any], known: Measurements, others: Measurements) -> Foretold:
    """Rows that are foretold by the law of a drawing after a calibration on known ones.

    config: the record of its configuration. Raises InputError for a state that the arm has not.
    """
    arm = BuiltArm(law, unknowns_of(law, config, (), max(known.pressures_kPa)))
    numbers, fitted = Numbers.of(others), fit(arm, Numbers.of(known))
    after = numbers_of(arm, numbers, fitted.changes)
    off, effects = np.abs(numbers.values - after), effects_on(arm, numbers, fitted.changes)
    stds = (fitted.deviations(effects, units) for units in ((), numbers.units))
    levels = (1.0 - 2.0 * t.sf(off / std, fitted.degrees) for std in stds)
    return Foretold(numbers, law.length, exp(fitted.changes[0]), _as_drawn(arm, numbers), after, *levels)


def _as_drawn(arm: BuiltArm, numbers: Numbers) -> Array:
    try:
        return numbers_of(arm, numbers, np.zeros(len(arm.unknowns)))
    except InputError:
        return np.full(len(numbers.values), np.nan)
