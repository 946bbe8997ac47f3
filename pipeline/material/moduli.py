"""The two Young's moduli of K. M. de Payrebrune and O. M. O'Reilly, Fig. 4, and the effect of using E = E_H in a law.

The paper fits by least squares, E_L to strains below 1.5 and E_H to strains above; it does not state the intercepts of
its lines. Here the first line passes through rest, where there is no stress, and the second has the slope and the
intercept that fit best; its slope under two other assumptions about the intercept is reported too.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem.materials import Hencky, StVenantKirchhoff
from geometry.arrays import Array, Index, Mask
from pipeline.material.regression import Regression, TooFewPoints, regress
from pipeline.material.tensile import TensileTest

#: the paper's E_L, E_H in MPa, nu
PAPER = (0.65, 1.2, 0.495)
#: stretch at which a law with E = E_H is compared with the measured line
CHECKED_STRETCH = 1.2


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

    def record(self) -> dict[str, float | bool]:
        """The part of material.json about the moduli."""
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
class HighModulusCheck:
    """Nominal stress of laws with E = E_H at one stretch, and that of the measured line E_L times strain."""

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
    ones = np.ones_like(strain)
    low = _line([strain], stress, groups, below)
    high = _line([strain, ones], stress, groups, beyond)
    joined = _line(
        [np.minimum(strain, break_strain), np.maximum(strain - break_strain, 0)], stress, groups, strain >= 0
    )
    return Moduli(
        break_strain,
        low.coefficients[0],
        low.errors[0],
        high.coefficients[0],
        high.errors[0],
        high.coefficients[1],
        joined.coefficients[1],
        _line([strain], stress, groups, beyond).coefficients[0],
        low.by_tests,
    )


def check_high_modulus(low: float, high: float, nu: float) -> HighModulusCheck | None:
    """Two laws with E = `high` and the line of slope `low` (MPa); None unless both are positive."""
    if not (low > 0 and high > 0):
        return None
    at = np.array([CHECKED_STRETCH])
    return HighModulusCheck(
        CHECKED_STRETCH,
        low * (CHECKED_STRETCH - 1),
        float(StVenantKirchhoff(high, nu).uniaxial(at).nominal[0]),
        float(Hencky(high, nu).uniaxial(at).nominal[0]),
    )


def _line(columns: Sequence[Array], stress: Array, groups: Index, selected: Mask) -> Regression:
    """Least squares through the selected points; NaN where there are too few."""
    matrix = np.column_stack(columns)[selected]
    try:
        return regress(matrix, stress[selected], groups[selected])
    except TooFewPoints:
        size = len(columns)
        return Regression(np.full(size, np.nan), np.full((size, size), np.nan), False, np.nan)
