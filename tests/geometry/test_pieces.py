"""The half cell and the end pieces of a body: the same elements as in the body, between mirror planes."""

import numpy as np
import pytest

from geometry import GRADINGS, BisectedCircle, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import SymmetricDesign
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
