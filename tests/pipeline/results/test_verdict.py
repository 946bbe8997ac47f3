"""The verdict: at most eight lines, one error that contains rod and mesh, and when no rod should be used."""

import csv
import json
import math
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.results.files import read_results
from pipeline.results.rod_errors import tip_moves_by, uncertain_forces
from pipeline.results.verdict import MOST_WARNINGS, Verdict, verdict_of
from pipeline.store.result_folder import json_text
from pipeline.values.errors import RunFailed
from pipeline.values.law import LawMeshError
from pipeline.values.run import Curve, Reported, RodError, Run
from rod.load import Load
from tests.coarse import coarse_run
from tests.commands import done
from tests.measured_arm import result_folder
from tests.rod.arm_law.test_space_law import law as law_in_space

MESH_ERROR = 0.02


@pytest.fixture(scope="module")
def run() -> Run:
    return coarse_run(MESH_ERROR)


@pytest.fixture(scope="module")
def verdict(run: Run) -> Verdict:
    return verdict_of(run)


def assert_short(verdict: Verdict) -> None:
    assert 1 <= len(verdict.lines) <= 8
    assert sum(len(line.split()) for line in verdict.lines) <= 150
    assert all(verdict.lines)


def test_the_first_line_says_how_far_the_arm_bends(verdict: Verdict, run: Run) -> None:
    bent = verdict.bending[-1]
    assert bent.pressure_kPa == 37.0
    assert bent.angle_deg == pytest.approx(139.9, abs=0.1)
    assert (bent.tip_x_mm, bent.tip_y_mm) == pytest.approx((30.4, -79.8), abs=0.1)
    assert "bends by 72°, 140° at 17, 37 kPa" in verdict.lines[0]


def test_without_a_law_the_finite_elements_say_how_far_the_arm_bends(run: Run) -> None:
    bent = verdict_of(replace(run, law=None, rod_errors=run.errors_of("five"))).bending[-1]
    curve = run.curve("II", 37.0)
    state = next(state for state in run.states if state.experiment == "II" and state.pressure_kPa == 37.0)
    assert bent.angle_deg == -state.end_rotation_deg == pytest.approx(140.2, abs=0.1)
    assert bent.tip_x_mm == pytest.approx(state.end_x_mm)
    assert bent.tip_y_mm == pytest.approx((state.end_y_mm or 0.0) - curve["y_mm"][0])


def test_an_arm_with_three_pressures_says_where_it_bends_the_most(tmp_path: Path) -> None:
    law: Any = law_in_space()
    verdict = verdict_of(read_results(result_folder(tmp_path, law)))
    row = law.rows[0]
    shape = law.at(row).solve_in_space(Load())
    assert verdict.bending[0].angle_deg == pytest.approx(shape.bending_deg)
    assert (
        f"bends by {shape.bending_deg:.0f}° at [10, 0, 0] kPa; its tip is at (78.7, -15.9, 0.0) mm" in verdict.lines[0]
    )
    assert "its errors are not known; no whole arm was solved" in verdict.lines[1]
    assert verdict.lines[2] == "Valid from 0 to 10 kPa."
    assert verdict.warnings == ()


def test_the_error_contains_rod_and_mesh(verdict: Verdict, run: Run) -> None:
    assert verdict.usable
    assert verdict.rod == "arm_law"
    curve = run.curve("II", 37.0)
    more = run.law.mesh_error.kappa_0_per_mm_std[-1]
    assert more == pytest.approx(MESH_ERROR * 0.0221, rel=0.01)
    rod, mesh = verdict.errors[0].shape, tip_moves_by(curve["s_mm"], curve["theta_rad"], more or 0.0)
    assert mesh > 10.0 * rod  # on this mesh nearly all of it is the mesh
    assert verdict.shape_error == pytest.approx(rod + mesh)
    assert verdict.force_error == pytest.approx(verdict.errors[0].force + MESH_ERROR)
    assert_short(verdict)


def test_the_command_runs(verdict: Verdict) -> None:
    words = shlex.split(verdict.command.removeprefix("For example: "))
    assert words[0] == "pneurod"
    assert "bends by" in done(*words[1:])


def test_it_says_where_the_rod_holds(verdict: Verdict) -> None:
    assert verdict.pressures_kPa == (0.0, 37.0)
    assert verdict.moments_N_mm == pytest.approx((-4.15, 15.7), abs=0.05)


