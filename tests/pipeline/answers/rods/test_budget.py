"""What tolerances do to an arm, by the derivatives of its law."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from pipeline.answers.rods.budget import Budget, budget_of, budget_page, make_budgets
from pipeline.api.frames import budget_frame, sensitivities_frame
from pipeline.config import units
from pipeline.config.load import load_config
from pipeline.config.tolerances import STIFFNESS, Tolerance, Tolerances
from pipeline.results.files import read_plane_law
from pipeline.results.laws import law_record
from rod import ArmLaw
from rod.arm_law.curves import ACROSS, IN_SPACE, CellCurve
from rod.arm_law.rates import CellRate, ClampRate, LawRate, changed_cells, onset_rate
from tests.coarse import COARSE, coarse_run
from tests.commands import refused

CONFIG = Path(__file__).resolve().parents[4] / "configs" / "pneunet_coarse.yaml"


def scaled_law() -> ArmLaw:
    """The law of the coarse arm with the exact derivatives by its modulus: moments scale with it, at p over it."""
    law, E = read_plane_law(COARSE / "law.json"), 1.2

    def of_cell(cell: CellCurve) -> CellRate:
        p = cell.pressure
        moment = (cell.moment - p * cell.moment_by_pressure) / E
        return CellRate(moment, -p * cell.stretch_by_pressure / E, np.zeros((len(moment), 2, 2)), np.zeros(()))

    clamps = tuple(
        ClampRate(
            -(one.moment * one.rotation_by_moment + one.pressure * one.rotation_by_pressure) / E,
            np.zeros_like(one.offset),
        )
        for one in law.clamps
    )
    rate = LawRate(E, "MPa", 0.0, 0.0, 0.0, tuple(map(of_cell, law.cells)), clamps)
    # rounding is left of the moments of cells that do not have the parameter
    none = tuple(
        CellRate(1e-15 * c.moment, 0.0 * c.moment, np.zeros((len(c.moment), 2, 2)), np.zeros(())) for c in law.cells
    )
    still = tuple(ClampRate(0.0 * c.rotation, 0.0 * c.offset) for c in law.clamps)
    longer = LawRate(10.0, "mm", 0.0, 0.0, 1.0, none, still)
    return replace(law, rates={"material.E": rate, "geometry.end": longer})


def budget(tolerances: Tolerances, held_mm: float | None = 0.0) -> Budget:
    return make_budgets(scaled_law(), tolerances, [37.0], held_mm)[0]


def test_a_stiffer_arm_is_an_arm_at_a_lower_pressure() -> None:
    """Curvature and tip depend on p/E alone; forces and rigidities are E times functions of p/E."""
    found = {row.parameter: row for row in budget(Tolerances("cast", {"pressure": Tolerance(0.1, True)})).rows}
    modulus, pressure = found[STIFFNESS], found["pressure"]
    assert modulus.changes["kappa_0"] == pytest.approx(pressure.changes["kappa_0"], rel=0.005)
    assert modulus.changes["tip"] == pytest.approx(pressure.changes["tip"], rel=0.01)
    assert modulus.changes["force"] == pytest.approx(
        abs(0.1 - pressure.changes["force"]), rel=0.3
    )  # a difference of large numbers
    assert 0.03 < modulus.changes["kappa_0"] < 0.2
    assert modulus.tolerance == pressure.tolerance == "10 %"
    assert modulus.is_default
    assert not pressure.is_default


def test_tolerances_are_linear_independent_and_ordered() -> None:
    small, large = (budget(Tolerances("cast", {"material.E": Tolerance(amount, False)})) for amount in (0.06, 0.12))
    rows = [next(row for row in one.rows if row.parameter == "material.E") for one in (small, large)]
    assert rows[1].changes["rigidity"] == pytest.approx(2.0 * rows[0].changes["rigidity"], rel=1e-6)
    assert rows[0].tolerance == "0.06 MPa"
    tips = [row.changes["tip"] for row in large.rows]
    assert tips == sorted(tips, reverse=True)
    assert large.total("tip") == pytest.approx(math.hypot(*tips))
    assert large.largest().parameter == "material.E"
    # an arm of 10 + 0.2 mm of something that makes it longer by as much, and does nothing else
    longer = next(row for row in large.rows if row.parameter == "geometry.end")
    assert longer.tolerance == "0.2 mm"
    assert longer.changes["kappa_0"] == pytest.approx(0.0, abs=1e-12)
    assert longer.changes["tip"] == pytest.approx(0.2 / 112.0, rel=0.1)


def test_rigidities_out_of_the_plane_have_columns_where_the_law_has_them() -> None:
    """Here they are E times constants of the cells."""
    planar = scaled_law()
    cells, rates = [], []
    for cell, rate in zip(planar.cells, planar.rates["material.E"].cells, strict=True):
        cells.append(replace(cell, **dict.fromkeys(IN_SPACE, 600.0 + 0.0 * cell.moment)))
        rates.append(replace(rate, **dict.fromkeys(ACROSS, 500.0 + 0.0 * cell.moment)))
    known = planar.rates | {"material.E": replace(planar.rates["material.E"], cells=tuple(rates))}
    law = replace(planar, cells=tuple(cells), rates=known)
    found = {row.parameter: row for row in make_budgets(law, Tolerances(), [37.0], None)[0].rows}
    assert found[STIFFNESS].changes["lateral_rigidity"] == pytest.approx(0.1)
    assert found[STIFFNESS].changes["torsional_rigidity"] == pytest.approx(0.1)
    assert found["geometry.end"].changes["lateral_rigidity"] == pytest.approx(0.0, abs=1e-12)
    assert found["pressure"].changes["torsional_rigidity"] == pytest.approx(0.0, abs=1e-12)
    table = make_budgets(law, Tolerances(), [37.0], None)[0].table
    assert table.heads[-2:] == ("B₂ (%)", "GJ (%)")
    assert [cells[-1] for cells in table.rows if cells[0] == "all"] == ["10"]
    assert "GJ (%)" not in make_budgets(planar, Tolerances(), [37.0], None)[0].table.heads
    assert law.derivative("material.E")["lateral_rigidity"] == pytest.approx(500.0)
    assert "lateral_rigidity" not in planar.derivative("material.E")
    assert set(sensitivities_frame(law)["number"]) - set(sensitivities_frame(planar)["number"]) == set(ACROSS)
    assert "lateral_rigidity_N_mm2" in law_record(law)["derivatives"]["material.E"]
    assert "lateral_rigidity_N_mm2" not in law_record(planar)["derivatives"]["material.E"]
    carried = law.carried({"material.E": 0.012})
    assert carried.cells[-1].torsional_rigidity == pytest.approx(606.0)
    assert carried.rates["material.E"].cells[-1].torsional_rigidity == pytest.approx(500.0)


def test_a_free_end_has_no_force() -> None:
    found = budget(Tolerances(), None)
    assert all(math.isnan(row.changes["force"]) for row in found.rows)
    assert math.isnan(found.total("force"))
    assert all(row[-1] == "-" for row in found.table.rows)
    assert "force in III" not in budget_page("arm", [found])


def test_the_budget_is_a_table_in_per_cent() -> None:
    found = budget(Tolerances("cast", {"pressure": Tolerance(0.1, True)}))
    table = budget_frame(found)
    assert table.columns.to_list()[:3] == ["tolerance_of", "tolerance", "tip_percent"]
    assert table.tolerance_of.to_list() == [*(row.parameter for row in found.rows), "all"]
    assert table.tip_percent.iloc[-1] == pytest.approx(100.0 * found.total("tip"))
    assert str(table).splitlines()[0].split() == table.columns.to_list()


def test_a_law_without_derivatives_has_no_budget() -> None:
    assert budget_of(coarse_run()) is None
    assert pneurod.read_results(COARSE).budget().empty
    assert "no derivatives" in refused("budget", str(COARSE))


def test_tolerances_are_read_and_kept_apart_from_the_results() -> None:
    given = "tolerances={process: printed, geometry.wall: 0.2 mm, material.E: 5 %, pressure: 1 kPa}"
    config = load_config(CONFIG, [given])
    assert config.tolerances == Tolerances.from_record(config.record()["tolerances"])
    every = config.tolerances.all({"geometry.wall": 1.0, "geometry.width": 15.0})
    assert every["geometry.wall"].of(1.0) == 0.2
    assert every["geometry.width"].of(15.0) == 0.1
    assert every["material.E"].of(1.2) == pytest.approx(0.06)
    assert STIFFNESS not in every
    assert "tolerances" not in load_config(CONFIG).record()  # hashes of results stay
    changed = config.tolerances.with_setting("geometry.wall", "0.3 mm", {"geometry.wall": units.LENGTH})
    assert (changed.given["geometry.wall"].amount, changed.process) == (0.3, "printed")
    assert changed.with_setting("process", "cast", {}).process == "cast"


def test_cast_arms_have_the_tolerances_of_moulded_rubber() -> None:
    every = Tolerances().all({"a": 1.0, "b": 5.0, "c": 15.0, "d": 112.0, "e": 200.0})
    assert [every[key].of(value) for key, value in zip("abcde", (1.0, 5.0, 15.0, 112.0, 200.0), strict=True)] == [
        *(0.1, 0.15, 0.2, 0.7),
        1.0,
    ]


def test_derivatives_as_a_frame() -> None:
    frame = sensitivities_frame(scaled_law())
    row = frame.query("parameter == 'material.E' and number == 'kappa_0' and pressure_kPa == 37")
    expected = scaled_law().derivative("material.E")["kappa_0"][-1]
    assert float(row["derivative"].iloc[0]) == expected
    assert row["unit"].iloc[0] == "1/mm per MPa"
    assert float(row["relative"].iloc[0]) == pytest.approx(-0.71, abs=0.01)
    assert sensitivities_frame(None).empty


def test_the_onset_of_contact_moves_with_a_kink() -> None:
    """Two lines of rigidity 160 and 240 N mm2 that meet at a curvature which moves by 0.02 1/mm per unit."""
    cell, moves = read_plane_law(COARSE / "law.json").cells[-1], 0.02
    onset = float(cell.kappa[len(cell.kappa) // 2 - 1 : len(cell.kappa) // 2 + 1].mean())
    beyond = cell.kappa > onset
    kinked = replace(
        cell,
        moment=160.0 * cell.kappa + 80.0 * np.maximum(cell.kappa - onset, 0.0),
        rigidity=np.where(beyond, 240.0, 160.0),
        contact=beyond,
    )
    rate = CellRate(3.0 - 80.0 * moves * beyond, 0.0 * cell.kappa, np.zeros((len(beyond), 2, 2)), np.zeros(()))
    assert onset_rate(kinked, rate) == pytest.approx(moves)
    (changed,) = changed_cells([kinked], [[rate.times(0.01)]])
    assert changed.onset == pytest.approx(onset + 0.01 * moves)
    assert changed.rigidity == pytest.approx(kinked.rigidity)
    assert np.isnan(onset_rate(replace(kinked, contact=~beyond & beyond), rate))
