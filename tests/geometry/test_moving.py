"""Meshes that follow the dimensions of their drawing."""

import numpy as np
import pytest

from geometry import DesignError
from geometry.families import BisectedCircle, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import SymmetricDesign
from geometry.grading import OFF
from geometry.meshing.moving import Movement

#: mm, of the dimension in difference quotients of the mesh
STEP = 1e-4
DESIGNS = [PneuNet(), PneuNet(fillet=0.5), Semicircular(), SemicircularSingle(), BisectedCircle(), Rectangular()]


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: f"{design.family}{getattr(design, 'fillet', 0) or ''}")
def test_volumes_change_as_those_of_the_drawing(design: SymmetricDesign) -> None:
    """Solid and air have exact formulas; those of round walls are met to the elements' approximation of the arc."""
    repetition = design.repetition(4.0, OFF)
    found = design.movements(repetition)
    assert set(found) == set(design.dimensions)
    for name, movement in found.items():
        assert isinstance(movement, Movement)
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
    assert isinstance(movement, Movement)
    moved, changed = movement.moved(repetition, 0.1), design.with_dimension("chamber_length", 8.1)
    assert moved.half_pitch == pytest.approx(changed.pitch / 2.0, abs=1e-12)
    assert np.ptp(moved.half_cell().points[:, 0]) == pytest.approx(changed.pitch / 2.0, abs=1e-12)
    assert np.ptp(moved.end_piece(2).points[:, 0]) == pytest.approx(changed.gap + 8.1 / 2.0 + changed.pitch)


def test_a_dimension_at_its_bound_has_no_velocity() -> None:
    """A fillet of the smallest radius cannot become smaller."""
    design = PneuNet(fillet=0.1)
    refused = design.movements(design.repetition(4.0, OFF))["fillet"]
    assert isinstance(refused, DesignError)
    assert refused.keys == ("fillet",)
