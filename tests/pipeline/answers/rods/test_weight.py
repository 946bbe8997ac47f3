"""The rod with the arm's own law under its weight, against finite elements of the whole arm; light and heavy arms."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pneurod
from geometry import Centreline
from pipeline.config.load import load_config
from pipeline.results.files import read_results
from pipeline.results.verdict import verdict_of
from pipeline.simulate.mass import element_masses, mass_along, weight_per_length
from pipeline.simulate.scene import Scene
from rod.weight import WEIGHT_OF_GRAM, Mass
from tests.commands import call
from tests.measured_arm import LENGTH, arm_law, result_folder

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent.parent / "configs"
#: largest distance from the finite elements, over the length
NEAR = 0.005
SETTINGS = {"geometry.chambers": 7, "mesh.size": "8 mm", "mesh.coarser": "off", "accuracy": "off", "validation": "off"}


def results(orientation: str, folder: Path) -> pneurod.Results:
    settings = {**SETTINGS, "pressures": ["6 kPa", "14 kPa"], "effects.gravity": orientation}
    return pneurod.characterize(CONFIGS / "pneunet_coarse.yaml", out=folder, settings=settings, jobs=1)


@pytest.mark.slow  # tests/rod/test_weight.py and tests/pipeline/answers/rods/test_loads.py have the rod alone
@pytest.mark.parametrize("orientation", ["lying", "hanging", "standing"])
def test_a_rod_with_weight_is_near_the_finite_elements(orientation: str, tmp_path: Path) -> None:
    run = results(orientation, tmp_path)
    table = run.validation.query("rod == 'arm_law'")
    assert len(table) == 4
    assert (table["distance_over_length"] < NEAR).all(), table
    law = run.arm_law
    assert np.hypot(*law.weight) * law.length == pytest.approx(9.81e-3 * law.mass.grams[-1])
    with pytest.warns(pneurod.RodWarning):
        rod = run.rod(14.0)
    of_run = run.curves.query("experiment == 'II' and pressure_kPa == 14.0")
    free = Centreline(*(of_run[name].to_numpy() for name in ("s_mm", "x_mm", "y_mm")))
    for shape in (rod.solve(), rod.solve(direction=orientation)):
        apart = shape.positions(free.s) + run.curve_start_mm - np.column_stack([free.x, free.y])
        assert np.linalg.norm(apart, axis=1).max() < NEAR * run.length_mm
    weightless = rod.solve(direction=orientation, weight=False)
    assert np.linalg.norm(np.subtract(weightless.end, rod.solve().end)) > 0.003 * run.length_mm


def test_the_mass_of_the_mesh_is_spread_along_the_arm() -> None:
    settings = ["materials.base={law: svk, E: 1 MPa, nu: 0.4, density: 2000 kg/m^3}", "effects.gravity=30 deg"]
    config = load_config(CONFIGS / "pneunet_coarse.yaml", settings)
    body = Scene.meshed(config).body
    masses, mass = element_masses(body, config), mass_along(body, config)
    assert mass.grams[-1] == pytest.approx(masses.sum()) == pytest.approx(1e6 * (config.mass_tonne or 0.0), rel=1e-6)
    assert mass.grams[len(mass.grams) // 2] == pytest.approx(masses.sum() / 2.0, rel=0.01)  # the arm is symmetric
    centre = body.mesh.points[body.mesh.tets, 1].mean(axis=1) @ masses / masses.sum()
    assert mass.heights[-1] / mass.grams[-1] == pytest.approx(centre - body.curve_y)
    x, y = np.array(weight_per_length(mass, config)) * body.length
    assert (x, y) == pytest.approx(9.81e-3 * masses.sum() * np.array([-0.5, -np.sqrt(0.75)]))
    bare = load_config(CONFIGS / "pneunet_coarse.yaml", ["material={law: svk, E: 1.2 MPa, nu: 0.495}"])
    assert mass_along(body, bare) is None


COMMANDS = (
    ("rod", "--pressure", "0 kPa", "--orientation", "lying"),
    ("rod", "--pressure", "40 kPa", "--orientation", "standing", "--tip-mass", "1 g"),
    ("rod", "--pressure", "20 kPa"),
    ("budget", "--pressure", "20 kPa"),
    ("solve", "--angle", "30 deg"),
    ("move", "--pressure", "0 kPa", "--orientation", "hanging", "--release", "--seconds", "0.1"),
)


@pytest.mark.parametrize("times", [0.1, 1.0, 100.0])
@pytest.mark.parametrize("with_weight", [False, True], ids=["law without weight", "law with weight"])
def test_light_and_heavy_arms(tmp_path: Path, times: float, with_weight: bool) -> None:
    mass = 70.0 * times  # g; the law bears 40 N mm, which 74 g bend it with, straight and lying
    weight = (0.0, -mass * WEIGHT_OF_GRAM / LENGTH) if with_weight else (0.0, 0.0)
    folder = result_folder(tmp_path / "arm", replace(arm_law(), mass=Mass.even(LENGTH, mass), weight=weight))
    words = [" ".join(verdict_of(read_results(folder)).lines)]
    for command, *options in COMMANDS:
        ended = call(command, str(folder), *options)
        assert isinstance(ended.exception, SystemExit | None)
        told = ended.stderr.split("pneurod: ")[1:]
        assert (len(told), ended.exit_code in (1, 2)) == ((1, True) if ended.exit_code else (0, False))
        words.append(ended.output)
    assert not {"nan", "inf", "Traceback"} & {*" ".join(words).split()}
    lying = call("rod", str(folder), "--pressure", "0 kPa", "--orientation", "lying")
    assert (lying.exit_code == 0) is (times <= 1.0)
