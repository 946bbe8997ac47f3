"""A law with a limit of the pressure: both forms, what moves them, law.json; and one with a bend of second order."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.laws import law_of_record, law_record
from rod import ArmLaw, RodError
from rod.arm_law.moved import order_of_strain
from tests.rod.arm_law.test_arm_law import law_of, straight_law
from tests.snapping_arm import BACK, BY_MODULUS, BY_WALL, CURVED, LIMIT, SWOLLEN, kappa_0, snapping_law

LAW = snapping_law()


@pytest.mark.parametrize("pressure", [15.0, 22.1, 24.0, 26.6])
def test_below_the_limit_the_form_from_rest_is_meant(pressure: float) -> None:
    assert LAW.at(pressure).section.kappa_0 == pytest.approx(kappa_0(pressure), rel=2e-3)


@pytest.mark.parametrize("pressure", [22.1, 24.0, 26.6, 26.9, 30.0])
def test_the_form_after_the_snap_is_asked_for_below_the_limit(pressure: float) -> None:
    true = kappa_0(pressure, after_snap=True)
    assert LAW.at(pressure, after_snap=True).section.kappa_0 == pytest.approx(true, rel=2e-3)


def test_beyond_the_limit_inflation_from_rest_has_snapped() -> None:
    assert LAW.at("27.01 kPa").section.kappa_0 == pytest.approx(kappa_0(27.01, after_snap=True), rel=2e-3)
    assert LAW.at(30.0).section.kappa_0 == LAW.at(30.0, after_snap=True).section.kappa_0


def test_moduli_scale_the_limits_exactly() -> None:
    law = LAW.scaled(1.25)
    assert law.swollen
    assert (law.limit.value, law.limit.std, law.back.value) == (1.25 * LIMIT, 0.25, 1.25 * BACK)
    assert law.limit.rates == {"geometry.wall": 1.25 * BY_WALL, "material.mu": BY_MODULUS}
    assert law.limit.rates["material.mu"] * law.rates["material.mu"].value == law.limit.value
    np.testing.assert_allclose(law.limit.pressures[[0, -1]], [1.25 * LIMIT, 1.25 * BACK])
    np.testing.assert_allclose(law.limit.kappas[[0, -1]], [CURVED, 3 * CURVED])
    assert law.at(1.25 * 24.0, after_snap=True).section.kappa_0 == pytest.approx(
        LAW.at(24.0, after_snap=True).section.kappa_0, rel=1e-12
    )


def test_moduli_that_grow_with_the_pressure_move_both_forms_alike() -> None:
    law, factor = LAW.stiffened(0.2), float(np.exp(0.2 * LIMIT / LAW.pressures[-1]))
    assert law.limit.value == pytest.approx(factor * LIMIT)
    assert law.back.value == pytest.approx(BACK * np.exp(0.2 * BACK / LAW.pressures[-1]))
    assert law.swollen.pressures == pytest.approx([p * np.exp(0.2 * p / LAW.pressures[-1]) for p in SWOLLEN])


def test_a_change_of_the_design_moves_the_limit_and_both_forms() -> None:
    """A form that the change pushes beyond its limit is left there."""
    change = {"geometry.wall": -0.02}
    for law in (LAW.with_changes(change), LAW.carried(change)):
        assert law.limit.value == LIMIT - 0.02 * BY_WALL
        assert law.at(24.0).section.kappa_0 == pytest.approx(kappa_0(24.8), rel=0.03)
        assert law.at(25.0, after_snap=True).section.kappa_0 == pytest.approx(kappa_0(25.8, after_snap=True), rel=0.01)
        assert law.at(26.5).section.kappa_0 == law.at(26.5, after_snap=True).section.kappa_0
    assert LAW.carried(change).limit.rates == LAW.limit.rates  # type: ignore[union-attr]
    assert LAW.with_changes({}).swollen.rates == {}  # type: ignore[union-attr]


def test_a_form_without_derivatives_by_what_changes_is_left_out() -> None:
    assert LAW.swollen
    law = replace(LAW, swollen=replace(LAW.swollen, rates={})).with_changes({"geometry.wall": 0.01})
    assert law.swollen is None
    with pytest.raises(RodError, match="This form of the arm ends there"):
        law.at(30.0)


def test_another_rubber_moves_both_forms() -> None:
    def with_axial(law: ArmLaw) -> ArmLaw:
        return replace(law, cells=tuple(replace(cell, axial_rigidity=np.full(9, 60.0)) for cell in law.cells))

    assert LAW.swollen
    soft = replace(with_axial(LAW), swollen=with_axial(LAW.swollen))
    for after_snap in (False, True):
        rods = [law.at(23.0, after_snap=after_snap) for law in (soft.with_second_order(0.5, 0.3), soft)]
        assert rods[0].section.kappa_0 > rods[1].section.kappa_0


@pytest.mark.parametrize("law", [LAW, snapping_law(swells=False), LAW.with_changes({})], ids=["both", "limit", "bare"])
def test_both_forms_come_back_from_law_json(law: ArmLaw) -> None:
    record = json.loads(json.dumps(law_record(law)))
    again = law_of_record(record)
    assert json.dumps(law_record(again)) == json.dumps(record)
    assert record["limit_kPa"]["value"] == LIMIT
    assert record["limit_kPa"]["std"] == 0.2
    forms = [row.get("form") for row in record["curves"]]
    if law.swollen is None:
        assert forms == [None] * 8
        assert record["return_kPa"] is None
        return
    for table in (record["curves"], record["clamp"]["curves"], record["tip"]["curves"]):
        assert [row.get("form") for row in table] == [None] * 8 + ["after_snap"] * 5
    assert again.swollen.pressures == law.swollen.pressures
    assert again.rates.keys() == again.swollen.rates.keys() == law.rates.keys()
    assert all(len(rate.cells) == 5 for rate in again.swollen.rates.values())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda record: record.pop("return_kPa"), "has a limit pressure, and one below which it snaps back"),
        (lambda record: record["limit_kPa"].pop("value"), "value"),
        (lambda record: record["clamp"]["curves"].pop(), "at each pressure, in ascending order"),
        (lambda record: record["curves"][-1].update(form="swollen"), "at each pressure, in ascending order"),
    ],
)
def test_a_file_with_half_a_form_is_refused(change: Callable[[dict[str, object]], object], said: str) -> None:
    record = json.loads(json.dumps(law_record(LAW)))
    change(record)
    with pytest.raises(ValueError, match=said):
        law_of_record(record)


def test_a_file_of_the_format_before_is_read() -> None:
    record = law_record(replace(LAW, limit=None, back=None, swollen=None))
    old = {key: value for key, value in record.items() if key not in ("limit_kPa", "return_kPa")}
    again = law_of_record(json.loads(json.dumps({**old, "format": 4})))
    assert again.limit is None
    assert again.pressures == LAW.pressures


def test_a_curve_that_begins_without_moment_but_for_rounding_has_a_curvature_there() -> None:
    section = LAW.at(24.0).section
    width = float(np.ptp(section.moment))
    first = replace(section, moment=section.moment - section.moment[0] + 1e-9 * width)
    assert first.kappa_0 == pytest.approx(section.kappa[0], rel=1e-6)
    with pytest.raises(RodError, match="no point without moment"):
        _ = replace(section, moment=first.moment + 1e-3 * width).kappa_0


COARSE_LAW = Path("tests/data/results_coarse/law.json")


@pytest.fixture(scope="module")
def law() -> ArmLaw:
    return law_of_record(json.loads(COARSE_LAW.read_text(encoding="utf-8")))


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
