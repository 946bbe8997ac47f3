"""Nothing that has fallen over stands: straight columns under a force or their own weight, against closed forms."""

import math

import pytest

from rod import FiveParameters, Rod, RodError
from rod.weight import WEIGHT_OF_GRAM, Mass

EI, LENGTH = 140.0, 90.0
LAW = FiveParameters(EI, EI, 0.0, 0.0, 9.0)
#: S. P. Timoshenko and J. M. Gere, "Theory of Elastic Stability", 2.1; A. G. Greenhill (1881): first zero of J_(-1/3)
EULER, GREENHILL = math.pi**2 * EI / (4.0 * LENGTH**2), 7.837347


def pushed(part: float) -> tuple[float, float]:
    return Rod(LENGTH, 0.0, LAW).solve(force=(-part * EULER, 0.0)).end


def standing(part: float) -> tuple[float, float]:
    grams = part * GREENHILL * EI / LENGTH**2 / WEIGHT_OF_GRAM
    return Rod(LENGTH, 0.0, LAW, mass=Mass.even(LENGTH, grams)).solve(direction="standing").end


@pytest.mark.parametrize("column", [pushed, standing])
@pytest.mark.parametrize("part", [0.5, 0.9, 0.99])
def test_below_its_limit_a_column_stands(column, part: float) -> None:
    assert column(part) == pytest.approx((LENGTH, 0.0), abs=1e-4)


@pytest.mark.parametrize("column", [pushed, standing])
@pytest.mark.parametrize("part", [1.01, 1.1, 2.0, 8.0, 9.5, 15.0, 24.0, 26.0, 60.0, 150.0])
def test_beyond_its_limit_a_column_buckles_there_whatever_the_number_of_its_unstable_directions(
    column, part: float
) -> None:
    """Beyond 9 times Euler's load two directions are unstable: a determinant does not see an even number."""
    with pytest.raises(RodError, match=r"The rod buckles at [\d.]+ % of the load") as told:
        column(part)
    (percent,) = (float(word) for word in str(told.value).split() if word.replace(".", "").isdigit())
    assert percent == pytest.approx(100.0 / part, rel=0.01)
