"""Meshes of other programs: formats, faces by planes, cavities, the material curve, directions, and what is refused."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.spatial import cKDTree

from geometry import DesignError, Mesh, MeshFile
from geometry.files.frame import rotation
from geometry.files.shells import windings
from geometry.manifold import check_manifold, check_untangled
from geometry.meshing.solid import session
from geometry.quality import radius_ratios
from geometry.topology import signed_volumes
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, bar, half_bar, meshed, tube, two_chambers, write_mesh
from tests.step_bodies import box


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("foreign")


@pytest.fixture(scope="module")
def plain() -> tuple[np.ndarray, np.ndarray]:
    return meshed(bar, 4.0)


def check_bar(design: MeshFile, rel: float = 1e-9) -> None:
    mesh = design.fixed_body.mesh
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=rel)
    assert design.cavity_volume == pytest.approx(BAR_AIR, rel=rel)
    assert mesh.area("clamp") == pytest.approx(12 * 15, rel=rel)
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    assert set(mesh.faces) == {"clamp", "tip", "cavity", "outer"}
    check_manifold(mesh)
    check_untangled(mesh)
    curve = mesh.points[design.fixed_body.curve_vertices]
    assert curve[[0, -1], 0] == pytest.approx([0, 60])


def test_nodes_of_no_element_are_left_out(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    """A reference point behind the tip, first in the file, and one in the cavity."""
    points, tets = plain
    more = np.vstack([[[100.0, 0.0, 0.0]], points, [[30.0, 6.0, 0.0]]])
    design = MeshFile(str(write_mesh(folder / "reference.inp", more, tets + 1)), 1.5)
    check_bar(design)
    assert design.length == 60
    without = MeshFile(str(write_mesh(folder / "plain.inp", points, tets)), 1.5)
    assert len(design.fixed_body.mesh.points) == len(without.fixed_body.mesh.points)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".inp", ".mesh", ".su2", ".avs"])
def test_formats_of_meshio(suffix: str, folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    check_bar(MeshFile(str(write_mesh(folder / f"bar{suffix}", *plain)), curve=1.5))


@pytest.mark.parametrize("suffix", [".bdf", ".unv", ".med", ".inp", ".msh", ".vtk"])
@pytest.mark.parametrize("order", [1, 2])
def test_files_that_gmsh_writes(suffix: str, order: int, folder: Path) -> None:
    """With quadratic elements the round walls are those of the drawing."""
    path = folder / f"tube{order}{suffix}"
    with session() as gmsh:
        tube(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1])
        gmsh.option.setNumber("Mesh.MeshSizeMax", 4)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    design = MeshFile(str(path), curve=-6)
    exact = np.pi * 49 * 50 - np.pi * 25 * 44
    assert design.solid_volume == pytest.approx(exact, rel=5e-4 if order == 2 else 5e-2)
    assert (len(design.fixed_body.mesh.curved) > 0) == (order == 2)
    assert design.cavity_volume == pytest.approx(np.pi * 25 * 44, rel=5e-4 if order == 2 else 5e-2)


@pytest.mark.parametrize("curve", [0.0, 1.5, 2.0])
@pytest.mark.parametrize("size", [5.0, 2.5])
def test_elements_are_divided_along_the_curve_alone(curve: float, size: float, folder: Path) -> None:
    points, tets = meshed(bar, size)
    before = Mesh(points, tets, {})
    body = MeshFile(str(write_mesh(folder / "divided.vtu", points, tets)), curve=curve).fixed_body
    mesh = body.mesh
    assert mesh.volume == pytest.approx(before.volume, rel=1e-12)
    assert mesh.quality.minimum > 0.05
    assert len(body.edge("tip")) >= 3
    assert body.edge("tip")[[0, -1], 2] == pytest.approx([-7.5, 7.5])
    # vertices away from the curve and the tip are where they were
    away, _ = cKDTree(mesh.points).query(points)
    far = (np.hypot(points[:, 1] - curve, points[:, 2]) > 1.5 * size) & (points[:, 0] < 60 - size)
    assert far.sum() > 50
    assert away[far].max() < 1e-4


def test_half_of_an_arm(folder: Path) -> None:
    path = write_mesh(folder / "half.vtu", *meshed(half_bar, 4.0))
    design = MeshFile(str(path), curve=1.5, symmetric=True)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)
    assert design.cavity_volume == pytest.approx(BAR_AIR, rel=1e-9)
    assert design.fixed_body.half
    assert design.extent == pytest.approx((60, 12, 15))
    with pytest.raises(DesignError, match=r"symmetric, middle: .* symmetric: true"):
        MeshFile(str(path), curve=1.5)


@pytest.mark.parametrize("order", [1, 2])
def test_a_half_below_is_the_same_arm(order: int, folder: Path) -> None:
    """Its file has z <= 0, and so have the points in its air that its user knows; another end may be clamped."""
    points, tets = meshed(half_of_two, 4.0, order)
    above = write_mesh(folder / "above.vtu", points, tets)
    below = write_mesh(folder / "below.vtu", points * [1, 1, -1], tets)
    for clamp, tip in ((0, 60), (60, 0)):
        air = {"near": (20.0, 5.0, 1.0), "far": (44.0, 6.5, 2.5)}
        expected = MeshFile(str(above), 1.5, clamp, tip, air, symmetric=True).fixed_body
        air = {name: (x, y, -z) for name, (x, y, z) in air.items()}
        body = MeshFile(str(below), 1.5, clamp, tip, air, symmetric=True).fixed_body
        np.testing.assert_allclose(body.mesh.points, expected.mesh.points, atol=1e-12)
        assert len(body.mesh.curved) == len(expected.mesh.curved)
        assert {name: len(faces) for name, faces in body.mesh.faces.items()} == {
            name: len(faces) for name, faces in expected.mesh.faces.items()
        }
    with pytest.raises(DesignError, match=r"symmetric, middle: .* symmetric: true"):
        MeshFile(str(below), curve=1.5)
    beside = write_mesh(folder / "beside.vtu", points * [1, 1, -1] - [0, 0, 2], tets)
    with pytest.raises(DesignError, match=r"from z = -9.5 to -2 mm; .* middle: -9.5 mm or -2 mm"):
        MeshFile(str(beside), curve=1.5, symmetric=True)


def test_directions_units_and_the_other_end(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    """The bar stands along the file's -y with its top towards z, in inches, and is clamped at its larger x."""
    points, tets = plain
    x, y, z = points.T
    turned = np.column_stack([z, -x, y]) / 25.4
    path = write_mesh(folder / "turned.vtu", turned, tets)
    with pytest.raises(DesignError, match=r"axes: \[-y, z, x\] mirrors the body; write \[-y, z, -x\]"):
        MeshFile(str(path), curve=1.5, unit=25.4, axes=("-y", "z", "x"))
    design = MeshFile(str(path), curve=1.5, unit=25.4, axes=("-y", "z", "-x"))
    check_bar(design)
    other = MeshFile(str(path), curve=1.5, unit=25.4, axes=("-y", "z", "-x"), clamp=60, tip=0)
    check_bar(other)
    ends = [np.unique(d.fixed_body.mesh.faces[face]) for d, face in ((design, "clamp"), (other, "tip"))]
    first, last = design.fixed_body.mesh.points[ends[0]], other.fixed_body.mesh.points[ends[1]]
    # turned by half a turn about y: what was at z is at -z
    away, _ = cKDTree(last).query(first * [1, 1, -1] + [60, 0, 0])
    corners = np.abs(first[:, 2]) > 7.4
    assert away[corners].max() < 1e-9
    with pytest.raises(DesignError, match=r"axes: .* names a direction twice"):
        MeshFile(str(path), curve=1.5, unit=25.4, axes=("x", "x", "z"))


