"""What is unusual about a configuration, and what is said before and while a body is meshed."""

import re
import subprocess
import sys
from pathlib import Path
from time import sleep
from types import SimpleNamespace
from typing import Any

import meshio
import numpy as np
import pytest

from geometry import Reason
from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.identify.state_notes import _long_cells
from pipeline.simulate.design_notes import check_design, check_load
from pipeline.simulate.scene import Scene, mesh_with_progress
from pipeline.simulate.too_short import too_short
from pipeline.values.reasons import render
from tests.commands import call
from tests.foreign_bodies import bar, meshed, two_chambers, write_mesh, write_surface
from tests.step_bodies import save

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"
PRESSURES = "pressures=[10 kPa, 20 kPa, 30 kPa]"
STEEL = "materials={base: {law: svk, E: 200 GPa, nu: 0.3, density: 7850 %s}}"
CONSTANT = "effects.pressure={cavities: {cavity: 4 kPa}}"


def checked(*settings: str, config: Path = CONFIGS / "pneunet_coarse.yaml") -> dict[str, Reason]:
    """The reasons by code, all of which can be written."""
    reasons = check_design(load_config(config, settings))
    assert all(map(render, reasons))
    return {reason.code: reason for reason in reasons}


@pytest.mark.parametrize("name", ["pneunet", "semicircular", "semicircular_single", "bisected_circle", "finger"])
def test_the_shipped_designs_are_usual(name: str) -> None:
    assert set(checked(config=CONFIGS / f"{name}.yaml")) <= {"few_pressures", "unequal_cells"}


@pytest.mark.parametrize(
    ("settings", "codes"),
    [
        ((PRESSURES,), set()),
        ((PRESSURES, "geometry.chambers=6", "law=cell"), set()),
        (("pressures=[10 kPa, 20 kPa]",), {"few_pressures"}),
        (("pressures=[0.1 MPa, 0.2 MPa, 0.4 MPa]",), {"strong_pressure"}),
        (("pressures=[10 Pa, 20 Pa, 30 Pa]",), {"weak_pressure"}),
        ((PRESSURES, "material.E=1200 MPa"), {"weak_pressure"}),
        ((PRESSURES, "geometry.chambers=6"), {"too_short"}),
        (("pressures=[5 kPa]", "geometry.chambers=6"), {"too_short"}),  # nothing on linearity
        ((PRESSURES, CONSTANT), {"pressure_unused"}),
        ((PRESSURES, "effects.pressure=off"), {"pressure_unused"}),
        (("pressures=[5 kPa]", "effects.pressure=off"), set()),
        ((PRESSURES, "effects.pressure={cavities: {cavity: 0.5}}"), set()),
        ((PRESSURES, f"geometry.gaps=[{11 * '2 mm, '}3 mm]"), {"unequal_cells"}),
        ((PRESSURES, "material.density=1.07 kg/m^3"), {"density"}),
        ((PRESSURES, "material.density=1070 g/cm^3"), {"density"}),
        ((PRESSURES, STEEL % "g/cm^3"), {"density"}),
        ((PRESSURES, STEEL % "kg/m^3"), set()),
        ((PRESSURES, "material.density=30 kg/m^3"), set()),
    ],
)
def test_what_is_unusual_is_known_before_anything_is_solved(settings: tuple[str, ...], codes: set[str]) -> None:
    assert set(checked(*settings)) == codes


def test_the_numbers_of_reasons_are_those_of_the_configuration() -> None:
    strong = checked("pressures=[10 kPa, 30 kPa, 500 kPa]")["strong_pressure"].values
    assert strong["bearable_kPa"] == pytest.approx(500.0 / strong["ratio"], rel=0.05)
    assert (strong["pressure_kPa"], strong["modulus_MPa"]) == pytest.approx((500.0, 1.2), rel=0.02)
    short = checked(PRESSURES, "geometry.chambers=6")["too_short"].values
    assert short == {"length_mm": 62.0, "needed_mm": 65.0, "averaging_mm": 10.0}
    dense = checked(PRESSURES, STEEL % "g/cm^3")["density"].values
    assert (dense["key"], dense["density_kg_m3"]) == ("materials.base", pytest.approx(7.85e6))
    assert checked("pressures=[5 kPa]")["few_pressures"].values == {"count": 1}


