"""The five parameters of one pressure with their intervals: what every estimator returns."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from rod.curves.uncertainty import Interval, interval
from rod.law import PARAMETER_NAMES, FiveParameters


@dataclass(frozen=True, kw_only=True)
class ParameterEstimate:
    """Five parameters with intervals."""

    law: FiveParameters
    alpha1: Interval  #: N mm2
    alpha2: Interval  #: N mm2
    m01: Interval  #: N mm
    m02: Interval  #: N mm
    d: Interval  #: mm


def intervals(law: FiveParameters, sampled: Array) -> dict[str, Interval]:
    """Intervals by name around the values of a law, from bootstrap draws (draws, 5) in the order of PARAMETER_NAMES."""
    return {name: interval(getattr(law, name), column) for name, column in zip(PARAMETER_NAMES, sampled.T, strict=True)}


def parameters_of_lines(a: tuple[Array, Array], b: tuple[Array, Array], d: Array) -> Array:
    """(draws, 5): alpha1, alpha2, m01, m02, d from compliances a_i and offsets b_i of Delta = a_i M - b_i, (draws,)."""
    return np.column_stack([1.0 / a[0], 1.0 / a[1], b[0] / a[0], b[1] / a[1], d])
