"""Bodies from CAD and mesh files, and the messages for files that cannot be used."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError, Mesh, MeshError, MeshFile, PneuNet
from geometry.manifold import count_components
from geometry.meshing.solid import session

Draw = Callable[[Any], Any]


def box(occ: Any, low: tuple[float, ...], high: tuple[float, ...]) -> tuple[int, int]:
    return (3, occ.addBox(*low, *np.subtract(high, low)))


def finger(occ: Any, hole: bool = False, second: bool = False) -> list[tuple[int, int]]:
    """A bar of 60 x 12 x 15 mm with a cavity of 54 x 7 x 10 mm and a knob of radius 3 mm, 4 mm high, on it."""
    bar, _ = occ.fuse([box(occ, (0, 0, -7.5), (60, 12, 7.5))], [(3, occ.addCylinder(30, 12, 0, 0, 4, 0, 3))])
    ends = [(3, 29), (31, 57)] if second else [(3, 57)]
    air = [box(occ, (start, 3, -5), (stop, 10, 5)) for start, stop in ends]
    if hole:
        air.append((3, occ.addCylinder(-1, 6, 0, 10, 0, 0, 1)))
    return occ.cut(bar, air)[0]


def save(path: Path, draw: Draw) -> Path:
    with session() as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("own")


def own(path: Path, **changes: Any) -> CadFile:
    spec: dict[str, Any] = {"clamp": 0, "tip": 60, "curve": 1.5, "air": {"cavity": (30, 5, 0)}}
    return CadFile(str(path), **(spec | changes))


SOLID = 60 * 12 * 15 + np.pi * 9 * 4 - 54 * 7 * 10


@pytest.mark.parametrize("suffix", [".step", ".brep"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_cad_file_becomes_a_body(folder: Path, suffix: str, symmetric: bool) -> None:
    design = own(save(folder / f"finger{symmetric}{suffix}", finger), symmetric=symmetric)
    assert design.extent == pytest.approx((60, 16, 15))
    assert design.solid_volume == pytest.approx(SOLID, rel=1e-7)
    assert design.cavity_volume == pytest.approx(54 * 7 * 10, rel=1e-7)
    body = design.body(4)
    mesh, share = body.mesh, 0.5 if symmetric else 1
    assert mesh.volume == pytest.approx(share * SOLID, rel=1e-3)
    assert mesh.enclosed_volume("cavity") == pytest.approx(share * 54 * 7 * 10, rel=1e-10)
    assert set(mesh.faces) == {"clamp", "tip", "cavity", "outer"} | ({"sym"} if symmetric else set())
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    assert mesh.area("clamp") == pytest.approx(share * 12 * 15)
    assert (body.half, body.length, body.curve_y, body.pitch) == (symmetric, 60, 1.5, 10)
    assert np.diff(mesh.points[body.curve_vertices, 0]).max() <= 4 + 1e-9
    assert mesh.quality.minimum > 0.1


def test_half_that_is_drawn_as_a_half(folder: Path) -> None:
    path = save(folder / "half.brep", lambda occ: occ.intersect(finger(occ), [box(occ, (-1, -1, 0), (61, 20, 8))]))
    design = own(path)
    assert design.extent == pytest.approx((60, 16, 15))
    assert design.solid_volume == pytest.approx(SOLID, rel=1e-7)
    assert 2 * design.body(4).mesh.enclosed_volume("cavity") == pytest.approx(3780)


def test_body_away_from_the_origin_is_clamped_at_zero(folder: Path) -> None:
    path = save(folder / "moved.step", lambda occ: occ.translate(finger(occ), 100, 0, 0))
    body = own(path, clamp=100, tip=160, air={"cavity": (130, 5, 0)}).body(5)
    assert body.mesh.points[body.curve_vertices[[0, -1]], 0] == pytest.approx([0, 60])


def test_two_cavities_keep_their_names(folder: Path) -> None:
    path = save(folder / "two.step", lambda occ: finger(occ, second=True))
    points = {"cavity": (10, 5, 0), "cavity_far": (50, 5, 0)}
    design = own(path, air=points)
    mesh = design.body(5).mesh
    assert design.cavities == ("cavity", "cavity_far")
    for name in design.cavities:
        assert 2 * mesh.enclosed_volume(name) == pytest.approx(26 * 7 * 10)
        centre = mesh.points[np.unique(mesh.faces[name]), 0].mean()
        assert centre == pytest.approx(points[name][0], abs=8)
    with pytest.raises(DesignError, match="one more cavity, around") as caught:
        own(path, air={"cavity": (10, 5, 0)})
    assert caught.value.keys == ("air",)
    with pytest.raises(DesignError, match=r"air\.other: .* same cavity as that of cavity"):
        own(path, air={"cavity": (10, 5, 0), "other": (12, 5, 0)})


def test_unit_of_a_brep_file(folder: Path) -> None:
    path = save(folder / "metres.brep", lambda occ: occ.dilate(finger(occ), 0, 0, 0, 1e-3, 1e-3, 1e-3))
    assert own(path, unit=1000).solid_volume == pytest.approx(SOLID, rel=1e-6)
    with pytest.raises(DesignError, match=r"measures 0\.06 x 0\.016 x 0\.015 mm; is its file in another unit"):
        own(path)


def lopsided(occ: Any) -> None:
    occ.fuse(finger(occ), [box(occ, (20, 12, 3), (25, 14, 5))])


BAD_FILES: dict[str, tuple[Draw, str, str]] = {
    "open": (lambda occ: finger(occ, hole=True), "air.cavity", "open to the outside"),
    "several": (lambda occ: [finger(occ), box(occ, (0, 20, -1), (60, 22, 1))], "file", "holds 2 solids; unite them"),
    "surface": (lambda occ: occ.addRectangle(0, 0, 0, 60, 10), "file", "holds no solid"),
    "huge": (lambda occ: occ.dilate(finger(occ), 0, 0, 0, 1e3, 1e3, 1e3), "file", "in another unit"),
    "lopsided": (lopsided, "symmetric", "differ"),
    "aside": (lambda occ: occ.translate(finger(occ), 0, 0, 3), "symmetric", "neither one half"),
}


@pytest.mark.parametrize("case", BAD_FILES)
def test_cad_files_that_cannot_be_used(case: str, folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    draw, key, sentence = BAD_FILES[case]
    path = save(folder / f"{case}.step", draw)
    capfd.readouterr()
    with pytest.raises(DesignError, match=sentence) as caught:
        own(path)
    assert caught.value.keys[0] == key
    assert capfd.readouterr() == ("", "")


BAD_SPECS: list[tuple[dict[str, Any], str, str]] = [
    ({"air": {"cavity": (30, 1, 0)}}, "air.cavity", "lies in the material"),
    ({"air": {"cavity": (30, 30, 0)}}, "air.cavity", "away from the body|outside the body"),
    ({"air": {"cavity": (500, 30, 0)}}, "air.cavity", "away from the body"),
    ({"air": {}}, "air", "at least one cavity"),
    ({"tip": 61}, "tip", "lies outside the body, which reaches from 0 to 60 mm"),
    ({"tip": -5}, "clamp", "must lie beyond the clamp"),
    ({"curve": 17}, "curve", "y = 17 mm lies outside the body"),
    ({"cell": 0}, "cell", "positive"),
    ({"unit": float("nan")}, "unit", "positive"),
]


@pytest.mark.parametrize(("changes", "key", "sentence"), BAD_SPECS)
def test_specs_that_cannot_be_used(changes: dict[str, Any], key: str, sentence: str, folder: Path) -> None:
    path = folder / "finger.brep"
    if not path.exists():
        save(path, finger)
    with pytest.raises(DesignError, match=sentence) as caught:
        own(path, **changes)
    assert caught.value.keys[0] == key


def test_what_only_the_mesh_can_show(folder: Path) -> None:
    path = save(folder / "late.brep", finger)
    with pytest.raises(DesignError, match="tip: the body has no face in the plane x = 40 mm"):
        own(path, tip=40).body(5)
    with pytest.raises(MeshError, match="material curve"):
        own(path, curve=5).body(5)
    with pytest.raises(DesignError, match=r"mesh\.size"):
        own(path).body(50)


def test_solid_that_touches_itself_along_a_line_is_refused(folder: Path) -> None:
    def hinge(occ: Any) -> None:
        parts = [
            box(occ, (0, 0, -7.5), (60, 12, 7.5)),
            box(occ, (10, 12, -2), (20, 16, 2)),
            box(occ, (20, 16, -2), (30, 20, 2)),
        ]
        bridge = [box(occ, (29, 12, -2), (30, 16, 2))]
        joined, _ = occ.fuse(parts[:1], parts[1:] + bridge)
        occ.cut(joined, [box(occ, (3, 3, -5), (57, 10, 5))])

    path = save(folder / "hinge.brep", hinge)
    with pytest.raises((MeshError, DesignError), match="not manifold"):
        own(path).body(5)


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"file: .* does not exist"):
        own(tmp_path / "none.step")
    with pytest.raises(DesignError, match="is not a CAD file"):
        own(tmp_path / "finger.stl")
    (tmp_path / "text.step").write_text("not a solid\n")
    with pytest.raises(DesignError, match=r"cannot be read as STEP or BREP|holds no solid"):
        own(tmp_path / "text.step")


@pytest.fixture(scope="module")
def pneunet(folder: Path) -> Path:
    PneuNet(chambers=2).body(5).mesh.write(folder / "pneunet.msh")
    return folder / "pneunet.msh"


def test_ready_mesh_becomes_a_body(pneunet: Path) -> None:
    drawn = PneuNet(chambers=2)
    design = MeshFile(str(pneunet), curve=1)
    assert design.extent == pytest.approx(drawn.extent)
    assert design.solid_volume == pytest.approx(drawn.solid_volume)
    assert design.cavity_volume == pytest.approx(drawn.cavity_volume)
    assert design.length == pytest.approx(22)
    assert design.body(3) is design.ready
    assert len(design.digest) == 64


def test_mesh_in_metres_needs_its_unit(pneunet: Path, tmp_path: Path) -> None:
    mesh = Mesh.read(pneunet)
    Mesh(np.add(mesh.points, [3, 0, 0]) / 1000, mesh.tets, mesh.faces).write(tmp_path / "metres.msh")
    with pytest.raises(DesignError, match=r"file, unit: the body measures .* in another unit"):
        MeshFile(str(tmp_path / "metres.msh"), curve=1)
    assert MeshFile(str(tmp_path / "metres.msh"), curve=1, unit=1000).length == pytest.approx(22)


def renamed(mesh: Mesh, **names: str) -> Mesh:
    return Mesh(mesh.points, mesh.tets, {names.get(name, name): triangles for name, triangles in mesh.faces.items()})


def twice(mesh: Mesh) -> Mesh:
    count = len(mesh.points)
    faces = {name: np.vstack([f, f + count]) for name, f in mesh.faces.items()}
    return Mesh(
        np.vstack([mesh.points, np.add(mesh.points, [0, 2 * np.ptp(mesh.points), 0])]),
        np.vstack([mesh.tets, mesh.tets + count]),
        faces,
    )


def torn(mesh: Mesh) -> Mesh:
    return Mesh(mesh.points, mesh.tets, dict(mesh.faces) | {"cavity": mesh.faces["cavity"][1:]})


def hinged(mesh: Mesh) -> Mesh:
    """One more tetrahedron that touches the body along an edge of its top only."""
    a, b = mesh.faces["outer"][np.argmax(mesh.points[mesh.faces["outer"]][:, :, 1].min(axis=1))][:2]
    count, middle = len(mesh.points), mesh.points[[a, b]].mean(axis=0)
    points = np.vstack([mesh.points, np.add(middle, [[0.5, 3, 0.2], [-0.5, 3, -0.2]])])
    return Mesh(points, np.vstack([mesh.tets, [[a, b, count, count + 1]]]), mesh.faces)


BAD_MESHES: dict[str, tuple[Callable[[Mesh], Mesh], str]] = {
    "no clamp": (lambda mesh: renamed(mesh, clamp="foot"), "no face named clamp"),
    "no cavity": (lambda mesh: renamed(mesh, cavity="air"), "no face named cavity"),
    "round clamp": (lambda mesh: renamed(mesh, clamp="foot", outer="clamp"), "clamp must be flat"),
    "backwards": (lambda mesh: renamed(mesh, clamp="tip", tip="clamp"), "tip must lie at a greater x"),
    "open cavity": (torn, "cavity encloses no volume: it has an open edge near"),
    "filled cavity": (lambda mesh: renamed(mesh.mirrored(), outer="cavity_2"), "cavity_2 encloses"),
    "two solids": (twice, "2 solids"),
    "hinge": (hinged, "not manifold: an edge near"),
}


def test_pieces_are_counted() -> None:
    mesh = PneuNet().body(5).mesh
    assert [count_components(m) for m in (mesh, twice(mesh), twice(twice(mesh)))] == [1, 2, 4]


@pytest.mark.parametrize("case", BAD_MESHES)
def test_meshes_that_cannot_be_used(case: str, pneunet: Path, tmp_path: Path) -> None:
    change, sentence = BAD_MESHES[case]
    change(Mesh.read(pneunet)).write(tmp_path / "bad.msh")
    with pytest.raises(DesignError, match=sentence) as caught:
        MeshFile(str(tmp_path / "bad.msh"), curve=1)
    assert caught.value.keys[0] == "file"


def test_mesh_that_misses_the_curve_is_refused(pneunet: Path) -> None:
    with pytest.raises(DesignError, match=r"file: the material curve y = 1\.5 mm, z = 0"):
        MeshFile(str(pneunet), curve=1.5)
