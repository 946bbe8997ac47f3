"""Volumes and areas of the meshed bodies against closed forms."""

import pickle
from dataclasses import replace
from itertools import pairwise
from math import cos, pi, sin
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geometry import BisectedCircle, Design, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.curved import CurvedEdges
from geometry.files.mesh.reader import read_mesh_file


def halves(design: Design, size: float) -> tuple[float, float]:
    """Twice the volumes of the solid and of the pressurised air of the half mesh, mm3."""
    mesh = design.body(size).mesh
    return 2 * mesh.volume, 2 * mesh.enclosed_volume("cavity")


def test_pneunet_by_hand() -> None:
    design = PneuNet()
    assert design.length == 112
    assert design.cavity_volume == 11 * 6 * 11 * 13 + 10 * 4 * 2 * 2
    assert design.solid_volume == 112 * 15 * 5 + 11 * 8 * 15 * 12 - design.cavity_volume
    assert design.pitch == 10


@pytest.mark.parametrize("size", [6, 4, 3, 2])
@pytest.mark.parametrize("design", [PneuNet(), PneuNet(chambers=1), PneuNet(chambers=2, gap=3, wall=1.5, channel=1)])
def test_pneunet_volumes_are_exact(design: PneuNet, size: float) -> None:
    solid, air = halves(design, size)
    assert solid == pytest.approx(design.solid_volume, rel=1e-10)
    assert air == pytest.approx(design.cavity_volume, rel=1e-10)


def test_pneunet_areas_are_exact() -> None:
    mesh = PneuNet().body(4).mesh
    assert 2 * mesh.area("clamp") == pytest.approx(15 * 5)
    assert 2 * mesh.area("tip") == pytest.approx(15 * 5)
    assert 2 * mesh.area("gap") == pytest.approx(10 * (2 * 15 * 12 + 15 * 2))
    air = 11 * (6 * 11 * 2 + 2 * 13 * (6 + 11)) + 10 * (4 * 2 * 4 - 2 * 2 * 2)
    assert 2 * mesh.area("cavity") == pytest.approx(air)


@pytest.mark.parametrize("size", [4, 2, 1])
@pytest.mark.parametrize("radius", [0.5, 0.7])
def test_fillets_of_the_pneunet_are_prisms_on_arcs_of_parabolas(radius: float, size: float) -> None:
    """A fillet has three chords at least, and more where they would be longer than 0.35 times the size."""
    sharp, design = PneuNet(chambers=2), PneuNet(chambers=2, fillet=radius)
    assert design.solid_volume - sharp.solid_volume == pytest.approx(4 * 15 * (1 - pi / 4) * radius**2)
    assert design.cavity_volume == sharp.cavity_volume
    half_angle = pi / 4 / max(3, int(np.ceil(pi / 2 * radius / (0.35 * size))))
    segment = 2 / 3 * 2 * sin(half_angle) * (1 - cos(half_angle))
    quarter = pi / 4 / half_angle * (sin(2 * half_angle) / 2 + segment)
    solid, air = halves(design, size)
    assert solid == pytest.approx(sharp.solid_volume + 4 * 15 * (1 - quarter) * radius**2, rel=1e-10)
    assert solid == pytest.approx(design.solid_volume, rel=2e-5)
    assert air == pytest.approx(design.cavity_volume, rel=1e-10)


@pytest.mark.parametrize("radius", [0.25, 0.5, 0.9])
def test_the_gap_has_the_fillets_and_they_are_finely_divided(radius: float) -> None:
    mesh = PneuNet(fillet=radius).body(4).mesh
    walls, bottom, arcs = 2 * 15 * (12 - radius), 15 * (2 - 2 * radius), 2 * 15 * pi / 2 * radius
    assert 2 * mesh.area("gap") == pytest.approx(10 * (walls + bottom + arcs), rel=2e-4)
    assert 2 * mesh.area("clamp") == pytest.approx(15 * 5)
    points = mesh.points[mesh.curved.ends]
    round_ = np.abs(np.hypot((points[:, :, 0] - 2) % 10 - (8 + radius), points[:, :, 1] - 5 - radius) - radius) < 1e-9
    chords = np.linalg.norm(np.diff(points, axis=1)[:, 0, :2], axis=1)[round_.all(axis=1)]
    assert len(chords) > 100
    assert chords.max() == pytest.approx(2 * radius * sin(pi / 12), rel=1e-6)


