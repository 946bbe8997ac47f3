"""Inlets of CAD files that are filled with the material of the body."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError
from pipeline.config.load import load_config
from pipeline.errors import InputError
from pipeline.simulation.simulate import experiments_of
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, Draw, bar, tube
from tests.step_bodies import box, in_inches, save

Cut = Callable[[Any], Any]


def drilled(*cuts: Cut, draw: Draw = bar) -> Draw:
    """A body without what is cut out of it."""
    return lambda occ: occ.cut(draw(occ), [cut(occ) for cut in cuts])[0]


def cylinder(*numbers: float) -> Cut:
    """Centre of one end, axis and radius, mm."""
    return lambda occ: (3, occ.addCylinder(*numbers))


def half(draw: Draw, side: int) -> Draw:
    """What a body has at z >= 0, or at z <= 0."""
    low, high = sorted((0, side * 8))
    return lambda occ: occ.intersect(draw(occ), [box(occ, (-1, -9, low), (61, 20, high))])[0]


BELOW = drilled(cylinder(30, -1, 0, 0, 5, 0, 1.2))

THROUGH_A_WALL = {
    "below": (BELOW, (30, 0, 0), {}),
    "a point beside the middle": (BELOW, (30.5, 0, 0.3), {}),
    "the whole body": (BELOW, (30, 0, 0), {"symmetric": False}),
    "clamped at the larger x": (BELOW, (30, 0, 0), {"clamp": 60, "tip": 0}),
    "half": (half(BELOW, 1), (30, 0, 0), {"symmetric": True}),
    "other half": (half(BELOW, -1), (30, 0, 0), {"symmetric": True}),
    "at the clamp": (drilled(cylinder(-1, 6, 0, 5, 0, 0, 1.5)), (0, 6, 0), {}),
    "in one side": (drilled(cylinder(30, 6, 0, 0, 0, 9, 1.5)), (30, 6, 7.5), {}),
    "in one side of an arm clamped at its larger x": (
        drilled(cylinder(30, 6, 0, 0, 0, 9, 1.5)),
        (30, 6, 7.5),
        {"clamp": 60, "tip": 0},
    ),
    "square": (drilled(lambda occ: box(occ, (28, -1, -2), (32, 4, 2))), (30, 0, 0), {}),
    "in the shape of an L": (
        drilled(lambda occ: box(occ, (28, -1, -3), (33, 4, 3)), lambda occ: box(occ, (26, -1, -3), (28, 4, -1))),
        (27, 0, -2),
        {"symmetric": False},
    ),
    "conical": (drilled(lambda occ: (3, occ.addCone(30, -0.1, 0, 0, 4, 0, 2, 1))), (30, 0, 0), {}),
    "with a draft": (drilled(lambda occ: (3, occ.addCone(30, -0.1, 0, 0, 4, 0, 1.2, 1.5))), (30, 0, 0), {}),
    "oblique": (drilled(cylinder(30 - np.tan(0.2), -1, 0, 5 * np.tan(0.2), 5, 0, 1.2)), (30, 0, 0), {}),
    "away from its mouth": (drilled(cylinder(29, -1, 0, 2.5, 5, 0, 1.0)), (29.5, 0, 0), {}),
    "with a counterbore wider than the rest": (
        drilled(cylinder(30, -1, 0, 0, 2, 0, 6), cylinder(30, -1, 0, 0, 5, 0, 1)),
        (34, 0, 0),
        {"curve": 11},
    ),
    "a point near the plane": (BELOW, (30, 0.02, 0), {}),
    "on both sides": (drilled(cylinder(30, 6, -9, 0, 0, 18, 1.5)), (30, 6, 7.5), {}),
    "longer than twice its width": (drilled(cylinder(30, -1, 0, 0, 5, 0, 0.4)), (30, 0, 0), {}),
    "from within": (BELOW, (30, 3, 0), {}),
    "stepped": (drilled(cylinder(30, -1, 0, 0, 5, 0, 1), cylinder(30, -1, 0, 0, 2, 0, 2)), (30, 0, 0), {}),
}


@pytest.mark.parametrize("name", THROUGH_A_WALL)
def test_an_inlet_through_a_wall_is_filled(tmp_path: Path, name: str) -> None:
    """The body is then the bar without an inlet."""
    draw, point, options = THROUGH_A_WALL[name]
    options = {"curve": 1.5, "plug": {"inlet": point}, **options}
    design = CadFile(str(save(tmp_path / "inlet.step", draw)), **options)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)
    assert design.cavity_volumes == pytest.approx({"cavity": BAR_AIR}, rel=1e-6)
    assert not design.is_open_at_clamp


def test_the_mesh_of_a_filled_body_has_the_faces_of_the_bar(tmp_path: Path) -> None:
    plain = CadFile(str(save(tmp_path / "bar.step", bar)), 1.5).body(5.0).mesh
    design = CadFile(str(save(tmp_path / "inlet.step", BELOW)), 1.5, plug={"inlet": (30, 0, 0)})
    assert design.plug_depths == pytest.approx({"inlet": 3.0})
    mesh = design.body(5.0).mesh
    areas = {name: mesh.area(name) for name in mesh.faces}
    assert areas == pytest.approx({name: plain.area(name) for name in plain.faces}, rel=1e-9)
    assert mesh.quality.minimum > 0.5 * plain.quality.minimum


def test_a_plug_in_a_long_channel_is_as_deep_as_wide(tmp_path: Path) -> None:
    def long_channel(occ: Any) -> Any:
        block = occ.fuse(bar(occ), [box(occ, (-20, 0, -7.5), (0, 12, 7.5))])[0]
        return occ.cut(block, [(3, occ.addCylinder(-25, 6, 0, 40, 0, 0, 1.0))])[0]

    design = CadFile(str(save(tmp_path / "long.step", long_channel)), 1.5, plug={"inlet": (-20, 6, 0)})
    assert design.plug_depths == pytest.approx({"inlet": 2.0}, rel=1e-6)
    assert design.cavity_volume == pytest.approx(BAR_AIR + 21 * np.pi, rel=1e-6)  # 23 mm, 2 of them filled


def test_a_plug_in_a_round_wall_has_a_flat_end(tmp_path: Path) -> None:
    def round_cavity(occ: Any) -> Any:
        air = [(3, occ.addCylinder(3, 7, 0, 54, 0, 0, 4)), (3, occ.addCylinder(30, -1, 0, 0, 8, 0, 2))]
        return occ.cut([box(occ, (0, 0, -7.5), (60, 12, 7.5))], air)[0]

    design = CadFile(str(save(tmp_path / "round.step", round_cavity)), 1.5, plug={"inlet": (30, 0, 0)})
    assert design.plug_depths == pytest.approx({"inlet": 3.0 - 0.1 * 4.0}, abs=2e-3)
    mesh = design.body(3.0).mesh
    assert mesh.quality.minimum > 0.02
    assert 2 * mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-3)


def test_a_brep_file_in_inches(tmp_path: Path) -> None:
    """Its flat faces are splines once it is in mm."""
    path = in_inches(BELOW, tmp_path / "inches.brep")
    design = CadFile(str(path), 1.5, unit=25.4, plug={"inlet": (30, 0, 0)})
    assert design.cavity_volume == pytest.approx(BAR_AIR, rel=1e-5)


def test_several_inlets(tmp_path: Path) -> None:
    path = str(save(tmp_path / "two.step", drilled(cylinder(30, -1, 0, 0, 5, 0, 2), cylinder(61, 7, 0, -6, 0, 0, 2))))
    with pytest.raises(DesignError, match=r"no closed cavity: .*another inlet is open: .*centres at \(60, 7, 0\)"):
        CadFile(path, 1.5, plug={"inlet": (30, 0, 0)})
    both = {"inlet": (30, 0, 0), "end": (60, 7, 0)}
    design = CadFile(path, 1.5, plug=both)
    assert (design.solid_volume, design.cavity_volume) == pytest.approx((BAR_VOLUME, BAR_AIR), rel=1e-6)
    assert design.plug_depths == pytest.approx({"inlet": 3.0, "end": 3.0}, rel=1e-6)


def test_a_plug_is_of_the_material_around_its_middle(tmp_path: Path) -> None:
    def on_a_base(occ: Any) -> Any:
        body = BELOW(occ)
        base = occ.intersect(body, [box(occ, (-1, -1, -9), (61, 1, 9))], removeObject=False)[0]
        return base + occ.intersect(body, [box(occ, (-1, 1, -9), (61, 20, 9))])[0]

    path = str(save(tmp_path / "parts.step", on_a_base))
    design = CadFile(path, 0.5, plug={"inlet": (30, 0, 0)}, parts={"base": (10, 0.5, 0)})
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)
    assert design.region_volumes == pytest.approx({"base": 60 * 15 - np.pi * 1.2**2}, rel=1e-6)


def _half_disc(occ: Any) -> Any:
    """A half disc of radius 8 mm, 60 mm long, with a cavity of radius 6 mm from 3 mm above its base."""
    disc = occ.intersect([(3, occ.addCylinder(0, 0, 0, 60, 0, 0, 8))], [box(occ, (-1, 0, -9), (61, 9, 9))])[0]
    air = occ.intersect([(3, occ.addCylinder(3, 0, 0, 54, 0, 0, 6))], [box(occ, (2, 3, -9), (58, 9, 9))])[0]
    return occ.cut(disc, air)[0]


TUBE_AIR = np.pi * 44 * 25
TUBE_VOLUME = np.pi * 50 * 49 - TUBE_AIR
ABOVE = cylinder(20, 0, 0, 0, 10, 0, 1.5)
#: cuts of the tube, a point in the mouth, further keys, and the depth where the wall is 1.5 mm (2 mm beside z = 0)
IN_A_ROUND_FACE = {
    "above": (drilled(ABOVE, draw=tube), (20, 7, 0), {}, 1.5),
    "a point beside the middle": (drilled(ABOVE, draw=tube), (20.5, 6.95, 0.5), {}, 1.5),
    "clamped at the larger x": (drilled(ABOVE, draw=tube), (20, 7, 0), {"clamp": 50, "tip": 0}, 1.5),
    "across the seam": (drilled(cylinder(20, 0, 0, 0, 0, 10, 1.5), draw=tube), (20, 0, 7), {"symmetric": False}, 2.04),
    "on both sides": (drilled(cylinder(20, 0, -10, 0, 0, 20, 1.5), draw=tube), (20, 0, 7), {}, 2.04),
    "half": (half(drilled(ABOVE, draw=tube), 1), (20, 7, 0), {"symmetric": True}, 1.5),
    "oblique": (drilled(cylinder(20, 0, 0, 4, 10, 0, 1.2), draw=tube), (22.8, 7, 0), {}, 1.5),
    "square": (drilled(lambda occ: box(occ, (19, 0, -1), (21, 9, 1)), draw=tube), (20, 7, 0), {}, 1.92),
    "stepped": (
        drilled(cylinder(20, 0, 0, 0, 10, 0, 1), cylinder(20, 6.3, 0, 0, 9, 0, 2), draw=tube),
        (20, 7, 0),
        {},
        0.83,
    ),
    "countersunk": (
        drilled(cylinder(20, 0, 0, 0, 10, 0, 1), lambda occ: (3, occ.addCone(20, 6, 0, 0, 2, 0, 1, 3)), draw=tube),
        (20, 7, 0),
        {},
        0.73,
    ),
}


@pytest.mark.parametrize("name", IN_A_ROUND_FACE)
def test_an_inlet_with_its_mouth_in_a_round_face_is_filled_up_to_both_faces(tmp_path: Path, name: str) -> None:
    draw, point, keys, depth = IN_A_ROUND_FACE[name]
    path = str(save(tmp_path / "tube.step", draw))
    design = CadFile(path, keys.pop("curve", -6.5), plug={"inlet": point}, **keys)
    assert design.solid_volume == pytest.approx(TUBE_VOLUME, rel=1e-9)
    assert design.cavity_volumes["cavity"] == pytest.approx(TUBE_AIR, rel=1e-9)
    assert design.plug_depths["inlet"] == pytest.approx(depth, abs=0.02)


def test_inlets_of_a_half_that_is_mirrored_and_splines_then(tmp_path: Path) -> None:
    path = str(save(tmp_path / "tube.step", half(drilled(ABOVE, draw=tube), -1)))
    design = CadFile(path, -6.5, plug={"inlet": (20, 7, 0)}, symmetric=True)
    assert design.solid_volume == pytest.approx(TUBE_VOLUME, rel=1e-5)
    assert design.plug_depths["inlet"] == pytest.approx(1.5, abs=0.02)


def test_the_mesh_of_an_arm_with_two_inlets_in_its_round_face(tmp_path: Path) -> None:
    """Beside the plane of symmetry, where both sides are filled, and in it; the base of the arm stays as it is."""
    beside, other = cylinder(20, 3.5, 3.5, 0, 8, 8, 1), cylinder(20, 3.5, -3.5, 0, 8, -8, 1)
    draw = drilled(beside, other, cylinder(40, 4, 0, 0, 10, 0, 1.5), draw=_half_disc)
    path = str(save(tmp_path / "arm.step", draw))
    whole = CadFile(str(save(tmp_path / "whole.step", _half_disc)), 1.5)
    design = CadFile(path, 1.5, plug={"beside": (20, 8 * 0.5**0.5, 8 * 0.5**0.5), "above": (40, 8, 0)})
    assert design.solid_volume == pytest.approx(whole.solid_volume, rel=2e-4)  # a mouth between two round faces
    body, expected = design.body(4.0), whole.body(4.0)
    assert set(body.mesh.faces) == set(expected.mesh.faces)
    assert body.mesh.enclosed_volume("cavity") == pytest.approx(expected.mesh.enclosed_volume("cavity"), rel=2e-3)


def test_what_is_not_an_inlet_in_a_round_face_is_refused(tmp_path: Path) -> None:
    path = str(save(tmp_path / "tube.step", drilled(ABOVE, draw=tube)))
    for point in ((30, 7, 0), (0, 0, 0), (20, -7, 0)):
        with pytest.raises(
            DesignError, match="lies in no opening of a flat face, nor in one of a round face that can be"
        ):
            CadFile(path, -6.5, plug={"inlet": point})
    with pytest.raises(DesignError, match=r"plug.again: the point .* lies in the inlet that plug.inlet has filled"):
        CadFile(path, -6.5, plug={"inlet": (20, 7, 0), "again": (20.5, 6.9, 0)})


def test_points_in_no_inlet_are_refused(tmp_path: Path) -> None:
    path = str(save(tmp_path / "inlet.step", BELOW))
    for point in ((20, 0, 0), (30, 1, 0), (90, 0, 0)):
        no_opening = r"plug.inlet: the point .* lies in no opening of a flat face, nor .*\(30, 0, 0\)"
        with pytest.raises(DesignError, match=no_opening):
            CadFile(path, 1.5, plug={"inlet": point})
    with pytest.raises(DesignError, match=r"curve: .* if the line crosses an inlet, .* plug: .*\(30, 0, 0\) mm"):
        CadFile(path, 1.5)
    with pytest.raises(DesignError, match=r"plug.again: the point .* lies in the inlet that plug.inlet has filled"):
        CadFile(path, 1.5, plug={"inlet": (30, 0, 0), "again": (30.5, 0, 0)})
    with pytest.raises(DesignError, match=r"plug.inlet: must be a point \(x, y, z\) in mm, not \(30, 0\)"):
        CadFile(path, 1.5, plug={"inlet": (30, 0)})


@pytest.mark.parametrize("is_half", [False, True])
def test_the_inlet_is_named_before_larger_openings_between_chambers(tmp_path: Path, is_half: bool) -> None:
    """The air in the plane of symmetry of a half body is no opening."""

    def with_partition(occ: Any) -> Any:
        partition = occ.cut([box(occ, (39, 2, -7), (41, 11, 7))], [cylinder(38, 6, 0, 4, 0, 0, 2.5)(occ)])[0]
        return occ.fuse(drilled(cylinder(30, -1, 3, 0, 5, 0, 1.2))(occ), partition)[0]

    path = str(save(tmp_path / "chambers.step", half(with_partition, 1) if is_half else with_partition))
    others = "" if is_half else r", \(41, 6, 0\) mm, \(39, 6, 0\) mm, \(30, 3, 3\) mm"
    with pytest.raises(DesignError, match=rf"have their centres at \(30, 0, 3\) mm{others}"):
        CadFile(path, 11, symmetric=is_half)


def test_the_foot_of_a_part_is_no_opening(tmp_path: Path) -> None:
    def with_boss(occ: Any) -> Any:
        return occ.fuse(BELOW(occ), [(3, occ.addCylinder(20, 12, 0, 0, 3, 0, 2.5))])[0]

    path = str(save(tmp_path / "boss.step", with_boss))
    with pytest.raises(DesignError, match=r"plug.inlet: .* behind which the air is wider at once"):
        CadFile(path, 11, plug={"inlet": (20, 12, 0)})
    with pytest.raises(DesignError) as refused:
        CadFile(path, 11)
    assert "(30, 0, 0)" in str(refused.value)
    assert "(20, 12, 0)" not in str(refused.value)


def test_both_sides_of_a_symmetric_body_may_be_named(tmp_path: Path) -> None:
    path = str(save(tmp_path / "sides.step", drilled(cylinder(30, 6, -9, 0, 0, 18, 1.5))))
    design = CadFile(path, 1.5, plug={"right": (30, 6, 7.5), "left": (30, 6, -7.5)})
    assert design.plug_depths == pytest.approx({"right": 2.5, "left": 2.5})
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)


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
