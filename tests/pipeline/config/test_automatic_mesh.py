"""Elements, grading and size where a configuration leaves them to the program, and what the report says of them."""

from pathlib import Path
from typing import Any

import pytest

from geometry import GRADINGS, BisectedCircle, CadFile, Design, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import expected_tets
from pipeline.config.automatic_mesh import MOST_CHOSEN_TETS, GivenMesh, MeshSettings, chosen_mesh
from pipeline.config.load import load_config
from pipeline.simulate.scene import Scene
from tests.foreign_bodies import two_chambers
from tests.step_bodies import box, pneunet_as_step, save

NOTHING = GivenMesh()
FAR, NEAR = "[40 mm, 6 mm, 0 mm]", "[20 mm, 6 mm, 0 mm]"
SEMICIRCULAR = """
name: arm
geometry: {family: semicircular, chambers: 2}
material: {law: svk, E: 1.2 MPa, nu: 0.495, density: 1130 kg/m^3}
"""


@pytest.fixture
def written(tmp_path: Path) -> Path:
    path = tmp_path / "arm.yaml"
    path.write_text(SEMICIRCULAR, encoding="utf-8")
    return path


def test_elements_follow_from_law_and_drawing(tmp_path: Path) -> None:
    def element(design: Design, law: str, nu: float, against_locking: bool | None = None) -> str:
        return chosen_mesh(design, law, nu, against_locking, NOTHING).formulation

    assert element(Semicircular(), "svk", 0.495) == "mixed"
    assert element(PneuNet(), "neo_hooke", 0.495) == "mixed"
    assert element(PneuNet(), "svk", 0.495) == "p2p0"
    assert element(PneuNet(), "svk", 0.3) == "p2"
    assert element(PneuNet(), "svk", 0.3, against_locking=True) == "p2p0"
    assert element(Semicircular(), "svk", 0.495, against_locking=False) == "p2"
    net = PneuNet(chambers=3)
    assert element(CadFile(str(pneunet_as_step(tmp_path / "net.step", net)), net.curve_y), "svk", 0.495) == "p2p0"


def test_sizes_follow_from_the_walls() -> None:
    usual, thin = (chosen_mesh(PneuNet(wall=w), "hencky", 0.495, None, NOTHING) for w in (1.0, 0.25))
    assert thin.size_mm == pytest.approx(usual.size_mm / 2, rel=0.05)
    assert thin.chosen["size"] == "walls of 0.25 mm in a body 15 mm across need it"
    even = chosen_mesh(PneuNet(), "hencky", 0.495, None, GivenMesh(grading="off"))
    assert even.size_mm == pytest.approx(0.9 * usual.size_mm, rel=0.05)


@pytest.mark.parametrize(
    ("family", "part"), [(Semicircular, 0.18), (BisectedCircle, 0.18), (SemicircularSingle, 0.15), (Rectangular, 0.12)]
)
def test_without_gaps_sizes_follow_from_the_body_where_walls_are_thick(family: Any, part: float) -> None:
    def chosen(wall: float) -> MeshSettings:
        design = family(roof=wall) if family is Rectangular else family(wall=wall)
        return chosen_mesh(design, "svk", 0.495, None, NOTHING)

    thick, thicker, thin = (chosen(wall) for wall in (1.0, 1.5, 0.1))
    assert thick.size_mm == thicker.size_mm == pytest.approx(part * min(family().extent), rel=0.05)
    assert thick.chosen["size"] == f"that is {part:g} times the smallest side, the most for {family.family}"
    assert thin.size_mm < thick.size_mm
    assert "walls of 0.1 mm" in thin.chosen["size"]


def test_with_gaps_sizes_follow_from_the_walls() -> None:
    gapped = PneuNet(wall=1.5)
    assert chosen_mesh(gapped, "hencky", 0.495, None, NOTHING).size_mm > 0.2 * min(gapped.extent)


def test_sizes_end_where_memory_does() -> None:
    usual = chosen_mesh(Semicircular(), "svk", 0.495, None, NOTHING)
    design = Semicircular(chambers=800)
    long = chosen_mesh(design, "svk", 0.495, None, NOTHING)
    assert long.size_mm > usual.size_mm
    assert expected_tets(long.size_mm, design.extent, design.solid_volume / 2) < 1.2 * MOST_CHOSEN_TETS
    assert "but the body would then have more than 100000 elements" in long.chosen["size"]


