"""`pneurod cell` of an arm with three chambers, on a coarse mesh and with few states."""

import json
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem import Experiment, Model, follow
from pipeline.config.document import read_document
from pipeline.config.load import load_config
from pipeline.law.in_space import measure
from pipeline.law.rows import read_rows
from pipeline.results.files import read_law
from pipeline.simulate.scene import Scene
from pipeline.store.store import open_store
from pipeline.values.pressure import in_MPa
from rod.arm_law.space_law import SpaceLaw
from rod.errors import RodError
from rod.load import Load
from tests.commands import done, refused
from tests.step_bodies import save

LENGTH, SIDE, BORE, AWAY, END = 40.0, 12.0, 3.0, 3.4, 4.0
ANGLES = np.pi * np.array([1 / 2, 7 / 6, 11 / 6])  # from y to z
ROWS = "[[12 kPa, 4 kPa, 0 kPa]]"
CONFIG = """
name: three
geometry:
  family: own
  file: three.step
  symmetric: false
  curve: 0 mm
  cell: {from: 16 mm, to: 20 mm}
  air: {a: [20 mm, 0 mm, 3.4 mm], b: [20 mm, -2.944 mm, -1.7 mm], c: [20 mm, 2.944 mm, -1.7 mm]}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49, density: 1130 kg/m^3}
mesh: {size: 8 mm, formulation: p2p0, grading: off}
"""


def three(occ: Any) -> None:
    """A bar with three holes around its axis."""
    body = occ.addBox(0, -SIDE / 2, -SIDE / 2, LENGTH, SIDE, SIDE)
    corners = AWAY * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]) - BORE / 2
    occ.cut([(3, body)], [(3, occ.addBox(END, y, z, LENGTH - 2 * END, BORE, BORE)) for y, z in corners.tolist()])


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("three")
    save(folder / "three.step", three)
    path = folder / "three.yaml"
    path.write_text(f"{CONFIG}pressures: {ROWS}\n", encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def folder(config: Path) -> Path:
    out = config.parent / "law"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measure, "ONE_RATIO", (0.5, 1.0))
        patch.setattr(measure, "RINGS", ((0.5, 3),))
        printed = done("cell", str(config), "--out", str(out))
    assert "The law interpolates" in printed
    assert "On a mesh of 70 % of the size" in printed
    assert "first numbers, from its cells alone: the arm bends by " in printed
    assert "left" in printed  # time
    assert "error of the shape 0 %" not in printed
    return out


@pytest.fixture(scope="module")
def law(folder: Path) -> SpaceLaw:
    law = read_law(folder).law
    assert isinstance(law, SpaceLaw)
    return law


def test_the_arm_bends_away_from_the_pressure(law: SpaceLaw) -> None:
    end = np.array(law.at((12.0, 4.0, 0.0)).solve_in_space(Load()).end)[1:]
    towards = 3 * np.array([np.cos(ANGLES[0]), np.sin(ANGLES[0])]) + [np.cos(ANGLES[1]), np.sin(ANGLES[1])]
    turned = np.arccos(-end @ towards / np.linalg.norm(end) / np.linalg.norm(towards))
    assert turned < 0.3  # the curvature grows faster than the pressure
    assert np.linalg.norm(end) > 0.05


def test_the_law_is_known_along_its_row(law: SpaceLaw) -> None:
    assert law.error < 0.01
    less, more = (np.linalg.norm(law.at((12.0 * part, 4.0 * part, 0.0)).kappa_0) for part in (0.5, 1.0))
    assert 0.2 < less / more < 0.5
    with pytest.raises(RodError, match="are not between rows of the law"):
        law.at((12.0, 0.0, 0.0))


@pytest.mark.parametrize("pressure", [9.0, 12.0])
def test_the_air_is_that_of_finite_elements_of_the_whole_arm(law: SpaceLaw, config: Path, pressure: float) -> None:
    given = [f"pressures=[{pressure} kPa]", "effects.pressure.cavities={a: 1, b: 0.3333333333333333, c: 0}"]
    scene = Scene.meshed(load_config(config, given))
    supports = Experiment.of("II", scene.body, None).supports
    effects = scene.effects(in_MPa(pressure))
    step = follow(Model(scene.body.mesh, scene.material, supports, effects, "p2p0"), [1.0]).steps[-1]
    solid = np.array([step.cavity_volume(name) for name in law.cavities])
    rod = law.at((pressure, pressure / 3.0, 0.0))
    assert rod.volumes(rod.solve_in_space(Load())) == pytest.approx(solid, rel=1e-3)
    assert solid[0] > 1.03 * BORE**2 * (LENGTH - 2.0 * END)


