"""Tables of machines and publications, in the forms in which they were written: the laws that they must give."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pipeline.answers.material.study import FitOptions, Material, fit_tests
from pipeline.answers.material.table import Specimen

DATA = Path(__file__).resolve().parents[3] / "data"
#: nominal equibiaxial stress of the natural rubber at a stretch of 2, MPa
MEASURED = 0.82


@cache
def fitted(name: str) -> Material:
    return fit_tests([DATA / "tensile" / f"{name}.csv"], FitOptions())


def constants(name: str) -> list[float]:
    first = fitted(name).judged.laws[0]
    assert first.name == "yeoh"
    return [float(constant) for constant in first.constants]


def test_no_law_of_natural_rubber_is_offered_that_is_far_off_in_two_directions() -> None:
    """Uniaxial data to a stretch of 7 admit Ogden's laws that are 700 times too stiff in biaxial tension."""
    two = np.array([2.0])
    usable = [fit for fit in fitted("natural_rubber").judged.usable if fit.holds and fit.holds[1] >= 2.0]
    assert len(usable) >= 2
    for fit in usable:
        assert MEASURED / 1.5 < fit.law.incompressible(two, two)[0] < 1.5 * MEASURED


def test_slack_and_a_rounded_start_are_taken_away() -> None:
    assert constants("slack_start")[0] == pytest.approx(0.06, rel=0.01)
    assert constants("rounded_start") == pytest.approx([0.0895, 0.0085, -0.00025], rel=0.1)
    assert constants("rounded_start")[0] == pytest.approx(0.0895, rel=0.01)


@pytest.mark.parametrize("name", ["two_kinds_of_columns", "stretch_without_unit"])
def test_true_beside_engineering_columns_and_a_stretch_without_a_unit_are_read(name: str) -> None:
    assert constants(name)[:2] == pytest.approx([0.06, 0.004], rel=0.01)


@pytest.mark.parametrize("name", ["results_first.csv", "statistik.txt"])
def test_tables_of_results_above_the_curves_of_two_specimens_are_passed_over(name: str) -> None:
    """An English file with one specimen below the other, a German one with both beside each other; 2 % off the law."""
    material = fit_tests([DATA / "tensile" / name], FitOptions(Specimen(33.0, 16.0)))
    assert [(test.name, len(test.stress)) for test in material.tests] == [("1", 26), ("2", 26)]
    assert material.notes == ()
    assert material.points.spread == pytest.approx(0.04 / 2**0.5, rel=0.01)
    first = material.judged.laws[0]
    assert first.name == "yeoh"
    assert first.constants[:2] == pytest.approx([0.06, 0.004], rel=0.01)
