"""The two Young's moduli of K. M. de Payrebrune and O. M. O'Reilly, Fig. 4, and what their choice of E_H means.

The paper: least squares, E_L for strains below 1.5, E_H for strains above. It does not say how its lines are placed.
Here the first starts at rest, where there is no stress, and the second has the slope and the height that fit best;
the two other ways of placing the second are given beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem import Hencky, StVenantKirchhoff, uniaxial
from geometry.arrays import Array, Index, Mask
from pipeline.material.regression import Regression, TooFewPoints, regress
from pipeline.material.tensile import TensileTest

#: lines 111-113 and 118 of the paper: E_L, E_H in MPa, nu
PAPER = (0.65, 1.2, 0.495)
#: stretch at which the paper's choice is looked at
LOOKED_AT = 1.2


@dataclass(frozen=True)
class Moduli:
    """Slopes of the nominal stress over the strain, MPa; NaN where the data do not reach."""

    break_strain: float
    low: float  #: E_L
    low_error: float
    high: float  #: E_H: slope of the best line through the points beyond the break
    high_error: float
    high_at_rest: float  #: that line at strain 0
    high_joined: float  #: slope where the second line begins at the end of the first
    high_from_rest: float  #: slope where the second line passes through the origin
    by_tests: bool  #: as in `Regression`

    def record(self) -> dict[str, Any]:
        """As in material.json."""
        return {
            "break_strain": self.break_strain,
            "E_L_MPa": self.low,
            "E_L_standard_error_MPa": self.low_error,
            "E_H_MPa": self.high,
            "E_H_standard_error_MPa": self.high_error,
            "E_H_line_at_rest_MPa": self.high_at_rest,
            "E_H_joined_MPa": self.high_joined,
            "E_H_from_rest_MPa": self.high_from_rest,
            "errors_by_tests": self.by_tests,
        }


@dataclass(frozen=True)
class Choice:
    """What a law with E = E_H carries at one stretch, against the measured line E_L times strain."""

    stretch: float
    line: float  #: MPa
    svk: float  #: MPa
    hencky: float  #: MPa


def moduli(tests: Sequence[TensileTest], break_strain: float) -> Moduli:
    """Both lines through the points of all tests in tension."""
    strain = np.concatenate([test.strain for test in tests])
    stress = np.concatenate([test.stress for test in tests])
    groups = np.concatenate([np.full(len(test.strain), k) for k, test in enumerate(tests)])
    below, beyond = (strain >= 0) & (strain <= break_strain), strain > break_strain
    one = np.ones_like(strain)
    low = _line([strain], stress, groups, below)
    high = _line([strain, one], stress, groups, beyond)
    joined = _line(
        [np.minimum(strain, break_strain), np.maximum(strain - break_strain, 0)], stress, groups, strain >= 0
    )
    return Moduli(
        break_strain,
        low.numbers[0],
        low.errors[0],
        high.numbers[0],
        high.errors[0],
        high.numbers[1],
        joined.numbers[1],
        _line([strain], stress, groups, beyond).numbers[0],
        low.by_tests,
    )


def choice(low: float, high: float, nu: float) -> Choice | None:
    """Two laws with E = `high` against the line of slope `low` (MPa); None where one is missing."""
    if not (low > 0 and high > 0):
        return None
    at = np.array([LOOKED_AT])
    return Choice(
        LOOKED_AT,
        low * (LOOKED_AT - 1),
        float(uniaxial(StVenantKirchhoff(high, nu), at).nominal[0]),
        float(uniaxial(Hencky(high, nu), at).nominal[0]),
    )


def _line(columns: Sequence[Array], stress: Array, groups: Index, chosen: Mask) -> Regression:
    """The best numbers for the chosen points; NaN where there are too few."""
    matrix = np.column_stack(columns)[chosen]
    try:
        return regress(matrix, stress[chosen], groups[chosen])
    except TooFewPoints:
        nothing = np.full(len(columns), np.nan)
        return Regression(nothing, nothing, False, np.nan)
