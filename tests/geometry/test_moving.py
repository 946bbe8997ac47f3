"""Meshes that follow the dimensions of their drawing."""

import numpy as np
import pytest

from geometry import DesignError
from geometry.families import BisectedCircle, PneuNet, Rectangular, Semicircular, SemicircularSingle
from geometry.families.design import SymmetricDesign
from geometry.grading import OFF
from geometry.meshing.moving import Movement, moved

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
