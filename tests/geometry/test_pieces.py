"""The half cell and the end pieces of a body, and meshes that follow the dimensions of their drawing."""

import numpy as np
import pytest

from geometry import GRADINGS, BisectedCircle, DesignError, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import SymmetricDesign
from geometry.grading import OFF
from geometry.meshing.moving import moved
from tests.pieces import end_piece, half_cell

ONE_CAVITY = Rectangular(1, 28.0, 22.0, 86.0, 2.0, 1.5, 4.0, 1.5, 1.5)
DESIGNS = (
    PneuNet(),
    Semicircular(),
    SemicircularSingle(),
    BisectedCircle(),
    PneuNet(chambers=4, fillet=0.5),
    ONE_CAVITY,
)


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: f"{design.family}-{design.length:g}mm")
def test_pieces_add_up_to_the_body(design: SymmetricDesign) -> None:
    body, cell = design.body(4.0), half_cell(design, 4.0)
    ends = [end_piece(design, count, 4.0) for count in (0, 1, 3)]
    inner = round((body.length - 2 * ends[0].length) / cell.length)
    assert cell.length == pytest.approx(design.pitch / 2)
    assert inner * cell.length + 2 * ends[0].length == pytest.approx(body.length)
    assert len(body.mesh.tets) == 2 * len(ends[0].mesh.tets) + inner * len(cell.mesh.tets)
    assert body.mesh.volume == pytest.approx(2 * ends[0].mesh.volume + inner * cell.mesh.volume, rel=1e-12)
    for count, end in zip((0, 1, 3), ends, strict=True):
        assert end.length == pytest.approx(ends[0].length + count * cell.length)
        assert end.mesh.volume == pytest.approx(ends[0].mesh.volume + count * cell.mesh.volume, rel=1e-12)


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: f"{design.family}-{design.length:g}mm")
def test_every_vertex_of_an_end_piece_is_one_of_the_body(design: SymmetricDesign) -> None:
    rows = {tuple(row) for row in np.round(design.body(4.0).mesh.points, 9) + 0.0}
    piece = {tuple(row) for row in np.round(end_piece(design, 3, 4.0).mesh.points, 9) + 0.0}
    assert piece <= rows


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: f"{design.family}-{design.length:g}mm")
def test_planes_of_a_half_cell_lie_exactly_at_its_ends(design: SymmetricDesign) -> None:
    cell = half_cell(design, 4.0)
    for name, x in (("clamp", 0.0), ("tip", cell.length)):
        nodes = np.unique(cell.mesh.faces[name])
        np.testing.assert_array_equal(cell.mesh.points[nodes, 0], x)


def test_a_flat_element_of_gmsh_does_not_end_the_process() -> None:
    """HXT leaves an element with its corners in one plane in this cell, at which Netgen's optimization crashes."""
    design = Rectangular(8, 14.2, 12.9, 5.71, 2.2, 2.3, 1.89, 1.9, 1.69, 1.19)
    cell = half_cell(design, 1.95, GRADINGS["walls"])
    assert cell.mesh.quality.minimum > 0.1
    body = design.body(4.0)
    ends = 2 * end_piece(design, 0, 4.0).mesh.volume
    half_cells = round((body.length - 2 * end_piece(design, 0, 4.0).length) / cell.length)
    assert cell.mesh.volume == pytest.approx((body.mesh.volume - ends) / half_cells, rel=1e-12)


#: mm, of the dimension in difference quotients of the mesh
STEP = 1e-4
MOVED = [PneuNet(), PneuNet(fillet=0.5), Semicircular(), SemicircularSingle(), BisectedCircle(), Rectangular()]


@pytest.mark.parametrize("design", MOVED, ids=lambda design: f"{design.family}{getattr(design, 'fillet', 0) or ''}")
def test_volumes_change_as_those_of_the_drawing(design: SymmetricDesign) -> None:
    """Solid and air have exact formulas; those of round walls are met to the elements' approximation of the arc."""
    repetition = design.repetition(4.0, OFF)
    found = design.movements(repetition)
    assert set(found) == set(design.dimensions)
    for name, movement in found.items():
        less, more = (movement.moved(repetition, sign * STEP).mesh() for sign in (-1.0, 1.0))
        drawn = [design.with_dimension(name, design.dimensions[name] + sign * STEP) for sign in (-1.0, 1.0)]
        solid = 2.0 * (more.volume - less.volume)
        air = 2.0 * (more.enclosed_volume("cavity") - less.enclosed_volume("cavity"))
        nothing = 1e-5 * design.solid_volume / design.dimensions[name] * STEP
        assert solid == pytest.approx(drawn[1].solid_volume - drawn[0].solid_volume, rel=1e-3, abs=nothing)
        assert air == pytest.approx(drawn[1].cavity_volume - drawn[0].cavity_volume, rel=1e-3, abs=nothing)


def test_pieces_of_a_moved_mesh_have_the_planes_of_the_changed_design() -> None:
    design = PneuNet()
    repetition = design.repetition(4.0, OFF)
    movement = design.movements(repetition)["chamber_length"]
    pieces, changed = movement.moved(repetition, 0.1), design.with_dimension("chamber_length", 8.1)
    assert pieces.half_pitch == pytest.approx(changed.pitch / 2.0, abs=1e-12)
    assert np.ptp(pieces.half_cell().points[:, 0]) == pytest.approx(changed.pitch / 2.0, abs=1e-12)
    assert np.ptp(pieces.end_piece(2).points[:, 0]) == pytest.approx(changed.gap + 8.1 / 2.0 + changed.pitch)


@pytest.mark.parametrize(
    ("design", "changes"),
    [
        (PneuNet(), {"wall": 0.25, "side_wall": -0.5, "gap": 0.4, "base": 0.5}),
        (Semicircular(), {"wall": -0.2, "radius": 1.8, "base": -0.4}),
    ],
)
def test_several_dimensions_move_by_a_quarter(design: SymmetricDesign, changes: dict[str, float]) -> None:
    """Volumes are those of the drawing, of round walls to the elements' approximation of the arc."""
    repetition = design.repetition(4.0, OFF)
    mesh, drawn = moved(repetition, design.movements(repetition), changes).mesh(), design
    for name, change in changes.items():
        drawn = drawn.with_dimension(name, design.dimensions[name] + change)
    assert 2.0 * mesh.volume == pytest.approx(drawn.solid_volume, rel=2e-3)
    assert 2.0 * mesh.enclosed_volume("cavity") == pytest.approx(drawn.cavity_volume, rel=2e-3)
    assert mesh.volumes.min() > 0.0


def test_a_dimension_at_its_bound_has_no_velocity() -> None:
    """A fillet of the smallest radius cannot become smaller."""
    design = PneuNet(fillet=0.1)
    refused = design.movements(design.repetition(4.0, OFF))["fillet"]
    assert isinstance(refused, DesignError)
    assert refused.keys == ("fillet",)
