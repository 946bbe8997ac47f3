"""Where the chambers of a body from a file are along the arm, and over which length its curvature is averaged then."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, MeshFile, PneuNet, SurfaceFile
from geometry.files.chambers import chambers_of, distances, has_gaps, middles_of, sections
from geometry.files.frame import PITCHES
from geometry.files.from_file import FileDesign, usual_pitch
from rod.identification.observed import FEWEST_PITCHES
from tests.foreign_bodies import meshed, two_chambers, write_mesh, write_surface
from tests.step_bodies import box, pneunet_as_step, save

AIR = {"far": (40.0, 6.0, 0.0), "near": (20.0, 6.0, 0.0)}
NET = PneuNet(chambers=7)


def test_two_chambers_in_a_file_of_each_kind(tmp_path: Path) -> None:
    step = str(save(tmp_path / "two.step", two_chambers))
    mesh = str(write_mesh(tmp_path / "two.vtu", *meshed(two_chambers, 6.0)))
    surface = str(write_surface(tmp_path / "two.stl", two_chambers, 50))
    designs: list[FileDesign] = [
        CadFile(step, 1.5, air=AIR),
        CadFile(step, 1.5, clamp=60.0, tip=0.0, air=AIR),
        MeshFile(mesh, 1.5, air=AIR),
        SurfaceFile(surface, 1.5, air=AIR),
    ]
    assert [design.cavity_pitch for design in designs] == pytest.approx([28.0] * 4)
    assert [design.pitch for design in designs] == pytest.approx([6.0] * 4)  # an arm of 60 mm has too few cells
    assert PneuNet().cavity_pitch == 0.0
    within = {
        cell: CadFile(step, 1.5, air=AIR, cell=cell).averages_within_cavities for cell in (None, 27.0, 27.9, 28.0)
    }
    assert within == {None: True, 27.0: True, 27.9: False, 28.0: False}
    assert not PneuNet().averages_within_cavities


def test_chambers_joined_by_a_channel(tmp_path: Path) -> None:
    step = str(pneunet_as_step(tmp_path / "net.step", NET))
    solid = CadFile(step, NET.curve_y)
    half = solid.body(6.0).mesh
    mesh = str(write_mesh(tmp_path / "net.vtu", half.points, half.tets))
    designs: list[FileDesign] = [
        solid,
        CadFile(step, NET.curve_y, clamp=NET.length, tip=0.0),
        MeshFile(mesh, NET.curve_y, symmetric=True),
    ]
    begins = NET.gap + NET.wall + NET.pitch * np.arange(NET.chambers)
    expected = np.column_stack([begins, begins + NET.chamber_length - 2 * NET.wall])
    np.testing.assert_allclose(designs[0].chamber_ranges["cavity"], expected, atol=1e-3)
    np.testing.assert_allclose(designs[1].chamber_ranges["cavity"], -expected[::-1, ::-1], atol=1e-3)
    np.testing.assert_allclose(designs[2].chamber_ranges["cavity"], expected, atol=1e-3)
    assert [design.pitch for design in designs] == pytest.approx([NET.pitch] * 3, abs=1e-3)
    assert not any(design.averages_within_cavities for design in designs)
    assert [design.reason_for_pitch for design in designs] == ["this is the distance of its 7 chambers"] * 3
    given = CadFile(step, NET.curve_y, cell=5.0)
    assert (given.averages_within_cavities, given.reason_for_pitch) == (True, "")


@pytest.mark.parametrize(
    ("heights", "is_gapped"),
    [
        ((10, 7, 10), True),
        ((10, 9, 10), False),
        ((10, 7, 5), False),
        ((90, 7, 7, 7, 7, 7), False),
        ((90, 3, 10, 3, 10, 3), True),  # with a flange at the clamp
    ],
)
def test_a_notch_is_a_gap_where_it_is_deep_and_both_sides_are_higher(
    heights: tuple[float, ...], is_gapped: bool
) -> None:
    """Steps of a bar, its outside as rectangles in pairs of triangles; only those across x count."""
    points, triangles = list[list[float]](), list[list[int]]()
    for x, (before, after) in enumerate(pairwise((0.0, *heights, 0.0))):
        low, high = sorted((before, after))
        corners = [[float(x), y, z] for y, z in ((low, 0.0), (high, 0.0), (high, 4.0), (low, 4.0))]
        first = len(points)
        points += corners
        turned = [[0, 1, 2], [0, 2, 3]] if after < before else [[0, 2, 1], [0, 3, 2]]
        triangles += [[first + corner for corner in triangle] for triangle in turned]
    assert has_gaps(np.array(points), np.array(triangles)) == is_gapped


@pytest.mark.parametrize("clamp", [0.0, 60.0])
def test_a_surface_that_is_open_at_the_clamp_has_gaps_and_chambers_at_either_end(tmp_path: Path, clamp: float) -> None:
    """Two chambers of 24 x 6 x 8 mm that a channel joins, a gap of 8 mm between them, and an inlet in one end."""

    def drawn(occ: Any) -> Any:
        blocks = [box(occ, (x, 0, -6), (x + 26, 12, 6)) for x in (0, 34)]
        solid, _ = occ.fuse([box(occ, (0, 0, -6), (60, 4, 6))], blocks)
        air = [box(occ, (x, 3, -4), (x + 24, 10, 4)) for x in (1, 35)] + [box(occ, (5, 1, -1), (55, 3, 1))]
        inlet = box(occ, (clamp - 5, 5, -1), (clamp + 5, 7, 1))
        return occ.cut(solid, [*air, inlet])

    path = str(write_surface(tmp_path / "open.stl", drawn, 50))
    design = SurfaceFile(path, 0.5, clamp=clamp, tip=60.0 - clamp, plug=True)
    assert design.outer_corners
    chambers = np.array(design.chamber_ranges["cavity"])
    np.testing.assert_allclose(chambers, [[1.0, 25.0], [35.0, 59.0]], atol=1e-2)


def _cone_and_steps(occ: Any) -> Any:
    """A block with a cone from radius 4 to 2 mm, a bore of 1 mm with a wider part, and a chamber of 6 x 6 mm."""
    air = [
        (3, occ.addCone(2, 0, 0, 20, 0, 0, 4, 2)),
        (3, occ.addCylinder(21, 0, 0, 20, 0, 0, 1)),
        (3, occ.addCylinder(28, 0, 0, 3, 0, 0, 1.6)),
        box(occ, (40, -3, -3), (50, 3, 3)),
    ]
    return occ.cut([box(occ, (0, -8, -8), (60, 8, 8))], air)[0]


def test_sections_and_chambers_of_a_cone_and_a_box_with_a_bore_between(tmp_path: Path) -> None:
    surface = SurfaceFile(str(write_surface(tmp_path / "cone.stl", _cone_and_steps, 5, around=90)), -6.0)
    points, walls = surface.surface.points, surface._cavities["cavity"]
    x = np.array([2.5, 12.0, 21.5, 25.0, 29.0, 35.0, 45.0])
    exact = [np.pi * (4 - (x[0] - 2) / 10) ** 2, np.pi * 9, np.pi * (4 - 1.95) ** 2, np.pi, np.pi * 1.6**2, np.pi, 36]
    np.testing.assert_allclose(sections(points, walls, x), exact, rtol=5e-3)
    np.testing.assert_allclose(sections(points, walls[::-1, ::-1], x), exact, rtol=5e-3)  # facing the other way
    (begin, end), box_range = chambers_of(points, walls)
    assert begin == pytest.approx(2.0, abs=1e-3)
    assert end == pytest.approx(2 + 10 * (4 - 4 * np.sqrt(0.5)), abs=0.1)  # where half of the largest section is left
    assert box_range == pytest.approx((40.0, 50.0), abs=1e-3)


@pytest.mark.parametrize(
    ("ranges", "between"),
    [
        ([(3, 57)], []),
        ([(3, 57), (3, 57)], []),
        ([(3, 29), (3, 29), (31, 57)], [28]),
        ([(3, 20), (22, 38), (40, 57), (22, 38)], [18.5, 18.5]),
        ([(3, 50), (52, 57)], []),
        ([(3, 29), (20, 57)], []),
    ],
    ids=["one", "beside one another", "two and one", "three and one", "almost all of the arm", "overlapping"],
)
def test_chambers_beside_one_another_are_one(ranges: list[tuple[float, float]], between: list[float]) -> None:
    assert distances(middles_of(ranges, 60.0)) == pytest.approx(between)


@pytest.mark.parametrize(
    ("length", "between", "pitch", "reason"),
    [
        (110.0, [], 10.0, "no chambers follow one another along the arm"),
        (60.0, [], 6.0, "no chambers follow one another along the arm"),
        (110.0, [15.0] * 6, 15.0, "this is the distance of its 7 chambers"),
        (110.0, [14.8, 15.0, 14.6], 15.0, "this is the distance of its 4 chambers"),
        (110.0, [14.0, 15.0], 10.0, "its chambers are not equally far apart"),
        (110.0, [17.0] * 5, 10.0, "five parameters need 6.5 times the distance of its chambers, 17 mm"),
        (65.0, [10.0] * 5, 10.0, "this is the distance of its 6 chambers"),
    ],
    ids=["one cavity", "short", "equal", "nearly equal", "unequal", "too few", "just enough"],
)
def test_curvature_is_averaged_over_equal_cells_where_there_are_enough(
    length: float, between: list[float], pitch: float, reason: str
) -> None:
    assert usual_pitch(length, between) == (pytest.approx(pitch), reason)


def test_as_many_cells_as_five_parameters_need() -> None:
    assert PITCHES == FEWEST_PITCHES