def test_all_rotations_are_accepted_and_mirror_images_are_not() -> None:
    signed = [sign + axis for axis in "xyz" for sign in ("", "-")]
    counts = {True: 0, False: 0}
    for axes in [(a, b, c) for a in signed for b in signed for c in signed if len({a[-1], b[-1], c[-1]}) == 3]:
        try:
            assert np.linalg.det(rotation(axes)) == pytest.approx(1)
            counts[True] += 1
        except DesignError:
            counts[False] += 1
    assert counts == {True: 24, False: 24}


def test_several_cavities_are_chosen_by_points(folder: Path) -> None:
    path = write_mesh(folder / "two.vtu", *meshed(two_chambers, 4.0))
    with pytest.raises(DesignError, match=r"air: no name for 2 cavities, around \(16, 6.5, 0\) mm; \(44, 6.5, 0\) mm"):
        MeshFile(str(path), curve=1.5)
    design = MeshFile(str(path), curve=1.5, air={"far": (40, 5, 1), "near": (20, 5, 1)})
    assert design.cavities == ("far", "near")
    body = design.fixed_body
    assert body.mesh.points[np.unique(body.mesh.faces["far"]), 0].min() == pytest.approx(31)
    for air, sentence in (
        ({"cavity": (40, 5, 0)}, r"air: no name for 1 cavities, around \(16, 6.5, 0\)"),
        ({"a": (40, 5, 0), "b": (45, 5, 0)}, r"air\.b: .* same cavity as that of a"),
        ({"a": (40, 1, 0)}, r"air\.a: the point \(40, 1, 0\) mm lies in the material"),
        ({"a": (40, 30, 0)}, r"air\.a: .* in no closed cavity"),
        ({"tip": (40, 5, 0), "b": (20, 5, 0)}, r"air\.tip: a cavity cannot be named tip"),
    ):
        with pytest.raises(DesignError, match=sentence):
            MeshFile(str(path), curve=1.5, air=air)


