"""A CAD file of several solids, some of which are of another material."""

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError, Mesh
from pipeline.config.load import load_config
from pipeline.simulate.mesh_notes import check_body
from pipeline.simulate.scene import Scene
from pipeline.values.errors import InputError
from tests.step_bodies import box, save

DATA = Path(__file__).resolve().parents[1] / "data"
PAPER = """
name: paper
geometry: {family: own, file: paper.step, curve: 2.1 mm, parts: {paper: [40 mm, 2.1 mm, 0 mm]}}
material: {law: yeoh, c10: 0.11 MPa, c20: 0.02 MPa, c30: 0 MPa, nu: 0.495}
materials: {paper: {law: hencky, E: 6500 MPa, nu: 0.2}}
pressures: [20 kPa]
mesh: {size: 4.2 mm}
"""
#: mm3: a plate of 60 x 3 x 15 mm below a block of 60 x 9 x 15 mm, and a cavity of 54 x 5 x 9 mm that the plate closes
PLATE, BLOCK, AIR = 60.0 * 3 * 15, 60.0 * 9 * 15, 54.0 * 5 * 9
IN_PLATE, IN_BLOCK = (20.0, 1.0, 0.0), (20.0, 11.0, 0.0)


def pair(occ: Any, apart: float = 0.0) -> None:
    """Both solids, `apart` mm from each other (overlapping where that is negative)."""
    box(occ, (0, -apart, -7.5), (60, 3 - apart, 7.5))
    occ.cut([box(occ, (0, 3, -7.5), (60, 12, 7.5))], [box(occ, (3, 3, -4.5), (57, 8, 4.5))])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("parts")
    save(folder / "pair.step", pair)
    save(
        folder / "half.brep",
        lambda occ: (pair(occ), occ.intersect(occ.getEntities(3), [box(occ, (0, 0, 0), (60, 12, 8))])),
    )
    save(folder / "standing.step", lambda occ: (pair(occ), occ.rotate(occ.getEntities(3), 0, 0, 0, 1, 0, 0, np.pi / 2)))
    return folder


def volume_of(mesh: Mesh, name: str) -> float:
    return Mesh(mesh.points, mesh.tets[mesh.regions[name]], {}).volume


@pytest.mark.parametrize(
    ("file", "keys"),
    [
        ("pair.step", {}),
        ("pair.step", {"symmetric": False}),
        ("pair.step", {"clamp": 60.0, "tip": 0.0, "parts": {"plate": (10.0, 1.0, -2.0)}}),
        ("half.brep", {"clamp": 60.0, "tip": 0.0, "symmetric": True}),
        ("standing.step", {"axes": ("x", "z", "-y")}),
    ],
    ids=["half", "whole", "clamped at the larger x", "half, clamped at the larger x", "standing"],
)
def test_a_solid_is_a_region(file: str, keys: dict[str, Any], folder: Path) -> None:
    design = CadFile(str(folder / file), 1.5, **{"parts": {"plate": IN_PLATE}, **keys})
    assert design.region_volumes == pytest.approx({"plate": PLATE}, rel=1e-6)
    assert design.solid_volume == pytest.approx(PLATE + BLOCK - AIR, rel=1e-6)
    assert design.cavity_volumes == pytest.approx({"cavity": AIR}, rel=1e-6)
    assert design.body(6.0).mesh.regions == {}
    mesh = design.with_regions(["plate"]).body(6.0).mesh
    halves = 2 if "sym" in mesh.faces else 1
    assert halves * volume_of(mesh, "plate") == pytest.approx(PLATE, rel=1e-9)
    assert mesh.points[mesh.tets[mesh.regions["plate"]], 1].max() == pytest.approx(3.0, abs=1e-12)
    assert halves * mesh.volume == pytest.approx(PLATE + BLOCK - AIR, rel=1e-9)
    assert halves * mesh.enclosed_volume("cavity") == pytest.approx(AIR, rel=1e-9)


def test_the_solid_with_the_cavity_may_be_the_part(folder: Path) -> None:
    design = CadFile(str(folder / "pair.step"), 1.5, parts={"block": IN_BLOCK}).with_regions(["block"])
    assert 2 * volume_of(design.body(6.0).mesh, "block") == pytest.approx(BLOCK - AIR, rel=1e-9)


def rails(occ: Any) -> None:
    """The block on a plate that is a solid between two rails, each a solid of its own and 2 mm wide."""
    box(occ, (0, 0, -5.5), (60, 3, 5.5))
    box(occ, (0, 0, 5.5), (60, 3, 7.5))
    box(occ, (0, 0, -7.5), (60, 3, -5.5))
    occ.cut([box(occ, (0, 3, -7.5), (60, 12, 7.5))], [box(occ, (3, 3, -4.5), (57, 8, 4.5))])


