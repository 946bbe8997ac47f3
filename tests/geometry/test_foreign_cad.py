"""Solids as other programs save them: other directions, several solids; inlets of solids, meshes and surfaces."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError, MeshFile, SurfaceFile
from geometry.files.cad import mirror
from pipeline.config.load import load_config
from pipeline.simulate.simulate import experiments_of
from pipeline.values.errors import InputError
from tests.foreign_bodies import (
    BAR_AIR,
    BAR_VOLUME,
    INLET,
    Draw,
    bar,
    bar_with_inlet,
    half_bar,
    meshed,
    standing_bar,
    tube,
    two_chambers,
    two_solids,
    write_mesh,
    write_surface,
)
from tests.step_bodies import box, in_inches, save


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cad")


@pytest.fixture(scope="module")
def step(folder: Path) -> Path:
    return save(folder / "bar.step", bar)


def check_bar(design: Any, rel: float = 1e-6, air: float = BAR_AIR) -> Any:
    assert design.extent == pytest.approx((60, 12, 15))
    assert design.solid_volume == pytest.approx(BAR_VOLUME + BAR_AIR - air, rel=rel)
    assert design.cavity_volumes == pytest.approx({"cavity": air}, rel=rel)
    mesh = design.body(5.0).mesh
    halves = 2 if "sym" in mesh.faces else 1
    assert halves * mesh.enclosed_volume("cavity") == pytest.approx(air, rel=max(rel, 1e-3))
    return mesh


def test_ends_and_cavity_need_not_be_given(step: Path) -> None:
    design = CadFile(str(step), 1.5)
    check_bar(design)
    assert (design.length, design.pitch, design.cavities) == (60, 6, ("cavity",))


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_small_body_may_be_in_another_unit(folder: Path, symmetric: bool) -> None:
    path, as_step = (in_inches(bar, folder / f"inches{suffix}") for suffix in (".brep", ".step"))
    for inches in (path, as_step):
        with pytest.raises(DesignError, match=r"curve: y = 1.5 mm lies outside the body, .*; is its unit right"):
            CadFile(str(inches), 1.5, symmetric=symmetric)
    check_bar(CadFile(str(path), 1.5, unit=25.4, symmetric=symmetric))
    with pytest.raises(DesignError, match=r"curve: y = 15 mm lies outside the body, .* to 12 mm$"):
        CadFile(str(path), 15.0, unit=25.4, symmetric=symmetric)


@pytest.mark.parametrize("symmetric", [True, False])
def test_other_directions(folder: Path, symmetric: bool) -> None:
    """The file's z is along the arm, its -y up."""
    path = save(folder / "standing.step", standing_bar)
    design = CadFile(str(path), 1.5, axes=("z", "-y", "x"), symmetric=symmetric)
    check_bar(design)
    with pytest.raises(DesignError, match=r"axes: \[z, -y, -x\] mirrors the body; write \[z, -y, x\]"):
        CadFile(str(path), 1.5, axes=("z", "-y", "-x"))


def knobbed(occ: Any) -> Any:
    """The bar with a knob at (50, 12, 4)."""
    return occ.fuse(bar(occ), [box(occ, (48, 12, 2), (52, 14, 6))])[0]


def test_the_clamp_at_the_other_end(folder: Path) -> None:
    path = save(folder / "knob.step", knobbed)
    design = CadFile(str(path), 1.5, clamp=60, tip=0, symmetric=False, air={"cavity": (50, 5, 1)})
    mesh = design.body(4.0).mesh
    top = mesh.points[mesh.points[:, 1] > 13]
    assert (top[:, 0].min(), top[:, 0].max()) == pytest.approx((8, 12))
    assert (top[:, 2].min(), top[:, 2].max()) == pytest.approx((-6, -2)), "turned about y, not mirrored"
    half = CadFile(str(save(folder / "plain.step", bar)), 1.5, clamp=60, tip=0)
    check_bar(half)
    with pytest.raises(DesignError, match=r"clamp: x = 70 mm lies outside the body, which reaches from 0 to 60 mm"):
        CadFile(str(path), 1.5, clamp=70, tip=0, symmetric=False)
    with pytest.raises(DesignError, match=r"air\.cavity: the point \(50, 1, 1\) mm lies in the material"):
        CadFile(str(path), 1.5, clamp=60, tip=0, symmetric=False, air={"cavity": (50, 1, 1)})
    assert (design.meshed_volume, half.meshed_volume) == (design.solid_volume, half.solid_volume / 2)
    one_half = save(folder / "one_half.step", half_bar)
    with pytest.raises(DesignError, match=r"symmetric, middle: the body reaches from z = 0 to 7.5 mm"):
        CadFile(str(one_half), 1.5, clamp=60, tip=0, symmetric=False)


