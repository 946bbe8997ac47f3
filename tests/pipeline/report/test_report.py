"""The report is made from the result files alone, opens offline, and names what a failed run did not reach."""

import csv
import json
import re
import shlex
import shutil
import struct
import zlib
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.next_steps import next_steps
from pipeline.report.page import render_report
from pipeline.report.results import read_results
from pipeline.report.sentences import (
    difference_of_rest_curvatures,
    left_out,
    lines_needed,
    time_of_factorization,
)
from pipeline.report.validation import under_all_loads
from pipeline.report.verdict import verdict_of

LENGTH, CUT = 112.0, 15.0
PRESSURES = (17.0, 37.0)
ALPHAS = {17.0: (60.0, 300.0), 37.0: (52.0, 440.0)}


def curve_rows(experiment: str, pressure: float) -> list[list[float | str]]:
    """A rod with known numbers: constant kappa_0, two slopes in III."""
    s = np.linspace(0.0, LENGTH, 113)
    moment = np.zeros_like(s)
    kappa = np.full_like(s, -4e-4 * pressure * (1.001 if experiment == "I" else 1.0))
    if experiment == "III":
        moment = 6e-4 * pressure * (LENGTH - s) * 10.0 / LENGTH * 20.0
        first, second = ALPHAS[pressure]
        kappa = kappa + np.where(s < CUT, moment / first, moment / second)
    theta = np.concatenate([[0.0], np.cumsum((kappa[1:] + kappa[:-1]) / 2 * np.diff(s))])
    x = np.concatenate([[0.0], np.cumsum(np.cos((theta[1:] + theta[:-1]) / 2) * np.diff(s))])
    y = 1.0 + np.concatenate([[0.0], np.cumsum(np.sin((theta[1:] + theta[:-1]) / 2) * np.diff(s))])
    spread = np.full_like(s, 2e-4)
    rod = ["", ""] if experiment == "I" else None
    return [
        [experiment, pressure, *values, *(rod or (values[1] + 0.4, values[2] + 0.3))]
        for values in zip(s, x, y, theta, kappa, spread, moment, strict=True)
    ]


def experiment_row(experiment: str, pressure: float) -> dict[str, object]:
    return {
        "experiment": experiment,
        "pressure_kPa": pressure,
        "end_x_mm": 80.0,
        "end_y_mm": -60.0,
        "reaction_N": [0.0, 0.08] if experiment == "III" else [0.0, 0.0],
        "cavity_volume_mm3": 9800.0,
        "stretch_of_curve": 1.0012,
        "min_J": 0.93,
        "max_stretch": 1.31,
        "min_stretch": 0.8,
        "min_gap_mm": 0.17,
        "newton_iterations": 12,
        "factorizations": 11,
        "seconds": 4.2,
        "status": "converged",
        "reason": "",
    }