@settings(max_examples=10, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_pneunet_volumes_for_any_dimensions(data: st.DataObject) -> None:
    def draw(low: float, high: float) -> float:
        return round(data.draw(st.floats(low, high)), 3)

    width, length, height = draw(5, 40), draw(3, 20), draw(3, 30)
    side_wall, strip = draw(0.3, 0.4 * width), draw(0.6, 8)
    design = PneuNet(
        chambers=data.draw(st.integers(1, 4)),
        width=width,
        chamber_length=length,
        gap=draw(0.3, 8),
        chamber_height=height,
        strip=strip,
        base=draw(0.5, 6),
        wall=draw(0.3, 0.45 * length),
        side_wall=side_wall,
        roof=draw(0.3, 0.9 * height),
        channel=draw(0.3, 0.9 * min(strip, width - 2 * side_wall)),
    )
    if data.draw(st.booleans()):
        design = replace(design, fillet=max(0.1, draw(0.05, 0.9) * min(design.gap / 2, design.chamber_height)))
    mesh = design.body(min(8, *design.extent)).mesh
    # edges that curved would fold an element stay straight: at worst all, in three chords of a quarter of a circle
    chords = 2 * design.chambers * design.width * (pi / 4 - 3 / 4) * design.fillet**2
    assert 2 * mesh.volume == pytest.approx(design.solid_volume, rel=1e-10, abs=chords)
    assert 2 * mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-10)
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    assert mesh.quality.minimum > 1e-3


@pytest.mark.parametrize(
    ("seed", "fillet", "regions"), [(1, 0.0, ()), (2, 0.0, ("base",)), (4, 0.0, ()), (7, 0.0, ("base",)), (6, 0.8, ())]
)
def test_volumes_of_unequal_chambers(seed: int, fillet: float, regions: tuple[str, ...]) -> None:
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 5))

    def lengths(number: int, low: float, high: float) -> tuple[float, ...]:
        return tuple(np.round(random.uniform(low, high, number), 3).tolist())

    inside, above, gaps = lengths(count, 1, 10), lengths(count, 0.5, 15), lengths(count + 1, 0.3 + 2 * fillet, 6)
    design = PneuNet(
        chambers=count,
        chamber_lengths=tuple(length + 2.0 for length in inside),
        chamber_heights=tuple(height + 2.0 for height in above),
        gaps=gaps,
        fillet=fillet,
    ).with_regions(regions)
    mesh = design.body(4.0).mesh
    cavities = sum(11 * length * (height + 3.0) for length, height in zip(inside, above, strict=True))
    channels = sum(gap + 2.0 for gap in gaps[1:-1]) * 2.0**2
    assert design.cavity_volume == pytest.approx(cavities + channels)
    assert design.length == pytest.approx(sum(inside) + 2.0 * count + sum(gaps))
    outside = 15 * sum((i + 2.0) * (h + 2.0) for i, h in zip(inside, above, strict=True)) + 15 * 5 * design.length
    rounded = 2 * count * 15 * (1 - pi / 4) * design.fillet**2
    assert design.solid_volume == pytest.approx(outside + rounded - cavities - channels)
    chords = 2 * count * 15 * (pi / 4 - 3 / 4) * design.fillet**2  # where curved edges stay straight
    assert 2 * mesh.volume == pytest.approx(design.solid_volume, rel=1e-9, abs=chords)
    assert 2 * mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-9)
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    facing = sum(15 * (h + 2.0) for pair in pairwise(above) for h in pair) + 15 * sum(gaps[1:-1])
    if not fillet:
        assert 2 * mesh.area("gap") == pytest.approx(facing)
    assert mesh.quality.minimum > 0.05


def test_equal_entries_are_the_arm_of_the_scalars() -> None:
    listed = PneuNet(chambers=3, chamber_lengths=(8.0,) * 3, chamber_heights=(12.0,) * 3, gaps=(2.0,) * 4)
    single = PneuNet(chambers=3)
    assert listed.repeats
    np.testing.assert_array_equal(listed.body(4.0).mesh.points, single.body(4.0).mesh.points)
    assert (listed.length, listed.pitch, listed.solid_volume) == (single.length, single.pitch, single.solid_volume)
    other = PneuNet(chambers=3, gaps=(2.0, 3.0, 4.0, 2.0), chamber_lengths=(8.0, 7.0, 6.0))
    assert other.pitch == pytest.approx(11.0 / 4 + 7.0)


def test_round_families_by_hand() -> None:
    channels = Semicircular()
    assert channels.cavity_volume == pytest.approx(88 * pi / 2 * 6.5**2 + 10 * 2 * 2 * 2)
    assert channels.solid_volume + channels.cavity_volume == pytest.approx(112 * (15 * 2 + pi / 2 * 7.5**2))
    assert SemicircularSingle().cavity_volume == pytest.approx(108 * pi / 2 * 6.5**2)
    nearly_half = BisectedCircle(divider=1e-2).cavity_volume
    assert nearly_half == pytest.approx(108 * (pi / 2 * 6.5**2 - 6.5 * 1e-2), rel=1e-6)
    angles = np.linspace(np.arcsin(0.75 / 6.5), pi / 2, 100001)
    height = 6.5 * np.sin(angles) - 0.75
    segment = 2 * np.trapezoid(height[::-1], 6.5 * np.cos(angles)[::-1])
    assert BisectedCircle().cavity_volume == pytest.approx(108 * segment, rel=1e-8)