@pytest.mark.parametrize("kind", ["step", "vtk", "stl"])
def test_gravity_along_an_arm_that_is_turned(kind: str, tmp_path: Path) -> None:
    """Its x runs from the clamp to the tip, and so against that of the file."""
    write = {
        "step": lambda path: save(path, bar),
        "vtk": lambda path: write_mesh(path, *meshed(bar, 5.0)),
        "stl": lambda path: write_surface(path, bar, 50),
    }[kind]
    write(tmp_path / f"bar.{kind}")
    path = tmp_path / "hanging.yaml"
    path.write_text(
        f"name: hanging\ngeometry: {{family: own, file: bar.{kind}, curve: 1.5 mm}}\npressures: [10 kPa]\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49, density: 1070 kg/m^3}\n"
    )

    def is_named(x: str, *settings: str) -> bool:
        gravity = f"effects.gravity={{acceleration: [{x}, -1 m/s^2, 0 m/s^2]}}"
        return "turned_gravity" in checked(gravity, *settings, config=path)

    assert is_named("9.81 m/s^2", "geometry.clamp=60 mm")
    assert not is_named("9.81 m/s^2")
    assert not is_named("0 m/s^2", "geometry.clamp=60 mm")


CHAMBERS = """
name: chambers
geometry:
  {family: own, file: chambers.step, curve: 1.5 mm, air: {near: [15 mm, 6 mm, 0 mm], far: [45 mm, 6 mm, 0 mm]}}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49}
pressures: [1 kPa, 2 kPa, 3 kPa]
mesh: {size: 6 mm}
law: five
"""


def only_single(config: Config, two_lines: bool) -> tuple[Reason, ...]:
    """The note on an arm whose parameters at 2 kPa have two lines or one; at 1 kPa walls touch."""
    given = [(1.0, False, True), (2.0, True, two_lines)]
    of_pressures = [SimpleNamespace(pressure_kPa=p, one_rigidity=one, two_lines=two) for p, one, two in given]
    return tuple(_long_cells(SimpleNamespace(config=config, parameters=of_pressures)))  # type: ignore[arg-type]


def test_cavities_that_are_longer_than_the_curvature_is_averaged_over(tmp_path: Path) -> None:
    save(tmp_path / "chambers.step", two_chambers)
    path = tmp_path / "chambers.yaml"
    path.write_text(CHAMBERS, encoding="utf-8")
    config = load_config(path)
    assert check_design(config) == ()
    assert only_single(config, two_lines=True) == ()  # with a given d, or where walls touch
    (long,) = only_single(config, two_lines=False)
    assert long.values == {
        "averaging_mm": pytest.approx(6.0),
        "between_mm": pytest.approx(28.0),
        "pressures_kPa": [2.0],
    }
    assert "a single line is taken at 2 kPa" in render(long)
    assert only_single(load_config(path, ["geometry.cell=28 mm"]), two_lines=False) == ()


@pytest.mark.parametrize(("chambers", "is_short"), [(6, True), (7, False)])
def test_an_arm_is_too_short_whatever_is_made_of_it_but_the_law_of_a_cell(chambers: int, is_short: bool) -> None:
    settings = [PRESSURES, f"geometry.chambers={chambers}"]
    assert bool(too_short(load_config(CONFIGS / "pneunet_coarse.yaml", settings))) is is_short
    assert too_short(load_config(CONFIGS / "pneunet_coarse.yaml", [*settings, "law=cell"])) is None


