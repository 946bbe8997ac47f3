"""parameters.json and law.json edited by hand: what is wrong is told in one sentence with the file and the key."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import pneurod
from pipeline.cli import app
from pipeline.results.laws import law_record
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
        "format": 6,
        "length_mm": LENGTH,
        "mass_g": 16.5,
        "solid_volume_mm3": 14600.0,
        "material": {"law": "svk", "E": 1.2, "nu": 0.495, "density_tonne_mm3": 1.13e-9},
        "pressures_kPa": [17.0, 37.0],
        **law,
        "alpha1_N_mm2_std": [2.0, None],
        "moment_range_N_mm": [[0.1, 3.0], [0.2, 4.0]],
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


def test_the_files_themselves_are_read(tmp_path: Path) -> None:
    for name, content in (("parameters.json", parameters()), ("law.json", law())):
        (tmp_path / name).write_text(json.dumps(content))
        ended = CliRunner().invoke(app, ["rod", str(tmp_path / name), "--pressure", "17 kPa"])
        assert ended.exit_code == 0, ended.stderr


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        (("format",), 99, "has format 99"),
        (("length_mm",), 0, "length_mm: must be positive"),
        (("length_mm",), None, "length_mm must be a finite number, not None"),
        (("length_mm",), 90.0, "kappa_0 is given from s = 0 to 110 mm, the rod goes from 0 to 90 mm"),
        (("pressures_kPa",), ["17 kPa", "37 kPa"], "pressures_kPa.0: must be a number"),
        (("pressures_kPa",), [37.0, 17.0], "pressures of a rod must rise, from 0 kPa at least"),
        (("pressures_kPa",), [-5.0, 17.0], "pressures of a rod must rise, from 0 kPa at least"),
        (("mass_g",), 0, "mass_g: must be positive"),
        (("alpha1_N_mm2",), [60.0], "alpha1_N_mm2: must have a length of 2, and has 1"),
        (("alpha2_N_mm2",), [300.0, NAN], "alpha2_N_mm2.1: must be a finite number"),
        (("alpha2_N_mm2",), [300.0, -440.0], "alpha2 is a rigidity and must be positive, not -440 N mm2"),
        (("d_mm",), None, "d_mm: must be a list"),
        (("kappa_0", "theta0_rad"), [0.0], "kappa_0.theta0_rad: must have a length of 2, and has 1"),
        (
            ("kappa_0", "kappa_0_per_mm", 1),
            lambda row: row[1:],
            "kappa_0_per_mm.1: must have a length of 12, and has 11",
        ),
        (("moment_range_N_mm",), [[0.1, 3.0]], "moment_range_N_mm: must have a length of 2"),
        (("alpha1_N_mm2_std",), [1.0], "alpha1_N_mm2_std: must have a length of 2"),
        (("alpha1_N_mm2_std",), [None], "alpha1_N_mm2_std: must have a length of 2"),
        (("solid_volume_mm3",), -1.0, "solid_volume_mm3: must be positive"),
        (("kappa_0", "cell_averaged_per_mm"), [[0.0] * 4], "kappa_0.cell_averaged_per_mm: must have a length of 2"),
        (("kappa_0", "s_mm"), [], "kappa_0.kappa_0_per_mm.0: must have a length of 0"),
        (("kappa_0", "s_mm"), lambda s: s[::-1], "column s of kappa_0 must rise"),
    ],
)
def test_parameters(tmp_path: Path, path: tuple[str | int, ...], value: Any, sentence: str) -> None:
    assert sentence in refusal(tmp_path / "parameters.json", changed(parameters(), path, value))
    with pytest.raises(pneurod.InputError, match=r"parameters\.json: ") as refused:
        pneurod.read_results(tmp_path)
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        (("pitch_mm",), 0.0, "pitch_mm: must be positive, and has 0"),
        (("pitch_mm",), -10.0, "pitch_mm: must be positive, and has -10"),
        (("length_mm",), None, "length_mm: must be a number"),
        (("first_middle_mm",), NAN, "first_middle_mm: must be a finite number"),
        (("curves", 1, "kappa_per_mm"), lambda row: row[1:], "curves.1: kappa_per_mm must be 9 numbers, and has 8"),
        (("curves", 0, "moment_N_mm", 4), None, "curves.0.moment_N_mm: must be finite numbers"),
        (("curves", 0, "stretch", 4), NAN, "curves.0.stretch: must be finite numbers"),
        (("curves", 0, "stretch"), [1.0], "curves.0: stretch must be 9 numbers, and has 1"),
        (("curves", 0, "ripple_mm", 2), [[0.0, 0.0]], "curves.0.ripple_mm: must be lists of equal length with finite"),
        (("curves", 0, "rigidity_N_mm2", 0), 0.0, "curves.0.rigidity_N_mm2: must be positive, and has 0"),
        (("curves", 0, "rigidity_N_mm2", 4), -1.0, "curves.0.rigidity_N_mm2: must be positive, and has -1"),
        (("curves", 0, "s_mm"), lambda s: s[::-1], "curves.0: s_mm must rise"),
        (("clamp", "curves", 0, "moment_N_mm"), lambda m: m[::-1], "clamp.curves.0: moment_N_mm must rise"),
        (("curves", 1, "axial_rigidity_N", 2), 0.0, "curves.1.axial_rigidity_N: must be positive, and has 0"),
        (("curves", 1, "shear_rigidity_N", 2), -3.0, "curves.1.shear_rigidity_N: must be positive, and has -3"),
        (("curves",), 3.0, "curves: must be a list"),
        (("curves", 0), 3.0, "curves.0: must have keys"),
        (("clamp", "curves", 0, "rotation_rad"), [0.0], "clamp.curves.0: rotation_rad must be 9 numbers, and has 1"),
        (("clamp", "curves"), [], "must have a cell, a clamped end and a tip at each pressure"),
        (("clamp",), None, "clamp.curves: is missing"),
        (("tip", "curves", 0, "edge_mm"), [0.0], "tip.curves.0: edge_mm must be 2 numbers, and has 1"),
        (("tip", "curves", 0, "beside_mm"), "none", "tip.curves.0.beside_mm: must be lists of equal length"),
        (("curves", 0, "pressure_kPa"), "0 kPa", "curves.0.pressure_kPa: must be a number"),
        (
            ("mass",),
            {"from_end_mm": [], "mass_g": [], "mass_times_height_g_mm": []},
            "mass.from_end_mm: must be finite",
        ),
    ],
)
def test_laws(tmp_path: Path, path: tuple[str | int, ...], value: Any, sentence: str) -> None:
    assert sentence in refusal(tmp_path / "law.json", changed(law(), path, value))


def test_a_law_may_soften_to_a_negative_rigidity_at_its_end(tmp_path: Path) -> None:
    """As measured ones do where a wall buckles."""
    file = tmp_path / "law.json"
    file.write_text(json.dumps(changed(law(), ("curves", 0, "rigidity_N_mm2", 8), -20.0)))
    assert CliRunner().invoke(app, ["rod", str(file), "--pressure", "17 kPa"]).exit_code == 0


def test_a_key_of_a_curve_that_is_missing_is_named(tmp_path: Path) -> None:
    content = law()
    del content["tip"]["curves"][1]["s_mm"]
    assert "tip.curves.1.s_mm: is missing" in refusal(tmp_path / "law.json", content)