def test_a_moment_that_is_small_at_a_low_pressure_does_not_veto_the_rod() -> None:
    """Five chambers of a cast arm: 1.3 N mm at 5 kPa, known to 11 %, beside 9 N mm at 12 kPa."""
    run = coarse_run()
    error = replace(
        run.law.mesh_error,
        kappa_0_per_mm=(1e-5, 0.02),
        kappa_0_per_mm_std=(3e-5, 1e-4),
        rigidity_N_mm2_std=(1.0, 1.0),
        moment_N_mm=(1.3, 9.0),
        moment_N_mm_std=(0.143, 0.1),
    )
    law = replace(run.law, mesh_error=error)
    verdict = verdict_of(replace(run, law=law))
    assert verdict.usable
    assert verdict.mesh.kappa_0 == pytest.approx(1e-4 / 0.02)
    assert verdict.mesh.force == pytest.approx(0.143 / 9.0)
    (uncertain,) = (warning for warning in verdict.warnings if warning.code == "forces_uncertain")
    assert uncertain.values == {
        "pressures_kPa": [run.law.mesh_error.pressures_kPa[0]],
        "percent": pytest.approx(11),
    }


def test_a_rod_without_an_equilibrium_says_why() -> None:
    run = coarse_run()
    why = "The load bends the cells with -38 to 33 N mm; the law covers -12 to 16 N mm."
    lost = tuple(replace(row, reason=why, distance_over_length=None, force_error=None) for row in run.rod_errors)
    refused = verdict_of(replace(run, rod_errors=lost)).refusal
    assert refused.code == "no_rod_bends"
    assert why in refused.text


def test_a_coarse_mesh_is_a_reason_not_to_use_the_rod() -> None:
    refused = verdict_of(coarse_run())
    assert not refused.usable
    assert refused.refusal.code == "no_rod_is_near"
    assert refused.refusal.values["force_percent"] == pytest.approx(11.0, abs=0.5)
    assert "of the force 11 % (rod and mesh added); allowed are 5 and 10 %." in refused.refusal.text
    assert refused.shape_error is None
    assert "--accuracy 1%" in refused.command
    assert_short(refused)


def test_an_arm_that_leaves_the_plane_has_no_rod(run: Run) -> None:
    out = Reported("out_of_plane", {"distance_mm": 3.0}, None, "The arm leaves its plane by 3 mm.")
    record = replace(run.record, remarks=(out,))
    refused = verdict_of(replace(run, record=record))
    assert refused.refusal.code == "out_of_plane"
    assert refused.lines[0] == "pneunet_coarse: The arm leaves its plane by 3 mm."
    assert sum("3 mm" in line for line in refused.lines) == 1
    assert verdict_of(replace(run, record=record, rod_errors=())).refusal == out  # without a rod to compare, too
    assert not refused.warnings  # it is said once


def test_warnings_are_ranked_and_few(run: Run) -> None:
    codes = ("few_pressures", "hardly_bent", "beyond_law", "coarse", "flat")
    remarks = tuple(Reported(code, {}, None, f"About {code}.") for code in codes)
    warned = verdict_of(replace(run, record=replace(run.record, remarks=remarks)))
    assert [warning.code for warning in warned.warnings] == ["beyond_law", "hardly_bent"]
    assert len(warned.warnings) == MOST_WARNINGS
    assert_short(warned)


def test_an_unknown_error_of_the_mesh_is_said(run: Run) -> None:
    unknown = verdict_of(replace(run, law=run.law and replace(run.law, mesh_error=None, unloaded=())))
    assert unknown.usable
    assert unknown.shape_error == unknown.errors[0].shape
    assert "mesh_error_unknown" in {warning.code for warning in unknown.warnings}
    assert "without the error of the mesh" in unknown.lines[1]


def test_failures_are_named(run: Run) -> None:
    failures = (Reported("stopped", {}, None, "experiment II stopped before 45 kPa."), Reported("other", {}, None, "x"))
    failed = verdict_of(replace(run, record=replace(run.record, failures=failures)))
    assert failed.lines[4] == "Not reached: experiment II stopped before 45 kPa. (1 more in the report)"
    assert_short(failed)


def test_a_failure_is_named_with_its_limit_alone(run: Run) -> None:
    why = [
        {"code": "ends_beyond", "values": {"reached_kPa": 40.0, "target_kPa": 45.0}, "where": None},
        {"code": "has_limit", "values": {"limit_kPa": 41.0}, "where": None},
        {"code": "limit_point", "values": {"stiffness": 0.1}, "where": [1.0, 2.0, 3.0]},
    ]
    failure = Reported("stopped", {"experiment": "II", "pressure_kPa": 45.0, "why": why}, None, "A long sentence.")
    failed = verdict_of(replace(run, record=replace(run.record, failures=(failure,))))
    assert "Not reached: Experiment II stopped before 45 kPa: the limit is at 41 kPa." in failed.lines
    first = replace(failure, values={**failure.values, "why": why[:1]})
    failed = verdict_of(replace(run, record=replace(run.record, failures=(first,))))
    assert any(line.endswith("no equilibrium found beyond 40 kPa on the way to 45 kPa.") for line in failed.lines)