def half_of_two(occ: Any) -> Any:
    """The half z >= 0 of the bar with two chambers."""
    return occ.intersect(two_chambers(occ), [box(occ, (-1, -1, 0), (61, 20, 8))])[0]


def test_both_cavities_of_a_half_need_a_name(folder: Path) -> None:
    path = str(write_mesh(folder / "half_of_two.vtu", *meshed(half_of_two, 4.0)))
    for plug in (False, True):
        with pytest.raises(DesignError, match=r"air: no name for 1 cavities, around \(44, 6.5, 2.5\) mm"):
            MeshFile(path, curve=1.5, symmetric=True, plug=plug, air={"near": (20, 5, 1)})
    design = MeshFile(path, curve=1.5, symmetric=True, air={"near": (20, 5, 1), "far": (44, 6.5, 2.5)})
    assert design.cavity_volumes == pytest.approx({"near": 1820, "far": 1820})


@pytest.mark.parametrize("half", [False, True])
def test_positions_in_sentences_are_those_of_the_file(half: bool, folder: Path) -> None:
    """The bar reaches from 100 to 160 mm and is clamped at its larger x; what a sentence proposes can be written."""
    points, tets = meshed(half_of_two if half else two_chambers, 4.0)
    path = str(write_mesh(folder / "moved.vtu", np.add(points, [100, 0, 0]), tets))
    with pytest.raises(DesignError, match=r"around \(116, 6.5, .*\) mm; \(144, 6.5") as caught:
        MeshFile(path, curve=1.5, clamp=160, tip=100, symmetric=half)
    proposed = [float(x) for x in re.findall(r"around \((.*?)\) mm", caught.value.sentence)[0].split(", ")]
    with pytest.raises(DesignError, match=r"no name for 1 cavities, around \(144, 6.5") as caught:
        MeshFile(path, curve=1.5, clamp=160, tip=100, symmetric=half, air={"cavity": tuple(proposed)})
    assert caught.value.keys == ("air",)
    design = MeshFile(
        path, curve=1.5, clamp=160, tip=100, symmetric=half, air={"a": tuple(proposed), "b": (144, 6.5, 1)}
    )
    assert design.cavity_volumes == pytest.approx({"a": 1820, "b": 1820})
    walls = design.fixed_body.mesh.points[np.unique(design.fixed_body.mesh.faces["a"])]
    assert walls[:, 0].min() == pytest.approx(31)
    for at, where in (((144, 1, 1), "in the material"), ((144, 30, 1), "in no closed cavity")):
        with pytest.raises(DesignError, match=where):
            MeshFile(path, curve=1.5, clamp=160, tip=100, symmetric=half, air={"a": at})


