"""parameters.json and law.json edited by hand: what is wrong is told in one sentence with the file and the key."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import pneurod
from pipeline.cli import app
from rod import law_record
from tests.rod.arm_law.test_arm_law import law_of, straight_law

LENGTH = 110.0
NAN = float("nan")


def parameters() -> dict[str, Any]:
    law = {
        "alpha1_N_mm2": [60.0, 55.0],
        "alpha2_N_mm2": [300.0, 440.0],
        "m01_N_mm": [0.1, 0.2],
        "m02_N_mm": [-0.2, -0.4],
        "d_mm": [10.0, 10.0],
    }
    return {
        "format": 4,
        "length_mm": LENGTH,
        "mass_g": 16.5,
        "solid_volume_mm3": 14600.0,
        "material": {"law": "svk", "E": 1.2, "nu": 0.495, "density_tonne_mm3": 1.13e-9},
        "pressures_kPa": [17.0, 37.0],
        **law,
        "alpha1_N_mm2_std": [2.0, None],
        "moment_range_N_mm": [[0.1, 3.0], [0.2, 4.0]],
        "eccentricity": {**law, "eccentricity_mm": [1.2, 1.4], "rest_stretch": [[1.02] * 12, [1.04] * 12]},
        "kappa_0": {
            "s_mm": np.linspace(0.0, LENGTH, 12).tolist(),
            "theta0_rad": [0.0, 0.02],
            "cell_s_mm": [0.0, 40.0, 80.0, LENGTH],
            "cell_averaged_per_mm": [[-0.012] * 4, [-0.023] * 4],
            "kappa_0_per_mm": [[-0.012] * 12, [-0.023] * 12],
        },
    }


def law() -> dict[str, Any]:
    return json.loads(json.dumps(law_record(law_of(straight_law(0.0), straight_law(20.0, -0.01)))))


def changed(content: dict[str, Any], path: tuple[str | int, ...], value: Any) -> dict[str, Any]:
    """The content with another value at a path of keys and positions; a callable gets what was there."""
    *way, last = path
    at: Any = content
    for key in way:
        at = at[key]
    at[last] = value(at[last]) if callable(value) else value
    return content


def refusal(file: Path, content: dict[str, Any]) -> str:
    """What `pneurod rod` says on standard error about a file with the content."""
    file.write_text(json.dumps(content))
    ended = CliRunner().invoke(app, ["rod", str(file), "--pressure", "17 kPa"])
    assert ended.exit_code == 2, (ended.stdout, ended.exception)
    assert ended.stderr.count("\n") == 1
    assert ended.stderr.startswith(f"pneurod: {file}: ")
    return ended.stderr


def named(path: tuple[str | int, ...]) -> str:
    """The key at a path as a sentence names it: `stretch of curves[0]`."""
    last = max(k for k, part in enumerate(path) if isinstance(part, str))
    table = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path[:last])
    return f"{path[last]} of {table[1:]}" if table else str(path[last])


def test_the_files_themselves_are_read(tmp_path: Path) -> None:
    for name, content in (("parameters.json", parameters()), ("law.json", law())):
        (tmp_path / name).write_text(json.dumps(content))
        ended = CliRunner().invoke(app, ["rod", str(tmp_path / name), "--pressure", "17 kPa"])
        assert ended.exit_code == 0, ended.stderr


@pytest.mark.parametrize(
    ("path", "value", "must"),
    [
        (("length_mm",), 0, "be positive"),
        (("length_mm",), None, "be a finite number"),
        (("pressures_kPa",), ["17 kPa", "37 kPa"], "be n finite"),
        (("pressures_kPa",), [37.0, 17.0], "rise"),
        (("mass_g",), 0, "be positive"),
        (("alpha1_N_mm2",), [60.0], "be 2 finite"),
        (("alpha2_N_mm2",), [300.0, NAN], "be 2 finite"),
        (("alpha2_N_mm2",), [300.0, -440.0], "be positive"),
        (("d_mm",), None, "be 2 finite"),
        (("kappa_0", "theta0_rad"), [0.0], "be 2 finite"),
        (("kappa_0", "kappa_0_per_mm", 1), lambda row: row[1:], "be 2 × 12 finite"),
        (("moment_range_N_mm",), [[0.1, 3.0]], "be 2 × 2 finite"),
        (("alpha1_N_mm2_std",), [1.0], "be 2 finite"),
        (("alpha1_N_mm2_std",), [None], "be 2 numbers"),
        (("solid_volume_mm3",), -1.0, "be positive"),
        (("kappa_0", "cell_averaged_per_mm"), [[0.0] * 4], "be 2 × 4 finite"),
        (("kappa_0", "s_mm"), [], "be two numbers"),
        (("eccentricity", "rest_stretch", 0, 3), None, "be 2 × 12 finite"),
        (("eccentricity", "alpha1_N_mm2"), [60.0], "be 2 finite"),
    ],
)
def test_parameters(tmp_path: Path, path: tuple[str | int, ...], value: Any, must: str) -> None:
    content = changed(parameters(), path, value)
    assert f": {named(path)} must {must}" in refusal(tmp_path / "parameters.json", content)
    with pytest.raises(pneurod.InputError, match=r"parameters\.json: ") as refused:
        pneurod.read_results(tmp_path)
    assert str(path[0]) in str(refused.value)


@pytest.mark.parametrize(
    ("path", "value", "must"),
    [
        (("pitch_mm",), 0.0, "be positive"),
        (("pitch_mm",), -10.0, "be positive"),
        (("length_mm",), None, "be a finite number"),
        (("first_middle_mm",), NAN, "be a finite number"),
        (("curves", 1, "kappa_per_mm"), lambda row: row[1:], "be 9 finite"),
        (("curves", 0, "moment_N_mm", 4), None, "be 9 finite"),
        (("curves", 0, "stretch", 4), NAN, "be 9 finite"),
        (("curves", 0, "ripple_mm", 2), [[0.0, 0.0]], "be 9 × 3 × 2 finite"),
        (("curves", 0, "rigidity_N_mm2", 0), 0.0, "not be zero"),
        (("curves", 0, "s_mm"), lambda s: s[::-1], "rise"),
        (("clamp", "curves", 0, "moment_N_mm"), lambda m: m[::-1], "rise"),
        (("curves", 1, "axial_rigidity_N", 2), 0.0, "be positive"),
        (("curves", 1, "shear_rigidity_N", 2), -3.0, "be positive"),
        (("curves",), 3.0, "be a list"),
        (("clamp", "curves", 0, "rotation_rad"), [0.0], "be 9 finite"),
        (("clamp",), None, "have keys"),
        (("tip", "curves", 0, "edge_mm"), [0.0], "be 2 finite"),
        (("tip", "curves", 0, "beside_mm"), "none", "be 2 × 2 finite"),
        (("curves", 0, "pressure_kPa"), "0 kPa", "be one finite"),
    ],
)
def test_laws(tmp_path: Path, path: tuple[str | int, ...], value: Any, must: str) -> None:
    assert f": {named(path)} must {must}" in refusal(tmp_path / "law.json", changed(law(), path, value))


@pytest.mark.parametrize(
    ("name", "path", "value", "sentence"),
    [
        ("parameters.json", ("format",), 99, "format 99"),
        ("parameters.json", ("length_mm",), 0, "length_mm must be positive, not 0."),
        ("parameters.json", ("length_mm",), None, "length_mm must be a finite number, not None."),
        ("parameters.json", ("length_mm",), 90.0, "s_mm of kappa_0 goes to 110 mm, and length_mm is 90 mm."),
        ("parameters.json", ("kappa_0", "s_mm"), lambda s: s[::-1], "s_mm of kappa_0 goes to 0 mm"),
        ("parameters.json", ("pressures_kPa",), [-5.0, 17.0], "pressures_kPa begin with -5; a rod has pressures"),
        ("parameters.json", ("pressures_kPa",), ["17 kPa"], "pressures_kPa must be n finite numbers, without texts"),
        ("law.json", ("curves", 0, "stretch", 4), NAN, "must be 9 finite numbers, and has one that is none."),
        ("law.json", ("curves", 0, "stretch"), [1.0], "must be 9 finite numbers, and has 1."),
        ("law.json", ("curves", 0, "rigidity_N_mm2", 4), -1.0, "of curves[0] at the smallest moment must be positive"),
        ("law.json", ("curves", 0), 3.0, "curves[0] must have keys, and is 3.0."),
        ("law.json", ("clamp", "curves"), [], "must have a cell, a clamped end and a tip at each pressure"),
    ],
)
def test_every_sentence(tmp_path: Path, name: str, path: tuple[str | int, ...], value: Any, sentence: str) -> None:
    content = changed(parameters() if name == "parameters.json" else law(), path, value)
    assert sentence in refusal(tmp_path / name, content)


def test_a_law_may_soften_to_a_negative_rigidity_at_its_end(tmp_path: Path) -> None:
    """As measured ones do where a wall buckles."""
    file = tmp_path / "law.json"
    file.write_text(json.dumps(changed(law(), ("curves", 0, "rigidity_N_mm2", 8), -20.0)))
    assert CliRunner().invoke(app, ["rod", str(file), "--pressure", "17 kPa"]).exit_code == 0


def test_a_key_of_a_curve_that_is_missing_is_named(tmp_path: Path) -> None:
    content = law()
    del content["tip"]["curves"][1]["s_mm"]
    assert "The key 's_mm' of tip.curves[1] is missing." in refusal(tmp_path / "law.json", content)
