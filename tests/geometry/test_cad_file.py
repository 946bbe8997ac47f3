"""Bodies from CAD files, and the messages for files and keys that cannot be used."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError, MeshError
from tests.step_bodies import box, save


def finger(occ: Any, hole: bool = False, second: bool = False) -> list[tuple[int, int]]:
    """A bar of 60 x 12 x 15 mm with a cavity of 54 x 7 x 10 mm and a knob of radius 3 mm, 4 mm high, on it."""
    bar, _ = occ.fuse([box(occ, (0, 0, -7.5), (60, 12, 7.5))], [(3, occ.addCylinder(30, 12, 0, 0, 4, 0, 3))])
    ends = [(3, 29), (31, 57)] if second else [(3, 57)]
    air = [box(occ, (start, 3, -5), (stop, 10, 5)) for start, stop in ends]
    if hole:
        air.append((3, occ.addCylinder(-1, 6, 0, 10, 0, 0, 1)))
    return occ.cut(bar, air)[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cad")


def design_of(path: Path, **changes: Any) -> CadFile:
    spec: dict[str, Any] = {"clamp": 0, "tip": 60, "curve": 1.5, "air": {"cavity": (30, 5, 0)}}
    return CadFile(str(path), **(spec | changes))


SOLID = 60 * 12 * 15 + np.pi * 9 * 4 - 54 * 7 * 10


@pytest.mark.parametrize("suffix", [".step", ".brep"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_cad_file_becomes_a_body(folder: Path, suffix: str, symmetric: bool) -> None:
    design = design_of(save(folder / f"finger{symmetric}{suffix}", finger), symmetric=symmetric)
    assert design.extent == pytest.approx((60, 16, 15))
    assert design.solid_volume == pytest.approx(SOLID, rel=1e-7)
    assert design.cavity_volume == pytest.approx(54 * 7 * 10, rel=1e-7)
    body = design.body(4)
    mesh, fraction = body.mesh, 0.5 if symmetric else 1
    assert mesh.volume == pytest.approx(fraction * SOLID, rel=1e-5)
    assert mesh.enclosed_volume("cavity") == pytest.approx(fraction * 54 * 7 * 10, rel=1e-10)
    assert set(mesh.faces) == {"clamp", "tip", "cavity", "outer"} | ({"sym"} if symmetric else set())
    assert sum(map(len, mesh.faces.values())) == len(mesh.boundary)
    assert mesh.area("clamp") == pytest.approx(fraction * 12 * 15)
    assert (body.half, body.length, body.curve_y, body.pitch) == (symmetric, 60, 1.5, 6)
    assert np.diff(mesh.points[body.curve_vertices, 0]).max() <= 4 + 1e-9
    assert mesh.quality.minimum > 0.1


def test_half_that_is_drawn_as_a_half(folder: Path) -> None:
    path = save(folder / "half.brep", lambda occ: occ.intersect(finger(occ), [box(occ, (-1, -1, 0), (61, 20, 8))]))
    design = design_of(path, symmetric=True)
    assert design.extent == pytest.approx((60, 16, 15))
    assert design.solid_volume == pytest.approx(SOLID, rel=1e-7)
    assert 2 * design.body(4).mesh.enclosed_volume("cavity") == pytest.approx(3780)


def test_body_away_from_the_origin_is_clamped_at_zero(folder: Path) -> None:
    path = save(folder / "moved.step", lambda occ: occ.translate(finger(occ), 100, 0, 0))
    body = design_of(path, clamp=100, tip=160, air={"cavity": (130, 5, 0)}).body(5)
    assert body.mesh.points[body.curve_vertices[[0, -1]], 0] == pytest.approx([0, 60])


def test_two_cavities_keep_their_names(folder: Path) -> None:
    path = save(folder / "two.step", lambda occ: finger(occ, second=True))
    points = {"cavity": (10, 5, 0), "cavity_far": (50, 5, 0)}
    design = design_of(path, air=points)
    mesh = design.body(5).mesh
    assert design.cavities == ("cavity", "cavity_far")
    for name in design.cavities:
        assert 2 * mesh.enclosed_volume(name) == pytest.approx(26 * 7 * 10)
        centre = mesh.points[np.unique(mesh.faces[name]), 0].mean()
        assert centre == pytest.approx(points[name][0], abs=8)
    with pytest.raises(DesignError, match="no name for 1 cavities, around") as caught:
        design_of(path, air={"cavity": (10, 5, 0)})
    assert caught.value.keys == ("air",)
    with pytest.raises(DesignError, match=r"air\.other: .* same cavity as that of cavity"):
        design_of(path, air={"cavity": (10, 5, 0), "other": (12, 5, 0)})


def test_the_unit_stands_in_place_of_the_one_that_a_step_file_stores(folder: Path) -> None:
    """The CAD kernel converts the stored one to mm; some programs store metres for numbers in mm."""
    path = save(folder / "unit.step", finger)
    for suffix in (".step", ".stp", ".STP"):
        copy = path.replace(folder / f"unit{suffix}")
        assert design_of(copy).solid_volume == pytest.approx(SOLID, rel=1e-7)
        assert design_of(copy, unit=1).solid_volume == pytest.approx(SOLID, rel=1e-7)
        path = copy
    text = path.read_text(encoding="utf-8")
    in_mm = "SI_UNIT(.MILLI.,.METRE.)"
    assert in_mm in text
    for stored in ("SI_UNIT($,.METRE.)", "SI_UNIT( .CENTI. , .METRE. )"):
        path.write_text(text.replace(in_mm, stored), encoding="utf-8")
        assert design_of(path, unit=1).solid_volume == pytest.approx(SOLID, rel=1e-6)
    path.write_text(text.replace(in_mm, "SI_UNIT($,.METRE.)"), encoding="utf-8")
    with pytest.raises(DesignError, match=r"the body measures .*e\+04 x .* is it in another unit\? give unit"):
        design_of(path)
    path.write_text(text.replace(in_mm, in_mm + " SI_UNIT($,.METRE.)"), encoding="utf-8")
    with pytest.raises(DesignError, match="stores no single unit of length; save it in mm, and leave unit out"):
        design_of(path, unit=1)


def asymmetric(occ: Any) -> None:
    occ.fuse(finger(occ), [box(occ, (20, 12, 3), (25, 14, 5))])


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
        design_of(path).body(5)