def png(colour: tuple[int, int, int]) -> bytes:
    """A picture of 8 x 4 pixels."""

    def chunk(name: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    lines = (b"\0" + bytes(colour) * 8) * 4
    header = struct.pack(">IIBBBBB", 8, 4, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def parameters() -> dict[str, object]:
    numbers = {
        "alpha1_N_mm2": [60.0, 52.0],
        "alpha2_N_mm2": [300.0, 440.0],
        "m01_N_mm": [0.1, 0.2],
        "m02_N_mm": [-0.3, -0.4],
        "d_mm": [15.0, 15.0],
    }
    spreads = {f"{name}_std": [abs(value) / 30 for value in values] for name, values in numbers.items()}
    slopes = {"beta1_N_mm2_per_kPa": -0.4, "beta1_N_mm2_per_kPa_std": 0.05, "beta2_N_mm2_per_kPa": 7.0}
    lines: dict[str, object] = {"single_line_alpha_N_mm2": [250.0, 350.0], "single_line_m0_N_mm": [0.0, 0.0]}
    lines["single_line_suffices"] = [True, False]
    return {"length_mm": LENGTH, "pressures_kPa": list(PRESSURES), **numbers, **spreads, **slopes, **lines}


@pytest.fixture
def finished(tmp_path: Path) -> Path:
    """The result files of a run that reached everything."""
    (tmp_path / "pictures").mkdir()
    header = ["experiment", "pressure_kPa", "s_mm", "x_mm", "y_mm", "theta_rad", "kappa_per_mm", "kappa_std_per_mm"]
    with (tmp_path / "curves.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*header, "moment_N_mm", "rod_x_mm", "rod_y_mm"])
        for experiment in ("I", "II", "III"):
            for pressure in PRESSURES:
                writer.writerows(curve_rows(experiment, pressure))
                (tmp_path / "pictures" / f"{experiment}_{pressure:g}kPa.png").write_bytes(png((40, 90, 160)))
    for name in ("body", "body_open"):
        (tmp_path / "pictures" / f"{name}.png").write_bytes(png((200, 200, 210)))
    rows = [experiment_row(experiment, pressure) for experiment in ("I", "II", "III") for pressure in PRESSURES]
    validation = [
        {"experiment": "II", "pressure_kPa": 37.0, "distance_over_length": 0.0071, "end_angle_error_rad": 0.01},
        {
            "experiment": "III",
            "pressure_kPa": 37.0,
            "distance_over_length": 0.018,
            "end_angle_error_rad": 0.02,
            "force_error": -0.03,
        },
    ]
    effects = [
        {"effect": "self_contact", "state": "on", "reason": "walls come close <here>", "share_of_time": 0.018},
        {"effect": "symmetry", "state": "on", "reason": "body and loads are mirror images", "share_of_time": None},
    ]
    run = {
        "config": {"name": "arm"},
        "config_hash": "ab" * 32,
        "pneurod": "0.2.0",
        "commit": None,
        "python": "3.11",
        "packages": {"numpy": "2.4.6"},
        "machine": {"processor": "a processor", "cores": 2, "memory_GB": 24.0, "system": "Linux"},
        "seconds": {"mesh": 0.3, "experiments": 30.0},
        "solver_seconds": {"set_up": 1.0, "assembly": 4.0, "contact": 0.5, "factorization": 12.0, "solve": 1.5},
    }
    for name, content in {
        "parameters": parameters(),
        "experiments": rows,
        "validation": validation,
        "effects": effects,
        "run": run,
    }.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    return tmp_path


def test_report_opens_offline(finished: Path) -> None:
    html = render_report(finished)
    assert not re.findall(r"<script[^>]*\ssrc", html)
    page = re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL)
    sources = re.findall(r"<[^>]+\s(?:src|href)\s*=\s*[\"']?([^\"'\s>]{0,40})", page)
    assert len(sources) >= 8
    assert all(source.startswith(("data:", "#")) for source in sources)
    assert html.count('<svg class="chart"') >= 8
    assert "@import" not in page


def test_the_contents_lead_to_every_section(finished: Path) -> None:
    html = render_report(finished)
    links, sections = re.findall(r'<a href="#(\w+)"', html), re.findall(r'<h2 id="(\w+)"', html)
    assert links == sections
    assert len(sections) == 9


def test_the_report_begins_with_the_verdict(finished: Path) -> None:
    html = unescape(render_report(finished))
    verdict = verdict_of(read_results(finished))
    assert len(verdict.sentences) >= 6
    positions = [html.index(f">{sentence}<") for sentence in verdict.sentences]
    assert positions == sorted(positions)
    assert positions[-1] < html.index("<nav")


def test_no_number_of_the_report_is_a_negative_zero(finished: Path) -> None:
    changed = json.loads((finished / "parameters.json").read_text(encoding="utf-8"))
    changed |= {"m01_N_mm": [-0.0022, 0.2], "m01_N_mm_std": [1.37, 0.52]}
    (finished / "parameters.json").write_text(json.dumps(changed), encoding="utf-8")
    html = render_report(finished)
    assert "0.0 ± 1.4" in html
    assert not re.search(r"[^\w.]-0(\.0*)?[^\d.]", re.sub(r"<(script|style|svg).*?</\1>", "", html, flags=re.DOTALL))


def test_report_has_the_five_parameters_and_the_agreement(finished: Path) -> None:
    html = render_report(finished)
    for text in ("60.0 ± 2.0", "440 ± 15", "β₁ = -0.40 ± 0.05 N mm²/kPa", "β₂ = 7.000 N mm²/kPa"):
        assert text in html
    (sentence,) = under_all_loads(read_results(finished))
    assert sentence == (
        "The rod with five parameters: the largest distance between the curves is 1.8 % of l (III, 37 kPa), the "
        "largest error of the end angle is 1.1° (III, 37 kPa), that of the end force is 3 % (III, 37 kPa). No error "
        "exceeds 3 % of l or 10 % of the force."
    )
    assert "At 17 kPa a single line is taken, because the data do not justify the additional parameters of" in html
    assert "walls come close &lt;here&gt;" in html


@pytest.mark.parametrize(
    ("single", "evidence", "sentence"),
    [
        ([False, False], [9.0, 9.0], "At every pressure two lines describe the data better than a single one."),
        (
            [True, True],
            [-9.0, 12.9],
            "At 17 kPa a single line is taken, because the data do not justify the additional parameters of a second "
            "one (R², the part of the variance that they describe: 0.95 with two lines, 0.70 with one); at 37 "
            "kPa two lines fit the data better, but a single line is taken, because no walls touch, and nothing else "
            "changes the rigidity along the arm: two lines then usually describe the ends of the arm, or of long "
            "cells, and predict other loads less well. There α₁ = α₂, and d has no meaning.",
        ),
        (
            [False, True],
            [9.0, 0.5],
            "At 37 kPa two lines fit the data better, but a single line is taken, because no walls touch, and nothing "
            "else changes the rigidity along the arm: two lines then usually describe the ends of the arm, or of long "
            "cells, and predict other loads less well. There α₁ = α₂, and d has no meaning.",
        ),
    ],
)
def test_report_says_why_there_is_a_single_line(
    finished: Path, single: list[bool], evidence: list[float], sentence: str
) -> None:
    changed = {**parameters(), "single_line_suffices": single, "evidence_for_two_lines": evidence}
    changed |= {"r2_two_lines": [0.95, 0.97], "r2_single_line": [0.7, 0.7]}
    (finished / "parameters.json").write_text(json.dumps(changed), encoding="utf-8")
    assert lines_needed(read_results(finished)) == sentence
    changed |= {"r2_single_line": [0.949, 0.97]}
    (finished / "parameters.json").write_text(json.dumps(changed), encoding="utf-8")
    with_both = "that they describe: 0.95 with both)"
    assert (with_both in lines_needed(read_results(finished))) == ("0.95 with two lines" in sentence)


def test_the_figure_of_moments_says_why_dots_lie_beside_the_lines(finished: Path) -> None:
    html = render_report(finished)
    assert "one that is less than a cell away from s = d contains a part of both lines" in html
    assert "below the dots" not in html


def test_report_has_the_difference_of_I_and_II_and_the_computing_time(finished: Path) -> None:
    results = read_results(finished)
    assert [row[3] for row in difference_of_rest_curvatures(results)] == ["0.1 %", "0.1 %"]
    assert time_of_factorization(results) == (
        "Numeric factorization took 63 % of 19 s of the solver's time; there were 66 factorizations."
    )


@pytest.mark.parametrize(
    ("averaging", "leaving"),
    [
        (10.0, "15 mm, which is 1.5 times the length over which curvatures are averaged,"),
        (None, "10 % of it"),
        (40.0, "40 % of it"),
    ],
)
def test_the_comparison_of_I_and_II_says_how_much_it_leaves_out(
    finished: Path, averaging: float | None, leaving: str
) -> None:
    assert "over the length of the arm without 10 % of it at each end." in render_report(finished)
    change(finished, "run", mesh={"averaging_mm": averaging})
    assert left_out(read_results(finished)) == leaving


def change(folder: Path, name: str, **keys: object) -> None:
    path = folder / f"{name}.json"
    path.write_text(json.dumps({**json.loads(path.read_text(encoding="utf-8")), **keys}), encoding="utf-8")


@pytest.mark.parametrize(
    ("end", "options"),
    [
        (None, "'37 kPa' --end-y '51.960283 mm'"),
        ({"x_mm": None, "y_mm": 0.5, "force_N": [0.0, 0.0]}, "'37 kPa' --end-y '51.960283 mm'"),
        ({"x_mm": 0.0, "y_mm": 0.0, "force_N": [0.0, 0.0]}, "'37 kPa' --end '[93.874007 mm, 51.960283 mm]'"),
        ({"x_mm": None, "y_mm": None, "force_N": [0.0, 0.05]}, "'37 kPa' --force '[0 N, 0.05 N]'"),
        ({"x_mm": None, "y_mm": 0.0, "force_N": [0.1, 0.0]}, ""),
        ({"x_mm": 0.0, "y_mm": None, "force_N": [0.0, 0.0]}, ""),
    ],
)
def test_the_rod_is_suggested_under_the_load_of_experiment_III(
    finished: Path, end: dict[str, object] | None, options: str
) -> None:
    """The end is where the curve of the finite elements has it, from the clamped end, which is 1 mm high here."""
    *_, (_, _, _, end_x, end_y, *_) = curve_rows("III", 37.0)
    assert (end_x, end_y) == pytest.approx((93.874, 52.96), abs=5e-4)
    change(finished, "run", config={"name": "arm", "end": end})
    (step,) = (step for step in verdict_of(read_results(finished)).on("next") if "To use the rod, for" in step)
    under = "the load of experiment III" if options else "the pressure alone"
    assert step == (
        f"To use the rod, for example under {under}: pneurod rod {finished}/parameters.json --pressure "
        f"{options or repr('37 kPa')} --no-stretch"
    )


def test_the_couple_of_the_edge_acts_on_a_rod_with_five_parameters_alone(finished: Path) -> None:
    """The rod with the arm's own law is compared without it."""
    path = finished / "curves.csv"
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        row["moment_N_mm"] = "0.0125"
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    validation = json.loads((finished / "validation.json").read_text(encoding="utf-8"))
    of_law = [{**row, "rod": "arm_law"} for row in validation]
    (finished / "validation.json").write_text(json.dumps([*validation, *of_law]), encoding="utf-8")
    (finished / "law.json").write_text(json.dumps({"pressures_kPa": [0.0, 37.0]}), encoding="utf-8")
    results = read_results(finished)
    assert "--end-y '51.960283 mm' --moment '0.0125 N*mm' --no-stretch" in next_steps(results, "five")[-2]
    assert next_steps(results, "arm_law")[-3].endswith("law.json --pressure '37 kPa' --end-y '51.960283 mm'")
    change(finished, "run", config={"name": "arm", "end": {"x_mm": 0.0, "y_mm": None, "force_N": [0.0, 0.0]}})
    assert next_steps(read_results(finished), "five")[-2].endswith("--pressure '37 kPa' --no-stretch")


def test_a_folder_with_a_blank_is_quoted(finished: Path) -> None:
    folder = shutil.move(finished, finished.with_name("two words"))
    steps = [step for step in verdict_of(read_results(Path(folder))).on("next") if step.startswith("To use")]
    assert [shlex.split(step.split(": ", 1)[1])[2] for step in steps] == [f"{folder}/parameters.json", f"{folder}"]


def test_the_pressure_of_the_suggested_load_is_one_at_which_the_rod_has_an_equilibrium(finished: Path) -> None:
    path = finished / "validation.json"
    rows = json.loads(path.read_text(encoding="utf-8"))
    at_17 = {**rows[1], "pressure_kPa": 17.0}
    rows[1] |= {"reason": "no equilibrium", "distance_over_length": None}
    higher = {**rows[1], "load": "end at +5 mm", "reason": ""}  # not the load of III as identified
    other = {**rows[1], "rod": "five_extensible", "reason": "", "distance_over_length": 0.5}
    cases = [([*rows, at_17], "'17 kPa' --end-y"), (rows, "'37 kPa' --no-stretch")]
    cases += [([*rows, higher], "'37 kPa' --no-stretch"), ([*rows, other, at_17], "'17 kPa' --end-y")]
    for content, expected in cases:
        path.write_text(json.dumps(content), encoding="utf-8")
        steps = verdict_of(read_results(finished)).on("next")
        assert any(f"parameters.json --pressure {expected}" in step for step in steps)


def test_the_suggested_pressure_is_not_above_those_of_the_parameters(finished: Path) -> None:
    """III may have gone farther than the identification."""
    one = {key: value[:1] if isinstance(value, list) else value for key, value in parameters().items()}
    (finished / "parameters.json").write_text(json.dumps(one), encoding="utf-8")
    assert "--pressure '17 kPa' --no-stretch" in next_steps(read_results(finished), "five")[-2]


def test_a_curve_that_begins_behind_the_clamp_has_no_position_of_the_end(finished: Path) -> None:
    """As in files of format 1, where curves begin half a cell from the clamp."""
    path = finished / "curves.csv"
    head, *lines = path.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if float(line.split(",")[2]) > 10.0]
    path.write_text("\n".join([head, *kept]), encoding="utf-8")
    assert "--pressure '37 kPa' --no-stretch" in next_steps(read_results(finished), "five")[-2]


def test_the_pictures_are_those_of_the_highest_pressure_of_every_experiment(finished: Path) -> None:
    path = finished / "experiments.json"
    rows = json.loads(path.read_text(encoding="utf-8"))
    rows[-1] |= {"status": "not converged", "reason": "a limit"}
    path.write_text(json.dumps(rows[::-1]), encoding="utf-8")
    html = render_report(finished)
    titles = [f"Experiment {name}, {pressure} kPa<" for name in ("I", "II", "III") for pressure in (17, 37)]
    assert [title in html for title in titles] == [False, True, False, True, True, False]


def test_the_stretches_of_a_law_are_not_constants(finished: Path) -> None:
    material = {"law": "neo_hooke", "E": 1.2, "nu": 0.49, "density_tonne_mm3": 1e-9, "holds_between": [0.7, 1.9]}
    change(finished, "run", config={"name": "arm", "material": material})
    sentence = (
        "law neo_hooke, E = 1.2, nu = 0.49 (MPa; nu without unit); it holds, according to the configuration, from "
    )
    assert f"{sentence}stretch 0.7 to 1.9<" in render_report(finished)


def test_the_exported_rod_is_named_where_another_one_is_to_be_taken(finished: Path) -> None:
    path = finished / "validation.json"
    rows = json.loads(path.read_text(encoding="utf-8"))
    better = {**rows[1], "rod": "five_extensible", "distance_over_length": 0.001, "force_error": 0.001}
    path.write_text(json.dumps([*rows, better]), encoding="utf-8")
    (step,) = (step for step in verdict_of(read_results(finished)).on("next") if "--to pyelastica" in step)
    assert step.endswith("(the rod that does not stretch: its shape is wrong by up to 1.8 % of l)")


def test_report_of_a_failed_run_names_what_failed(finished: Path) -> None:
    for name in ("parameters.json", "validation.json"):
        (finished / name).unlink()
    rows = json.loads((finished / "experiments.json").read_text(encoding="utf-8"))
    rows[-1] |= {"status": "failed", "reason": "an element near (3, 4, 5) mm turned inside out", "min_J": None}
    (finished / "experiments.json").write_text(json.dumps(rows), encoding="utf-8")
    html = render_report(finished)
    assert html.count("Not every pressure was reached: III at 37 kPa: an element near (3, 4, 5) mm turned inside") == 1
    assert "They were not identified" in html
    assert "Not compared" in html


def test_report_of_a_run_that_reached_nothing(tmp_path: Path) -> None:
    html = render_report(tmp_path)
    assert "No pressure was reached" in html
    assert "The run wrote no run.json" in html
