"""What is said of an arm whose chambers swell at a limit of the pressure, and the questions to its two forms."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from pipeline.answers.measured.rows import State
from pipeline.results.laws import law_record
from pipeline.results.unloaded import limit_of, unloaded_states
from pipeline.show.figures import bending
from pipeline.values.law import DeliveredLaw
from pipeline.values.reasons import render
from pneurod import InputError, RodWarning, RunFailed
from rod import ArmLaw
from rod.arm_law.curves import CellCurve
from tests.measured_arm import LENGTH, measured, parts_of, result_folder, with_body
from tests.snapping_arm import BY_WALL, CURVED, LIMIT, kappa_0, snapping_law

BEFORE = "At 27 kPa its chambers swell at once. At 24 kPa this is the form before that; there is a swollen one, too."
WAY = "unstable, along the volume of its air"
AFTER = "At 27 kPa its chambers swell at once. This is the swollen form, which is lost below 22 kPa."


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of an arm with both forms."""
    return folder_of(tmp_path_factory.mktemp("snaps"), snapping_law())


def folder_of(folder: Path, law: ArmLaw) -> Path:
    """With the arm without a load at 15, 26 and 30 kPa."""
    with_body(result_folder(folder, law))
    states = [asdict(state) for state in unloaded_states(law, [15.0, 26.0, 30.0])]
    (folder / "law.json").write_text(json.dumps({**law_record(law), "unloaded": states}), encoding="utf-8")
    return folder


def angle(pressure: float, *, after_snap: bool) -> float:
    """Degrees, in closed form."""
    return abs(np.degrees(LENGTH * kappa_0(pressure, after_snap=after_snap)))


def test_a_rod_of_either_form_says_which_it_is(folder: Path) -> None:
    for after_snap, note in ((False, BEFORE), (True, AFTER)):
        shown = pneurod.shape(folder, "24 kPa", after_snap=after_snap)
        assert shown.shape.bending_deg == pytest.approx(angle(24.0, after_snap=after_snap), rel=2e-3)
        assert shown.lines[-1] == note
        results = pneurod.read_results(folder)
        with pytest.warns(RodWarning):
            rod = results.rod(24.0, after_snap=after_snap)
        assert rod.notes[-1] == note
        assert rod.solve().bending_deg == pytest.approx(shown.shape.bending_deg, abs=1e-9)
    assert not any("swell" in line for line in pneurod.shape(folder, "15 kPa").lines)


def test_beyond_the_limit_a_rod_has_swollen(folder: Path) -> None:
    shown = pneurod.shape(folder, "30 kPa")
    assert shown.shape.bending_deg == pytest.approx(angle(30.0, after_snap=True), rel=2e-3)
    assert shown.lines[-1] == AFTER


def test_near_a_limit_without_a_form_beyond_it_is_noted(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, snapping_law(swells=False))
    assert pneurod.shape(folder, "25 kPa").lines[-1] == "At 27 kPa its chambers swell at once."
    assert "At 27 kPa its chambers swell at once." in pneurod.export(folder, "json", out=tmp_path).sentences
    assert not any("swell" in line for line in pneurod.shape(folder, "20 kPa").lines)


def test_the_report_draws_both_forms_and_the_unstable_part(folder: Path) -> None:
    run = pneurod.read_results(folder).run
    angle_over_pressure, _ = bending(run)
    lines = {line.name: line for line in angle_over_pressure.lines}
    rising, unstable, swollen = (lines[name] for name in ("inflated from rest", WAY, "after the snap"))
    assert unstable.dash == "dash"
    assert np.allclose(np.array(unstable.x)[[0, -1]], [27.0, 22.0])
    assert np.allclose(unstable.y, np.degrees(LENGTH * abs(CURVED)) * np.linspace(1.0, 3.0, 21), rtol=1e-3)
    assert (rising.y[-1], swollen.y[0]) == pytest.approx([angle(26.6, after_snap=False), angle(22.1, after_snap=True)])
    law = run.law
    assert law.curves(30.0) is None
    assert (law.curves(32.0) or law.curves(0.0))[0].pressure == 32.0  # type: ignore[index]