def test_given_keys_are_kept_and_have_no_reason(written: Path) -> None:
    mesh = load_config(written, ["mesh={size: 4 mm, formulation: p2p0, grading: off}"]).mesh
    assert (mesh.size_mm, mesh.formulation, mesh.grading, mesh.chosen) == (4.0, "p2p0", "off", {})
    mesh = load_config(written, ["mesh={size: 4 mm}"]).mesh
    assert (mesh.size_mm, mesh.formulation, mesh.grading) == (4.0, "mixed", "walls")
    assert set(mesh.chosen) == {"formulation", "grading"}


def test_the_error_of_a_given_mesh_is_estimated_unless_it_is_switched_off(written: Path) -> None:
    assert load_config(written, ["mesh={size: 4 mm}"]).mesh.coarser == 1.5
    assert load_config(written, ["mesh={size: 4 mm, coarser: off}"]).mesh.coarser is None
    assert load_config(written, ["mesh={size: 4 mm, coarser: 2}"]).mesh.coarser == 2.0


@pytest.mark.parametrize("override", [(), ("mesh={size: auto, formulation: auto, grading: auto, coarser: auto}",)])
def test_without_keys_the_mesh_and_a_second_one_are_chosen(written: Path, override: tuple[str, ...]) -> None:
    config = load_config(written, override)
    assert (config.mesh.formulation, config.mesh.grading, config.mesh.coarser) == ("mixed", "walls", 1.5)
    assert set(config.mesh.chosen) == {"formulation", "grading", "size"}
    assert load_config(written, ["mesh.coarser=off"]).mesh.coarser is None
    given = [f"mesh={{size: {config.mesh.size_mm} mm, formulation: mixed, grading: walls, coarser: 1.5}}"]
    assert load_config(written, given).hash == config.hash


def test_the_record_tells_what_was_chosen_and_how_long_the_edges_are(written: Path) -> None:
    scene = Scene.meshed(load_config(written, ["mesh.size=6 mm"]))
    record = scene.mesh_record
    assert record.longest_edge_mm == pytest.approx(scene.body.mesh.quality.longest_edge)
    assert 0.0 < record.mean_edge_mm < 6.0
    assert (record.formulation, record.grading, record.size_mm) == ("mixed", "walls", 6.0)
    assert set(record.chosen) == {"formulation", "grading"}


def test_the_record_tells_over_which_length_curvature_is_averaged(tmp_path: Path) -> None:
    save(tmp_path / "two.step", two_chambers)
    own = f"{{family: own, file: two.step, curve: 1.5 mm, air: {{far: {FAR}, near: {NEAR}}}}}"
    (tmp_path / "two.yaml").write_text(
        f"name: two\ngeometry: {own}\nmaterial: {{law: neo_hooke, mu: 0.1 MPa, nu: 0.49}}\npressures: [5 kPa]\n"
    )
    record = Scene.meshed(load_config(tmp_path / "two.yaml", ["mesh.size=10 mm"])).mesh_record
    assert record.averaging_mm == pytest.approx(6.0)
    assert "averaging" in record.chosen


@pytest.mark.parametrize("symmetric", [None, False])
def test_the_thinnest_wall_of_a_half_is_that_of_the_whole(symmetric: bool | None, tmp_path: Path) -> None:
    """A wall of 2 mm: less than a quarter of the smallest side, 12 mm, and more than one of half of the width, 7 mm."""

    def draw(occ: Any) -> None:
        occ.cut([box(occ, (0, 0, -7), (40, 12, 7))], [box(occ, (2, 3, -5), (38, 10, 5))])

    design = CadFile(str(save(tmp_path / "box.step", draw)), curve=1.5, symmetric=symmetric)
    assert design.thinnest_wall == pytest.approx(2.0, rel=0.04)


def test_the_thinnest_wall_of_a_drawing_is_measured_in_a_cad_file(configs: Path) -> None:
    config = load_config(configs / "finger.yaml", ["mesh={}"])
    # between the corner of the cavity, 1.5 mm from two sides, and the round edge of 3 mm beside it
    assert config.design.thinnest_wall == pytest.approx(3.0 - 1.5 * 2**0.5, rel=0.06)
    assert config.mesh.grading in GRADINGS