def test_points_that_every_element_has_for_itself_are_joined(
    folder: Path, plain: tuple[np.ndarray, np.ndarray]
) -> None:
    points, tets = plain
    path = write_mesh(folder / "loose.vtu", points[tets].reshape(-1, 3), np.arange(tets.size).reshape(-1, 4))
    check_bar(MeshFile(str(path), curve=1.5))


def test_curved_edges_of_points_that_are_joined(folder: Path) -> None:
    """The two ends of a tube with ten nodes per element share no point, then no elements do: the body is the same."""
    points, tets = meshed(tube, 4.0, order=2)
    whole = MeshFile(str(write_mesh(folder / "whole10.vtu", points, tets)), curve=-6)
    left = points[tets[:, :4]].mean(axis=1)[:, 0] < 25
    halves = [points[tets[side]].reshape(-1, 3) for side in (left, ~left)]
    kept = [np.unique(tets[side], return_inverse=True) for side in (left, ~left)]
    two = [numbers.reshape(-1, 10) for _, numbers in kept]
    parts = np.vstack([two[0], two[1] + len(kept[0][0])])
    for name, split, elements in (
        ("two", np.vstack([points[used] for used, _ in kept]), parts),
        ("loose", np.vstack(halves), np.arange(tets.size).reshape(-1, 10)),
    ):
        design = MeshFile(str(write_mesh(folder / f"{name}10.vtu", split, elements)), curve=-6)
        assert len(design.fixed_body.mesh.curved) == len(whole.fixed_body.mesh.curved) > 100
        assert design.solid_volume == pytest.approx(whole.solid_volume, rel=1e-9)
        assert design.cavity_volume == pytest.approx(whole.cavity_volume, rel=1e-9)


def test_solid_angle_of_a_closed_surface(plain: tuple[np.ndarray, np.ndarray]) -> None:
    mesh = Mesh(*plain, {})
    corners = mesh.points[mesh.boundary]
    inside = [windings(np.array(at), corners) for at in ((30, 1.5, 0), (1.5, 6, 3), (30, 6, 0), (30, 20, 0))]
    assert inside == pytest.approx([1, 1, 0, 0], abs=1e-9)


def hexahedra(path: Path) -> None:
    corners = np.array([[x, y, z] for x in (0, 9) for y in (0, 2) for z in (-1, 1)], dtype=float)
    meshio.Mesh(corners, [("hexahedron", [[0, 4, 6, 2, 1, 5, 7, 3]])]).write(path)


def surface(path: Path) -> None:
    meshio.Mesh(np.eye(3) * 9, [("triangle", [[0, 1, 2]])]).write(path)


def shuffled(path: Path) -> None:
    points, tets = meshed(bar, 6.0, order=2)
    meshio.Mesh(points, [("tetra10", tets[:, [0, 1, 2, 3, 9, 8, 7, 6, 5, 4]])]).write(path)


def cut_short(path: Path) -> None:
    path.write_text("# vtk DataFile Version 3.0\n", encoding="ascii")


def solid_block(path: Path) -> None:
    points, tets = meshed(lambda occ: occ.addBox(0, 0, -2, 20, 4, 4), 4.0)
    write_mesh(path, points, tets)


def tangled(path: Path) -> None:
    points, tets = meshed(bar, 4.0)
    top = np.argmin(np.linalg.norm(points - [30, 12, 0], axis=1))
    points[top, 1] -= 11.0
    write_mesh(path, points, tets)


def bad(write: Callable[[Path], None], folder: Path) -> str:
    """A file that one of the functions before writes."""
    write(folder / "bad.vtk")
    return str(folder / "bad.vtk")


def two_materials(folder: Path, suffix: str, order: int = 1) -> Path:
    """The bar as two volumes, its lowest 3 mm named base and the rest named chamber; both together are named all."""
    path = folder / f"two{order}{suffix}"
    with session() as gmsh:
        occ = gmsh.model.occ
        plate = [box(occ, (-1, -1, -8), (61, 3, 8))]
        occ.fragment(bar(occ), occ.intersect(bar(occ), plate)[0])
        occ.synchronize()
        volumes = {tag for _, tag in gmsh.model.getEntities(3)}
        base = {tag for tag in volumes if occ.getCenterOfMass(3, tag)[1] < 3}
        for name, tags in (("base", base), ("chamber", volumes - base), ("all", volumes)):
            gmsh.model.addPhysicalGroup(3, sorted(tags), name=name)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 4)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    return path


