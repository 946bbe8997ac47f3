"""The pressure for a place of the end, an angle or a force: `pneurod solve` against `pneurod rod`, both ways."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import pneurod
from pipeline.answers.rods.choice import choose_rod
from pipeline.answers.rods.pressures import Wish, pressures_for
from pipeline.answers.rods.rods import Rods
from rod import FiveParameters, Load, Loading, Rod, RodError
from rod.inverse import Branch
from tests.coarse import COARSE, coarse_run
from tests.commands import done, refused

HANGING = Loading(direction=(1.0, 0.0), tip_mass=1.0)


@pytest.fixture(scope="module")
def rods() -> Rods:
    return choose_rod(coarse_run(0.001))


@pytest.mark.parametrize("pressure", [3.0, 17.0, 24.5, 36.0])
def test_the_pressure_comes_back_from_what_the_rod_does(rods: Rods, pressure: float) -> None:
    rod = rods.at(pressure)
    free, held, loaded = rod.solve(), rod.solve(end_y=-5.0), rod.solve(direction="hanging", tip_mass=1.0)
    wishes = {
        "tip": Wish(tip_mm=free.end),
        "angle": Wish(angle_deg=free.bending_deg),
        "bent": Wish(angle_deg=loaded.bending_deg, loading=HANGING),
        "force": Wish(force_N=float(held.force[1]), height_mm=-5.0),
        "loaded": Wish(tip_mm=loaded.end, loading=HANGING),
    }
    for name, wish in wishes.items():
        found = pressures_for(rods, wish)
        nearest = min(found, key=lambda at: abs(at.pressure_kPa - pressure))
        assert nearest.pressure_kPa == pytest.approx(pressure, abs=0.005), name
        shape = held if name == "force" else loaded if name in ("loaded", "bent") else free
        assert nearest.tip_mm == pytest.approx(shape.end, abs=0.02)
        assert nearest.error_kPa is not None
        assert 0.0 < nearest.error_kPa < 2.0


def test_the_angle_of_a_held_end_is_that_of_its_section(rods: Rods) -> None:
    """Its chord does not turn, its section turns by tens of degrees; the slope is that of neighbouring pressures."""
    [branch] = Branch.all_of(rods.at, lambda rod: rod.solve(end_y=0.0), rods.over_one_pressure)
    bends = branch.paths[-1].bending_deg
    [at] = branch.where(bends, 33.4)
    held = rods.at(at.pressure).solve(end_y=0.0)
    assert held.end[1] == pytest.approx(0.0, abs=1e-6)
    assert held.bending_deg == pytest.approx(33.4, abs=1e-3)
    less, more = (rods.at(at.pressure + step).solve(end_y=0.0).bending_deg for step in (-0.05, 0.05))
    assert at.of(bends)[1] == pytest.approx((more - less) / 0.1, rel=5e-3)  # the first pass is right to half a percent


def test_the_commands_agree_both_ways() -> None:
    [at] = json.loads(done("solve", str(COARSE), "--tip", "[70.87 mm, -70.87 mm]", "--json"))["solutions"]
    printed = done("rod", str(COARSE), "--pressure", f"{at['pressure_kPa']} kPa")
    end = [float(value) for value in re.findall(r"[xy] = (-?[\d.]+) mm", printed)]
    assert end == pytest.approx(at["tip_mm"], abs=0.01)
    bends_by = float(re.findall(r"bends by +(-?[\d.]+)°", printed)[0])
    assert bends_by == pytest.approx(at["angle_deg"], abs=0.01)
    out = done("solve", str(COARSE), "--angle", "1.5708 rad")
    assert "bends by 90.00°" in out
    assert "Do not use a rod of this run" in out


def test_several_solutions_are_named() -> None:
    """An arm whose bending has a maximum over the pressure."""
    parabola = np.array([0.0, 0.01, 0.012, 0.01, 0.004])
    lines = FiveParameters(400.0, 400.0, 0.0, 0.0, 50.0)

    def rod(pressure: float) -> Rod:
        return Rod(100.0, float(np.interp(pressure, [0.0, 10.0, 20.0, 30.0, 40.0], parabola)), lines)

    [branch] = Branch.all_of(rod, Rod.solve, [0.0, 10.0, 20.0, 30.0, 40.0])
    found = list(branch.where(lambda states: states[:, 1], rod(5.0).solve().end[1]))
    assert [at.pressure for at in found] == pytest.approx([5.0, 38.3333], abs=0.01)
    near = list(branch.nearest(rod(25.0).solve().end))
    assert any(at.pressure == pytest.approx(25.0, abs=0.01) for at in near)


def test_an_upright_arm_that_its_load_has_bent_over_is_followed_to_no_pressure() -> None:
    """A column under more than the force of Euler: at rest the load has no path, but the arm came from elsewhere."""
    lines, force = FiveParameters(400.0, 400.0, 0.0, 0.0, 50.0), (-1.5 * np.pi**2 / 4.0 * 400.0 / 100.0**2, 0.0)

    def rod(pressure: float) -> Rod:
        return Rod(100.0, 2e-4 * pressure, lines)

    with pytest.raises(RodError, match=r"66\.7 % of the load"):
        rod(0.0).under(Load(force))
    [branch] = Branch.all_of(rod, lambda one: one.under(Load(force)), [0.0, 20.0, 40.0])
    assert branch.pressures[[0, -1]] == pytest.approx([0.0, 40.0])
    k = brentq(lambda m: ellipk(m) - 0.5 * np.pi * np.sqrt(1.5), 0.0, 0.99)
    elastica = 100.0 * np.array([2.0 * ellipe(k) / ellipk(k) - 1.0, 2.0 * np.sqrt(k) / ellipk(k)])
    assert branch.states[0, :2] == pytest.approx(elastica, abs=1e-3)
    [at] = branch.where(lambda states: states[:, 0], rod(1.0).solve(force=force).end[0])
    assert at.pressure == pytest.approx(1.0, abs=1e-3)
    less, more = (rod(pressure).solve(force=force).end for pressure in (0.99, 1.01))
    assert at.slope[:2] == pytest.approx((np.array(more) - less) / 0.02, rel=0.01)


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    table, again = tmp_path / "shape.csv", tmp_path / "again.csv"
    write = ("rod", str(COARSE), "--pressure", "17 kPa", "--out")
    table.write_text("mine")
    assert "was not made by this command" in refused(*write, str(table))
    assert table.read_text() == "mine"
    done(*write, str(again))
    done(*write, str(again))
    again.write_text(again.read_text() + "a note")
    refused(*write, str(again))
    assert again.read_text().endswith("a note")


def test_python_takes_numbers_and_texts() -> None:
    results = pneurod.read_results(COARSE)
    numbers, texts = results.pressure_for(angle=90.0), results.pressure_for(angle="90 deg")
    pd.testing.assert_frame_equal(numbers, texts)
    held = results.pressure_for(force="0.03 N", at_height="0 mm")
    assert held.force_y_N.to_list() == pytest.approx([0.03], abs=1e-4)
    loaded = results.pressure_for(angle="60 deg", direction="hanging", tip_mass="1 g")
    assert loaded.pressure_kPa[0] > results.pressure_for(angle=60.0).pressure_kPa[0]
    wrong: Any = 3
    with pytest.raises(pneurod.InputError, match=r"^tip: 3 is not a pair"):
        results.pressure_for(tip=wrong)
    with pytest.raises(pneurod.InputError, match="give one of a tip, an angle and a force"):
        results.pressure_for()


def test_the_pressures_are_a_table_that_prints_every_column() -> None:
    found = pneurod.read_results(COARSE).pressure_for(tip=("70.87 mm", "-70.87 mm"))
    columns = ["pressure_kPa", "error_kPa", "tip_x_mm", "tip_y_mm", "angle_deg", "force_x_N", "force_y_N", "away_mm"]
    assert found.columns.to_list() == columns
    head, *rows = str(found).splitlines()
    assert head.split() == columns
    assert len(rows) == len(found)
    assert rows[0].split()[0] == f"{found.pressure_kPa[0]:.4g}"