def test_solve_finds_the_pressure_in_either_form(folder: Path) -> None:
    (before,) = pneurod.solve(folder, angle="12 deg").solutions
    (after,) = pneurod.solve(folder, angle="76 deg").solutions
    assert angle(before.pressure_kPa, after_snap=False) == pytest.approx(12.0, rel=2e-3)
    assert angle(after.pressure_kPa, after_snap=True) == pytest.approx(76.0, rel=2e-3)
    assert before.note == BEFORE.replace("24", f"{before.pressure_kPa:.4g}")
    assert after.note == AFTER


def test_solve_gives_both_pressures_where_both_forms_have_the_force(tmp_path: Path) -> None:
    """The swollen form is as bent as the other at first, and so has the same forces."""
    law = snapping_law()
    assert law.limit
    assert law.back
    swollen = replace(
        law.swollen,
        cells=tuple(parts_of(p, 0.5 * CURVED * p / 25.0, 0.5 * CURVED / 25.0)[0] for p in law.swollen.pressures),
    )
    folder = folder_of(tmp_path, replace(law, swollen=swollen))
    first, second = pneurod.solve(folder, angle="9 deg").solutions
    assert (first.note, second.note) == ("", AFTER)
    assert angle(first.pressure_kPa, after_snap=False) == pytest.approx(9.0, rel=2e-3)
    assert second.pressure_kPa == pytest.approx(25.0 * 9.0 / np.degrees(0.5 * abs(CURVED) * LENGTH), rel=2e-3)


def test_a_motion_ends_at_the_limit(folder: Path, tmp_path: Path) -> None:
    table = tmp_path / "p.csv"
    table.write_text("t_s,pressure_kPa\n0,20\n0.5,30\n", encoding="utf-8")
    with pytest.raises(RunFailed, match=r"At t = 0\.\d+ s the motion leaves .*At 27 kPa its chambers swell at once\."):
        pneurod.move(folder, table, seconds=0.5, out=tmp_path)


def test_air_that_chambers_share_is_doubted(tmp_path: Path) -> None:
    def aired(law: ArmLaw) -> ArmLaw:
        cells = tuple(replace(cell, volume=np.full((9, 1), 50.0)) for cell in law.cells)
        clamps = tuple(replace(clamp, volume=np.full((9, 1), 500.0)) for clamp in law.clamps)
        return replace(
            law, cells=cells, clamps=clamps, tips=tuple(replace(tip, volume=np.full(1, 500.0)) for tip in law.tips)
        )

    folder = folder_of(tmp_path, aired(snapping_law(swells=False)))
    moved = pneurod.move(folder, "10 kPa", seconds=0.02, air="closed")
    assert (
        "Near 27 kPa chambers that share a given amount of air may swell one by one; that is not solved." in moved.notes
    )


@pytest.mark.parametrize(
    ("pressure", "note"), [(None, BEFORE.replace("24", "26.6")), ("24 kPa", BEFORE), ("30 kPa", AFTER)]
)
def test_an_export_says_which_form_it_has(folder: Path, tmp_path: Path, pressure: str | None, note: str) -> None:
    made = pneurod.export(folder, "json", pressure=pressure, out=tmp_path)
    assert note in made.sentences
    content = json.loads(made.files[0].read_text(encoding="utf-8"))
    after_snap = pressure == "30 kPa"
    middle = np.interp(0.0, content["moment_N_mm"][-1], content["kappa_per_mm"][-1])
    assert middle == pytest.approx(kappa_0(content["pressures_kPa"][-1], after_snap=after_snap), rel=2e-3)


def test_the_budget_has_the_swing_of_the_limit(folder: Path) -> None:
    found = pneurod.budget(folder, pressure="20 kPa")
    changes = {row.parameter: row.changes["limit"] for row in found.rows}
    assert changes["geometry.wall"] == pytest.approx(0.1 * BY_WALL / LIMIT)
    assert changes["material.stiffness"] == pytest.approx(0.1)
    assert np.isnan(changes["pressure"])
    assert found.total("limit") == pytest.approx(np.hypot(0.1 * BY_WALL / LIMIT, 0.1))
    assert found.numbers["limit"] == "limit pressure"
    frame = pneurod.read_results(folder).budget(20.0)
    assert frame["limit_percent"].iloc[-1] == pytest.approx(100.0 * found.total("limit"))