def corner_of_the_file(folder: Path, kind: str) -> Path:
    """The bar with z from 0 to 15 mm in a file of some kind."""

    def draw(occ: Any) -> Any:
        solids = bar(occ)
        occ.translate(solids, 0, 0, 7.5)
        return solids

    if kind == "stl":
        return write_surface(folder / "corner.stl", draw, 50)
    if kind == "vtk":
        return write_mesh(folder / "corner.vtk", *meshed(draw, 5.0))
    return save(folder / f"corner.{kind}", draw)


@pytest.mark.parametrize("kind", ["step", "brep", "stl", "vtk"])
def test_a_body_with_its_origin_at_a_corner(kind: str, folder: Path) -> None:
    """It is not taken as one half of an arm with twice the material and twice the air."""
    path = str(corner_of_the_file(folder, kind))
    family = {"stl": SurfaceFile, "vtk": MeshFile}.get(kind, CadFile)
    with pytest.raises(DesignError, match=r"from z = 0 to 15 mm; .*write middle: 7\.5 mm for a whole arm"):
        family(path, 1.5)
    with pytest.raises(DesignError, match=r"middle: must be a length, not nan"):
        family(path, 1.5, middle=float("nan"))
    design = family(path, 1.5, middle=7.5, air={"cavity": (30, 5, 1)})
    check_bar(design)
    if family is CadFile:
        for ends in ({}, {"clamp": 60, "tip": 0}):
            with pytest.raises(DesignError, match=r"from z = -5 to 10 mm; .*write middle: 7\.5 mm .* 0 mm or 15 mm"):
                family(path, 1.5, middle=5.0, **ends)


def half_knobbed_below(occ: Any) -> Any:
    """The half z <= 0 of the same."""
    half = occ.intersect(bar(occ), [box(occ, (-1, -1, -8), (61, 20, 0))])[0]
    return occ.fuse(half, [box(occ, (48, 12, -6), (52, 14, 0))])[0]


