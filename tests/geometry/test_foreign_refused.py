"""What a body from a file must not be taken for: each is refused, or read for what it is, in one sentence."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from geometry import CadFile, Design, DesignError, Mesh, MeshError, MeshFile, SurfaceFile
from pipeline.config.load import load_config
from pipeline.simulate.simulate import experiments_of
from tests.foreign_bodies import (
    BAR_AIR,
    BAR_VOLUME,
    Draw,
    bar,
    bar_with_inlet,
    meshed,
    tube,
    two_chambers,
    write_mesh,
    write_surface,
)
from tests.step_bodies import box, save


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("refused")


def oval(occ: Any) -> Any:
    """The tube 1.3 times as wide: the CAD kernel makes its walls splines, whose poles lie outside."""
    solids = tube(occ)
    occ.dilate(solids, 0, 0, 0, 1, 1, 1.3)
    return solids


@pytest.mark.parametrize("symmetric", [pytest.param(True, marks=pytest.mark.slow), False])
def test_the_bounds_of_splines_are_those_of_the_body(folder: Path, symmetric: bool) -> None:
    """Those of their poles reach from z = -18.2 to 9.1 mm."""
    design = CadFile(str(save(folder / "oval.step", oval)), -6.0, symmetric=symmetric)
    assert design.extent == pytest.approx((50, 14, 18.2), rel=5e-4)
    assert design.solid_volume == pytest.approx(1.3 * np.pi * (49 * 50 - 25 * 44), rel=5e-4)


def test_a_half_of_splines_below_can_be_read(folder: Path) -> None:
    """The kernel crashes where it mirrors a solid on which it has made triangles for the bounds."""

    def half(occ: Any) -> Any:
        return occ.intersect(oval(occ), [box(occ, (-1, -9, -20), (51, 9, 0))])[0]

    design = CadFile(str(save(folder / "half.step", half)), -6.0, symmetric=True)
    assert design.extent == pytest.approx((50, 14, 18.2), rel=5e-4)


@pytest.mark.parametrize("name", ["clamp", "tip", "sym", "outer"])
def test_a_cavity_cannot_have_the_name_of_another_face(name: str, folder: Path) -> None:
    bodies = {
        CadFile: save(folder / "bar.step", bar),
        SurfaceFile: write_surface(folder / "bar.stl", bar, 8.0),
        MeshFile: write_mesh(folder / "bar.vtu", *meshed(bar, 8.0)),
    }
    for family, path in bodies.items():
        with pytest.raises(DesignError, match=f"air.{name}: a cavity cannot be named {name}"):
            family(str(path), 1.5, air={name: (30, 7, 0)})
        with pytest.raises(DesignError, match=r"air.cavity: must be a point \(x, y, z\) in mm, not \(30, 7\)"):
            family(str(path), 1.5, air={"cavity": (30, 7)})


def test_a_plug_where_nothing_is_open_is_refused(folder: Path) -> None:
    bodies = {
        CadFile: save(folder / "closed.step", bar),
        SurfaceFile: write_surface(folder / "closed.stl", bar, 8.0),
        MeshFile: write_mesh(folder / "closed.vtu", *meshed(bar, 8.0)),
    }
    for family, path in bodies.items():
        with pytest.raises(DesignError, match="plug: no cavity under pressure is open in the plane of the clamp"):
            family(str(path), 1.5, plug=True)


def named_mesh(path: Path, draw: Draw, names: dict[str, str] | None = None) -> Path:
    """A mesh of what is drawn with the names of a mesh file, some of them changed; empty: left out."""
    points, tets = meshed(draw, 4.0)
    mesh = Mesh(points, tets, {})
    corners = mesh.points[mesh.boundary]
    flat = {name: (np.abs(corners[:, :, 0] - x) < 1e-9).all(axis=1) for name, x in (("clamp", 0.0), ("tip", 60.0))}
    inner = ((corners > [0.1, 0.1, -7.4]) & (corners < [59.9, 11.9, 7.4])).all(axis=(1, 2))
    near = inner & (corners[:, :, 0].mean(axis=1) < 30)
    rim = (corners[:, :, 0] >= -1e-9).all(axis=1) & (corners[:, :, 0] < 3.1).all(axis=1)
    inlet = rim & (np.hypot(corners[:, :, 1] - 6, corners[:, :, 2]) < 1.6).all(axis=1) & ~flat["clamp"]
    parts = {**flat, "cavity": (near if draw is two_chambers else inner) | inlet}
    parts["outer"] = ~np.logical_or.reduce(list(parts.values()))
    faces = {(names or {}).get(name, name): mesh.boundary[rows] for name, rows in parts.items()}
    replace(mesh, faces={name: triangles for name, triangles in faces.items() if name}).write(path)
    return path


def test_names_may_leave_the_clamp_open(folder: Path) -> None:
    """The free body of experiment I would not be in balance."""
    path = named_mesh(folder / "inlet.msh", bar_with_inlet)
    assert MeshFile(str(path), 1.5).is_open_at_clamp
    config = folder / "inlet.yaml"
    text = (
        "name: inlet\ngeometry: {family: own, file: FILE, curve: 1.5 mm}\nmaterial: {law: hencky, E: 1 MPa, nu: 0.4}\n"
    )
    config.write_text(text.replace("FILE", path.name) + "pressures: [5 kPa]\n", encoding="utf-8")
    assert experiments_of(load_config(config)) == ("II", "III")
    closed = named_mesh(folder / "closed.msh", bar)
    assert not MeshFile(str(closed), 1.5).is_open_at_clamp
    config.write_text(text.replace("FILE", closed.name) + "pressures: [5 kPa]\n", encoding="utf-8")
    assert experiments_of(load_config(config)) == ("II", "III", "I")


def test_names_of_some_faces_only(folder: Path) -> None:
    assert MeshFile(str(named_mesh(folder / "some.msh", bar, {"tip": "end"})), 1.5).length == pytest.approx(60)
    with pytest.raises(DesignError, match=r"one more cavity, around \(44.0, 6.5, .*0.0\) mm; name its faces too"):
        MeshFile(str(named_mesh(folder / "two.msh", two_chambers)), 1.5)


def with_flange(occ: Any) -> Any:
    return occ.fuse(bar(occ), [box(occ, (-4, 0, -7.5), (0, 4, 7.5))])[0]


@pytest.mark.parametrize("suffix", [".step", ".stl", ".vtu"])
def test_a_body_that_goes_on_beyond_an_end_is_refused(suffix: str, folder: Path) -> None:
    """At the height of the curve; with another height the clamp is the face above the flange."""
    path = folder / f"flange{suffix}"
    if suffix == ".step":
        save(path, with_flange)
    elif suffix == ".stl":
        write_surface(path, with_flange, 8.0)
    else:
        write_mesh(path, *meshed(with_flange, 5.0))
    family: Any = {".step": CadFile, ".stl": SurfaceFile, ".vtu": MeshFile}[suffix]
    with pytest.raises(
        DesignError, match=r"clamp: the body goes on beyond x = 0 mm at the height of the material curve"
    ):
        family(str(path), 1.5, clamp=0.0).body(5.0)
    assert family(str(path), 11.0, clamp=0.0).body(5.0).length == pytest.approx(60)


def test_a_narrow_slit_across_the_curve_shows_when_the_file_is_read(folder: Path) -> None:
    """Narrower than the hundredth part of the length."""
    path = save(folder / "slit.step", lambda occ: occ.cut(bar(occ), [box(occ, (30.45, 0.5, -8), (30.55, 2.5, 8))])[0])
    with pytest.raises(
        DesignError, match=r"curve: the line y = 1.5 mm, z = 0 is outside the material from 30.45 to 30.55"
    ):
        CadFile(str(path), 1.5)
    assert CadFile(str(path), 11.0).solid_volume == pytest.approx(BAR_VOLUME - 0.1 * 2 * 15)


def test_nodes_in_a_coordinate_system_of_their_own_are_refused(folder: Path) -> None:
    """Of Nastran: meshio reads their numbers as if they were in the basic system."""
    points, tets = meshed(bar, 8.0)
    for name, system in (("basic", ""), ("own", "1")):
        grid = [f"GRID,{k + 1},{system},{x:.6g},{y:.6g},{z:.6g}" for k, (x, y, z) in enumerate(points)]
        elements = [f"CTETRA,{k + 1},1,{','.join(map(str, nodes + 1))}" for k, nodes in enumerate(tets)]
        (folder / f"{name}.bdf").write_text("\n".join(["BEGIN BULK", *grid, *elements, "ENDDATA", ""]))
    assert MeshFile(str(folder / "basic.bdf"), 1.5).cavity_volume == pytest.approx(BAR_AIR, rel=1e-5)
    with pytest.raises(DesignError, match=r"own.bdf has nodes in a coordinate system of their own \(CP of GRID\)"):
        MeshFile(str(folder / "own.bdf"), 1.5)


def test_elements_that_are_listed_twice(folder: Path) -> None:
    points, tets = meshed(bar, 8.0)
    meshio.Mesh(points, [("tetra", np.vstack([tets, tets]))]).write(folder / "twice.vtu")
    with pytest.raises(DesignError, match=f"share one face, near .*: {len(tets)} elements are listed twice"):
        MeshFile(str(folder / "twice.vtu"), 1.5)


@pytest.mark.parametrize("part", [0.1, 0.67, 0.999])
def test_a_truncated_brep_file_is_refused(part: float, folder: Path) -> None:
    """The CAD kernel would wait for the rest forever."""
    whole = save(folder / "whole.brep", bar).read_bytes()
    path = folder / "part.brep"
    path.write_bytes(whole[: int(part * len(whole))])
    with pytest.raises(DesignError, match=r"part.brep is not a complete BREP file; save it again"):
        CadFile(str(path), 1.5)


def test_a_solid_without_a_volume_is_refused(folder: Path) -> None:
    """Extruded from a line that crosses itself, so that its halves cancel."""

    def crossed(occ: Any) -> Any:
        points = [occ.addPoint(0, y, z) for y, z in ((0, -5), (10, 5), (10, -5), (0, 5))]
        lines = [occ.addLine(points[k], points[(k + 1) % 4]) for k in range(4)]
        return occ.extrude([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 50, 0, 0)

    with pytest.raises(DesignError, match=r"file: .*crossed.step holds a solid without a volume, which may pass"):
        CadFile(str(save(folder / "crossed.step", crossed)), 5.0)


def test_walls_that_pass_through_the_outside_of_a_surface(folder: Path) -> None:
    write_surface(folder / "outside.stl", lambda occ: box(occ, (0, 0, -7.5), (60, 12, 7.5)), 8.0, binary=False)
    write_surface(folder / "inside.stl", lambda occ: box(occ, (3, 3, -5), (57, 13, 5)), 8.0, binary=False)
    poking = folder / "poking.stl"
    poking.write_text("".join((folder / f"{name}.stl").read_text() for name in ("outside", "inside")))
    with pytest.raises(DesignError, match=r"file: the walls around \(.*\) in the surface pass through its outside"):
        SurfaceFile(str(poking), 1.5)


def test_points_that_are_no_numbers(folder: Path) -> None:
    points, tets = meshed(bar, 8.0)
    points[tets[0, 0], 1] = np.nan
    with pytest.raises(DesignError, match=r"nan.vtu has a point whose coordinates are no numbers"):
        MeshFile(str(write_mesh(folder / "nan.vtu", points, tets)), 1.5)


def abaqus(points: np.ndarray, tets: np.ndarray, blank: str = "") -> tuple[str, str]:
    nodes = [f"{k + 1}, {x:.17g}, {y:.17g}, {z:.17g}" for k, (x, y, z) in enumerate(points)]
    elements = [f"{k + 1}, {', '.join(map(str, nodes + 1))}" for k, nodes in enumerate(tets)]
    return "\n".join([f"{blank}*NODE", *nodes, ""]), "\n".join([f"{blank}*ELEMENT, TYPE=C3D4", *elements, ""])


def test_abaqus_files_with_blanks_and_comments(folder: Path) -> None:
    """Blanks before keywords; data in a file of its own are refused."""
    nodes, elements = abaqus(*meshed(bar, 8.0), blank=" ")
    whole = folder / "whole.inp"
    whole.write_text(f"  ** a comment\n{nodes}{elements}")
    assert MeshFile(str(whole), 1.5).cavity_volume == pytest.approx(BAR_AIR)
    whole.write_text(f'{nodes} *INCLUDE, INPUT="the elements.inp"\n')
    with pytest.raises(DesignError, match=r"has lines in another file \(the elements.inp\)"):
        MeshFile(str(whole), 1.5)


def round_tip(occ: Any) -> Any:
    """A round bar of radius 7 mm that ends in half a sphere."""
    bar, tip = (3, occ.addCylinder(0, 0, 0, 50, 0, 0, 7)), (3, occ.addSphere(50, 0, 0, 7))
    return occ.cut(occ.fuse([bar], [tip])[0], [(3, occ.addCylinder(4, 1, 0, 44, 0, 0, 4.5))])[0]


KINDS: dict[str, tuple[Callable[..., Design], Callable[[Path, Any], Path]]] = {
    "stl": (SurfaceFile, lambda path, draw: write_surface(path, draw, 50)),
    "vtu": (MeshFile, lambda path, draw: write_mesh(path, *meshed(draw, 4.0))),
    "step": (CadFile, save),
}


@pytest.mark.parametrize("suffix", KINDS)
def test_an_end_without_a_flat_face_is_named_whatever_the_curve(suffix: str, tmp_path: Path) -> None:
    kind, write = KINDS[suffix]
    path = write(tmp_path / f"round.{suffix}", round_tip)
    with pytest.raises(DesignError, match=r"tip: the body has no flat face .*cut a rounded end off"):
        kind(str(path), 1.0).body(4.0)


def test_a_height_at_which_elements_would_be_flat_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> Mesh:
        raise MeshError("tetrahedron 7 of the mesh is flat")

    monkeypatch.setattr("geometry.files.mesh.placing.with_curve", fails)
    path = str(write_mesh(tmp_path / "bar.vtk", *meshed(bar, 4.0)))
    with pytest.raises(DesignError, match=r"curve: the elements around the line y = .* because tetrahedron 7"):
        MeshFile(path, 1.0)
