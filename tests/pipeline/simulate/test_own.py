"""Bodies from files in a configuration: the STEP file in configs/, a mesh file, and files that are refused.

`python -m tests.pipeline.simulate.test_own` draws configs/finger.step again.
"""

import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import fem
from geometry import CadFile, Mesh, MeshError, MeshFile, SurfaceFile
from geometry.manifold import check_untangled
from geometry.meshing.solid import session
from pipeline.config.load import load_config
from pipeline.simulate.effects_record import list_effects
from pipeline.simulate.loadcase import identification_case
from pipeline.simulate.scene import Scene
from pipeline.simulate.simulate import experiments_of, simulate
from pipeline.values.errors import InputError
from tests.commands import refused
from tests.foreign_bodies import bar, bar_with_inlet, write_surface
from tests.solved import alone
from tests.step_bodies import save

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"


def finger(occ: Any) -> list[tuple[int, int]]:
    """A bar of 80 x 13 x 16 mm with round upper edges (3 mm) and a cavity of 76 x 9.5 x 13 mm, 2 mm over the base."""
    bar = occ.addBox(0, 0, -8, 80, 13, 16)
    occ.synchronize()
    upper = [tag for _, tag in occ.getEntities(1) if _along_the_top(occ, tag)]
    round_bar = occ.fillet([bar], upper, [3.0])
    return occ.cut(round_bar, [(3, occ.addBox(2, 2, -6.5, 76, 9.5, 13))])[0]


def _along_the_top(occ: Any, edge: int) -> bool:
    x0, y0, _, x1, y1, _ = occ.getBoundingBox(1, edge)
    return x1 - x0 > 79 and min(y0, y1) > 12.9