def test_the_rectangular_arm_by_hand() -> None:
    design = Rectangular()
    assert design.cavity_volume == pytest.approx(88 * 12 * 11 + 10 * 2 * 2 * 2)
    assert design.solid_volume + design.cavity_volume == pytest.approx(112 * 17 * 15)
    solid, air = halves(Rectangular(chambers=2), 4)
    assert air == pytest.approx(16 * 12 * 11 + 2 * 2 * 2, rel=1e-10)
    assert solid + air == pytest.approx(22 * 17 * 15, rel=1e-10)


@pytest.mark.parametrize("size", [4, 2])
def test_round_walls_are_prisms_on_arcs_of_parabolas(size: float) -> None:
    """Three points of each arc lie on the circle; the segment of a parabola has 2/3 of chord times height."""
    parts = max(5, int(np.ceil(pi / 2 * 7.5 / size)))
    half_angle = pi / 4 / parts
    segment = 2 / 3 * 2 * sin(half_angle) * (1 - cos(half_angle))
    area = 2 * parts * (sin(2 * half_angle) / 2 + segment)  # of half a disc of radius 1
    _, air = halves(SemicircularSingle(length=40), size)
    assert air == pytest.approx(36 * area * 6.5**2, rel=1e-10)
    solid, air = halves(Semicircular(chambers=3), size)
    assert air == pytest.approx(24 * area * 6.5**2 + 2 * 2 * 2 * 2, rel=1e-10)
    assert solid + air == pytest.approx(32 * (15 * 2 + area * 7.5**2), rel=1e-10)


@pytest.mark.parametrize("design", [Semicircular(chambers=1), SemicircularSingle(length=20), BisectedCircle(length=20)])
def test_round_volumes_converge_with_the_fourth_power_of_the_size(design: Design) -> None:
    sizes = [pi / 2 * 7.5 / parts for parts in (5, 10)]
    volumes = np.array([halves(design, size) for size in sizes])
    errors = np.abs(volumes - [design.solid_volume, design.cavity_volume])
    assert np.log2(errors[0] / errors[1]) == pytest.approx([4, 4], abs=0.1)
    assert (errors[0] / [design.solid_volume, design.cavity_volume] < 3e-4).all()


def test_areas_of_round_walls_are_those_of_the_drawing() -> None:
    design = SemicircularSingle(length=40)
    mesh = design.body(4).mesh
    ends_and_base = 40 * 15 + 2 * 40 * 2
    assert 2 * mesh.area("outer") == pytest.approx(ends_and_base + pi * 7.5 * 40, rel=1e-4)
    full = mesh.mirrored()
    assert full.volume == pytest.approx(design.solid_volume, rel=1e-4)
    assert full.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-4)
    assert len(pickle.loads(pickle.dumps(full)).curved) == len(full.curved) > len(mesh.curved)


def test_edges_that_would_fold_an_element_stay_straight() -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 0.1], [2, 2, -1]])
    tets = np.array([[0, 1, 2, 3], [1, 2, 0, 4]])
    slight = CurvedEdges(np.array([[0, 1]]), np.array([[1.0, 0, 0.01]]))
    assert len(slight.usable(points, tets)) == 1
    through = CurvedEdges(np.array([[0, 1], [1, 4]]), np.array([[1.0, 0, 0.2], [2, 1, -0.52]]))
    usable = through.usable(points, tets)
    assert usable.ends.tolist() == [[1, 4]]


def test_curved_edges_of_a_file_that_would_fold_an_element_are_known(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 1], [1, 0, 0.6], *[[0, 0, 0]] * 5])
    pairs = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    for row, (a, b) in list(enumerate(pairs, start=4))[1:]:
        points[row] = points[[a, b]].mean(axis=0)
    for middle, straightened in (([1, 0, 0.6], [[1, 0, 0.6]]), ([1, 0, 0.02], []), ([1, 0, 0], [])):
        points[4] = middle
        file = tmp_path / "one.vtu"
        meshio.Mesh(points, [("tetra10", np.arange(10)[None])]).write(file)
        content = read_mesh_file(file)
        assert content.straightened.tolist() == straightened
        assert len(content.curved) == (middle == [1, 0, 0.02])


def test_round_wall_keeps_its_thickness() -> None:
    """The inner vertices face the outer ones, so that the chords of both sides are parallel."""
    body = SemicircularSingle(length=40).body(4)
    points, faces = body.mesh.points, body.mesh.faces
    for name, radius in (("cavity", 6.5), ("outer", 7.5)):
        corners = points[faces[name]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        round_part = (np.abs(normal[:, 0]) < 1e-9) & (corners[:, :, 1].max(axis=1) > 2 + 1e-6)
        distance = np.abs(np.einsum("ij,ij->i", normal, corners[:, 0] - [0, 2, 0]))[round_part]
        assert distance == pytest.approx(np.full(round_part.sum(), radius * cos(pi / 20)))
