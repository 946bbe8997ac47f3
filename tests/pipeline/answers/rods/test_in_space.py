"""Loads across the plane from the command line."""

import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.results.laws import law_record
from rod.load import Load
from tests.coarse import COARSE
from tests.commands import done, refused
from tests.rod.arm_law.test_spatial import law_of_straight, straight


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("space") / "law.json"
    path.write_text(json.dumps(law_record(law_of_straight(axial=50.0))), encoding="utf-8")
    return path


def rod(path: Path, *options: str) -> str:
    return done("rod", str(path), "--pressure", "10 kPa", *options)


def test_three_components_give_the_rod_in_space(file: Path, tmp_path: Path) -> None:
    csv = tmp_path / "shape.csv"
    out = rod(file, "--force", "[0 N, 0 N, 0.1 N]", "--out", str(csv))
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
    assert "of the rigidity without load is left in the softest direction" in rod(file, *options)


def test_a_planar_shape_that_buckles_sideways_is_kept_and_said(file: Path) -> None:
    assert "buckles out of its plane" in rod(file, "--force", "[0 N, 0.5 N]")
    assert "buckles" not in rod(file, "--force", "[0 N, 0.2 N]")


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [("law", "measure it with law_in_space: true"), ("five", "A rod with five parameters stays in its plane")],
)
def test_a_rod_without_rigidities_out_of_its_plane_is_refused(kind: str, sentence: str) -> None:
    command = ("rod", str(COARSE), "--pressure", "37 kPa", "--rod", kind, "--force", "[0 N, 0 N, 0.01 N]")
    assert sentence in refused(*command, status=1)


def test_an_arm_that_is_unstable_across_in_itself_keeps_its_planar_shape(tmp_path: Path) -> None:
    path = tmp_path / "law.json"
    path.write_text(json.dumps(law_record(law_of_straight(lateral=-1.0))), encoding="utf-8")
    assert "buckles out of its plane" in rod(path, "--force", "[0 N, 0.001 N]")


def test_pressures_for_a_wish_need_gravity_in_the_plane(file: Path) -> None:
    command = ("solve", str(file), "--angle", "10 deg", "--orientation", "[0, 0, -1]")
    assert "give gravity as x and y" in refused(*command)
