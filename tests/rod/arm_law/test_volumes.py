"""Air in the cavities of an arm by its own law, of a law whose potential is known."""

import json
from dataclasses import replace

import numpy as np
import pytest

from geometry.arrays import Array
from pipeline.results.laws import law_of_record, law_record
from rod import RodError
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.arm_law.law import ArmLaw
from rod.arm_law.pairs import PairLaw
from rod.arm_law.rates import CellRate, ClampRate, LawRate
from tests.pair_laws import ray
from tests.rod.arm_law.test_arm_law import EI, LENGTH, law_of, straight_law

RATE = -4e-4  #: of the curvature without moment, 1/(mm kPa)
PRESSURES = (0.0, 10.0, 20.0, 30.0)
LONGER = 30.0  #: mm3, air of either end beyond that of cells


def cell_volume(kappa: Array, pressure: float) -> Array:
    """mm2: minus the derivative of EI (kappa - RATE p)^2 / 2 by the pressure in MPa, and air that grows with it."""
    return 40.0 + 0.1 * pressure + 1000.0 * EI * RATE * (kappa - RATE * pressure)


def part(pressure: float) -> tuple[CellCurve, ClampCurve, TipCurve]:
    cell, clamp, tip = straight_law(pressure, RATE * pressure)
    volume = cell_volume(cell.kappa, pressure)[:, None]
    at_rest = float(cell_volume(np.array(RATE * pressure), pressure))
    return (
        replace(cell, moment_by_pressure=np.full(9, -EI * RATE), volume=volume),
        replace(clamp, volume=float(clamp.s[-1]) * volume + LONGER),
        replace(tip, volume=np.array([-float(tip.s[0]) * at_rest + LONGER])),
    )


@pytest.fixture(scope="module")
def law() -> ArmLaw:
    return law_of(*map(part, PRESSURES))


@pytest.mark.parametrize("pressure", [0.0, 10.0, 12.5, 27.0])
def test_volumes_of_a_section_are_those_of_its_potential(law: ArmLaw, pressure: float) -> None:
    section = law.at(pressure).section
    assert section.volume[:, 0] == pytest.approx(cell_volume(section.kappa, pressure), rel=1e-9)


@pytest.mark.parametrize("pressure", [10.0, 14.0])
def test_the_moment_grows_with_the_pressure_as_the_air_does_with_the_curvature(law: ArmLaw, pressure: float) -> None:
    """At fixed curvature dM/dp = -dV/dkappa; moments in N mm, pressures in MPa."""
    step, (lower, section, upper) = 0.1, (law.at(p).section for p in (pressure - 0.1, pressure, pressure + 0.1))
    kappa = np.linspace(section.kappa[40], section.kappa[-41], 33)
    less, more = (np.interp(kappa, one.kappa, one.moment) for one in (lower, upper))
    by_pressure = 1000.0 * (more - less) / (2.0 * step)
    by_curvature = np.interp(kappa, section.kappa, np.gradient(section.volume[:, 0], section.kappa))
    assert by_pressure == pytest.approx(-by_curvature, abs=1e-3 * np.abs(by_curvature).max())


@pytest.mark.parametrize("pressure", [20.0, 23.0])
def test_the_air_of_an_arm_is_that_of_cells_and_what_its_ends_have_besides(law: ArmLaw, pressure: float) -> None:
    rod = law.at(pressure)
    state = rod.solve((0.0, 0.05))
    expected = np.trapezoid(cell_volume(state.kappa, pressure), state.s) + 2.0 * LONGER
    assert rod.volumes(state) == pytest.approx([expected], rel=1e-6)
    assert rod.volumes(rod.solve()) == pytest.approx([LENGTH * (40.0 + 0.1 * pressure) + 2.0 * LONGER], rel=1e-9)