@pytest.mark.parametrize(
    ("suffix", "order", "curve"),
    [(".msh", 1, 1.3), (".msh", 1, 3.0), (".msh", 1, 2.8), (".msh", 2, 1.3), (".med", 1, 3.0)],
)
def test_named_groups_of_elements_are_regions(suffix: str, order: int, curve: float, folder: Path) -> None:
    """Their boundary stays where it was, also where elements beside it are divided along the material curve."""
    design = MeshFile(str(two_materials(folder, suffix, order)), curve=curve)
    check_bar(design)
    assert dict(design.region_volumes) == pytest.approx(
        {"base": 60 * 3 * 15, "chamber": BAR_VOLUME - 60 * 3 * 15, "all": BAR_VOLUME}, rel=1e-9
    )
    assert not design.body(1.0).mesh.regions
    with_base = design.with_regions(["base"])
    check_bar(with_base)
    mesh = with_base.body(1.0).mesh
    assert set(mesh.regions) == {"base"}
    inside = np.zeros(len(mesh.tets), dtype=bool)
    inside[mesh.regions["base"]] = True
    np.testing.assert_array_equal(inside, mesh.points[mesh.tets, 1].mean(axis=1) < 3)
    assert mesh.volumes[inside].sum() == pytest.approx(60 * 3 * 15, rel=1e-9)
    flattest = radius_ratios(mesh.points, mesh.tets).min()
    if curve == 2.8:  # 0.2 mm beside the boundary elements are thin, and the note on them tells why
        assert flattest < 0.03
    else:  # 3 mm is the boundary, which is flat: vertices move within it
        assert flattest > 0.15


def test_the_volume_of_a_region_is_that_of_its_curved_elements(folder: Path) -> None:
    path = folder / "round.msh"
    with session() as gmsh:
        tube(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="tube")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 4)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(path))
    design = MeshFile(str(path), curve=-6)
    assert design.region_volumes["tube"] == pytest.approx(design.solid_volume, rel=2e-3)


def test_regions_that_are_missing_or_overlap_are_refused(folder: Path) -> None:
    design = MeshFile(str(two_materials(folder, ".msh")), curve=1.3)
    with pytest.raises(DesignError, match="no region of that name; it has base, "):
        design.with_regions(["layer"])
    with pytest.raises(DesignError, match="elements that belong to base and to all"):
        design.with_regions(["base", "all"])
    assert design.with_regions(["base", "chamber"]).regions == ("base", "chamber")