def test_a_run_without_any_state_has_a_verdict(run: Run) -> None:
    nothing = verdict_of(Run(run.directory))
    assert not nothing.usable
    assert np.isnan(nothing.length_mm)
    assert_short(nothing)


DESIGNS = Path(__file__).resolve().parents[3] / "studies" / "unseen_designs.csv"
LENGTH = 112.0
#: the moments that bend a cell, N mm
MOMENTS = (0.0, 4.0)


def row(rod: str, shape: float, force: float, pressure: float = 20.0, reason: str = "") -> RodError:
    if reason:
        return RodError("dead", pressure, "dead force 0, -1 N", rod, "out", reason=reason)
    return RodError("III", pressure, "", rod, "in", distance_over_length=shape, force_error=force, force_N=1.0)


def of_mesh(kappa_0: float, moment: float, rigidity: float = 0.0) -> LawMeshError:
    """Of an arm whose curvature and moment pass through zero; parts of the largest curvature, moment and rigidity."""
    return LawMeshError(
        4.0,
        2.0,
        (17.0, 37.0),
        kappa_0_per_mm=(1e-9, 0.02),
        kappa_0_per_mm_std=(0.02 * kappa_0, 0.02 * kappa_0),
        rigidity_N_mm2=(250.0, 250.0),
        rigidity_N_mm2_std=(250.0 * rigidity, 0.0),
        moment_N_mm=MOMENTS,
        moment_N_mm_std=(4.0 * moment, 4.0 * moment),
    )


def straight(run: Run) -> Run:
    """The run of a straight arm, whose end a curvature moves by a closed form, without a mass."""
    s = np.linspace(0.0, LENGTH, 200)
    law = replace(run.law, law=replace(run.law.law, mass=None))
    return replace(
        run, curves=(Curve("II", 20.0, {"s_mm": s, "x_mm": s, "y_mm": 0.0 * s, "theta_rad": 0.0 * s}),), law=law
    )


def moved(kappa: float) -> float:
    """The tip of a straight arm over its length, by a curvature."""
    turn = kappa * LENGTH
    return math.hypot(math.sin(turn) / turn - 1.0, (1.0 - math.cos(turn)) / turn) if turn else 0.0


def judged(run: Run, *rows: RodError, mesh: LawMeshError | None = None) -> Verdict:
    assert run.law is not None
    return verdict_of(replace(run, rod_errors=rows, law=replace(run.law, mesh_error=mesh)))


def check(verdict: Verdict, shape: float, force: float) -> None:
    """Taken within 5 % of the length and 10 % of the force; else both errors are the reason."""
    line = verdict.lines[1]
    if shape <= 0.05 and force <= 0.10:
        assert verdict.usable
        assert line.startswith("Take the rod with ")
        assert verdict.shape_error == pytest.approx(shape, rel=1e-2)
    else:
        assert not verdict.usable
        assert line.startswith("Do not use a rod of this run: error of the shape ")
        assert verdict.refusal.values["shape_percent"] == pytest.approx(100.0 * shape, rel=1e-2)
        assert verdict.refusal.values["force_percent"] == pytest.approx(100.0 * force, rel=1e-2)
    assert "of the length, of the force" in line


def drawn() -> list[tuple[float, float, float, float, float]]:
    """Shape and force of the rod, and curvature, force and rigidity of the mesh, of the designs that have all."""
    keys = ("shape_error", "force_error", "kappa_0_mesh_error", "force_mesh_error", "alpha2_mesh_error")
    rows = list(csv.DictReader(DESIGNS.read_text(encoding="utf-8").splitlines()))
    numbers = [tuple(abs(float(one[key] or 0.0)) for key in keys) for one in rows if one["shape_error"]]
    return [(a, b, c, d, e) for a, b, c, d, e in numbers]


def test_designs_drawn_at_random() -> None:
    run, random = straight(coarse_run()), np.random.default_rng(20261130)
    designs = drawn()
    assert len(designs) > 400
    taken = 0
    for shape, force, kappa_0, of_force, rigidity in (designs[k] for k in random.permutation(len(designs))[:150]):
        for larger in (1.0, float(random.uniform(2.0, 40.0))):  # and as if the rod were worse
            a, b = larger * shape, larger * force
            verdict = judged(run, row("arm_law", a, b), mesh=of_mesh(kappa_0, of_force, rigidity))
            check(verdict, a + moved(0.02 * kappa_0), b + of_force)
            taken += verdict.usable
    assert 100 < taken < 290


