"""A law that departs in the second order of the strain: how much, between its pressures, and with other moduli."""

import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.laws import law_of_record
from rod import RodError
from rod.arm_law.law import ArmLaw
from rod.arm_law.moved import order_of_strain
from tests.rod.arm_law.test_arm_law import law_of, straight_law

LAW = Path("tests/data/results_coarse/law.json")


@pytest.fixture(scope="module")
def law() -> ArmLaw:
    return law_of_record(json.loads(LAW.read_text(encoding="utf-8")))


def test_curvature_and_stretch_change_by_the_square_of_the_strain(law: ArmLaw) -> None:
    changed = law.with_second_order(0.5, 0.3)
    for before, after in zip(law.cells, changed.cells, strict=True):
        strain, height = order_of_strain(before)
        assert after.at(0.0)[0] - before.at(0.0)[0] == pytest.approx(0.5 * strain**2 / height, abs=1e-12)
        assert after.at(0.0)[1] - before.at(0.0)[1] == pytest.approx(0.3 * strain**2, abs=1e-12)
    assert changed.cells[-1].at(0.0)[0] > law.cells[-1].at(0.0)[0]


def test_a_bar_has_its_height(law: ArmLaw) -> None:
    """EI = E b h^3 / 12 and EA = E b h give h."""
    cell = law.cells[-1]
    bending, axial = (np.interp(0.0, cell.moment, values) for values in (cell.rigidity, cell.axial_rigidity))
    assert order_of_strain(cell)[1] ** 2 == pytest.approx(12.0 * bending / axial)


def test_slopes_by_the_pressure_follow() -> None:
    """Rigidities that do not depend on the pressure: between two pressures the change is that of a square."""
    bars = law_of(*(straight_law(pressure, EA=60.0) for pressure in (0.0, 10.0, 20.0)))
    changed = bars.with_second_order(2.0, 0.3)
    for pressure in (4.0, 13.0):
        section, last = changed.at(pressure).section, changed.at(20.0).section
        square = (pressure / 20.0) ** 2
        assert section.kappa_0 == pytest.approx(last.kappa_0 * square, rel=1e-6)
        longer = [float(np.interp(0.0, one.moment, one.stretch)) - 1.0 for one in (section, last)]
        assert longer[0] == pytest.approx(longer[1] * square, rel=1e-6)


def test_it_commutes_with_other_moduli(law: ArmLaw) -> None:
    one, other = law.scaled(0.8).with_second_order(0.5, 0.3), law.with_second_order(0.5, 0.3).scaled(0.8)
    for first, second in zip(one.cells, other.cells, strict=True):
        assert np.allclose(first.kappa, second.kappa, rtol=1e-12)
        assert np.allclose(first.moment_by_pressure, second.moment_by_pressure, rtol=1e-9)
        assert np.allclose(first.stretch, second.stretch, rtol=1e-12)


def test_what_is_no_number_is_refused(law: ArmLaw) -> None:
    with pytest.raises(RodError, match="second order"):
        law.with_second_order(float("nan"), 0.0)
