"""parameters.json and law.json edited by hand: what is wrong is told in one sentence with the file and the key."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.results.laws import law_record
from tests.commands import done, refused
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


def edited(content: dict[str, Any], change: str) -> dict[str, Any]:
    """The content after a change such as `["length_mm"] = 0`."""
    exec(f"content{change}", {"NAN": float("nan")}, {"content": content})
    return content


def refusal(file: Path, content: dict[str, Any]) -> str:
    """What `pneurod rod` says on standard error about a file with the content."""
    file.write_text(json.dumps(content))
    sentence = refused("rod", str(file), "--pressure", "17 kPa")
    assert sentence.startswith(f"{file}: ")
    return sentence


def test_the_files_themselves_are_read(tmp_path: Path) -> None:
    for name, content in (("parameters.json", parameters()), ("law.json", law())):
        (tmp_path / name).write_text(json.dumps(content))
        done("rod", str(tmp_path / name), "--pressure", "17 kPa")


def test_a_law_may_soften_to_a_negative_rigidity_at_its_end(tmp_path: Path) -> None:
    """As measured ones do where a wall buckles."""
    file = tmp_path / "law.json"
    file.write_text(json.dumps(edited(law(), "['curves'][0]['rigidity_N_mm2'][8] = -20.0")))
    done("rod", str(file), "--pressure", "17 kPa")
