"""The verdict of a run: what it says of errors, of the mesh, of what was not tested and of what to do next."""

import json
import shutil
from pathlib import Path

import pytest

import pneurod
from fem.path.diagnosis import EARLY_LIMITS
from pipeline.report.law_range import moments_of_identification
from pipeline.report.mesh_error import mesh_besides
from pipeline.report.next_steps import next_steps
from pipeline.report.page import render_report
from pipeline.report.results import Results, read_results
from pipeline.report.sentences import in_short, not_reached, opening
from pipeline.report.untested import untested
from pipeline.report.verdict import Verdict, verdict_of
from pipeline.terminal import verdict_table

OLD = Path(__file__).parent.parent.parent / "data" / "results_format_1"
OUT = {"sample": "out", "pressure_kPa": 17.0, "distance_over_length": 0.01}
HEIGHT = {**OUT, "experiment": "III", "load": "end at +10 mm", "force_error": 0.02}
FORCE = {**OUT, "experiment": "dead", "load": "dead force 0, 1 N"}
BETWEEN = {**OUT, "experiment": "II", "pressure_kPa": 27.0}
MESH = {
    "size_mm": 6.0,
    "from_file": False,
    "formulation": "mixed",
    "grading": "off",
    "chosen": {},
    "elements": 9000,
    "mean_edge_mm": 3.1,
    "longest_edge_mm": 7.2,
    "volume_over_drawing": 1.0,
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return shutil.copytree(OLD, tmp_path / "arm")


def change(folder: Path, name: str, **keys: object) -> None:
    path = folder / f"{name}.json"
    path.write_text(json.dumps({**json.loads(path.read_text(encoding="utf-8")), **keys}), encoding="utf-8")


def with_loads(folder: Path, *rows: dict[str, object]) -> Verdict:
    """The verdict after loads out of sample."""
    kept = json.loads((OLD / "validation.json").read_text(encoding="utf-8"))
    (folder / "validation.json").write_text(json.dumps([*kept, *rows]), encoding="utf-8")
    return verdict_of(read_results(folder))


def test_it_is_the_same_in_python(folder: Path) -> None:
    verdict = verdict_of(read_results(folder))
    assert pneurod.read_results(folder).verdict == verdict
    assert [row.pressure for row in verdict.five] == ["17", "37"]
    assert [cell.value for cell in verdict.five[0].cells] == [
        "185 ± 24", "289.8 ± 0.5", "0.0 ± 0.5", "-0.256 ± 0.004", "6.2 ± 0.5", "1.30 ± 0.03",
    ]  # fmt: skip
    assert verdict.stretches
    assert verdict.five[0].cells[1].interval == "289.1 … 291.0"
    assert verdict.rod == "five_extensible" == verdict.errors[0].rod
    assert verdict.on("rod")[0].startswith("Take the rod with five parameters that stretches")
    assert verdict.on("rod")[1].startswith("The error of the mesh comes on top of that")
    assert "to a real arm both errors apply" in verdict.on("rod")[1]
    assert len(verdict.on("errors")) == 4
    assert verdict.on("errors")[3] == (
        "The rod to take was identified under moments from 0.212 to 4.1 N mm at 17 kPa, from 0.499 to 10.9 N mm at 37 "
        "kPa. Beyond them it is extrapolated, and pneurod rod warns where this is so on more than 15 % of its length."
    )
    assert (
        "their end is then up to 3.58 mm (3.2 % of l, at 37 kPa) from its place without load" in verdict.on("errors")[2]
    )
    assert "symmetry (body, pressure and loads are mirror images" in verdict.on("simulated")[0]
    assert verdict.on("weather") == ()


def test_rods_without_offsets_do_not_jump_under_a_small_load(folder: Path) -> None:
    content = json.loads((folder / "parameters.json").read_text(encoding="utf-8"))
    offsets = {name: [1e-3 * value for value in content[name]] for name in ("m01_N_mm", "m02_N_mm")}
    change(folder, "parameters", **offsets, sixth_number={**content["sixth_number"], **offsets})
    assert not any("however small" in sentence for sentence in verdict_of(read_results(folder)).sentences)


def test_its_record_has_the_numbers_unrounded(folder: Path) -> None:
    record = json.loads(json.dumps(verdict_of(read_results(folder)).record()))
    results = pneurod.read_results(folder)
    first, second = record["parameters"]
    stretching = json.loads((folder / "parameters.json").read_text(encoding="utf-8"))["sixth_number"]
    assert record["parameters_of"] == "five_extensible" == record["rod"]
    for key in ("alpha1_N_mm2_std", "eccentricity_mm", "eccentricity_mm_std"):
        assert second[key] == stretching[key][1]
    assert first["d_mm_95"] == stretching["d_mm_95"][0]
    assert [errors["rod"] for errors in record["errors"]] == ["five_extensible", "five"]
    assert record["errors"][1]["distance_over_length_in_sample"] == pytest.approx(0.025, abs=0.001)
    assert record["errors"][1]["distance_over_length_out_of_sample"] is None
    (folder / "validation.json").unlink()  # without a rod to take the parameters are those of the one that does not
    record = verdict_of(read_results(folder)).record()
    assert (record["rod"], record["parameters_of"]) == ("", "five")
    assert record["parameters"][1]["alpha1_N_mm2_std"] == results.parameters["alpha1_N_mm2_std"][1]
    assert "eccentricity_mm" not in record["parameters"][1]


def test_of_many_pressures_the_moments_at_two_are_named(folder: Path) -> None:
    assert moments_of_identification(read_results(folder), "arm_law") == ""
    ranges, pressures = [[0.1 * k, k] for k in range(1, 6)], [10.0 * k for k in range(1, 6)]
    change(folder, "parameters", pressures_kPa=pressures, moment_range_N_mm=ranges)
    assert moments_of_identification(read_results(folder), "five") == (
        "The rod to take was identified under moments from 0.1 to 1 N mm at 10 kPa, from 0.5 to 5 N mm at 50 kPa "
        "(parameters.json has the moments at the other pressures). Beyond them it is extrapolated, and pneurod rod "
        "warns where this is so on more than 15 % of its length."
    )


def test_the_table_of_a_rod_that_does_not_stretch_has_no_eccentricity(folder: Path) -> None:
    (folder / "validation.json").unlink()
    (table,) = verdict_table(verdict_of(read_results(folder)))
    assert str(table.caption).endswith("below it the 95 % interval")
    assert len(table.columns) == 6


def test_the_verdict_says_whose_parameters_it_has(folder: Path) -> None:
    verdict = verdict_of(read_results(folder))
    assert (verdict.parameters_of, verdict.whose_parameters) == (verdict.rod, "")
    rows = json.loads((folder / "validation.json").read_text(encoding="utf-8"))
    of_law = [{**row, "rod": "arm_law", "distance_over_length": 1e-5, "force_error": 0.0} for row in rows]
    of_five = [{**row, "rod": "five"} for row in rows]
    (folder / "validation.json").write_text(json.dumps([*of_five, *of_law]), encoding="utf-8")
    verdict = verdict_of(read_results(folder))
    assert (verdict.rod, verdict.parameters_of, verdict.record()["parameters_of"]) == ("arm_law", "five", "five")
    sentence = "They belong to the rod with five parameters, not to the rod to take."
    assert sentence in render_report(folder)
    assert str(verdict_table(verdict)[0].caption).endswith(f"\n{sentence}")


@pytest.mark.parametrize(
    ("loads", "sentence"),
    [
        (
            [],
            "Not tested: the rods under another height of the end, a dead force on the end or a pressure between those "
            "of the run.",
        ),
        ([HEIGHT], "Not tested: the rods under a dead force on the end or a pressure between those of the run (tested: "
                   "another height of the end)."),
        ([HEIGHT, FORCE], "Not tested: the rods under a pressure between those of the run (tested: another height of "
                          "the end and a dead force on the end)."),
        ([HEIGHT, FORCE, BETWEEN], ""),
    ],
)  # fmt: skip
def test_loads_that_were_not_tested_are_named(folder: Path, loads: list[dict[str, object]], sentence: str) -> None:
    verdict = with_loads(folder, *loads)
    sentences = [text for text in verdict.on("not tested") if text.startswith("Not tested: the rods")]
    assert sentences == ([sentence] if sentence else [])
    to_do = [text for text in verdict.on("next") if "`validation`" in text]
    assert bool(to_do) == (not loads)


def test_a_dead_force_in_III_is_not_called_untested(folder: Path) -> None:
    config = json.loads((folder / "run.json").read_text(encoding="utf-8"))["config"]
    change(folder, "run", config={**config, "end": {"x_mm": None, "y_mm": None, "force_N": [0.0, 0.02]}})
    assert untested(read_results(folder))[0] == (
        "Not tested: the rods under a prescribed height of the end, another dead force on the end or a pressure "
        "between those of the run."
    )


def test_pressures_and_straight_lines_that_were_not_tested(folder: Path) -> None:
    sentences = verdict_of(read_results(folder)).on("not tested")
    assert "Not tested: pressures below 17 kPa and above 37 kPa." in sentences
    assert any("linear in the pressure" in text for text in sentences)
    change(folder, "parameters", linear_range_tested=True)
    assert not any("linear in the pressure" in text for text in verdict_of(read_results(folder)).on("not tested"))


def test_the_error_of_the_mesh_is_a_number_or_not_estimated(folder: Path) -> None:
    before = verdict_of(read_results(folder))
    assert before.on("mesh error")[0].startswith("Mesh error of the five parameters: not estimated.")
    assert before.spread == "one standard deviation, without the error of the mesh"
    assert verdict_table(before)[0].caption == f"± {before.spread}; below it the 95 % interval, of e only ±"
    assert render_report(folder).count(f"± {before.spread}.") == 1
    assert f"± is {before.spread}; below it is the 95 % interval, of e only ±." in render_report(folder)
    assert any("mesh.coarser" in text for text in before.on("next"))
    names = ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")
    error = {"sizes_mm": [4.0, 6.0], **{f"{name}_std": [1.0, 2.6] for name in names}}
    change(folder, "parameters", mesh_error=error)
    after = verdict_of(read_results(folder))
    assert "estimated from mesh sizes of 4 and 6 mm" in after.on("mesh error")[0]
    assert "2.6 N mm² of α₁" in after.on("mesh error")[0]
    assert after.spread == "one standard deviation"
    assert not any("mesh.coarser" in text for text in after.on("next"))


@pytest.mark.parametrize(("largest", "suggested"), [(0.7, True), (0.02, False)])
def test_a_large_error_of_the_mesh_is_followed_by_a_smaller_size(folder: Path, largest: float, suggested: bool) -> None:
    names = ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")
    error = {"sizes_mm": [6.0, 9.0], **{f"{name}_std": [1.0, 2.6] for name in names}}
    change(
        folder, "parameters", mesh_error=error | {"kappa_0_relative": [0.01, largest], "force_relative": [0.01, 0.01]}
    )
    change(folder, "run", mesh=MESH)
    expected = (
        "Next: take smaller elements, in another --out, because the error of the mesh is about 70 %: for example "
        "--set mesh.size='4 mm'."
    )
    assert (expected in verdict_of(read_results(folder)).on("next")) is suggested


def test_a_mesh_from_a_file_has_no_size_to_change(folder: Path) -> None:
    change(folder, "run", mesh=MESH | {"from_file": True})
    verdict = verdict_of(read_results(folder))
    assert verdict.on("mesh")[0].startswith("Mesh: 9000 mixed elements, those of the file; the edges are 3")
    assert "this one is from a file" in verdict.on("mesh error")[0]
    assert "Next: run the body with a finer mesh in its file too" in " ".join(verdict.on("next"))
    assert not any("mesh.size" in text or "mesh.coarser" in text for text in verdict.sentences)


def test_a_requested_accuracy_is_not_called_missing(folder: Path) -> None:
    change(folder, "run", accuracy={"sentence": "errors estimated: 2 %"})
    verdict = verdict_of(read_results(folder))
    sentence = "that of the requested accuracy, which the standard deviations do not contain."
    assert f"Mesh error of the five parameters: {sentence}" in verdict.on("mesh error")
    assert not any("not estimated" in text for text in (*verdict.on("rod"), *verdict.on("mesh error")))


def test_an_accuracy_that_could_not_be_estimated_is_not_suggested(folder: Path) -> None:
    config = json.loads((folder / "run.json").read_text(encoding="utf-8"))["config"]
    for requested, is_suggested in ((None, True), (0.05, False)):
        change(folder, "run", config=config | {"accuracy": requested})
        steps = " ".join(verdict_of(read_results(folder)).on("next"))
        assert "mesh.coarser=1.5" in steps
        assert ("--accuracy" in steps) == is_suggested


def test_an_accuracy_that_is_not_reached_has_a_next_step(folder: Path) -> None:
    accuracy = {"sentence": "", "requested": 0.03, "is_reached": False, "estimated_error": 0.02}
    finer = {"size_mm": 1.8, "degrees_of_freedom": 123_456}
    for after, step in (
        ({"after": {"estimated_error": 0.05}, "finer": finer}, "--set mesh.size='1.8 mm' with the same --accuracy"),
        ({"after": {"estimated_error": 0.05}, "finer": None}, "no smaller size that is tried would reach it"),
    ):
        change(folder, "run", accuracy=accuracy | after)
        verdict = verdict_of(read_results(folder))
        assert verdict.on("next")[0].startswith("Next: the requested accuracy of 3 % is not reached; ")
        assert step in verdict.on("next")[0]
        assert verdict.record()["accuracy"] == {"requested": 0.03, "is_reached": False, "estimated_error": 0.05}
    change(folder, "run", accuracy=accuracy | {"after": None, "estimated_error": 0.05, "finer": finer})
    assert "(about 120000 unknowns)" in verdict_of(read_results(folder)).on("next")[0]
    change(folder, "run", accuracy=accuracy | {"is_reached": True, "after": None, "finer": None})
    assert not any("requested accuracy of" in text for text in verdict_of(read_results(folder)).on("next"))


def test_the_error_of_the_mesh_in_the_law_is_relative(folder: Path) -> None:
    assert len(verdict_of(read_results(folder)).on("mesh error")) == 1
    error = {"kappa_0_per_mm": [-0.01, -0.02], "kappa_0_per_mm_std": [1e-4, 4e-4], "reason": ""}
    for more, at in (({}, ""), ({"pressures_kPa": [17.0, 37.0]}, " (at 37 kPa)")):
        (folder / "law.json").write_text(json.dumps({"format": 1, "mesh_error": error | more}))
        assert verdict_of(read_results(folder)).on("mesh error")[1] == (
            f"Mesh error of the arm's own law: about 2 % of κ₀{at}, one standard deviation."
        )


def test_the_error_of_the_mesh_in_a_law_that_hardly_bends_is_not_relative_to_nothing(folder: Path) -> None:
    error = {
        "pressures_kPa": [5.0],
        "kappa_0_per_mm": [1.5e-6],
        "kappa_0_per_mm_std": [5e-6],
        "rigidity_N_mm2": [200.0],
        "rigidity_N_mm2_std": [2.0],
        "moment_N_mm": [-1e-5],
        "moment_N_mm_std": [1e-3],
    }
    (folder / "law.json").write_text(json.dumps({"format": 1, "length_mm": 100.0, "mesh_error": error}))
    assert verdict_of(read_results(folder)).on("mesh error")[1] == (
        "Mesh error of the arm's own law: about 0.5 % of the curvature that turns the arm by 0.1 rad, which is above "
        "κ₀ (at 5 kPa), 1 % of the bending rigidity of a cell (at 5 kPa) and 1 % of the moment of a cell at half of "
        "the curvature that turns the arm by 0.1 rad (at 5 kPa), one standard deviation."
    )


@pytest.mark.parametrize(("rod", "advised"), [("arm_law", True), ("five", False)])
def test_a_large_error_of_the_mesh_in_the_law_counts_where_the_law_is_taken(
    folder: Path, rod: str, advised: bool
) -> None:
    change(folder, "run", mesh=MESH)
    error = {"pressures_kPa": [17.0, 37.0], "moment_N_mm": [1.0, 2.0], "moment_N_mm_std": [0.17, 0.2], "reason": ""}
    (folder / "law.json").write_text(json.dumps({"format": 1, "pressures_kPa": [0.0, 37.0], "mesh_error": error}))
    expected = (
        "Next: take smaller elements, in another --out, because the error of the mesh in the arm's own law is about "
        "17 %: for example --set mesh.size='4 mm'."
    )
    assert (expected in next_steps(read_results(folder), rod)) is advised


def test_a_failed_run_says_so_first(folder: Path) -> None:
    change(folder, "run", failure="experiment II stopped before 45 kPa: a limit point")
    verdict = verdict_of(read_results(folder))
    assert verdict.sentences[0] == "Not everything was reached: experiment II stopped before 45 kPa: a limit point."
    assert verdict.on("next")[0].startswith("Next: the first sentence names what was not reached")


SHORT = "no five parameters: five parameters need a length of 6.5 pitches; give more geometry.chambers"


def test_the_next_step_of_a_short_arm_is_a_longer_one(folder: Path) -> None:
    change(folder, "run", failure=SHORT, failures=[SHORT])
    (step, *others) = verdict_of(read_results(folder)).on("next")
    assert step == (
        "Next: whatever the pressures, five parameters need a length of 6.5 pitches; give more geometry.chambers."
    )
    assert not any("leave this pressure" in other for other in others)
    limit = "experiment II stopped before 45 kPa: a limit point"
    change(folder, "run", failure=f"{limit}; {SHORT}", failures=[limit, SHORT])
    steps = verdict_of(read_results(folder)).on("next")
    assert steps[0] == step
    assert "leave this pressure or load out" in steps[1]


def test_the_next_step_of_an_arm_without_a_law_is_not_about_its_pressures(folder: Path) -> None:
    reason, limit = "no law of the arm: the two ends disturb all cells", "experiment II stopped before 45 kPa: a limit"
    change(folder, "run", failure=reason, failures=[reason])
    (step, *others) = verdict_of(read_results(folder)).on("next")
    assert step == (
        "Next: no law of the arm: the two ends disturb all cells; take five parameters instead, with --set law=five in "
        "another --out, if the arm is long enough for them."
    )
    assert not any("leave this pressure" in other for other in others)
    change(folder, "run", failure=f"{limit}; {reason}", failures=[limit, reason])
    steps = verdict_of(read_results(folder)).on("next")
    assert steps[0] == step
    assert "leave this pressure or load out" in steps[1]


def test_the_opening_names_the_rods_that_there_are(folder: Path) -> None:
    assert "and rods were made that replace it" in opening(read_results(folder))
    columns = json.loads((folder / "parameters.json").read_text(encoding="utf-8"))
    change(folder, "parameters", **{key: [] for key, value in columns.items() if isinstance(value, list)})
    assert opening(read_results(folder)).endswith(
        "17, 37 kPa. It has no rod, because neither five parameters nor a law of its own were found."
    )
    (folder / "law.json").write_text(json.dumps({"format": 1, "pressures_kPa": [0.0, 37.0]}))
    assert "and a rod with the arm's own law was made that replaces it" in opening(read_results(folder))


def test_parameters_that_were_not_requested_are_called_so(folder: Path) -> None:
    config = json.loads((folder / "run.json").read_text(encoding="utf-8"))["config"]
    (folder / "parameters.json").unlink()
    for law, sentence in (("cell", "not requested (law: cell)"), ("both", "not identified: the identification needs")):
        change(folder, "run", config={**config, "law": law})
        assert f"<p>They were {sentence}" in render_report(folder)


LIMIT = (
    "stopped before 150 kPa: no equilibrium found beyond 64.65 kPa on the way to 150 kPa: the limit is at 64.74 kPa; "
    "the tangent becomes indefinite (1 negative pivots); the smallest J is 0.622 at (102.8, 13.1, 0.4) mm; the "
    "last equilibrium has 6.4% of its elastic stiffness left in a motion that is largest at (109.0, 8.5, 0.0) mm: a "
    "limit point; the law is beyond its limits there, and another law may lead further"
)
BEYOND = "stopped before 150 kPa: it was not solved, because experiment II has its limit at 64.74 kPa"


def test_a_terminal_shows_failures_in_short(folder: Path) -> None:
    failures = [f"experiment I {BEYOND}", f"experiment II {LIMIT}", f"experiment III {BEYOND}", "no law: too short"]
    change(folder, "run", failure="; ".join(failures), failures=failures)
    verdict = verdict_of(read_results(folder))
    assert verdict.terminal_sentences[0] == (
        f"Not reached: experiments I and III {BEYOND}; experiment II stopped before 150 kPa: no equilibrium found "
        "beyond 64.65 kPa on the way to 150 kPa: the limit is at 64.74 kPa; the smallest J is 0.622 at "
        "(102.8, 13.1, 0.4) mm; no law: too short. The report and run.json have the whole reason."
    )
    assert verdict.terminal_sentences[1:] == verdict.sentences[1:]
    assert verdict.on("failure") == (f"Not everything was reached: {'; '.join(failures)}.",)
    assert not_reached(failures) == ["experiments I, II and III stopped before 150 kPa", "no law"]


def test_a_reason_in_short_says_how_early_elements_reach_a_limit() -> None:
    remark = EARLY_LIMITS["p2p0"]
    (sentence,) = in_short([f"experiment II stopped: first; a limit point near (1.0, 2.0, 3.0) mm{remark}"])
    assert sentence == (
        "experiment II stopped: first; a limit point near (1.0, 2.0, 3.0) mm; p2p0 elements reach limits up to 16 % "
        "early"
    )


def test_mixed_elements_are_suggested_where_the_error_is_that_of_the_given_ones(folder: Path) -> None:
    error = {"sizes_mm": [6.0, 9.0], "kappa_0_relative": [0.8], "alpha2_relative": [0.1], "force_relative": [0.9]}
    for mixed_at, chosen, suggested in (
        (17.0, {}, "mesh.formulation=mixed"),
        (17.0, {"formulation": "ends early"}, "mesh.size='4 mm'"),
        (None, {}, "mesh.size='4 mm'"),
    ):
        change(folder, "run", mesh={**MESH, "formulation": "p2p0", "chosen": chosen})
        change(folder, "parameters", mesh_error={**error, "mixed_at_kPa": mixed_at})
        (step,) = [step for step in next_steps(read_results(folder), "five") if "error of the mesh is about" in step]
        assert suggested in step


def test_a_pressure_below_the_end_is_suggested_where_none_was_reached(folder: Path) -> None:
    change(folder, "run", failure="II stopped", failures=["II stopped"], end_kPa=13.52)
    (folder / "experiments.json").write_text("[]", encoding="utf-8")
    assert "Next: give pressures below 13.5 kPa, where an experiment ended," in next_steps(read_results(folder), "")[0]


def test_the_verdict_on_a_mesh_from_a_file_has_the_indicator(folder: Path) -> None:
    change(folder, "run", mesh={**MESH, "from_file": True}, indicator={"stress_error": 0.147})
    change(folder, "parameters", mesh_error=None)
    assert "It was not estimated, because the mesh is from a file; the stress of its elements differs" in (
        sentence := mesh_besides(read_results(folder), "five")
    )
    assert "by up to 15 % in energy" in sentence


def test_of_a_single_pressure_all_others_are_not_tested(folder: Path) -> None:
    change(folder, "parameters", pressures_kPa=[17.0])
    assert "Not tested: pressures other than 17 kPa." in untested(read_results(folder))


def test_a_reason_of_many_clauses_is_shortened(folder: Path) -> None:
    path = folder / "effects.json"
    clauses = [f"the law ends at {k} kPa" for k in range(9)]
    for count, shown in ((6, "; ".join(clauses[:6])), (9, "; ".join(clauses[:5]) + "; 4 more clauses are in ")):
        row = {"effect": "arm_law", "state": "on", "reason": "; ".join(clauses[:count]), "share_of_time": None}
        path.write_text(json.dumps([row]), encoding="utf-8")
        assert shown in verdict_of(read_results(folder)).on("simulated")[0]


def test_without_a_failure_a_terminal_shows_the_same_sentences(folder: Path) -> None:
    verdict = verdict_of(read_results(folder))
    assert verdict.terminal_sentences == verdict.sentences


def test_the_law_is_not_offered_above_the_pressures_of_the_experiments(folder: Path) -> None:
    (folder / "law.json").write_text(json.dumps({"format": 1, "pressures_kPa": [0.0, 17.0, 37.0, 64.6]}))
    assert any("law.json --pressure '37 kPa'" in step for step in next_steps(read_results(folder), "arm_law"))
    assert any("--law cell --to csv" in step for step in next_steps(read_results(folder), "arm_law"))
    assert not any("--law cell" in step for step in next_steps(read_results(folder), "five"))
    (folder / "law.json").write_text(json.dumps({"format": 1, "pressures_kPa": [0.0, 40.0, 64.6]}))
    assert any("law.json --pressure '37 kPa'" in step for step in next_steps(read_results(folder), "arm_law"))


def test_a_folder_with_nothing_has_a_verdict(tmp_path: Path) -> None:
    results: Results = read_results(tmp_path)
    verdict = verdict_of(results)
    assert (verdict.five, verdict.rod, verdict.errors, verdict.parameters) == ((), "", (), ())
    assert (verdict.parameters_of, verdict.whose_parameters) == ("", "")
    assert verdict.sentences == ("No rod was compared with the finite elements.",)
