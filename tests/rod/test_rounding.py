"""The five parameters depend neither on the number of threads nor on rounding."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

import rod
from geometry import Centreline
from geometry.arrays import Array

DATA = Path(__file__).parent.parent / "data"


class Arm(NamedTuple):
    """Curves of II and III at 37 kPa from finite elements."""

    file: str
    rows_before: int  #: the numbers
    load: rod.Load  #: on the end in III
    pitch: float  #: mm
    every: int = 1  #: how many rows are read as one

    def __str__(self) -> str:
        return self.file.removesuffix("_37kPa.csv")


ARMS = [
    Arm("pneunet_seven_chambers_37kPa.csv", 1, rod.Load((0.0, 0.1388029421)), 10.0),
    Arm("semicircular_single_37kPa.csv", 4, rod.Load((0.0, 0.0177597378), 0.0447686944), 108.0 / 11, 3),
]


def estimated(arm: Arm, rounding: float = 0.0) -> Array:
    """Numbers with their standard deviations."""
    s, *columns = np.loadtxt(DATA / arm.file, delimiter=",", skiprows=arm.rows_before)[:: arm.every].T
    noise = rounding * np.random.default_rng(7).standard_normal((4, len(s)))
    x_free, y_free, x, y = np.array(columns[:4]) + noise
    curves, load, pitch = (Centreline(s, x_free, y_free), Centreline(s, x, y)), arm.load, arm.pitch
    moment = rod.moment_between(*(rod.without_stretch(curve) for curve in curves), load)
    closure = rod.end_displacement_closure(*curves, load)
    averaged = (rod.cell_averaged(curve, pitch) for curve in curves)
    identified = rod.identify(*averaged, moment, closure, bootstrap=rod.Bootstrap(50))
    intervals = [getattr(identified, name) for name in rod.PARAMETER_NAMES] + [identified.single_line.alpha]
    return np.array([(interval.value, interval.std) for interval in intervals])


@pytest.mark.parametrize("arm", ARMS, ids=str)
def test_neither_the_number_of_threads_nor_the_order_of_sums_changes_an_estimate(arm: Arm) -> None:
    """1e-11 mm: more than shapes change with the number of threads of the finite elements."""
    with threadpool_limits(1):
        alone, rounded = estimated(arm), estimated(arm, 1e-11)
    with threadpool_limits(2):
        together = estimated(arm)
    for other in (together, rounded):
        assert other == pytest.approx(alone, rel=1e-6, abs=1e-9)