@pytest.mark.parametrize("command", ["mesh", "effects", "accuracy", "cell"])
def test_every_command_that_solves_tells_of_pressures_in_another_unit(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Begun(Exception):
        """The notes come before anything is solved."""

    def begins(*given: Any) -> None:
        raise Begun

    for name in ("study.effects.study.compare_effects", "study.accuracy.run.run_study", "law.study.measure_any_law"):
        monkeypatch.setattr(f"pipeline.{name}", begins)
    setting, config = "pressures=[0.37 MPa]", CONFIGS / "pneunet_coarse.yaml"
    result = call(command, str(config), "--set", setting, "--out", str(tmp_path))
    assert isinstance(result.exception, Begun) is (command != "mesh")
    (strong,) = check_load(load_config(config, [setting]))
    assert render(strong) in " ".join(result.output.split())


def test_regions_of_a_file_that_all_have_one_material_and_a_body_in_another_unit(tmp_path: Path) -> None:
    points, tets = meshed(bar, 5.0)
    low = points[tets, 1].mean(axis=1) < 3
    sets = {"base": [np.flatnonzero(low)], "top": [np.flatnonzero(~low)]}
    meshio.Mesh(points, [("tetra", tets)], cell_sets=sets).write(tmp_path / "bar.inp")
    save(tmp_path / "bar.step", bar)
    path = tmp_path / "bar.yaml"
    path.write_text(
        "name: bar\ngeometry: {family: own, file: bar.inp, curve: 1.5 mm}\npressures: [10 kPa]\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49}\n"
    )
    found = {reason.code: render(reason) for reason in check_load(load_config(path))}
    assert "the regions base, top, and all have one material" in found["one_material"]
    numbered = meshio.Mesh(points, [("tetra", tets)], cell_data={"material": [1 + low]})
    for file in ("bar.vtu", "bar.vtk"):
        numbered.write(tmp_path / file)
        (note,) = (r for r in check_load(load_config(path, [f"geometry.file={file}"])) if r.code == "one_material")
        assert "the regions material_1, material_2, and all have one material" in render(note)
        soft = [f"geometry.file={file}", "materials.material_2={law: neo_hooke, mu: 1 MPa, nu: 0.49}"]
        assert "one_material" not in {reason.code for reason in check_load(load_config(path, soft))}
    given = check_load(load_config(path, ["materials.base={law: neo_hooke, mu: 1 MPa, nu: 0.49}"]))
    assert {"one_material", "large_body"}.isdisjoint(reason.code for reason in given)
    step = ["geometry.file=bar.step", "mesh.size=5 mm"]
    assert {"one_material", "large_body"}.isdisjoint(r.code for r in check_load(load_config(path, step)))
    step += ["geometry.unit=cm", "geometry.curve=15 mm"]
    (large,) = (reason for reason in check_load(load_config(path, step)) if reason.code == "large_body")
    assert render(large) == "the body is 600 mm long, 120 times mesh.size; is it in another unit? give unit"


HERE = Path(__file__).resolve().parent.parent.parent.parent


def small_fillets(occ: Any, radius: float = 0.5) -> Any:
    """A bar of 60 x 12 x 15 mm with rounded upper edges and one cavity."""
    block = occ.addBox(0, 0, -7.5, 60, 12, 15)
    occ.synchronize()
    reach = {tag: occ.getBoundingBox(1, tag) for _, tag in occ.getEntities(1)}
    upper = [tag for tag, box in reach.items() if box[3] - box[0] > 59 and box[1] > 11]
    return occ.cut(occ.fillet([block], upper, [radius]), [(3, occ.addBox(5, 4, -4, 50, 5, 8))])[0]


FILLETS = """
name: fillets
geometry: {family: own, file: fillets.step, curve: 2 mm}
material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49}
pressures: [20 kPa]
mesh: {size: 5 mm, grading: off}
"""


def test_small_edges_are_named_before_meshing(tmp_path: Path) -> None:
    """In a process of its own, where what is printed while Gmsh meshes could be lost."""
    save(tmp_path / "fillets.step", small_fillets)
    path = tmp_path / "fillets.yaml"
    path.write_text(FILLETS, encoding="utf-8")
    command = [sys.executable, "-m", "pipeline", "mesh", str(path), "--out", str(tmp_path / "out")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=HERE) as meshing:
        small, stage = (meshing.stdout.readline().rstrip("\n") for _ in range(2))
        meshing.kill()
    assert stage == "stage: mesh"
    (reason,) = check_load(load_config(path))
    assert small == f"note: {render(reason)}"
    assert (reason.code, reason.values["count"]) == ("short_edges", 4)
    assert reason.values["shortest_mm"] == pytest.approx(np.pi / 4, rel=1e-3)
    assert re.fullmatch(r"\((0|60), 11\.\d, -?7\.\d+\) mm", reason.values["near"])
    assert check_load(load_config(path, ["mesh.size=2 mm"])) == ()


def test_long_calls_are_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    def told(seconds: float, every: float) -> list[str]:
        remarks: list[str] = []
        listener: Any = SimpleNamespace(remark=remarks.append)
        monkeypatch.setattr("pipeline.simulate.scene.EVERY", every)
        monkeypatch.setattr(Scene, "meshed", lambda config: sleep(seconds))
        config: Any = None
        mesh_with_progress(config, listener)
        return remarks

    quick, slow = told(0.0, 10.0), told(0.3, 0.02)
    assert quick == []
    assert len(slow) > 1
    count = len(slow)
    sleep(0.1)
    assert len(slow) == count, "nothing is told after the end"