def test_the_rod_from_the_command_line(folder: Path) -> None:
    rod = ("rod", str(folder), "--pressure")
    assert "z =" in done(*rod, "[6 kPa, 2 kPa, 0 kPa]", "--force", "[0 N, 0.01 N, 0 N]")
    assert "has the pressures of a, b, c; give all" in refused(*rod, "6 kPa")


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ("[[12 kPa, 0 kPa]]", "pressures[1]: has 2 pressures; give one for each of the cavities a, b, c"),
        ("[12 kPa, [1 kPa, 2 kPa, 3 kPa]]", "pressures[1]: is no row of pressures"),
        ("[[0 kPa, 0 kPa, 0 kPa]]", "pressures[1]: must have no pressure below 0 kPa, and one above"),
        ("[[1 kg, 0 kPa, 0 kPa]]", "pressures[1]: "),
    ],
)
def test_wrong_rows(changed: str, sentence: str, config: Path) -> None:
    assert sentence in refused("cell", str(config), "--set", f"pressures={changed}")


def test_the_report_draws_the_bent_body_and_mujoco_takes_the_law(folder: Path, law: SpaceLaw, tmp_path: Path) -> None:
    report = (folder / "report.html").read_text(encoding="utf-8")
    assert "up to <select" in report
    (data,) = re.findall(r'id="body-data">(.*?)</script>', report)
    assert {state["experiment"] for state in json.loads(data)["states"]} == {"12, 4, 0 kPa"}
    assert "The law interpolates" in report
    done("export", str(folder), "--to", "mujoco", "--out", str(tmp_path))
    _, data = runpy.run_path(str(tmp_path / "rod_mujoco_0_to_12kPa.py"))["load"]((12.0, 4.0, 0.0))
    end = law.at((12.0, 4.0, 0.0)).solve_in_space(Load()).end
    assert 1e3 * data.site("tip").xpos == pytest.approx(end, abs=0.01)


def test_other_commands_do_not_take_rows(config: Path, folder: Path) -> None:
    assert "`pneurod cell` takes rows for three chambers" in refused("run", str(config))


def test_pressures_for_a_wish_in_the_ratio_of_its_row(folder: Path, law: SpaceLaw) -> None:
    solve = ("solve", str(folder))
    (found,) = json.loads(done(*solve, "--angle", "0.2 deg", "--json"))["solutions"]
    assert found["angle_deg"] == pytest.approx(0.2, abs=1e-3)
    assert found["pressures_kPa"] == pytest.approx([found["pressure_kPa"], found["pressure_kPa"] / 3.0, 0.0])
    end = law.at(found["pressures_kPa"]).solve_in_space(Load()).end
    assert found["tip_mm"] == pytest.approx(end, abs=1e-4)
    place = ", ".join(f"{value} mm" for value in end)
    again = json.loads(done(*solve, "--tip", f"[{place}]", "--ratio", "3:1:0", "--json"))["solutions"]
    assert again[0]["pressure_kPa"] == pytest.approx(found["pressure_kPa"], rel=1e-3)
    other = refused(*solve, "--angle", "0.2 deg", "--ratio", "1:1:0")
    assert "--ratio 1:1:0: The law has no pressures in this ratio" in other


def test_other_commands_say_what_the_law_lacks(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "arm.csv").write_text("pressure_kPa,tip_x_mm,tip_y_mm\n2,40,0.1\n", encoding="utf-8")
    measured = [str(folder), str(tmp_path / "arm.csv")]
    others = (["export", str(folder), "--to", "pyelastica"], ["budget", str(folder)])
    for command in (*others, *([name, *measured] for name in ("compare", "calibrate"))):
        assert "takes a law in a plane, and this one is in space" in refused(*command)


def test_the_weight_of_the_saved_arm(folder: Path) -> None:
    heavy = done("rod", str(folder), "--pressure", "[6 kPa, 2 kPa, 0 kPa]", "--orientation", "[0, -1]")
    assert "which the rod carries besides" in heavy


def test_a_fresh_folder_has_no_older_law(folder: Path, config: Path) -> None:
    with open_store(folder, read_rows(read_document(config)).config, fresh=True):
        assert not (folder / "law.json").exists()
        assert not (folder / "law_in_space").exists()
