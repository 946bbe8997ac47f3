"""Volumes and areas of the meshed bodies against closed forms."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geometry import BisectedCircle, Design, PneuNet, Semicircular, SemicircularSingle


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


@settings(max_examples=25, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
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
    mesh = design.body(min(4, *design.extent)).mesh
    assert 2 * mesh.volume == pytest.approx(design.solid_volume, rel=1e-10)
    assert 2 * mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-10)
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    assert mesh.quality.minimum > 1e-3


def test_round_families_by_hand() -> None:
    channels = Semicircular()
    assert channels.cavity_volume == pytest.approx(88 * pi / 2 * 6.5**2 + 10 * 2 * 2 * 2)
    assert channels.solid_volume + channels.cavity_volume == pytest.approx(112 * (15 * 2 + pi / 2 * 7.5**2))
    assert SemicircularSingle().cavity_volume == pytest.approx(108 * pi / 2 * 6.5**2)
    nearly_half = BisectedCircle(divider=1e-3).cavity_volume
    assert nearly_half == pytest.approx(108 * (pi / 2 * 6.5**2 - 6.5 * 1e-3), rel=1e-7)
    angles = np.linspace(np.arcsin(0.75 / 6.5), pi / 2, 100001)
    height = 6.5 * np.sin(angles) - 0.75
    segment = 2 * np.trapezoid(height[::-1], 6.5 * np.cos(angles)[::-1])
    assert BisectedCircle().cavity_volume == pytest.approx(108 * segment, rel=1e-8)


@pytest.mark.parametrize("size", [4, 2])
def test_round_walls_are_prisms_on_regular_polygons(size: float) -> None:
    parts = max(4, int(np.ceil(pi / 2 * 7.5 / size)))
    polygon = 2 * parts * sin(pi / 2 / parts) / 2  # area of half a regular polygon in a circle of radius 1
    _, air = halves(SemicircularSingle(length=40), size)
    assert air == pytest.approx(36 * polygon * 6.5**2, rel=1e-10)
    solid, air = halves(Semicircular(chambers=3), size)
    assert air == pytest.approx(24 * polygon * 6.5**2 + 2 * 2 * 2 * 2, rel=1e-10)
    assert solid + air == pytest.approx(32 * (15 * 2 + polygon * 7.5**2), rel=1e-10)


@pytest.mark.parametrize("design", [Semicircular(chambers=1), SemicircularSingle(length=20), BisectedCircle(length=20)])
def test_round_volumes_converge_with_the_square_of_the_size(design: Design) -> None:
    sizes = [pi / 2 * 7.5 / parts for parts in (4, 8, 16)]
    volumes = np.array([halves(design, size) for size in sizes])
    errors = np.abs(volumes - [design.solid_volume, design.cavity_volume])
    rates = np.log2(errors[0] / errors[-1]) / 2  # 0.1: arcs of odd angles are divided by whole numbers too
    assert rates == pytest.approx([2, 2], abs=0.1)
    assert (errors[0] / [design.solid_volume, design.cavity_volume] < 0.03).all()


def test_round_wall_keeps_its_thickness() -> None:
    """The inner vertices face the outer ones, so the wall is nowhere thinner than the cosine of half the angle says."""
    body = SemicircularSingle(length=40).body(4)
    points, faces = body.mesh.points, body.mesh.faces
    for name, radius in (("cavity", 6.5), ("outer", 7.5)):
        corners = points[faces[name]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        round_part = (np.abs(normal[:, 0]) < 1e-9) & (corners[:, :, 1].max(axis=1) > 2 + 1e-6)
        distance = np.abs(np.einsum("ij,ij->i", normal, corners[:, 0] - [0, 2, 0]))[round_part]
        assert distance == pytest.approx(np.full(round_part.sum(), radius * cos(pi / 16)))
