"""Inlets that are filled with the material of the body, in drawings and in surfaces of triangles."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError, SurfaceFile
from pipeline.config.load import load_config
from pipeline.simulate.simulate import experiments_of
from pipeline.values.errors import InputError
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, Draw, bar, tube, write_surface
from tests.step_bodies import box, save

Cut = Callable[[Any], Any]


def drilled(*cuts: Cut, draw: Draw = bar) -> Draw:
    """A body without what is cut out of it."""
    return lambda occ: occ.cut(draw(occ), [cut(occ) for cut in cuts])[0]


def cylinder(*numbers: float) -> Cut:
    """Centre of one end, axis and radius, mm."""
    return lambda occ: (3, occ.addCylinder(*numbers))


BELOW = drilled(cylinder(30, -1, 0, 0, 5, 0, 1.2))
#: bodies, a point in the mouth, and the mean length of the walls
INLETS: dict[str, tuple[Draw, tuple[float, float, float], float]] = {
    "straight": (BELOW, (30, 0, 0), 3.0),
    "beside its middle, near the plane": (BELOW, (30.9, 0.01, 0.3), 3.0),
    "from the cavity": (BELOW, (30, 3, 0), 3.0),
    "at the clamp": (drilled(cylinder(-1, 6, 0, 5, 0, 0, 1.5)), (0, 6, 0), 3.0),
    "square": (drilled(lambda occ: box(occ, (28, -1, -2), (32, 4, 2))), (30, 0, 0), 3.0),
    "conical": (drilled(lambda occ: (3, occ.addCone(30, -0.1, 0, 0, 4, 0, 2, 1))), (30, 0, 0), 2.505),
    "with a draft": (drilled(lambda occ: (3, occ.addCone(30, -0.1, 0, 0, 4, 0, 1.2, 1.5))), (30, 0, 0), 3.289),
    "oblique": (drilled(cylinder(29, -1, 0, 2.5, 5, 0, 1.0)), (29.5, 0, 0), 3.165),
    "narrow": (drilled(cylinder(30, -1, 0, 0, 5, 0, 0.4)), (30, 0, 0), 3.0),
}


@pytest.mark.parametrize("kind", ["step", "stl"])
@pytest.mark.parametrize("name", INLETS)
def test_an_inlet_through_a_wall_is_filled(name: str, kind: str, tmp_path: Path) -> None:
    """The body is then the bar without an inlet."""
    draw, point, depth = INLETS[name]
    plug = {"inlet": point}
    design: CadFile | SurfaceFile
    if kind == "stl":
        design = SurfaceFile(str(write_surface(tmp_path / "inlet.stl", draw, 50)), 1.5, plug=plug)
    else:
        design = CadFile(str(save(tmp_path / "inlet.step", draw)), 1.5, plug=plug)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)
    assert design.cavity_volumes == pytest.approx({"cavity": BAR_AIR}, rel=1e-9)
    assert design.plug_depths == pytest.approx({"inlet": depth}, rel=5e-3)
    assert not design.is_open_at_clamp


SIDES = drilled(cylinder(30, 6, -9, 0, 0, 18, 1.5))
ONE_SIDE = drilled(cylinder(30, 6, 0, 0, 0, 9, 1.5))
#: bodies, points in mouths, and further keys of a CAD file
DRAWN: dict[str, tuple[Draw, dict[str, tuple[float, float, float]], dict[str, Any]]] = {
    "the whole body": (BELOW, {"inlet": (30, 0, 0)}, {"symmetric": False}),
    "clamped at the larger x": (BELOW, {"inlet": (30, 0, 0)}, {"clamp": 60, "tip": 0}),
    "in one side of an arm clamped at its larger x": (ONE_SIDE, {"inlet": (30, 6, 7.5)}, {"clamp": 60, "tip": 0}),
    "on both sides": (SIDES, {"inlet": (30, 6, 7.5)}, {}),
    "both sides named": (SIDES, {"right": (30, 6, 7.5), "left": (30, 6, -7.5)}, {}),
    "the same named twice": (BELOW, {"inlet": (30, 0, 0), "again": (30.5, 0, 0)}, {}),
    "two": (
        drilled(cylinder(30, -1, 0, 0, 5, 0, 2), cylinder(61, 7, 0, -6, 0, 0, 2)),
        {"inlet": (30, 0, 0), "end": (60, 7, 0)},
        {},
    ),
}


@pytest.mark.parametrize("name", DRAWN)
def test_inlets_of_drawings(name: str, tmp_path: Path) -> None:
    draw, plug, keys = DRAWN[name]
    design = CadFile(str(save(tmp_path / "inlet.step", draw)), 1.5, plug=plug, **keys)
    assert (design.solid_volume, design.cavity_volume) == pytest.approx((BAR_VOLUME, BAR_AIR), rel=1e-6)
    assert set(design.plug_depths) == set(plug)


def test_the_mesh_of_a_filled_body_has_the_faces_of_the_bar(tmp_path: Path) -> None:
    plain = CadFile(str(save(tmp_path / "bar.step", bar)), 1.5).body(5.0).mesh
    mesh = CadFile(str(save(tmp_path / "inlet.step", BELOW)), 1.5, plug={"inlet": (30, 0, 0)}).body(5.0).mesh
    areas = {name: mesh.area(name) for name in mesh.faces}
    assert areas == pytest.approx({name: plain.area(name) for name in plain.faces}, rel=1e-9)
    assert mesh.quality.minimum > 0.5 * plain.quality.minimum


def test_an_inlet_is_filled_up_to_a_round_wall(tmp_path: Path) -> None:
    def round_cavity(occ: Any) -> Any:
        air = [(3, occ.addCylinder(3, 7, 0, 54, 0, 0, 4)), (3, occ.addCylinder(30, -1, 0, 0, 8, 0, 2))]
        return occ.cut([box(occ, (0, 0, -7.5), (60, 12, 7.5))], air)[0]

    air, plug = np.pi * 16 * 54, {"inlet": (30.0, 0.0, 0.0)}
    drawn = CadFile(str(save(tmp_path / "round.step", round_cavity)), 1.5, plug=plug)
    assert drawn.cavity_volume == pytest.approx(air, rel=1e-9)
    design = SurfaceFile(str(write_surface(tmp_path / "round.stl", round_cavity, 50)), 1.5, plug=plug)
    assert design.cavity_volume == pytest.approx(air, rel=0.02)
    assert design.body(4.0).volume == pytest.approx(60 * 12 * 15 - air, rel=0.01)


def test_a_plug_is_of_the_solid_with_the_mouth(tmp_path: Path) -> None:
    def on_a_base(occ: Any) -> Any:
        body = BELOW(occ)
        base = occ.intersect(body, [box(occ, (-1, -1, -9), (61, 1, 9))], removeObject=False)[0]
        return base + occ.intersect(body, [box(occ, (-1, 1, -9), (61, 20, 9))])[0]

    path = str(save(tmp_path / "parts.step", on_a_base))
    design = CadFile(path, 0.5, plug={"inlet": (30, 0, 0)}, parts={"base": (10, 0.5, 0)})
    assert design.region_volumes == pytest.approx({"base": 60 * 15}, rel=1e-6)
    assert design.cavity_volume == pytest.approx(BAR_AIR + 2 * np.pi * 1.2**2, rel=1e-6)


#: bodies with inlets that are left to the CAD program, a point in the mouth, and the height of the curve
REFUSED: dict[str, tuple[Draw, tuple[float, float, float], float]] = {
    "in a round face": (drilled(cylinder(20, 0, 0, 0, 10, 0, 1.5), draw=tube), (20, 7, 0), -6.5),
    "with a bottom": (drilled(cylinder(30, -1, 0, 0, 2.5, 0, 1.2)), (33, 0, 0), 11.0),
    "flush with the floor of the cavity": (drilled(lambda occ: box(occ, (-1, 3, -1), (4, 5, 1))), (0, 4, 0), 1.5),
    "a point beside it": (BELOW, (20, 0, 0), 1.5),
    "a point in the channel": (BELOW, (30, 1.5, 0), 1.5),
}


@pytest.mark.parametrize("name", REFUSED)
def test_other_inlets_are_left_to_the_cad_program(name: str, tmp_path: Path) -> None:
    draw, point, curve = REFUSED[name]
    surface, drawing = write_surface(tmp_path / "inlet.stl", draw, 50), save(tmp_path / "inlet.step", draw)
    with pytest.raises(DesignError, match="close it in CAD") as refused:
        SurfaceFile(str(surface), curve, plug={"inlet": point})
    assert refused.value.keys == ("plug.inlet",)
    if not name.startswith("flush"):
        with pytest.raises(DesignError, match="close it in CAD"):
            CadFile(str(drawing), curve, plug={"inlet": point})


def test_holes_are_listed(tmp_path: Path) -> None:
    def with_boss(occ: Any) -> Any:
        return occ.fuse(BELOW(occ), [(3, occ.addCylinder(20, 12, 0, 0, 3, 0, 2.5))])[0]

    path = str(save(tmp_path / "boss.step", with_boss))
    for keys in ({"curve": 11.0}, {"curve": 1.5}, {"curve": 11.0, "plug": {"inlet": (5.0, 5.0, 5.0)}}):
        with pytest.raises(DesignError) as refused:
            CadFile(path, **keys)
        assert "(30, 0, 0) mm" in str(refused.value)
        assert "(20, 12, 0) mm" not in str(refused.value)  # the foot of the boss is no hole


def test_a_plug_in_a_configuration(tmp_path: Path) -> None:
    save(tmp_path / "inlet.step", BELOW)
    path = tmp_path / "inlet.yaml"
    path.write_text(
        "name: inlet\n"
        "geometry: {family: own, file: inlet.step, curve: 1.5 mm, plug: {inlet: [30 mm, 0 mm, 0 mm]}}\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.45}\npressures: [4 kPa]\n",
        encoding="utf-8",
    )
    config = load_config(path)
    assert config.record()["geometry"]["plug"] == {"inlet": [30.0, 0.0, 0.0]}
    assert experiments_of(config) == ("II", "III", "I")  # nothing has to carry the pressure on an opening
    for plug in ("{}", "2 mm", "{inlet: 3 mm}", "{inlet: [1 mm, 2 mm]}"):
        with pytest.raises(
            InputError, match=r"geometry.plug: .* allowed: true \(closes an inlet in the plane of the clamp\)"
        ):
            load_config(path, [f"geometry.plug={plug}"])
    with pytest.raises(InputError, match=r"geometry.plug: '30 MPa' is not a length"):
        load_config(path, ["geometry.plug={inlet: [30 MPa, 0 mm, 0 mm]}"])