@pytest.mark.parametrize("turned", [False, True])
def test_a_half_solid_below_is_the_same_arm(turned: bool, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its cells are compared by few points; `test_cad_mirror.py` takes as many as usual."""
    points_in_one = mirror._points_in_one
    monkeypatch.setattr(mirror, "_points_in_one", lambda *given: points_in_one(*given[:5], mirror.FEW))
    path = save(folder / "below.step", half_knobbed_below)
    clamp, tip = (60, 0) if turned else (0, 60)
    with pytest.raises(
        DesignError, match=r"from z = -7\.5 to 0 mm; .*write middle: -3\.75 mm for a whole arm, symmetric: true"
    ):
        CadFile(str(path), 1.5, clamp, tip)
    design = CadFile(str(path), 1.5, clamp, tip, {"cavity": (50, 5, -1)}, symmetric=True)
    assert design.solid_volume == pytest.approx(BAR_VOLUME + 2 * 4 * 2 * 6, rel=1e-6)
    mesh = design.body(4.0).mesh
    assert (mesh.points[:, 2].min(), mesh.points[:, 2].max()) == pytest.approx((0, 7.5))
    top = mesh.points[mesh.points[:, 1] > 13]
    assert (top[:, 0].min(), top[:, 0].max()) == pytest.approx((8, 12) if turned else (48, 52))


def test_solids_that_touch_are_united(folder: Path) -> None:
    path = save(folder / "pair.step", two_solids)
    with pytest.raises(DesignError, match=r"holds 2 solids, around .* unite: true"):
        CadFile(str(path), 1.5)
    check_bar(CadFile(str(path), 1.5, unite=True))
    apart = save(folder / "apart.step", lambda occ: (bar(occ), box(occ, (0, 20, -2), (60, 24, 2))))
    with pytest.raises(DesignError, match=r"unite: the 2 solids of the file are 2 parts that do not touch, around \("):
        CadFile(str(apart), 1.5, unite=True)


@pytest.mark.parametrize("symmetric", [True, False])
def test_air_that_is_drawn_as_a_solid_is_left_out(folder: Path, symmetric: bool) -> None:
    def with_air(occ: Any) -> None:
        two_chambers(occ)
        box(occ, (3, 3, -5), (29, 10, 5))
        box(occ, (31, 3, -5), (57, 10, 5))

    air: Any = {"left": (10, 6, 0), "right": (50, 6, 0)}
    design = CadFile(str(save(folder / "air.step", with_air)), 1.5, air=air, symmetric=symmetric)
    assert design.left_out == "(16, 6.5, 0); (44, 6.5, 0)"
    assert design.cavity_volumes == pytest.approx(dict.fromkeys(air, 26.0 * 7 * 10))
    assert design.solid_volume == pytest.approx(60 * 12 * 15 - 2 * 26 * 7 * 10)
    insert = save(folder / "insert.step", lambda occ: (two_chambers(occ), box(occ, (4, 3, -5), (28, 10, 5))))
    with pytest.raises(
        DesignError, match=r"file: .* holds 2 solids, around \(.*\); \(16, 6.5, 0\); leave out one of air"
    ):
        CadFile(str(insert), 1.5, air=air)


@pytest.mark.parametrize("symmetric", [True, False])
def test_an_inlet_at_the_clamp_of_a_solid_is_closed(folder: Path, symmetric: bool) -> None:
    path = save(folder / "inlet.step", bar_with_inlet)
    with pytest.raises(DesignError, match=r"air, file: .* no closed cavity: .* plug: true"):
        CadFile(str(path), 1.5, symmetric=symmetric)
    design = CadFile(str(path), 1.5, symmetric=symmetric, plug=True)
    mesh = check_bar(design, rel=1e-6, air=BAR_AIR + INLET)
    assert mesh.area("clamp") * (2 if symmetric else 1) == pytest.approx(180 - np.pi * 1.5**2, rel=1e-3)
    named = CadFile(str(path), 1.5, symmetric=symmetric, plug=True, air={"cavity": (30, 5, 0)})
    assert named.cavity_volume == pytest.approx(BAR_AIR + INLET, rel=1e-6)
    with pytest.raises(DesignError, match="no closed cavity: close its inlet"):
        CadFile(str(path), 1.5, symmetric=symmetric, plug=True, clamp=60, tip=0)


@pytest.mark.parametrize("kind", ["vtu", "stl"])
def test_an_inlet_at_the_clamp_of_a_mesh_is_closed(folder: Path, kind: str) -> None:
    if kind == "stl":
        path, reader = write_surface(folder / "inlet.stl", bar_with_inlet, 50, around=48), SurfaceFile
    else:
        path, reader = write_mesh(folder / "inlet.vtu", *meshed(bar_with_inlet, 4.0)), MeshFile
    with pytest.raises(DesignError, match=r"the air is open at the clamp, around \[0 mm, 6 mm, .*; write plug: true"):
        reader(str(path), 1.5)
    for plug in (True, False):
        with pytest.raises(DesignError, match=r"the air is open at the tip, around \[0 mm, 6 mm, 0 mm\]"):
            reader(str(path), 1.5, clamp=60, tip=0, plug=plug)
    if kind == "stl":  # what is written is accepted
        filled = SurfaceFile(str(path), 1.5, clamp=60, tip=0, plug={"inlet": (0, 6, 0)})
        assert filled.cavity_volume == pytest.approx(BAR_AIR, rel=1e-3)
    design = reader(str(path), 1.5, plug=True)
    assert design.cavity_volume == pytest.approx(BAR_AIR + INLET, rel=2e-3)
    mesh = design.body(4.0).mesh
    assert mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=2e-3)
    assert mesh.area("clamp") == pytest.approx(180 - np.pi * 1.5**2, rel=1e-2)  # elements of 4 mm around the hole
    named = reader(str(path), 1.5, plug=True, air={"cavity": (1, 6, 0)})
    assert named.cavity_volume == pytest.approx(design.cavity_volume, rel=1e-9)
    with pytest.raises(DesignError, match=r"the point \(-1, 6, 0\) mm lies behind the plane of the clamp"):
        reader(str(path), 1.5, plug=True, air={"cavity": (-1, 6, 0)})


def test_inlets_at_both_ends_of_a_surface_are_filled(folder: Path) -> None:
    """One after the other, as the refusals say."""

    def open_at_both_ends(occ: Any) -> Any:
        return occ.cut(bar_with_inlet(occ), [(3, occ.addCylinder(55, 6, 0, 10, 0, 0, 1.5))])[0]

    path = str(write_surface(folder / "both.stl", open_at_both_ends, 50, around=48))
    with pytest.raises(DesignError, match=r"no closed cavity: .* several inlets"):
        SurfaceFile(path, 1.5)
    ends = {"clamp": (0.0, 6.0, 0.0), "tip": (60.0, 6.0, 0.0)}
    for given, other, at in (("clamp", "tip", 60), ("tip", "clamp", 0)):
        with pytest.raises(DesignError, match=rf"open at the {other}, .* plug: {{inlet: \[{at} mm, 6 mm, 0 mm\]"):
            SurfaceFile(path, 1.5, plug={given: ends[given]})
    assert SurfaceFile(path, 1.5, plug=ends).cavity_volume == pytest.approx(BAR_AIR, rel=1e-3)


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
