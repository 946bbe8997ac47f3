"""The sentences and tables of the report about estimators, the linear range, other loads and other laws."""

import json
from pathlib import Path

import pytest

from pipeline.report.law_range import moments_sentence, moments_table
from pipeline.report.mesh_error import mesh_besides
from pipeline.report.numbers import (
    NO_BREAK,
    Cell,
    eccentricity,
    estimators,
    five_parameters,
    linear_range,
    observations,
)
from pipeline.report.page import render_report
from pipeline.report.results import Results, read_results
from pipeline.report.sentences import third_experiment
from pipeline.report.validation import (
    beyond_identified,
    recommended_rod,
    rod_errors,
    rod_table,
    rod_to_take,
    under_all_loads,
    validation_rows,
)


def results(folder: Path, **files: object) -> Results:
    for name, content in files.items():
        (folder / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    return read_results(folder)


def columns(d_at_most: bool) -> dict[str, object]:
    numbers = {"alpha1_N_mm2": 190.0, "alpha2_N_mm2": 400.0, "m01_N_mm": 0.0, "m02_N_mm": -0.5, "d_mm": 5.6}
    content: dict[str, object] = {"d_is_at_most": [d_at_most]}
    for name, value in numbers.items():
        content |= {name: [value], f"{name}_std": [0.5], f"{name}_95": [[value - 1.0, value + 1.0]]}
    return content


def test_estimators_stand_side_by_side(tmp_path: Path) -> None:
    none = {name: [None] for name in columns(False)}
    content = {"pressures_kPa": [17.0], **columns(True), "estimators": {"cell_averaged": columns(True)}}
    rows = estimators(results(tmp_path, parameters={**content, "predicted_by_arm_law": columns(False)}))
    assert [(row[0], row[1]) for row in rows] == [
        ("17", "cell averages"),
        ("17", "cell averages of the rod with the arm's own law"),
    ]
    assert rows[0][2][0] == Cell("190.0 ± 0.5", "189.0 … 191.0")
    assert rows[0][2][4] == Cell("at most 5.6", "< 6.6 (95 %)")
    assert rows[1][2][4] == Cell("5.6 ± 0.5", "4.6 … 6.6")
    nothing = {**content, "predicted_by_arm_law": none}
    assert estimators(results(tmp_path, parameters=nothing))[1][2][0] == Cell("-", "")


def test_a_single_line_has_no_break(tmp_path: Path) -> None:
    parameters = {"pressures_kPa": [17.0], **columns(True), "single_line_suffices": [True]}
    ((_, cells),) = five_parameters(results(tmp_path, parameters=parameters))
    assert cells[-1] == Cell("-", "single line")


LAW = {
    "pressures_kPa": [17.0, 37.0],
    "kappa_0_per_mm": [-0.01, -0.02],
    "kappa_0_per_mm_std": [0.0005, 0.0004],
}


@pytest.mark.parametrize(
    ("error", "law", "rod", "ending"),
    [
        (
            {"alpha2_relative": [0.01, 0.035], "kappa_0_relative": [0.044, None]},
            LAW,
            "five",
            " One standard deviation: about 4.4 % in κ₀(l/2) and 3.5 % in α₂ at the worst pressure.",
        ),
        (
            {"alpha2_relative": [0.01]},
            LAW,
            "arm_law",
            " One standard deviation: about 5 % of κ₀ (at 17 kPa); that of the clamped end and the tip is not known, "
            "and in the whole arm it is about 1.0 % in α₂ at the worst pressure.",
        ),
        (None, LAW, "five", "about 5 % of κ₀ (at 17 kPa); that of the clamped end and the tip is not known."),
        (None, {}, "five", "It was not estimated."),
    ],
    ids=["of the five parameters", "of the arm's own law", "of the arm's own law alone", "of none"],
)
def test_the_error_of_the_mesh_is_named_beside_that_of_the_rods(
    error: object, law: object, rod: str, ending: str, tmp_path: Path
) -> None:
    parameters = {"pressures_kPa": [17.0], **columns(False), "mesh_error": error}
    sentence = mesh_besides(results(tmp_path, parameters=parameters, law={"mesh_error": law}), rod)
    assert sentence.startswith("The error of the mesh comes on top of that")
    assert sentence.endswith(ending)


def test_the_moments_of_the_law_are_those_that_cell_and_clamped_end_have(tmp_path: Path) -> None:
    def curves(**moments: float) -> list[dict[str, object]]:
        return [{"pressure_kPa": float(p[1:]), "moment_N_mm": [-low, 0.0, 1.5]} for p, low in moments.items()]

    law = {"curves": curves(p0=1.0, p17=2.0, p20=3.0), "clamp": {"curves": curves(p17=1.5, p20=9.0)}}
    states = [{"experiment": "II", "pressure_kPa": pressure} for pressure in (17.0, 20.0)]
    read = results(tmp_path, law=law, experiments=states)
    assert moments_table(read) == [["17", "-2 to 1.5", "-1.5 to 1.5"], ["20", "-3 to 1.5", "-9 to 1.5"]]
    assert moments_sentence(read) == (
        "The arm's own law is known for moments from -1.5 to 1.5 N mm at 17 kPa, from -3 to 1.5 N mm at 20 kPa, and "
        "not extrapolated."
    )
    near = [{"experiment": "II", "pressure_kPa": pressure} for pressure in (17.1, 19.0)]  # the law is not made at these
    read = results(tmp_path, law=law, experiments=near)
    assert [pressure for pressure, *_ in moments_table(read)] == ["17"]
    assert moments_sentence(results(tmp_path, law={}, experiments=states)) == ""


def test_an_interval_has_the_digits_of_its_value(tmp_path: Path) -> None:
    """A large deviation takes decimals from both, which the smaller one at the other pressure would give."""
    content = {"pressures_kPa": [17.0, 37.0], "alpha1_N_mm2": [5678.0, 5678.0], "alpha1_N_mm2_std": [1234.0, 3.0]}
    content |= {"alpha1_N_mm2_95": [[3211.0, 8765.0], [5672.0, 5684.0]]}
    content |= {key: [1.0, 1.0] for key in ("alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm")}
    (_, first), (_, second) = five_parameters(results(tmp_path, parameters=content))
    assert (first[0], second[0]) == (Cell("5680 ± 1230", "3210 … 8760"), Cell("5678 ± 3", "5672 … 5684"))


def test_a_break_at_the_upper_end_of_its_range_is_marked(tmp_path: Path) -> None:
    """As in files: at most, at least, neither; files of earlier versions have no mark of the upper end."""
    marked = {**columns(False), "d_is_at_least": [True]}
    parameters = {"pressures_kPa": [17.0], "length_mm": 16.0, **marked, "estimators": {"cell_averaged": marked}}
    read = results(tmp_path, parameters=parameters)
    assert estimators(read)[0][2][4] == Cell("at least 5.6", "> 4.6 (95 %)")
    assert "at least 5.6" in render_report(tmp_path)


@pytest.mark.parametrize(
    ("parameters", "sentence"),
    [
        ({"linear_range_kPa": None}, "There are no three neighbouring pressures"),
        ({"linear_range_kPa": [10.0, 30.0]}, "was not tested: two pressures always lie"),
        (
            {"linear_range_kPa": [10.0, 30.0], "linear_range_tested": True},
            "α₂ departs from its straight line by -8 % at 45 kPa.",
        ),
    ],
)
def test_the_linear_range_in_words(tmp_path: Path, parameters: dict, sentence: str) -> None:
    rows = [{"quantity": "alpha2", "off_the_line": [0.0, 0.03, -0.08]}]
    given = {"pressures_kPa": [10.0, 30.0, 45.0], "straightness": rows, **parameters}
    sentences = linear_range(results(tmp_path, parameters=given))
    assert sentence in " ".join(sentences)
    assert not any("+3 %" in text and parameters["linear_range_kPa"] for text in sentences)


def test_one_pressure_has_no_range(tmp_path: Path) -> None:
    given = results(tmp_path, parameters={"pressures_kPa": [10.0], "observations": [19.54]})
    assert linear_range(given) == []
    assert observations(given).endswith("each pressure gives 20 independent observations.")


def row(sample: str, distance: float, force: float | None, load: str = "") -> dict[str, object]:
    return {
        "experiment": "III" if force is not None else "dead",
        "pressure_kPa": 31.0,
        "load": load,
        "sample": sample,
        "distance_over_length": distance,
        "distance_at_s_mm": 80.0,
        "force_error": force,
        "curvature_error": 0.1,
        "curvature_error_at_s_mm": 7.0,
        "reason": "",
    }


def test_loads_with_large_errors_are_named(tmp_path: Path) -> None:
    rows = [row("in", 0.5, 0.5), row("out", 0.01, 0.02, "end at +10 mm"), row("out", 0.04, None, "dead force 0, 1 N")]
    (sentence,) = under_all_loads(results(tmp_path, validation=rows))
    assert sentence == (
        "The rod with five parameters: the largest distance between the curves is 50 % of l (III, 31 kPa, at s = 80 "
        "mm), the largest error of the end force is 50 % (III, 31 kPa). Errors exceed 3 % of l or 10 % of the force "
        "at: III, 31 kPa; dead force 0, 1 N, 31 kPa."
    )
    (fine,) = under_all_loads(results(tmp_path, validation=rows[1:2]))
    assert fine.endswith("(end at +10 mm, 31 kPa). No error exceeds 3 % of l or 10 % of the force.")
    assert [cells[:3] for cells in validation_rows(results(tmp_path, validation=rows))] == [
        ["III", "the rod with five parameters", "in"],
        ["dead force 0, 1 N", "the rod with five parameters", "out"],
        ["end at +10 mm", "the rod with five parameters", "out"],
    ]


def test_every_rod_has_its_own_sentence_and_the_stretch_is_told_apart(tmp_path: Path) -> None:
    """The rod that does not stretch is far off because of that; the one to take comes first."""
    stiff = row("in", 0.05, 0.02) | {"distance_over_length_without_stretch": 0.008}
    rows = [stiff, row("in", 0.002, 0.01) | {"rod": "five_extensible", "end_angle_error_rad": -0.01}]
    first, second = under_all_loads(results(tmp_path, validation=rows))
    assert first == (
        "The rod with five parameters that stretches: the largest distance between the curves is 0.2 % of l (III, 31 "
        "kPa, at s = 80 mm), the largest error of the end angle is 0.57° (III, 31 kPa), that of the end force is 1 % "
        "(III, 31 kPa). No error exceeds 3 % of l or 10 % of the force."
    )
    assert second.endswith(
        "at: III, 31 kPa; without the stretch of the curve the distances that exceed 3 % would be at most 0.8 % of l."
    )
    wrong_force = row("out", 0.02, 0.2, "end at +9 mm") | {"distance_over_length_without_stretch": 0.019}
    _, second = under_all_loads(results(tmp_path, validation=[*rows, wrong_force]))
    assert "at: III, 31 kPa; end at +9 mm, 31 kPa; without the stretch" in second
    assert second.endswith("at most 0.8 % of l.")


def test_of_rods_that_stretch_no_shape_is_given_without_stretch(tmp_path: Path) -> None:
    whole = {**row("in", 0.02, 0.02), "distance_over_length_without_stretch": 0.01, "end_angle_error_rad": 0.0349066}
    rows = [{**whole, "rod": rod} for rod in ("five", "five_extensible", "arm_law")]
    shown = validation_rows(results(tmp_path, validation=rows))
    assert [cells[4:7] for cells in shown] == [["2 %", "1 %", "2"], ["2 %", "-", "2"], ["2 %", "-", "2"]]
    assert "end angle error (°)" in render_report(tmp_path)


def test_the_rod_with_the_smallest_error_over_all_loads_is_recommended(tmp_path: Path) -> None:
    five = [row("in", 0.02, 0.02), row("out", 0.04, None, "dead force 0, 1 N"), row("out", 0.03, -0.2, "end at +10 mm")]
    law = [{**r, "rod": "arm_law", "sample": "out", "distance_over_length": 0.002} for r in five]
    law = [{**r, "force_error": None if r["force_error"] is None else 0.004} for r in law]
    stored = results(tmp_path, validation=[*five, *law])
    assert rod_to_take(stored) == [
        "Take the rod with the arm's own law (arm_law): its largest error against finite elements on the same mesh, "
        "0.4 % of the largest force at the end, is the smallest of 2 rods (errors of the shape relative to the length, "
        "errors of the force at the end relative to the largest one).",
        "The rod with the arm's own law: out of sample (loads that nothing was fitted to) the shape is wrong by at "
        "most 0.2 % of l, the force by at most 0.4 %.",
        "The rod with five parameters: in sample the shape is wrong by at most 2 % of l, the force by at most 2 %; "
        "out of sample (loads that nothing was fitted to) the shape is wrong by at most 4 % of l, the force by at most "
        "20 %.",
    ]
    assert [cells[0] for cells in rod_table(stored)] == [
        "the rod with the arm's own law",
        "the rod with five parameters",
    ]
    far = [{**r, "rod": "five_extensible", "distance_over_length": 0.2} for r in five]
    of_near = rod_to_take(results(tmp_path, validation=[*five, *law, *far]))[0]
    assert "is the smallest of 2 rods that are within 10 % of l (errors of the shape" in of_near
    without = [{**law[0], "distance_over_length": None, "reason": ""}]
    assert [s.partition(":")[0] for s in under_all_loads(results(tmp_path, validation=[*five, *without]))] == [
        "The rod with five parameters"
    ]
    silent = [*five, {**law[0], "distance_over_length": None, "reason": "The moment leaves the law."}]
    silent.append({**silent[-1], "distance_over_length": 0.002, "reason": ""})
    assert rod_to_take(results(tmp_path, validation=silent))[0] == (
        "Take the rod with five parameters (five): every rod with a smaller error has no solution under some of the "
        "loads; its own largest error is 20 % of the largest force at the end."
    )
    assert rod_to_take(results(tmp_path, validation=[])) == []


def test_the_error_of_a_small_force_counts_over_the_largest_one(tmp_path: Path) -> None:
    five = [{**row("in", 0.02, 0.1), "force_N": 0.001}, {**row("out", 0.03, -0.02, "end at +10 mm"), "force_N": -0.1}]
    law = [{**r, "rod": "arm_law", "sample": "out", "distance_over_length": 0.001} for r in five]
    law[0] |= {"force_error": 0.7}
    law[1] |= {"force_error": 0.01}
    stored = results(tmp_path, validation=[*five, *law])
    assert rod_to_take(stored)[:2] == [
        "Take the rod with the arm's own law (arm_law): its largest error against finite elements on the same mesh, "
        "1 % of the largest force at the end, is the smallest of 2 rods (errors of the shape relative to the length, "
        "errors of the force at the end relative to the largest one).",
        "The rod with the arm's own law: out of sample (loads that nothing was fitted to) the shape is wrong by at "
        "most 0.1 % of l, the force by at most 70 % of itself and 1 % of the largest force of all "
        "loads.",
    ]


def test_no_rod_is_recommended_that_is_far_from_the_finite_elements(tmp_path: Path) -> None:
    """The force may be wrong by more, where it is small itself."""
    far = [row("in", 0.92, None), row("out", 0.05, 0.06, "end at +10 mm")]
    assert rod_to_take(results(tmp_path, validation=far))[0] == (
        "No rod describes this arm: the nearest, the rod with five parameters (five), is up to 92 % of l away from the "
        "finite elements."
    )
    assert recommended_rod(rod_errors(results(tmp_path, validation=far))) == ""
    law = [
        {**row("out", 0.004, None), "rod": "arm_law"},
        {**row("out", 0.004, None), "rod": "arm_law", "reason": "No."},
    ]
    both = results(tmp_path, validation=[*far, *law])
    assert recommended_rod(rod_errors(both)) == "arm_law"
    assert rod_to_take(both)[0] == (
        "Take the rod with the arm's own law (arm_law): every other one is more than 10 % of l away from the finite "
        "elements."
    )
    none = results(tmp_path, validation=[{**far[0], "distance_over_length": None, "reason": "No."}])
    assert rod_to_take(none)[0] == "No rod describes this arm: none has a solution under any of the loads."
    near = [row("in", 0.09, None), row("out", 0.05, 0.7, "end at +10 mm")]
    assert rod_to_take(results(tmp_path, validation=near))[0].startswith("Take the rod with five parameters (five)")


def test_a_load_beyond_the_identified_moments_is_named(tmp_path: Path) -> None:
    warned = {**row("out", 0.05, None, "dead force 0, 1 N"), "warning": "The moment leaves the range."}
    stretching = {**warned, "rod": "five_extensible", "distance_over_length": 0.01}
    stored = results(tmp_path, validation=[row("in", 0.01, 0.02), warned, stretching])
    assert beyond_identified(stored) == [
        f"{rod}, dead force 0, 1 N, 31 kPa: The moment leaves the range."
        for rod in ("The rod with five parameters that stretches", "The rod with five parameters")
    ]


def test_the_eccentricity_stands_with_the_five_parameters_that_go_with_it(tmp_path: Path) -> None:
    extensible = {**columns(False), "eccentricity_mm": [1.3], "eccentricity_mm_std": [0.05]}
    given = {"pressures_kPa": [17.0], **columns(False), "eccentricity": extensible}
    rows = eccentricity(results(tmp_path, parameters=given))
    ((pressure, cells),) = rows
    values = [cell.value for cell in cells]
    assert (pressure, values) == (
        "17",
        ["190.0 ± 0.5", "400.0 ± 0.5", "0.0 ± 0.5", "-0.5 ± 0.5", "5.6 ± 0.5", "1.30 ± 0.05"],
    )
    single = eccentricity(results(tmp_path, parameters={**given, "single_line_suffices": [True]}))
    assert single[0][1][4] == NO_BREAK
    assert eccentricity(results(tmp_path, parameters={"pressures_kPa": [17.0]})) == []


def test_a_load_without_a_rod_is_named(tmp_path: Path) -> None:
    lost = {**row("out", 0.0, None, "dead force 0, 9 N"), "distance_over_length": None, "reason": "The rod buckles."}
    assert under_all_loads(results(tmp_path, validation=[lost])) == [
        "The rod with five parameters, dead force 0, 9 N, 31 kPa: The rod buckles."
    ]


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ({"x_mm": None, "y_mm": 0.0, "force_N": [0.0, 0.0]}, "the height of the end held"),
        ({"y_mm": 0.0}, "the height of the end held"),
        ({"x_mm": 0.7, "y_mm": 0.0, "force_N": [0.0, 0.0]}, "the end held"),
        (
            {"x_mm": None, "y_mm": 0.0, "force_N": [0.175, 0.0]},
            "the height of the end held and a force F_x = 0.175 N on the end",
        ),
        ({"x_mm": None, "y_mm": None, "force_N": [0.175, 0.07]}, "a force F_x = 0.175 N, F_y = 0.07 N on the end"),
        ({"x_mm": 0.7, "y_mm": None, "force_N": [0.0, 0.0]}, "the end held along the arm"),
    ],
)
def test_the_report_says_what_the_end_has_in_the_third_experiment(
    tmp_path: Path, end: dict[str, object], words: str
) -> None:
    assert third_experiment(results(tmp_path, run={"config": {"end": end}})) == words