def test_derivatives_below_the_limit_are_of_the_form_from_rest() -> None:
    """A wall that is thinner by the step of the difference may snap there; that is another form."""
    law = snapping_law()
    near = replace(law, limit=replace(law.limit, value=26.6001))  # type: ignore[type-var]
    rate = near.derivative("geometry.wall")["kappa_0"][-1]
    assert rate == pytest.approx(law.derivative("geometry.wall")["kappa_0"][-1], rel=0.02)


def test_measurements_are_compared_with_the_form_from_rest(folder: Path, tmp_path: Path, few_proposals: None) -> None:
    states = [State(pressure, (0.0, 0.0)) for pressure in (10.0, 20.0, 25.0)]
    file = measured(tmp_path / "m.csv", snapping_law().scaled(1.05), states)
    assert pneurod.compare(folder, file).rows[0].pressure_kPa == 10.0
    pneurod.calibrate(folder, file, out=tmp_path / "fitted")
    law = pneurod.read_results(tmp_path / "fitted").arm_law
    assert law.swollen
    assert law.limit
    assert law.at(25.0).section.kappa_0 == pytest.approx(kappa_0(25.0 / 1.05), rel=0.03)
    file.write_text("pressure_kPa;tip_y_mm\n10;-4\n30;-70\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"30 kPa.* the rod, which goes from 0 to 26\.6 kPa"):
        pneurod.compare(folder, file)


def test_the_verdict_tells_the_snap(folder: Path) -> None:
    verdict = pneurod.read_results(folder).verdict
    assert verdict.lines[0].startswith("closed_form, 110 mm long, bends by 6°, 15°, 88° at 15, 26, 30 kPa")
    assert verdict.lines[2] == (
        "At 27 ± 0.2 kPa its chambers swell at once: it bends from 19° to 81°, and back at 22 kPa; known to 32 kPa."
    )
    assert verdict.record()["limit"]["code"] == "snaps"  # type: ignore[index]


def test_the_verdict_tells_a_limit_without_a_form_beyond(tmp_path: Path) -> None:
    verdict = pneurod.read_results(folder_of(tmp_path, snapping_law(swells=False))).verdict
    assert verdict.lines[2] == (
        "No form beyond 27 ± 0.2 kPa with this law: a law that stiffens (yeoh, ogden) may have one."
    )

    beyond = limit_of(DeliveredLaw(law=snapping_law(swells=False)), 30.0)
    assert beyond
    assert render(beyond).endswith("may have one, or moduli 1.11 times these for 30 kPa")


def cells_of(bent: dict[float, float]) -> ArmLaw:
    """A law whose arm bends by these degrees at these pressures in kPa."""
    parts = [parts_of(p, -np.radians(degrees) / LENGTH, 0.0) for p, degrees in bent.items()]
    cells, clamps, tips = zip(*parts, strict=True)
    first: CellCurve = cells[0]
    assert first.pressure == 0.0
    return ArmLaw(10.0, 5.0, LENGTH, cells, clamps, tips)


def test_the_verdict_tells_where_little_pressure_bends_it_much(tmp_path: Path) -> None:
    """The measured angles of c5-w7 (Moseley), about."""
    law = cells_of({0.0: 0.0, 20.0: 8.0, 30.0: 20.0, 35.0: 32.0, 37.0: 56.0, 39.0: 80.0, 45.0: 110.0})
    verdict = pneurod.read_results(folder_of(tmp_path, law)).verdict
    assert verdict.lines[2] == (
        "From 35 to 39 kPa 1 kPa changes the angle by 12°: here modulus and pressure must be known to 1 % for 5°."
    )


@pytest.mark.parametrize("power", [0.7, 1.0, 2.0, 3.0])
def test_usual_arms_are_not_steep(tmp_path: Path, power: float) -> None:
    """Even one that curls up at the highest pressure."""
    law = cells_of({p: 300.0 * (p / 45.0) ** power for p in (0.0, 5.0, 17.0, 31.0, 45.0)})
    verdict = pneurod.read_results(folder_of(tmp_path, law)).verdict
    assert verdict.limit is None
    assert "limit" not in verdict.record()