def test_of_two_rods_one_that_is_good_is_taken() -> None:
    run, random = straight(coarse_run()), np.random.default_rng(7)
    for _ in range(60):
        sizes = random.uniform(0.0, 0.08, 2), random.uniform(0.0, 0.16, 2)
        rows = [row(rod, a, b) for rod, a, b in zip(("arm_law", "five"), *sizes, strict=True)]
        lost = [row(("arm_law", "five")[random.integers(2)], 0.0, 0.0, reason="beyond its law") for _ in range(2)]
        verdict = judged(run, *rows, *lost, mesh=of_mesh(1e-4, 1e-4))
        good = (sizes[0] < 0.0497) & (sizes[1] < 0.0999)
        assert verdict.usable == good.any()
        assert not good.any() or good[("arm_law", "five").index(verdict.rod)]


def test_a_load_that_the_rod_does_not_bear_is_said_beside() -> None:
    rows = row("five", 0.019, 0.024), row("arm_law", 0.0002, 0.005), row("arm_law", 0.0, 0.0, 14.0, "beyond the law")
    verdict = judged(straight(coarse_run()), *rows, mesh=of_mesh(0.006, 0.005))
    assert (verdict.rod, verdict.usable) == ("arm_law", True)
    assert verdict.lines[1].startswith("Take the rod with the arm's own law: error of the shape 0.69 % of the length")
    assert "It does not bear 1 of 2 loads, such as dead force 0, -1 N, 14 kPa." in verdict.lines[2]


def test_one_rigidity_at_one_pressure_is_a_note() -> None:
    run = straight(coarse_run())
    verdict = judged(run, row("arm_law", 0.03, 0.05), mesh=of_mesh(0.006, 0.005, rigidity=0.13))
    assert verdict.usable
    (note,) = (one for one in verdict.warnings if one.code == "forces_uncertain")
    assert note.text == "Forces are uncertain by up to 13 % at 17 kPa because of the mesh; shapes hold."
    assert run.law is not None
    crossing = replace(run, law=replace(run.law, mesh_error=of_mesh(0.1, 0.05)))
    assert uncertain_forces(crossing, "arm_law") is None  # a moment of zero is uncertain by more than itself


def with_remarks(run: Run, *remarks: Reported) -> Run:
    return replace(run, record=replace(run.record, remarks=remarks))


def test_remarks_on_five_parameters_are_not_those_of_the_law() -> None:
    poor = Reported("one_rigidity_poor", {}, None, "R² is 0.00 at 14 kPa.")
    run = with_remarks(straight(coarse_run()), poor)
    law = judged(run, row("five", 0.03, 0.02), row("arm_law", 0.001, 0.001), mesh=of_mesh(1e-4, 1e-4))
    five = judged(run, row("five", 0.001, 0.001), row("arm_law", 0.03, 0.02), mesh=of_mesh(1e-4, 1e-4))
    assert (law.rod, five.rod) == ("arm_law", "five")
    assert poor not in law.warnings
    assert poor in five.warnings
    assert "the arm's own law" not in " ".join(five.lines)


def test_an_arm_that_falls_over_does_not_bend() -> None:
    text = "The arm falls over in its plane (along y): its equilibrium at 30 kPa (II) is unstable; make it shorter."
    falls = Reported("unstable_states", {"experiment": "II", "pressure_kPa": 30.0, "directions": 1}, None, text)
    lost = Reported("not_identified", {}, None, "No five parameters at 30 kPa: the moment turns back.")
    run = coarse_run()
    run = replace(run, record=replace(run.record, remarks=(falls,), failures=(lost,)), rod_errors=(), law=None)
    verdict = verdict_of(run)
    assert verdict.lines[0] == f"pneunet_coarse, 112 mm long: {text}"
    assert "bends by 74° at 17 kPa" in verdict.lines[1]
    assert not any("turns back" in line or "lower pressures" in line for line in verdict.lines)
    assert falls not in verdict.warnings
    with pytest.raises(RunFailed) as raised:
        run.raise_if_failed()
    assert raised.value.brief.startswith(text)


def test_the_record_is_json_with_these_keys(verdict: Verdict) -> None:
    record = json.loads(json_text(verdict.record()))
    keys = "design length_mm draft bending rod refusal shape_error force_error mesh falls not_borne pressures_kPa"
    assert set(record) == set(f"{keys} moments_N_mm tolerances failures warnings errors usable lines".split())
    assert record["lines"] == list(verdict.lines)
    assert record["errors"][0]["rod"] == "arm_law"
    assert record["bending"][1]["angle_deg"] == pytest.approx(139.9, abs=0.1)
