"""Loads across the plane from the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from pipeline.cli import app
from pipeline.results.laws import law_record
from rod.load import Load
from tests.coarse import COARSE
from tests.rod.arm_law.test_spatial import law_of_straight, straight


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("space") / "law.json"
    path.write_text(json.dumps(law_record(law_of_straight(axial=50.0))), encoding="utf-8")
    return path


def call(path: Path, pressure: str, *options: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["rod", str(path), "--pressure", pressure, *options])
    return result.exit_code, result.stdout, result.stderr


def test_three_components_give_the_rod_in_space(file: Path, tmp_path: Path) -> None:
    csv = tmp_path / "shape.csv"
    code, out, error = call(file, "10 kPa", "--force", "[0 N, 0 N, 0.1 N]", "--out", str(csv))
    assert code == 0, error
    end = straight(axial=50.0).solve_in_space(Load((0.0, 0.0, 0.1))).end
    assert f"z = {end[2]:.3f} mm" in out
    rows = np.genfromtxt(csv, delimiter=",", names=True)
    assert [rows[name][-1] for name in ("x_mm", "y_mm", "z_mm")] == pytest.approx(end)


@pytest.mark.parametrize(
    "options",
    [
        ("--moment", "[5 N*mm, 0 N*mm, 0 N*mm]"),
        ("--end", "[99.85 mm, 0 mm, 5 mm]"),
        ("--orientation", "[0, 0, -1]", "--tip-mass", "1 g"),
    ],
)
def test_all_loads_may_leave_the_plane(file: Path, options: tuple[str, ...]) -> None:
    code, out, error = call(file, "10 kPa", *options)
    assert code == 0, error
    assert "of the rigidity without load is left in the softest direction" in out


def test_a_planar_shape_that_buckles_sideways_is_kept_and_said(file: Path) -> None:
    code, out, _ = call(file, "10 kPa", "--force", "[0 N, 0.5 N]")
    assert code == 0
    assert "buckles out of its plane" in out
    assert "buckles" not in call(file, "10 kPa", "--force", "[0 N, 0.2 N]")[1]


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [("law", "measure it with law_in_space: true"), ("five", "A rod with five parameters stays in its plane")],
)
def test_a_rod_without_rigidities_out_of_its_plane_is_refused(kind: str, sentence: str) -> None:
    code, _, error = call(COARSE, "37 kPa", "--rod", kind, "--force", "[0 N, 0 N, 0.01 N]")
    assert code == 1
    assert sentence in error
    assert error.count("\n") == 1


def test_an_arm_that_is_unstable_across_in_itself_keeps_its_planar_shape(tmp_path: Path) -> None:
    path = tmp_path / "law.json"
    path.write_text(json.dumps(law_record(law_of_straight(lateral=-1.0))), encoding="utf-8")
    code, out, error = call(path, "10 kPa", "--force", "[0 N, 0.001 N]")
    assert code == 0, error
    assert "buckles out of its plane" in out


def test_pressures_for_a_wish_need_gravity_in_the_plane(file: Path) -> None:
    result = CliRunner().invoke(app, ["solve", str(file), "--angle", "10 deg", "--orientation", "[0, 0, -1]"])
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "give gravity as x and y" in result.stderr