def test_a_softer_rubber_has_the_same_air_at_lower_pressures(law: ArmLaw) -> None:
    for softer in (law.scaled(0.5), law.stiffened(-0.2)):
        for before, after in zip(law.cells, softer.cells, strict=True):
            assert np.array_equal(after.volume, before.volume)
    rod, scaled = law.at(24.0), law.scaled(0.5).at(12.0)
    assert scaled.volumes(scaled.solve()) == pytest.approx(rod.volumes(rod.solve()), rel=1e-9)


def test_a_bend_of_second_order_keeps_the_potential(law: ArmLaw) -> None:
    bars = replace(law, cells=tuple(replace(cell, axial_rigidity=np.full(9, 60.0)) for cell in law.cells))
    cell = bars.with_second_order(0.5, 0.2).cells[2]
    by_curvature = np.gradient(cell.volume[:, 0], cell.kappa)
    assert -1000.0 * cell.moment_by_pressure == pytest.approx(by_curvature, rel=1e-9)
    assert not np.allclose(cell.moment_by_pressure, law.cells[2].moment_by_pressure, rtol=1e-3)


def test_at_equal_curvature_a_change_of_the_design_leaves_the_air(law: ArmLaw) -> None:
    zeros = np.zeros(9)
    cells = tuple(CellRate(cell.moment, zeros, np.zeros((9, 2, 2)), np.zeros(())) for cell in law.cells)
    clamps = tuple(ClampRate(zeros, np.zeros((9, 2))) for _ in law.clamps)
    rate = LawRate(1.0, "MPa", 0.0, 0.0, 0.0, cells, clamps)
    changed = replace(law, rates={"material.E": rate}).with_changes({"material.E": 0.05})
    for before, after in zip(law.cells, changed.cells, strict=True):
        kept = np.interp(after.kappa, before.kappa, before.volume[:, 0])
        assert after.volume[:, 0] == pytest.approx(kept, rel=1e-12)


def test_the_record_has_the_volumes_and_may_lack_them(law: ArmLaw) -> None:
    record = json.loads(json.dumps(law_record(law)))
    assert np.shape(record["curves"][1]["volume_mm3_per_mm"]) == (9, 1)
    assert record["tip"]["curves"][0]["volume_mm3"] == list(law.tips[0].volume)
    assert law_record(law_of_record(record)) == record
    for row in record["clamp"]["curves"]:
        del row["volume_mm3"]
    rod = law_of_record(record).at(12.0)
    with pytest.raises(RodError, match="has no volumes of the air"):
        rod.volumes(rod.solve())


def test_two_cavities_have_volumes_of_their_own_between_ratios() -> None:
    """Air of the first cavity grows with its pressure, that of the second one with the curvature."""

    def of(direction: float) -> ArmLaw:
        known = ray(direction)
        first = min(1.0, 2.0 - direction)
        cells, clamps, tips = [], [], []
        for cell, clamp, tip in zip(known.cells, known.clamps, known.tips, strict=True):
            columns = [np.full(len(cell.kappa), 30.0 + 0.2 * first * cell.pressure), 40.0 - 50.0 * cell.kappa]
            volume = np.column_stack(columns)
            cells.append(replace(cell, volume=volume))
            clamps.append(replace(clamp, volume=float(clamp.s[-1]) * volume))
            tips.append(replace(tip, volume=-float(tip.s[0]) * volume[len(volume) // 2]))
        return replace(known, cells=tuple(cells), clamps=tuple(clamps), tips=tuple(tips))

    law = PairLaw(("upper", "lower"), (0.0, 1.0, 2.0), (of(0.0), of(1.0), of(2.0)))
    for pressures in ((20.0, 8.0), (8.0, 20.0)):
        section = law.at(pressures).section
        assert section.volume[:, 0] == pytest.approx(30.0 + 0.2 * pressures[0], rel=1e-9)
        assert section.volume[:, 1] == pytest.approx(40.0 - 50.0 * section.kappa, rel=1e-6)
        rod = law.at(pressures)
        assert rod.volumes(rod.solve())[0] == pytest.approx((30.0 + 0.2 * pressures[0]) * rod.length, rel=1e-3)