def draw(path: Path) -> None:
    """Write the finger as STEP, without the date and the program's paths in its head."""
    with session() as gmsh:
        finger(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    head = (
        "HEADER;\nFILE_DESCRIPTION(('a finger'),'2;1');\n"
        "FILE_NAME('finger.step','2000-01-01T00:00:00',('pneurod'),(''),'Gmsh','Open CASCADE','');\n"
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;"
    )
    text = re.sub(r"HEADER;.*?ENDSEC;", head, path.read_text(encoding="ascii"), count=1, flags=re.DOTALL)
    path.write_text(text, encoding="ascii")


def test_shipped_file_is_what_the_drawing_says(tmp_path: Path) -> None:
    draw(tmp_path / "finger.step")
    shipped = load_config(CONFIGS / "finger.yaml")
    assert isinstance(shipped.design, CadFile)
    again = CadFile(str(tmp_path / "finger.step"), 1, 0, 80, shipped.design.air)
    assert again.solid_volume == pytest.approx(shipped.design.solid_volume, rel=1e-9)
    assert shipped.design.solid_volume == pytest.approx(
        80 * (13 * 16 - (4 - 3.14159265) * 9 / 2) - 76 * 9.5 * 13, rel=1e-6
    )
    assert (CONFIGS / "finger.step").stat().st_size < 40_000


def test_own_body_is_read_and_recorded(tmp_path: Path) -> None:
    config = load_config(CONFIGS / "finger.yaml")
    geometry = config.record()["geometry"]
    assert geometry["file"] == "finger.step"
    assert len(geometry["sha256"]) == 64
    assert geometry["air"] == {"cavity": [40.0, 7.0, 0.0]}
    assert (config.design.length, config.family) == (80.0, "own")


def test_own_body_is_inflated(tmp_path: Path) -> None:
    config = load_config(CONFIGS / "finger.yaml", ["mesh.size=5 mm", "pressures=[20 kPa]"])
    scene = Scene.meshed(config)
    with alone(tmp_path, config) as context:
        outcomes = simulate(scene, context, ("II",))
        rows = {state.effect: state for state in list_effects(scene, outcomes)}
    (record,) = outcomes["II"].records
    assert record.state.end_mm[1] < 1.0 - 2.0
    assert abs(record.state.stretch_of_curve - 1.0) < 2e-3
    assert rows["self_contact"].state == "off"
    assert rows["symmetry"].state == rows["strain_limiting_layer"].state == "on"


def test_stretches_of_a_region_are_those_of_its_elements(tmp_path: Path) -> None:
    """A base of 500 MPa under soft rubber does not stretch."""
    path = tmp_path / "stiff_base.yaml"
    path.write_text(
        "name: stiff_base\ngeometry: {family: rectangular, chambers: 3, width: 14 mm, height: 12 mm, base: 2 mm}\n"
        "material: {law: neo_hooke, mu: 0.03 MPa, nu: 0.49}\nmaterials: {base: {law: hencky, E: 500 MPa, nu: 0.4}}\n"
        "pressures: [5 kPa]\nmesh: {size: 4 mm}\n"
    )
    scene = Scene.meshed(config := load_config(path))
    with alone(tmp_path / "out", config) as context:
        (record,) = simulate(scene, context, ("II",))["II"].records
    base = np.isin(np.arange(len(scene.body.mesh.tets)), scene.body.mesh.regions["base"])
    stretches = np.array([record.fields["smallest_stretch"], record.fields["stretch"]])
    np.testing.assert_allclose(stretches[:, base], 1.0, atol=1e-3)
    assert record.state.max_stretch == stretches[1, ~base].max() > 1.1


@pytest.fixture(scope="module")
def ready(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A configuration of the finger as a ready mesh."""
    folder = tmp_path_factory.mktemp("ready")
    body = Scene.meshed(load_config(CONFIGS / "finger.yaml", ["mesh.size=5 mm", "geometry.cell=8 mm"])).body
    body.mesh.write(folder / "finger.msh")
    text = (CONFIGS / "finger.yaml").read_text(encoding="utf-8")
    geometry = "geometry: {family: own, file: finger.msh, curve: 1 mm, cell: 8 mm}\n"
    text = re.sub(r"geometry:\n(  .*\n)+", geometry, text)
    text = re.sub(r"mesh:\n(  .*\n)+", "", text)
    path = folder / "finger.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_curvature_is_averaged_over_the_cell_that_is_given(ready: Path) -> None:
    for given, pitch in (("7 mm", 7.0), ("12.5 mm", 12.5)):  # of 80 mm
        config = load_config(ready, [f"geometry.cell={given}"])
        assert config.design.pitch == pitch
        assert Scene.meshed(config).body.pitch == pitch


def test_ready_mesh_stays_as_it_is(ready: Path) -> None:
    config = load_config(ready)
    assert isinstance(config.design, MeshFile)
    body = Scene.meshed(config).body
    assert (body.half, body.length, config.mesh.formulation) == (True, pytest.approx(80.0), "mixed")
    assert config.mesh.size_mm == pytest.approx(body.mesh.quality.longest_edge)
    assert config.design.solid_volume == pytest.approx(
        load_config(CONFIGS / "finger.yaml").design.solid_volume, rel=2e-2
    )


def refusal(path: Path, *overrides: str) -> str:
    with pytest.raises(InputError) as wrong:
        load_config(path, overrides)
    assert "\n" not in str(wrong.value)
    return str(wrong.value)


def test_ready_mesh_is_refused_by_key(ready: Path) -> None:
    assert "mesh.size: unknown key; allowed here: formulation" in refusal(ready, "mesh.size=3 mm")
    assert "geometry.file: the mesh file" in refusal(ready, "geometry.file=none.msh")
    assert "geometry.curve: the line y = 5 mm, z = 0 is outside the material" in refusal(ready, "geometry.curve=5 mm")


TWO_MATERIALS = """
name: two_materials
geometry: {geometry}
material: {{law: neo_hooke, mu: 0.1 MPa, nu: 0.49, density: 1000 kg/m^3}}
materials: {{base: {{law: neo_hooke, mu: 0.6 MPa, nu: 0.49, density: 1000 kg/m^3}}}}
pressures: [5 kPa]
mesh: {mesh}
law: five
"""


def test_a_region_of_a_mesh_file_has_a_material_of_its_own(tmp_path: Path) -> None:
    """The mesh of a drawn arm, written with its base as a named volume, gives the state of that arm."""

    def tip(name: str, geometry: str, mesh: str) -> tuple[Scene, np.ndarray]:
        path = tmp_path / f"{name}.yaml"
        path.write_text(TWO_MATERIALS.format(geometry=geometry, mesh=mesh), encoding="utf-8")
        scene = Scene.meshed(load_config(path))
        case = identification_case(scene.config, "II")
        experiment = fem.Experiment.of("II", scene.body, case.end.y_mm)
        effects = scene.effects(case.schedule.reference_MPa)
        model = experiment.model(scene.material, effects, scene.config.mesh.formulation)
        step = fem.follow(model, case.schedule.factors).steps[-1]
        return scene, step.displacement[step.space.surface("tip").unique_nodes].mean(axis=0)

    drawn, expected = tip("drawn", "{family: rectangular, chambers: 2}", "{size: 6 mm, formulation: mixed}")
    mesh = drawn.body.mesh
    base = mesh.regions["base"]
    rest = np.setdiff1d(np.arange(len(mesh.tets)), base)
    cells = [*(("triangle", triangles) for triangles in mesh.faces.values()), ("tetra", mesh.tets[base])]
    cells.append(("tetra", mesh.tets[rest]))
    names = {
        name: np.array([k, 3 if name in ("base", "top") else 2]) for k, name in enumerate([*mesh.faces, "base", "top"])
    }
    tags = [np.full(len(data), k, dtype=np.int32) for k, (_, data) in enumerate(cells)]
    groups = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    meshio.Mesh(mesh.points, cells, cell_data=groups, field_data=names).write(
        tmp_path / "two.msh", file_format="gmsh22"
    )
    own, moved = tip("own", f"{{family: own, file: two.msh, curve: {drawn.body.curve_y} mm}}", "{formulation: mixed}")
    assert set(own.body.mesh.regions) == {"base"}
    np.testing.assert_allclose(moved, expected, rtol=1e-8)


def test_a_mesh_whose_boundary_passes_through_itself_is_refused(ready: Path, tmp_path: Path) -> None:
    """A vertex of the cavity's roof is pulled down through the base: its elements are stretched, not turned over."""
    mesh = Mesh.read(ready.parent / "finger.msh")
    points, roof = np.array(mesh.points), np.unique(mesh.faces["cavity"])
    above = np.linalg.norm(points[roof] - [40.0, 11.5, 3.0], axis=1)
    for vertex in roof[np.argsort(above)]:
        points = np.array(mesh.points)
        points[vertex, 1] -= 15.0
        crossed = Mesh(points, mesh.tets, mesh.faces)
        with suppress(MeshError):
            check_untangled(crossed)
            break
    crossed.write(tmp_path / "crossed.msh")
    config = load_config(ready, [f"geometry.file={tmp_path / 'crossed.msh'}"])
    with pytest.raises(InputError, match=r"geometry.file: the boundary .* passes through itself near \("):
        Scene.meshed(config)


def test_the_clamp_carries_the_pressure_on_an_inlet(tmp_path: Path) -> None:
    """Nothing would carry it in experiment I, whose three constraints are for a body in balance."""
    save(tmp_path / "inlet.step", bar_with_inlet)
    path = tmp_path / "inlet.yaml"
    path.write_text(
        "name: inlet\ngeometry: {family: own, file: inlet.step, curve: 1.5 mm, plug: true}\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.45}\npressures: [4 kPa]\n"
        "mesh: {size: 6 mm, formulation: p2, grading: off}\n",
        encoding="utf-8",
    )
    config = load_config(path)
    assert experiments_of(config) == ("II", "III")
    assert experiments_of(load_config(CONFIGS / "finger.yaml")) == ("II", "III", "I")
    scene = Scene.meshed(config)
    with alone(tmp_path / "out", config) as context:
        outcomes = simulate(scene, context, ("II",))
    summary = outcomes["II"].records[0].state
    assert summary.clamp_reaction_N[0] == pytest.approx(-4e-3 * np.pi * 1.5**2, rel=0.03)
    reason = next(state.reason for state in list_effects(scene, outcomes) if state.effect == "pressure")
    assert "experiment I, without a clamp, is not simulated" in reason


def test_a_surface_is_filled_and_recorded(tmp_path: Path) -> None:
    write_surface(tmp_path / "bar.stl", bar, 50)
    path = tmp_path / "bar.yaml"
    path.write_text(
        "name: bar\ngeometry: {family: own, file: bar.stl, curve: 300 mm, unit: inch, axes: [x, z, -y], clamp: 0 mm}\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49}\npressures: [20 kPa]\n",
        encoding="utf-8",
    )
    assert "geometry.curve: y = 300 mm lies outside the body, which reaches from -190.5 to 190.5 mm" in refusal(path)
    right = ["geometry.unit=mm", "geometry.axes=[x, y, z]", "geometry.curve=1.5 mm"]
    config = load_config(path, right)
    assert isinstance(config.design, SurfaceFile)
    record = config.record()["geometry"]
    assert (record["file"], record["axes"], len(record["sha256"])) == ("bar.stl", ["x", "y", "z"], 64)
    assert (config.mesh.grading, config.mesh.coarser) == ("off", 1.5)
    assert config.design.thinnest_wall == pytest.approx(2.0, abs=0.15)
    assert config.mesh.size_mm == pytest.approx(0.18 * 12.0, abs=0.1)
    assert Scene.meshed(config).body.mesh.volume == pytest.approx(config.design.solid_volume, rel=1e-4)
    assert "mesh.grading: unknown key; allowed here: size, formulation, coarser" in refusal(
        path, *right, "mesh.grading=walls"
    )
    unit = refusal(path, *right, "geometry.unit=fathoms deep")
    assert "geometry.unit: 'fathoms deep' is no unit of length; allowed: mm, cm, m, inch" in unit
    assert "are no directions; allowed: the directions of the file" in refusal(path, *right, "geometry.axes=[x, y]")
    for axes in ("{along: [1, 0, 0]}", "{along: [1, 0, 0], up: [0, 1]}"):
        assert "allowed: " in refusal(path, *right, f"geometry.axes={axes}")
    turned = load_config(path, [*right, "geometry.axes={along: [2, 0, 0], up: [1, 1, 0]}"])
    assert turned.record()["geometry"]["axes"] == {"along": [2.0, 0.0, 0.0], "up": [1.0, 1.0, 0.0]}
    assert turned.design.extent == pytest.approx(config.design.extent)


def hinge(occ: Any) -> None:
    """The finger with two blocks on it that touch along a line."""
    blocks = [(10, 13, 10, 4), (20, 17, 10, 4), (29, 13, 1, 4)]
    occ.fuse(finger(occ), [(3, occ.addBox(x, y, -2, long, high, 4)) for x, y, long, high in blocks])


BAD: dict[str, tuple[Callable[[Any], Any], str]] = {
    "open": (lambda occ: occ.cut(finger(occ), [(3, occ.addCylinder(-1, 6, 0, 10, 0, 0, 1))]), "no closed cavity"),
    "several": (lambda occ: (finger(occ), occ.addBox(0, 20, -1, 60, 2, 2)), "holds 2 solids, around ("),
    "metres": (lambda occ: occ.dilate(finger(occ), 0, 0, 0, 1e3, 1e3, 1e3), "is it in another unit"),
    "pinched": (hinge, "not manifold"),
}


@pytest.mark.parametrize("case", BAD)
def test_files_that_cannot_be_used_end_with_2(case: str, tmp_path: Path) -> None:
    draw_bad, complaint = BAD[case]
    with session() as gmsh:
        draw_bad(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "finger.step"))
    (tmp_path / "finger.yaml").write_text((CONFIGS / "finger.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    assert complaint in refused("mesh", str(tmp_path / "finger.yaml"), "--out", str(tmp_path / "out"))


if __name__ == "__main__":
    draw(CONFIGS / "finger.step")
