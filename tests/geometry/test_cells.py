"""Cells of a body from a STEP file: the pieces are those of the family that draws the same body; lopsided ones."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, CellPlanes, DesignError, MeshError, PneuNet
from geometry.files.cad import cad_file
from tests.pieces import end_piece, half_cell, tip_piece
from tests.step_bodies import box, pneunet_as_step, save

NET = PneuNet(chambers=3)
#: in the middle of the second chamber, and of the gap behind it
PLANES = CellPlanes(16, 21)


def design_of(path: Path, planes: CellPlanes = PLANES, **changes: Any) -> CadFile:
    spec = {"clamp": 0, "tip": NET.length, "curve": NET.curve_y, "air": {"cavity": (6, 4, 0)}, "cell": planes}
    return CadFile(str(path), **(spec | changes))


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return pneunet_as_step(tmp_path_factory.mktemp("net") / "net.step", NET)


def test_pieces_of_a_step_body_are_those_of_the_family(drawn: Path) -> None:
    own = design_of(drawn)
    assert (own.cells.first, own.cells.half_pitch, own.cells.half_cells, own.pitch) == pytest.approx((6, 5, 4, 10))
    assert own.body(5.0).mesh.volume == pytest.approx(NET.solid_volume / 2, rel=1e-9)
    assert own.body(5.0).mesh.enclosed_volume("cavity") == pytest.approx(NET.cavity_volume / 2, rel=1e-9)
    pieces = [(half_cell(own, 5.0), half_cell(NET, 5.0))]
    pieces += [(kind(own, 3, 5.0), end_piece(NET, 3, 5.0)) for kind in (end_piece, tip_piece)]
    for ours, theirs in pieces:
        assert ours.length == pytest.approx(theirs.length)
        assert ours.mesh.volume == pytest.approx(theirs.mesh.volume, rel=1e-9)
        for name in ("clamp", "tip", "cavity", "sym"):
            assert ours.mesh.area(name) == pytest.approx(theirs.mesh.area(name), rel=1e-9)
        for name, x in (("clamp", 0.0), ("tip", ours.length)):
            assert np.ptp(ours.mesh.points[np.unique(ours.mesh.faces[name]), 0] - x) < 1e-9


def test_the_far_end_may_be_another_one(tmp_path: Path) -> None:
    """A block on the last chamber makes the two ends differ; the cells between them have equal meshes."""
    net = PneuNet(chambers=4)
    path = pneunet_as_step(tmp_path / "tip.step", net, knob=((33, 17, -2), (35, 19, 2)))
    own = design_of(path, tip=net.length)
    assert own.cells.half_cells == 4  # the last chamber with the half gap before it belongs to the far end
    end, far, body = end_piece(own, 1, 6.0).mesh, tip_piece(own, 1, 6.0).mesh, own.body(6.0).mesh
    cell = half_cell(own, 6.0).mesh
    assert len(body.tets) == len(end.tets) + len(far.tets) + 2 * len(cell.tets)
    assert body.volume == pytest.approx((net.solid_volume + 16) / 2, rel=1e-9)
    assert far.volume - end.volume == pytest.approx(8 + 2 * cell.volume, rel=1e-9)
    assert far.points[:, 1].max() == pytest.approx(19)


def test_planes_in_either_order_and_a_body_that_is_meshed_on_both_sides(drawn: Path) -> None:
    own = design_of(drawn, CellPlanes(21, 16), symmetric=False)
    assert (own.cells.first, own.cells.half_cells) == pytest.approx((11, 2))
    piece = end_piece(own, 1, 6.0)
    assert not piece.half
    assert piece.mesh.volume == pytest.approx(2 * end_piece(NET, 2, 6.0).mesh.volume, rel=1e-9)


REFUSED: list[tuple[CellPlanes, str]] = [
    (CellPlanes(15, 21), r"not symmetric about the plane x = 15 mm: the material beside it differs, around \("),
    (CellPlanes(16, 80), r"cell\.to: x = 80 mm lies outside the arm, which reaches from 0 to 32 mm"),
    (CellPlanes(16, 16), "the planes are 0 mm apart"),
    (CellPlanes(1, 6), "beside x = 1 mm is no room for a half cell"),
]


@pytest.mark.parametrize(("planes", "sentence"), REFUSED)
def test_planes_that_are_not_those_of_a_cell(planes: CellPlanes, sentence: str, drawn: Path) -> None:
    with pytest.raises(DesignError, match=sentence) as caught:
        design_of(drawn, planes)
    assert caught.value.keys[0].startswith("cell")


def test_a_lopsided_cell_is_refused_with_what_differs_and_where(tmp_path: Path) -> None:
    path = pneunet_as_step(tmp_path / "net.step", NET, ((18, 17, -2), (20, 18, 2)))
    with pytest.raises(DesignError, match=r"plane x = 16 mm: .* differs, around \(1\d\.?\d*, 17\.\d+, ") as caught:
        design_of(path)
    assert caught.value.keys == ("cell",)


def test_a_cavity_that_does_not_go_through_the_cells_is_refused(tmp_path: Path) -> None:
    def draw(occ: Any) -> None:
        bar = box(occ, (0, 0, -5), (42, 8, 5))
        occ.cut([bar], [box(occ, (x, 2, -3), (x + 8, 6, 3)) for x in (2, 12, 22, 32)])

    path = save(tmp_path / "closed.step", draw)
    air = {f"cavity{k}": (6.0 + 10.0 * k, 4.0, 0.0) for k in range(4)}
    with pytest.raises(DesignError, match="does not go through the cell; equal cells are in the same cavities"):
        half_cell(CadFile(str(path), 1, 0, 42, air, cell=PLANES), 6.0)


LONG = PneuNet(chambers=5)


def test_equal_chambers_are_the_cells_unless_a_length_is_given(tmp_path: Path) -> None:
    path = str(pneunet_as_step(tmp_path / "net.step", LONG))
    own = CadFile(path, LONG.curve_y)
    assert (own.cells.first, own.cells.half_pitch, own.cells.half_cells) == pytest.approx((6, 5, 8), abs=1e-9)
    assert half_cell(own, 5.0).mesh.volume == pytest.approx(half_cell(LONG, 5.0).mesh.volume, rel=1e-9)
    turned = CadFile(path, LONG.curve_y, clamp=LONG.length, tip=0.0)
    assert turned.cells == own.cells
    assert CadFile(path, LONG.curve_y, cell=10.0).cells is None


def test_three_chambers_are_cells_though_too_few_for_five_parameters(drawn: Path) -> None:
    own, given = CadFile(str(drawn), NET.curve_y), design_of(drawn)
    assert own.cells == given.cells
    assert (own.pitch, given.pitch) == (pytest.approx(3.2), 10)
    assert "five parameters need" in own.reason_for_pitch


def chambers_in_a_bar(occ: Any, *, channel: bool = True, notched: bool = False) -> None:
    bar = box(occ, (0, 0, -6), (70, 10, 6))
    air = [box(occ, (4 + 10 * k, 2, -4), (10 + 10 * k, 8, 4)) for k in range(6)]
    air += [box(occ, (6, 3, -1), (60, 4, 1))] if channel else []
    notches = [box(occ, (5 + 10 * k, 9, -6), (6 + 10 * k, 10, 6)) for k in range(6)] if notched else []
    occ.cut([bar], air + notches)


def test_equal_chambers_that_are_no_cells(tmp_path: Path) -> None:
    lopsided = CadFile(str(save(tmp_path / "lop.step", lambda occ: chambers_in_a_bar(occ, notched=True))), 1.0)
    assert (lopsided.repeats, lopsided.pitch) == (False, pytest.approx(10.0))
    assert "are 10 mm apart, but the body is not symmetric about the plane x = 37 mm" in lopsided.why_no_cell
    air = {f"c{k}": (7.0 + 10.0 * k, 5.0, 0.0) for k in range(6)}
    path = save(tmp_path / "apart.step", lambda occ: chambers_in_a_bar(occ, channel=False))
    apart = CadFile(str(path), 1.0, air=air)
    assert not apart.repeats
    assert "but the cavity c0 does not go through all of them" in apart.why_no_cell


def test_an_arm_with_one_section_has_cells_and_one_with_a_rib_has_none(tmp_path: Path) -> None:
    def draw(occ: Any, rib: tuple[int, int] | None = None) -> None:
        body = [box(occ, (0, 0, -6), (80, 10, 6))]
        if rib is not None:
            body, _ = occ.fuse(body, [box(occ, (rib[0], 9, -6), (rib[1], 11, 6))])
        occ.cut(body, [box(occ, (3, 2, -4), (77, 8, 4))])

    own = CadFile(str(save(tmp_path / "bar.step", draw)), 1.0)
    assert own.cells.half_cells == 16
    assert own.body(5.0).mesh.volume == pytest.approx((80 * 10 * 12 - 74 * 6 * 8) / 2, rel=1e-9)
    ribbed = CadFile(str(save(tmp_path / "rib.step", lambda occ: draw(occ, (41, 43)))), 1.0)
    assert not ribbed.repeats
    assert "name the planes of one" in ribbed.why_no_cell


def test_a_cavity_that_begins_just_behind_a_plane_gets_no_walls_between_cells(tmp_path: Path) -> None:
    def draw(occ: Any) -> None:
        occ.cut([box(occ, (0, 0, -6), (80, 10, 6))], [box(occ, (8.0001, 2, -4), (72, 8, 4))])

    path = str(save(tmp_path / "bar.step", draw))
    own, whole = CadFile(path, 1.0), CadFile(path, 1.0, cell=8.0)
    assert own.repeats
    assert own.body(5.0).mesh.area("cavity") == pytest.approx(whole.body(5.0).mesh.area("cavity"), rel=1e-4)


def test_cells_that_cannot_be_meshed_are_left_out(drawn: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise MeshError("flat")

    monkeypatch.setattr(cad_file, "mesh_cells", fails)
    assert CadFile(str(drawn), NET.curve_y).body(5.0).mesh.volume == pytest.approx(NET.solid_volume / 2, rel=1e-9)
    with pytest.raises(MeshError, match="flat"):
        design_of(drawn).body(5.0)


def test_a_lane_of_chambers_beside_one_without(tmp_path: Path) -> None:
    def draw(occ: Any) -> None:
        air = [box(occ, (4 + 10 * k, 2, -4), (10 + 10 * k, 8, 4)) for k in range(7)]
        air += [box(occ, (6, 3, -1), (70, 4, 1)), box(occ, (3, 11, -4), (77, 14, 4))]
        occ.cut([box(occ, (0, 0, -6), (80, 16, 6))], air)

    path = str(save(tmp_path / "lanes.step", draw))
    own = CadFile(path, 1.0, air={"chambers": (7.0, 5.0, 0.0), "plain": (40.0, 12.0, 0.0)})
    assert (own.cells.first, own.cells.half_pitch, own.cells.half_cells) == pytest.approx((7, 5, 12), abs=1e-6)
    assert own.pitch == pytest.approx(10.0)
    assert set(half_cell(own, 5.0).mesh.faces) >= {"chambers", "plain"}