def test_sets_of_abaqus_are_regions(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    points, tets = plain
    low = np.flatnonzero(points[tets, 1].mean(axis=1) < 3)
    path = folder / "sets.inp"
    meshio.Mesh(points, [("tetra", tets)], cell_sets={"base": [low], "left": [low[:5]]}).write(path)
    design = MeshFile(str(path), curve=1.5)
    check_bar(design)
    volumes = signed_volumes(points, tets)
    assert design.region_volumes == {
        name: pytest.approx(volumes[rows].sum()) for name, rows in (("base", low), ("left", low[:5]))
    }
    with pytest.raises(DesignError, match="belong to base and to left"):
        design.with_regions(["base", "left"])
    assert len(design.with_regions(["base"]).fixed_body.mesh.regions["base"]) >= len(low)


def test_sets_that_elements_name_are_regions(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    """Two blocks of one set, and one of another, as programs write solid sections."""
    points, tets = plain
    low = points[tets, 1].mean(axis=1) < 3
    blocks = {"BASE": np.flatnonzero(low)[::2], "base ": np.flatnonzero(low)[1::2], "TOP": np.flatnonzero(~low)}
    lines = ["*NODE", *(f"{k}, {x:.17g}, {y:.17g}, {z:.17g}" for k, (x, y, z) in enumerate(points, 1))]
    for name, rows in blocks.items():
        lines.append(f"*ELEMENT, TYPE=C3D4, ELSET={name.strip().upper()}")
        lines += [f"{k + 1}, {', '.join(map(str, tets[k] + 1))}" for k in rows]
    lines += ["*ELSET, ELSET=all", "BASE, TOP", "*ELSET, ELSET=some, GENERATE", f"1, {len(tets)}, 1"]
    (folder / "sections.inp").write_text("\n".join([*lines, ""]), encoding="utf-8")
    volumes, design = signed_volumes(points, tets), MeshFile(str(folder / "sections.inp"), curve=1.5)
    assert design.region_volumes == {
        "BASE": pytest.approx(volumes[low].sum()),
        "TOP": pytest.approx(volumes[~low].sum()),
        "some": pytest.approx(volumes.sum()),
    }
    with pytest.raises(DesignError, match="it has some, BASE, TOP"):
        design.with_regions(["layer"])


def test_other_formats_without_regions_say_which_keep_them(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    design = MeshFile(str(write_mesh(folder / "none.vtu", *plain)), curve=1.5)
    with pytest.raises(DesignError, match=r"it has none; mesh files keep them as \.msh, \.med, \.unv or \.inp"):
        design.with_regions(["base"])


def doubled(points: np.ndarray, tets: np.ndarray, low: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with nodes of their own for some of its elements (m,)."""
    used = np.unique(tets[low])
    number = np.arange(len(points))
    number[used] = len(points) + np.arange(len(used))
    return np.vstack([points, points[used]]), np.where(low[:, None], number[tets], tets)


def test_doubled_nodes_are_joined(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    """Of two parts, and of a slit between elements that hang together beside it."""
    points, tets = plain
    low = points[tets, 1].mean(axis=1) < 3
    check_bar(MeshFile(str(write_mesh(folder / "parts.vtu", *doubled(points, tets, low))), curve=1.5))
    apart, own = doubled(points, tets, low)
    shared = np.unique(tets[low & (points[tets, 0].mean(axis=1) < 30)])
    back = np.arange(len(apart))
    used = np.unique(tets[low])
    back[len(points) + np.flatnonzero(np.isin(used, shared))] = used[np.isin(used, shared)]
    slit = MeshFile(str(write_mesh(folder / "slit.vtu", apart, back[own])), curve=1.5)
    check_bar(slit)


def test_parts_whose_triangles_differ_are_said_to_share_no_nodes(folder: Path) -> None:
    """Two boxes, one above the other, with a cavity between them, meshed each for itself."""
    (low, lower), (high, upper) = (meshed(part, size) for part, size in ((lower_part, 6.0), (upper_part, 3.5)))
    path = write_mesh(folder / "two.vtu", np.vstack([low, high]), np.vstack([lower, upper + len(low)]))
    with pytest.raises(DesignError, match="its 2 parts share no nodes where they touch: mesh them in one step"):
        MeshFile(str(path), curve=1.5)


def lower_part(occ: Any) -> None:
    box(occ, (0, 0, -6), (60, 3, 6))


def upper_part(occ: Any) -> None:
    occ.cut([box(occ, (0, 3, -6), (60, 15, 6))], [box(occ, (5, 3, -4), (55, 12, 4))])


def test_air_that_is_meshed_as_a_group_is_named(folder: Path, plain: tuple[np.ndarray, np.ndarray]) -> None:
    points, tets = meshed(lambda occ: box(occ, (0, 0, -6), (60, 15, 6)), 5.0)
    middle = np.abs(points[tets].mean(axis=1) - [30.0, 8.0, 0.0])
    air = (middle < [20.0, 4.0, 3.0]).all(axis=1)
    sets = {"solid": [np.flatnonzero(~air)], "air": [np.flatnonzero(air)]}
    meshio.Mesh(points, [("tetra", tets)], cell_sets=sets).write(folder / "air.inp")
    with pytest.raises(DesignError, match="if one of the groups solid, air is air, save the others alone"):
        MeshFile(str(folder / "air.inp"), curve=1.5)
