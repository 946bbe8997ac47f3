"""The verdict: at most eight lines, one error that contains rod and mesh, and when no rod should be used."""

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.results.files import read_results
from pipeline.results.rod_errors import tip_moves_by
from pipeline.results.verdict import MOST_WARNINGS, Verdict, verdict_of
from pipeline.store.result_folder import json_text
from pipeline.values.run import Reported, Run
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
    assert curve is not None
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
    assert curve is not None
    assert run.law is not None
    assert run.law.mesh_error is not None
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
    assert run.law is not None
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
    assert refused is not None
    assert refused.code == "no_rod_bends"
    assert why in refused.text


def test_a_coarse_mesh_is_a_reason_not_to_use_the_rod() -> None:
    refused = verdict_of(coarse_run())
    assert not refused.usable
    assert refused.refusal is not None
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
    assert refused.refusal is not None
    assert refused.refusal.code == "out_of_plane"
    assert refused.lines[0] == "pneunet_coarse: The arm leaves its plane by 3 mm."
    assert sum("3 mm" in line for line in refused.lines) == 1
    assert verdict_of(replace(run, record=record, rod_errors=())).refusal == out  # without a rod to compare, too
    assert not refused.warnings  # it is said once


def test_a_rod_far_from_the_finite_elements_is_refused(run: Run) -> None:
    far = tuple(replace(error, distance_over_length=0.2) for error in run.rod_errors)
    refused = verdict_of(replace(run, rod_errors=far))
    assert refused.refusal is not None
    assert refused.refusal.code == "no_rod_is_near"


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


def test_the_record_is_json_with_these_keys(verdict: Verdict) -> None:
    record = json.loads(json_text(verdict.record()))
    assert set(record) == {
        *("design", "length_mm", "draft", "bending", "rod", "refusal", "shape_error", "force_error", "mesh"),
        *(
            "falls",
            "not_borne",
            "pressures_kPa",
            "moments_N_mm",
            "tolerances",
            "failures",
            "warnings",
            "errors",
            "usable",
            "lines",
        ),
    }
    assert record["lines"] == list(verdict.lines)
    assert record["errors"][0]["rod"] == "arm_law"
    assert record["bending"][1]["angle_deg"] == pytest.approx(139.9, abs=0.1)
