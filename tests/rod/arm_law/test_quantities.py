"""Derivatives of numbers of an arm by any parameter, and the table of what can be asked."""

import math

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.answers.rods.budget import NUMBERS, make_budgets
from pipeline.api.frames import sensitivities_frame
from pipeline.config.tolerances import Tolerances
from pipeline.results.laws import law_record
from pipeline.study.wishes import wish
from rod.arm_law.quantities import QUANTITIES, UNITS, Quantity, QuantityAt, jacobian, key_in_files
from rod.errors import RodError
from tests.measured_arm import BENDING, EI, THICKER, arm_law

STEPS = (1e-3, 2e-3)


def test_columns_are_derivatives_by_each_parameter() -> None:
    """Parabolas have exact central differences."""
    found = jacobian(
        lambda changes: 1.0 + changes,
        [lambda x: np.array([x[0] ** 2 * x[1]]), lambda x: np.array([x[1] ** 2, 3.0 * x[0]])],
        STEPS,
    )
    assert found == pytest.approx(np.array([[2.0, 1.0], [0.0, 2.0], [3.0, 0.0]]), abs=1e-11)


def test_a_number_that_one_side_lacks_is_differentiated_on_the_other() -> None:
    def root(x: Array) -> Array:
        if x[0] < 0.0:
            raise RodError("no arm there")
        return np.array([math.sqrt(1.0 + x[0])])

    (slope,) = jacobian(lambda changes: changes, [root], STEPS[:1])[0]
    assert slope == pytest.approx(0.5, abs=STEPS[0])
    with pytest.raises(RodError, match="no arm there"):
        jacobian(lambda changes: changes - 1.0, [root], STEPS[:1])


def test_an_arm_after_changes_is_made_once_for_all_numbers() -> None:
    made = []

    def at(changes: Array) -> float:
        made.append(changes)
        return float(changes.sum())

    jacobian(at, [lambda x: np.array([x])] * 5, STEPS)
    assert len(made) == 2 * len(STEPS)


def test_quantities_of_an_arm_in_closed_form() -> None:
    law, pressure = arm_law(), 20.0
    known = law.at(pressure)

    def number(name: str, given: float = math.nan) -> float:
        return float(QuantityAt(name, pressure, known, given).of(law.at)[0])

    kappa_0 = BENDING * pressure
    turn = kappa_0 * known.length
    assert number("kappa_0") == pytest.approx(kappa_0)
    assert number("rigidity") == pytest.approx(EI)
    assert number("end_angle") == pytest.approx(turn)
    assert number("angle") == pytest.approx(abs(math.degrees(turn)), rel=1e-6)
    assert number("tip") == pytest.approx(math.sin(turn) / kappa_0, rel=1e-6)
    assert number("force", float(known.solve().end[1])) == pytest.approx(0.0, abs=1e-9)
    tip = QuantityAt("tip", pressure, known)
    by_wall = jacobian(law.rods_after(["geometry.wall"]), [tip.of], [law.step("geometry.wall")])[:, 0]
    more = THICKER * kappa_0
    expected = more * (known.length * math.cos(turn) / kappa_0 - math.sin(turn) / kappa_0**2)
    assert by_wall[0] == pytest.approx(expected, rel=1e-5)


def test_a_row_of_the_table_is_asked_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = Quantity("turn", "rad", lambda rod, *_: rod.length * rod.section.kappa_0, title="turn", in_law=True)
    monkeypatch.setitem(QUANTITIES, "turn", asked)
    monkeypatch.setitem(UNITS, "turn", asked.unit)
    monkeypatch.setitem(NUMBERS, "turn", asked.title)
    law = arm_law()
    frame = sensitivities_frame(law).query("number == 'turn' and pressure_kPa == 20")
    assert float(frame["relative"].iloc[0]) == pytest.approx(THICKER, rel=1e-6)
    assert len(law_record(law)["derivatives"]["geometry.wall"]["turn_rad"]) == len(law.pressures)
    (budget,) = make_budgets(law, Tolerances(), [20.0], None)
    assert budget.largest("turn").parameter == "geometry.wall"
    assert "turn (%)" in budget.table.heads
    assert key_in_files("turn") == "turn_rad"


def test_a_row_that_can_be_wished_is_a_key_of_a_wish() -> None:
    assert {name for name, one in QUANTITIES.items() if one.wished} == {*wish.QUANTITIES}
    assert {one.wished for one in QUANTITIES.values()} == {"", "line", "power"}
    assert all(wish.QUANTITIES[name].unit == QUANTITIES[name].unit for name in wish.QUANTITIES)
