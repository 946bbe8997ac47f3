"""Weight, payload, loads along the arm and across its plane from the command line, on the rod of a stored run."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pneurod
from pipeline.answers.rods import end_loads
from pipeline.answers.rods.choice import rod_of_path
from pipeline.results.laws import law_record
from rod import Loading, PointLoad, RodError, Support
from rod.load import Load
from tests.coarse import COARSE, copy_with
from tests.commands import done, refused
from tests.rod.arm_law.test_spatial import law_of_straight, straight


def rod(*options: str) -> str:
    return done("rod", str(COARSE), "--pressure", "37 kPa", *options)


def end_of(printed: str) -> list[float]:
    return [float(number) for number in re.findall(r"[xy] = (-?[\d.]+) mm", printed)]


@pytest.mark.parametrize("orientation", ["hanging", "-45 deg", "[1, 1]"])
def test_weight_and_payload_are_those_of_python(orientation: str) -> None:
    out = rod("--orientation", orientation, "--tip-mass", "2 g")
    direction = (1.0, 1.0) if orientation.startswith("[") else orientation
    shape = rod_of_path(COARSE, "law").at(37.0).solve(direction=direction, tip_mass="2 g")
    assert end_of(out) == pytest.approx(shape.end, abs=1e-3)
    assert "N, which the rod carries besides" in out
    assert end_of(out) != pytest.approx(end_of(rod()), abs=0.1)


@pytest.mark.parametrize(
    ("options", "loads"),
    [
        (("--force-at", "0.5 l: [0 N, 0.005 N]"), {"along": [pneurod.PointLoad(56.0, (0.0, 0.005))]}),
        (
            ("--force-at", "56 mm: [0 N, 5 mN]", "--force-at", "3 cm: [1 mN, 0 N]"),
            {"along": [pneurod.PointLoad(56.0, (0.0, 0.005)), pneurod.PointLoad(30.0, (0.001, 0.0))]},
        ),
        (
            ("--line-load", "0.25 l to 0.75 l: [0 N/m, 0.1 N/m]"),
            {"along": [pneurod.LineLoad(28.0, 84.0, (0.0, 1e-4))]},
        ),
        (
            ("--mass-at", "0.5 l: 0.5 g", "--mass-at", "20 mm: 1 g", "--orientation", "hanging"),
            {"hung": [("0.5 l", 0.5), (20.0, "1 g")], "direction": "hanging"},
        ),
        (("--held-at", "0.5 l: y -20 mm"), {"along": [pneurod.Support(56.0, y=-20.0)]}),
        (
            ("--held-at", "56 mm: x 5 cm, y -20 mm", "--held-at", "1 l: angle -100 deg"),
            {"along": [pneurod.Support(56.0, 50.0, -20.0), pneurod.Support(112.0, angle=np.radians(-100.0))]},
        ),
    ],
)
def test_loads_along_the_arm_are_those_of_python(options: tuple[str, ...], loads: dict[str, Any]) -> None:
    end = end_of(rod(*options))
    assert end == pytest.approx(rod_of_path(COARSE, "law").at(37.0).solve(**loads).end, abs=1e-3)
    assert end != pytest.approx(end_of(rod()), abs=0.1)


def test_one_force_alone_acts_upwards_and_a_part_of_the_length_is_one_of_the_arm() -> None:
    """As `pneurod rod` and `pneurod move` read them."""
    assert end_loads.read_loading(None, None, force="0.05 N") == Loading((0.0, 0.05))
    load, held = end_loads.read_along(80.0, ["0.5 l: [0 N, 0.02 N]"], held_at=["20 mm: angle 5 deg, y -3 mm"])
    assert load == PointLoad(40.0, (0.0, 0.02))
    assert held == Support(20.0, y=-3.0, angle=np.radians(5.0))


def test_the_reactions_of_supports_have_a_line_each() -> None:
    out = rod("--held-at", "0.5 l: y -28 mm, angle -70 deg", "--held-at", "80 mm: x 46 mm")
    lines = [line for line in out.splitlines() if line.startswith("reaction at")]
    numbers = [[float(number) for number in re.findall(r"-?\d[\d.e-]*", line)] for line in lines]
    along = [pneurod.Support(56.0, y=-28.0, angle=np.radians(-70.0)), pneurod.Support(80.0, x=46.0)]
    first, second = rod_of_path(COARSE, "law").at(37.0).solve(along=along).reactions
    assert numbers[0] == pytest.approx([56.0, *first.force[:2], first.couple], rel=1e-3)
    assert numbers[1] == pytest.approx([80.0, *second.force[:2]], rel=1e-3)


def test_five_parameters_carry_the_weight_as_well() -> None:
    """More weight beyond the moments of the identification is a warning, not a refusal."""
    out = rod("--orientation", "hanging", "--rod", "five")
    assert "N, which the rod carries besides" in out
    by_law = end_of(rod("--orientation", "hanging"))
    assert np.linalg.norm(np.subtract(end_of(out), by_law)) < 1.0  # 0.25 mm
    assert np.linalg.norm(np.subtract(end_of(rod()), by_law)) > 30.0


def test_a_run_without_density_has_no_weight(tmp_path: Path) -> None:
    folder = copy_with(tmp_path / "arm", "law.json", lambda content: content | {"mass": None})
    command = ("rod", str(folder), "--pressure", "37 kPa", "--orientation", "lying")
    assert "give material.density in its configuration" in refused(*command)
    with pytest.warns(pneurod.RodWarning):
        light = pneurod.read_results(folder).rod(37.0)
    with pytest.raises(pneurod.RodError, match=r"give material\.density"):
        light.solve(direction="lying")


def test_where_the_law_ends_before_the_load_it_is_no_lack_of_equilibrium() -> None:
    known_rod = rod_of_path(COARSE, "law").at(17.0)
    low, high = known_rod.law.moments
    known = f"The law at 17 kPa is known from {low:.4g} to {high:.4g} N mm."
    with pytest.raises(RodError, match=rf"ends before the load does. {re.escape(known)} It bears 9.4 % of this"):
        known_rod.solve(force=(-0.1, -0.5))
    near = replace(known_rod, law=replace(known_rod.law, near=18.0))
    with pytest.raises(RodError, match=rf"{re.escape(known)} That is near a limit of the pressure, 18 kPa\. It bears"):
        near.solve(force=(-0.1, -0.5))


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("space") / "law.json"
    path.write_text(json.dumps(law_record(law_of_straight(axial=50.0))), encoding="utf-8")
    return path


def rod_at(path: Path, *options: str) -> str:
    return done("rod", str(path), "--pressure", "10 kPa", *options)


def test_three_components_give_the_rod_in_space(file: Path, tmp_path: Path) -> None:
    csv = tmp_path / "shape.csv"
    out = rod_at(file, "--force", "[0 N, 0 N, 0.1 N]", "--out", str(csv))
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
    assert "of the rigidity without load is left in the softest direction" in rod_at(file, *options)


def test_a_planar_shape_that_buckles_sideways_is_kept_and_said(file: Path) -> None:
    assert "buckles out of its plane" in rod_at(file, "--force", "[0 N, 0.5 N]")
    assert "buckles" not in rod_at(file, "--force", "[0 N, 0.2 N]")


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
    assert "buckles out of its plane" in rod_at(path, "--force", "[0 N, 0.001 N]")


def test_pressures_for_a_wish_need_gravity_in_the_plane(file: Path) -> None:
    command = ("solve", str(file), "--angle", "10 deg", "--orientation", "[0, 0, -1]")
    assert "give gravity as x and y" in refused(*command)