@pytest.mark.parametrize("z", [6.0, -6.0])
def test_a_solid_has_the_name_of_its_mirror_image(z: float, tmp_path: Path) -> None:
    path = save(tmp_path / "rails.step", rails)
    design = CadFile(str(path), 1.5, parts={"rail": (20.0, 1.0, z)}).with_regions(["rail"])
    assert design.region_volumes == pytest.approx({"rail": 2 * 60.0 * 3 * 2}, rel=1e-6)
    assert 2 * volume_of(design.body(6.0).mesh, "rail") == pytest.approx(2 * 60.0 * 3 * 2, rel=1e-9)
    single = CadFile(str(path), 1.5, symmetric=False, parts={"rail": (20.0, 1.0, z)})
    assert single.region_volumes == pytest.approx({"rail": 60.0 * 3 * 2}, rel=1e-6)


def test_materials_that_are_not_symmetric_are_refused(tmp_path: Path) -> None:
    """The body is symmetric as a whole."""
    path = save(tmp_path / "uneven.step", lambda occ: (rails(occ), occ.fuse([(3, 1)], [(3, 3)])))
    with pytest.raises(DesignError, match="symmetric: the halves of the body about z = 0 differ"):
        CadFile(str(path), 1.5, parts={"rail": (20.0, 1.0, 6.0)})


def test_a_configuration_gives_a_part_its_material(folder: Path) -> None:
    document = """
name: two
geometry: {family: own, file: pair.step, curve: 1.5 mm, parts: {plate: [20 mm, 1 mm, 0 mm]}}
material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49, density: 1000 kg/m^3}
materials: {plate: {law: neo_hooke, mu: 0.6 MPa, nu: 0.49, density: 2000 kg/m^3}}
mesh: {size: 6 mm}
"""
    (folder / "two.yaml").write_text(document, encoding="utf-8")
    config = load_config(folder / "two.yaml")
    assert config.mass_tonne == pytest.approx((2 * PLATE + BLOCK - AIR) * 1e-9, rel=1e-6)
    assert config.record()["geometry"]["parts"] == {"plate": [20.0, 1.0, 0.0]}
    size = config.mesh.size_mm
    assert check_body(config.design.body(size), config) == ()
    exchanged = load_config(folder / "two.yaml", ["geometry.parts={plate: [20 mm, 11 mm, 0 mm]}"])
    (note,) = check_body(exchanged.design.body(size), exchanged)
    share = (AIR / 5 + 2 * 5 * (54 + 9)) / (2 * AIR / 5 + 2 * 5 * (54 + 9))
    assert (note.code, note.values["part"], note.values["volume_mm3"]) == (
        "part_has_walls",
        "plate",
        pytest.approx(5670),
    )
    assert note.values["percent"] == pytest.approx(100 * share)
    united = ["geometry.parts={}", "geometry.unite=true", "materials={}"]
    assert "parts" not in load_config(folder / "two.yaml", united).record()["geometry"]


@pytest.mark.parametrize(
    ("parts", "complaint"),
    [
        ("3", "geometry.parts: 3 is not allowed; for example {base: [20 mm, 1 mm, 0 mm]}"),
        ("{plate: 5 mm}", "geometry.parts.plate: must be a list, for example [56 mm, 8 mm, 0 mm]"),
        ("{plate: [1 mm, 2 mm]}", "geometry.parts.plate: has 2 entries instead of 3"),
    ],
)
def test_parts_that_are_no_points_are_refused(parts: str, complaint: str, folder: Path) -> None:
    (folder / "wrong.yaml").write_text(
        f"name: wrong\ngeometry: {{family: own, file: pair.step, curve: 1.5 mm, parts: {parts}}}\n"
        "material: {law: neo_hooke, mu: 0.1 MPa, nu: 0.49}\n",
        encoding="utf-8",
    )
    with pytest.raises(InputError) as refused:
        load_config(folder / "wrong.yaml")
    assert complaint in str(refused.value)


@pytest.mark.slow  # nine seconds
def test_a_sheet_far_thinner_than_the_elements_is_meshed(tmp_path: Path) -> None:
    """Gmsh's fastest mesher ends the process at this one."""
    (tmp_path / "paper.step").write_bytes(gzip.decompress((DATA / "paper.step.gz").read_bytes()))
    (tmp_path / "paper.yaml").write_text(PAPER, encoding="utf-8")
    mesh = Scene.meshed(load_config(tmp_path / "paper.yaml")).body.mesh
    assert mesh.volumes[mesh.regions["paper"]].sum() == pytest.approx(80 * 0.2 * 8, rel=1e-6)
