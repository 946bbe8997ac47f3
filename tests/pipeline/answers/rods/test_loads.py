"""Weight and payload from the command line, on the rod of a stored run."""

import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pneurod
from pipeline.answers.rods.choice import rod_of_path
from pipeline.cli import app
from tests.coarse import COARSE, copy_with


def call(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["rod", str(COARSE), "--pressure", "37 kPa", *arguments])
    return result.exit_code, result.stdout, result.stderr


def end_of(printed: str) -> list[float]:
    return [float(number) for number in re.findall(r"[xy] = (-?[\d.]+) mm", printed)]


@pytest.mark.parametrize("orientation", ["hanging", "-45 deg", "[1, 1]"])
def test_weight_and_payload_are_those_of_python(orientation: str) -> None:
    code, out, error = call("--orientation", orientation, "--tip-mass", "2 g")
    assert code == 0, error
    rod = rod_of_path(COARSE, "law").at(37.0)
    direction = (1.0, 1.0) if orientation.startswith("[") else orientation
    shape = rod.solve(direction=direction, tip_mass="2 g")
    assert end_of(out) == pytest.approx(shape.end, abs=1e-3)
    assert "N, which the rod carries besides" in out
    assert end_of(out) != pytest.approx(end_of(call()[1]), abs=0.1)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--tip-mass", "2 g"), "--tip-mass: needs --orientation hanging, lying, standing"),
        (("--orientation", "sideways"), "--orientation: 'sideways' is no orientation of an arm; allowed are hanging"),
        (("--orientation", "[0, 0]"), "--orientation: The direction of gravity must not be zero"),
        (("--orientation", "[0, down]"), "--orientation: The direction of gravity is a pair of finite numbers"),
        (("--orientation", "lying", "--tip-mass", "2 mm"), "--tip-mass: '2 mm' is no mass; write it in g"),
        (("--orientation", "lying", "--tip-mass", "2 g", "--end", "[9 mm, 9 mm]"), "an end that is held carries no m"),
    ],
)
def test_weights_that_are_none_or_contradict_are_refused(options: tuple[str, ...], sentence: str) -> None:
    code, _, error = call(*options)
    assert (code, error.count("\n")) == (2, 1)
    assert sentence in error


def test_five_parameters_carry_the_weight_as_well() -> None:
    """More weight beyond the moments of the identification is a warning, not a refusal."""
    code, out, _ = call("--orientation", "hanging", "--rod", "five")
    assert code == 0
    assert "N, which the rod carries besides" in out
    by_law = end_of(call("--orientation", "hanging")[1])
    assert np.linalg.norm(np.subtract(end_of(out), by_law)) < 1.0  # 0.25 mm
    assert np.linalg.norm(np.subtract(end_of(call()[1]), by_law)) > 30.0


def test_a_run_without_density_has_no_weight(tmp_path: Path) -> None:
    folder = copy_with(tmp_path / "arm", "law.json", lambda content: content | {"mass": None})
    command = ["rod", str(folder), "--pressure", "37 kPa", "--orientation", "lying"]
    ended = CliRunner().invoke(app, command)
    assert (ended.exit_code, "give material.density in its configuration" in ended.stderr) == (2, True)
    with pytest.warns(pneurod.RodWarning):
        rod = pneurod.read_results(folder).rod(37.0)
    with pytest.raises(pneurod.RodError, match=r"give material\.density"):
        rod.solve(direction="lying")
