"""Bodies from closed surfaces (STL): filled with elements, and refused with the position of what is wrong."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest

from geometry import DesignError, SurfaceFile
from geometry.files.shells import find_crossing
from geometry.files.surface.triangles import read_surface, thinnest
from geometry.manifold import check_manifold, check_untangled
from tests.foreign_bodies import (
    BAR_AIR,
    BAR_VOLUME,
    ROUNDED_VOLUME,
    bar,
    rounded_bar,
    tube,
    two_chambers,
    write_surface,
)

DATA = Path(__file__).resolve().parents[1] / "data"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("surfaces")


@pytest.fixture(scope="module")
def stl(folder: Path) -> Path:
    return write_surface(folder / "bar.stl", bar, 50)


def triangles_of(path: Path) -> tuple[np.ndarray, np.ndarray]:
    content = meshio.read(path)
    return content.points.astype(float), content.cells_dict["triangle"]


def written(path: Path, points: np.ndarray, triangles: np.ndarray) -> Path:
    meshio.Mesh(points, [("triangle", triangles)]).write(path)
    return path


def test_bar_is_filled(stl: Path) -> None:
    design = SurfaceFile(str(stl), curve=1.5)
    assert design.extent == pytest.approx((60, 12, 15))
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)
    assert design.cavity_volume == pytest.approx(BAR_AIR, rel=1e-6)
    assert design.thinnest_wall == pytest.approx(2.0, rel=1e-3)
    body = design.body(4.0)
    mesh = body.mesh
    check_manifold(mesh)
    check_untangled(mesh)
    assert mesh.volume == pytest.approx(BAR_VOLUME, rel=1e-5)
    assert mesh.enclosed_volume("cavity") == pytest.approx(BAR_AIR, rel=1e-5)
    assert mesh.area("clamp") == pytest.approx(180, rel=1e-5)
    assert set(mesh.faces) == {"clamp", "tip", "cavity", "outer"}
    assert mesh.quality.minimum > 0.05
    assert 2.0 < mesh.quality.mean_edge < 4.5
    assert design.body(2.5).mesh.quality.count > 1.8 * mesh.quality.count


def test_round_walls_have_curved_edges(folder: Path) -> None:
    design = SurfaceFile(str(write_surface(folder / "round.stl", rounded_bar, 50)), curve=1.5)
    assert design.solid_volume == pytest.approx(ROUNDED_VOLUME, rel=3e-3)  # 24 triangles around a circle
    body = design.body(4.0)
    assert body.mesh.volume == pytest.approx(design.solid_volume, rel=5e-3)
    straight = body.mesh.volumes.sum()
    assert abs(straight / design.solid_volume - 1) > 3 * abs(body.mesh.volume / design.solid_volume - 1)


def test_elements_that_are_too_large_for_round_walls_become_smaller(folder: Path) -> None:
    path = write_surface(folder / "tube.stl", tube, 50)
    design = SurfaceFile(str(path), curve=-6)
    body = design.body(5.0)
    assert body.mesh.volume == pytest.approx(design.solid_volume, rel=1e-2)
    assert body.mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-2)
    assert body.mesh.quality.mean_edge < 3.5


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off"])
def test_other_formats_of_surfaces(suffix: str, stl: Path, folder: Path) -> None:
    design = SurfaceFile(str(written(folder / f"bar{suffix}", *triangles_of(stl))), curve=1.5)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)


def loose(path: Path, corners: np.ndarray, noise: float, digits: int = 9) -> Path:
    """Write triangles with the corners (k, 3, 3) as text, each coordinate off by up to `noise` mm, as programs do that
    compute the corners of each triangle for themselves."""
    lines = ["solid loose"]
    for triangle in corners + noise * np.random.default_rng(1).uniform(-1, 1, corners.shape):
        vertices = ["vertex " + " ".join(f"{x:.{digits}g}" for x in corner) for corner in triangle]
        lines += ["facet normal 0 0 0", "outer loop", *vertices, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid loose"]), encoding="ascii")
    return path


@pytest.mark.parametrize(
    ("noise", "digits", "shift"), [(5e-7, 9, 0.0), (5e-6, 9, 0.0), (2e-4, 9, 0.0), (5e-5, 6, 123.4)]
)
def test_corners_that_differ_by_rounding_are_one(
    noise: float, digits: int, shift: float, stl: Path, tmp_path: Path
) -> None:
    points, triangles = triangles_of(stl)
    surface = read_surface(loose(tmp_path / "loose.stl", points[triangles] + [shift, 0, 0], noise, digits))
    assert surface.volume == pytest.approx(BAR_VOLUME, rel=1e-4)
    assert len(surface.points) == len(np.unique(triangles))
    assert len(surface.triangles) == len(triangles)


def test_nothing_but_rounding_is_welded(stl: Path, tmp_path: Path) -> None:
    """A slit that is wider than rounding stays a hole; so does one between triangles that are as small themselves."""
    points, triangles = triangles_of(stl)
    corners = points[triangles].copy()
    right = corners.mean(axis=1)[:, 0] > 30
    corners[right] += [0.005, 0, 0]
    with pytest.raises(DesignError, match="has a hole"):
        SurfaceFile(str(loose(tmp_path / "slit.stl", corners, 0.0)), curve=1.5)
    chain = np.column_stack([np.arange(9) * 6e-4, np.zeros((9, 2))])  # near the end of a body of 60 mm
    small = np.vstack([points, np.add(chain, [60, 12, 0]), [[60, 13, 0]]])
    fan = [[len(points) + k, len(points) + k + 1, len(small) - 1] for k in range(8)]
    path = written(tmp_path / "small.ply", small, np.vstack([triangles, fan]))
    with pytest.raises(DesignError, match="has a hole: 10 edges"):
        SurfaceFile(str(path), curve=1.5)


def test_inches_and_z_up(stl: Path, folder: Path) -> None:
    points, triangles = triangles_of(stl)
    x, y, z = points.T / 25.4
    path = written(folder / "inch.stl", np.column_stack([x, -z, y]), triangles)
    design = SurfaceFile(str(path), curve=1.5, unit=25.4, axes=("x", "z", "-y"))
    assert design.extent == pytest.approx((60, 12, 15))
    assert design.body(5.0).mesh.volume == pytest.approx(BAR_VOLUME, rel=1e-5)
    with pytest.raises(DesignError, match=r"measures 0\.002362 x .* in another unit"):
        SurfaceFile(str(path), curve=1.5, unit=0.001, axes=("x", "z", "-y"))


def test_cavities_by_points(folder: Path) -> None:
    path = write_surface(folder / "two.stl", two_chambers, 50)
    with pytest.raises(DesignError, match=r"air: no name for 2 cavities"):
        SurfaceFile(str(path), curve=1.5)
    design = SurfaceFile(str(path), curve=1.5, air={"far": (40, 5, 0), "near": (20, 5, 0)}, clamp=60, tip=0)
    assert design.cavity_volumes == pytest.approx({"far": 1820, "near": 1820}, rel=1e-5)
    body = design.body(5.0)
    assert body.cavities == ("far", "near")
    far = body.mesh.points[np.unique(body.mesh.faces["far"]), 0]
    assert far.mean() < 30, "the arm is clamped at its other end"


def test_triangles_that_face_either_way_are_turned(stl: Path, folder: Path) -> None:
    points, triangles = triangles_of(stl)
    triangles = triangles.copy()
    triangles[::3] = triangles[::3][:, ::-1]
    surface = read_surface(written(folder / "either.ply", points, triangles))
    assert surface.volume == pytest.approx(BAR_VOLUME, rel=1e-6)
    assert thinnest(surface) == pytest.approx(2.0, rel=1e-3)


def bad(change: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]], folder: Path) -> str:
    """A file with the surface of the bar after a change."""
    bar_alone = write_surface(folder / "bar.stl", bar, 50)
    return str(written(folder / "bad.stl", *change(*triangles_of(bar_alone))))


def with_hole(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return points, np.delete(
        triangles, np.argmin(np.linalg.norm(points[triangles].mean(axis=1) - [30, 12, 0], axis=1)), 0
    )


def with_fin(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.vstack([points, [[30, 20, 0]]]), np.vstack([triangles, [[*triangles[0][:2], len(points)]]])


def apart(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    small = 0.2 * points + [0, 30, 0]
    return np.vstack([points, small]), np.vstack([triangles, triangles + len(points)])


def nested(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    small = 0.1 * (points - [30, 6, 0]) + [30, 6, 0]
    return np.vstack([points, small]), np.vstack([triangles, triangles + len(points)])


def massive(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    outside = np.ptp(points[triangles], axis=1).max(axis=1) >= 0
    inner = (np.abs(points[triangles] - [30, 6.5, 0]) <= [27.1, 3.6, 5.1]).all(axis=(1, 2))
    return points, triangles[outside & ~inner]


def test_obj_files(tmp_path: Path) -> None:
    """A closed prism on a pentagon, whose ends have five corners; texts without triangles are refused."""
    corners = [(x, np.sin(angle), np.cos(angle)) for x in (0, 9) for angle in np.arange(5) * 2 * np.pi / 5]
    sides = [f"f {k + 1} {(k + 1) % 5 + 1} {(k + 1) % 5 + 6} {k + 6}" for k in range(5)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + sides + ["f 5 4 3 2 1", "f 6 7 8 9 10"]
    path = tmp_path / "prism.obj"
    path.write_text("\n".join(["mtllib bar.mtl", "o upper half", "usemtl rubber", *lines]))
    assert read_surface(path).volume == pytest.approx(9 * 2.5 * np.sin(0.4 * np.pi))
    for text in ("v 0 0 0\nv 1 zero 0\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 4/1\n", "solid bar\n"):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(DesignError) as caught:
            SurfaceFile(str(path), curve=1.5)
        assert caught.value.keys == ("file",)


@pytest.mark.parametrize("around", [24, 32])
def test_a_flat_face_with_a_hole_of_which_gmsh_makes_no_patch_is_filled(around: int, folder: Path) -> None:
    """With one of these numbers of triangles around the opening Gmsh needs both sides of the face apart."""
    path = write_surface(
        folder / "open.stl",
        lambda occ: occ.cut(bar(occ), [(3, occ.addCylinder(-1, 7, 0, 6, 0, 0, 1.5))])[0],
        50,
        around,
    )
    design = SurfaceFile(str(path), 2.0, plug=True)
    assert design.is_open_at_clamp
    assert design.body(6.0).volume == pytest.approx(design.solid_volume, rel=1e-3)


@pytest.mark.parametrize("size", [4.0, 8.0])
def test_two_bellows_with_holes_through_the_body_are_filled(size: float) -> None:
    """Of the patches of this closed surface Gmsh needs those of another sorting angle."""
    air = {"left": (20.0, 0.0, -12.0), "right": (20.0, 0.0, 12.0)}
    design = SurfaceFile(str(DATA / "twin_bellows.stl"), curve=-11.0, air=air)
    mesh = design.body(size).mesh
    assert len(mesh.tets) < 8000
    assert mesh.volume == pytest.approx(design.solid_volume, rel=0.01)
    for name in air:
        assert mesh.enclosed_volume(name) == pytest.approx(design.cavity_volumes[name], rel=0.01)


def test_a_surface_is_blamed_with_the_place_at_which_it_passes_through_itself(stl: Path, folder: Path) -> None:
    """A corner of the roof of the cavity is pulled through its floor; a surface without such a place is not blamed."""
    points, triangles = triangles_of(stl)
    moved = points.copy()
    moved[np.linalg.norm(points - [3, 10, -5], axis=1) < 1e-3] = [20, 1.5, 0]
    design = SurfaceFile(str(written(folder / "crossed.stl", moved, triangles)), curve=1.0)
    with pytest.raises(DesignError, match=r"file: the surface passes through itself near \([0-9.]+, (2\.|3)"):
        design.body(6.0)
    surface = read_surface(stl)
    assert find_crossing(surface.points, surface.triangles) is None
