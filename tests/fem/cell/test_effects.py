"""Pressure of the air and contact with the mirror image on a part of a body between planes of mirror symmetry."""

import numpy as np
import pytest

from fem import SelfContact, StVenantKirchhoff
from fem.cell.air import AirPressure
from fem.cell.mirror_contact import MirrorContact, plane_pairs
from fem.discretisation import Discretisation
from fem.effects.effect import Term
from fem.effects.loads import enclosed_volume
from geometry import Mesh, PneuNet, Semicircular
from tests.pieces import end_piece, half_cell

MATERIAL = StVenantKirchhoff(1.2, 0.4)
DESIGN = PneuNet()


@pytest.fixture(scope="module")
def cell() -> Discretisation:
    return Discretisation.of(half_cell(DESIGN, 4.0).mesh, "p2p0")


def moved(space: Discretisation, size: float = 0.05) -> np.ndarray:
    return space.points + size * np.random.default_rng(3).standard_normal(space.points.shape)


def hessian(term: Term, x: np.ndarray) -> np.ndarray:
    blocks, size = term.blocks(x, 1.0, False), x.shape[0]
    dense = np.zeros((size, 3, size, 3))
    for row, column, value in zip(blocks.rows, blocks.columns, blocks.values, strict=True):
        dense[row, :, column] += value
        if row != column:
            dense[column, :, row] += value.T
    return dense.reshape(3 * size, 3 * size)


def gradient(term: Term, x: np.ndarray) -> np.ndarray:
    out = np.zeros_like(x)
    term.gradient(x, 1.0, out)
    return out


@pytest.mark.parametrize("effect", [AirPressure("cavity", 0.03), MirrorContact("gap", "tip", 3.0)])
def test_derivatives_are_those_of_the_potential(cell: Discretisation, effect) -> None:
    term, x = effect.bind(cell, MATERIAL), moved(cell)
    direction = np.random.default_rng(4).standard_normal(x.shape)
    step = 1e-5
    ahead, behind = x + step * direction, x - step * direction
    slope = (term.energy(ahead, 1.0) - term.energy(behind, 1.0)) / (2 * step)
    assert slope == pytest.approx(float(np.vdot(gradient(term, x), direction)), rel=1e-7)
    change = (gradient(term, ahead) - gradient(term, behind)) / (2 * step)
    matrix = hessian(term, x)
    np.testing.assert_allclose(matrix @ direction.ravel(), change.ravel(), atol=1e-6 * np.abs(change).max())
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())


def test_the_air_between_the_planes_is_that_of_the_drawing(cell: Discretisation) -> None:
    inside = (DESIGN.chamber_length - 2 * DESIGN.wall) / 2
    across = DESIGN.width / 2 - DESIGN.side_wall
    volume = inside * across * (DESIGN.strip + DESIGN.chamber_height - DESIGN.roof)
    volume += (DESIGN.wall + DESIGN.gap / 2) * DESIGN.channel**2 / 2
    assert -AirPressure("cavity", 1.0).bind(cell, MATERIAL).energy(cell.points, 1.0) == pytest.approx(volume, rel=1e-12)


def test_a_closed_cavity_has_the_volume_it_encloses() -> None:
    body = Semicircular(chambers=2).body(4.0)
    space = Discretisation.of(body.mesh, "p2p0")
    x = moved(space)
    x[space.surface("sym").unique_nodes, 2] = 0.0
    volume = -AirPressure("cavity", 1.0).bind(space, MATERIAL).energy(x, 1.0)
    assert volume == pytest.approx(enclosed_volume(space.surface("cavity"), x), rel=1e-10)


def test_walls_that_face_the_plane_are_paired_with_it(cell: Discretisation) -> None:
    pairs = plane_pairs(cell.surface("gap"), cell.surface("tip"), cell.points)
    wall = DESIGN.chamber_length / 2
    np.testing.assert_allclose(cell.points[pairs.nodes, 0], wall)
    np.testing.assert_allclose(pairs.gaps(cell.points), DESIGN.gap / 2, rtol=1e-12)
    assert pairs.area.sum() == pytest.approx(DESIGN.chamber_height * DESIGN.width / 2, rel=1e-12)


def test_inner_walls_of_an_end_piece_are_left_to_self_contact() -> None:
    space = Discretisation.of(end_piece(DESIGN, 3, 4.0).mesh, "p2p0")
    pairs = plane_pairs(space.surface("gap"), space.surface("tip"), space.points)
    last = DESIGN.gap + 2 * DESIGN.chamber_length + DESIGN.gap
    np.testing.assert_allclose(space.points[pairs.nodes, 0], last)


def test_a_wall_and_its_image_press_as_two_walls_do() -> None:
    """Two half cells with the gap between their chambers closed to 0.02 mm: each wall has the energy per area of a wall
    and its image."""
    cell = half_cell(DESIGN, 4.0).mesh
    image = cell.points * [-1.0, 1.0, 1.0] + [DESIGN.pitch, 0.0, 0.0]
    count = len(cell.points)
    both = Mesh(
        np.vstack([cell.points, image]),
        np.vstack([cell.tets, cell.tets + count]),
        {"gap": np.vstack([cell.faces["gap"], cell.faces["gap"] + count])},
    )
    half, whole = Discretisation.of(cell, "p1"), Discretisation.of(both, "p1")
    shift = DESIGN.gap / 2 - 0.01
    moved_half, moved_whole = half.points.copy(), whole.points.copy()
    moved_half[half.points[:, 0] < DESIGN.pitch / 2 - 1e-9, 0] += shift
    moved_whole[:, 0] += np.sign(DESIGN.pitch / 2 - whole.points[:, 0]) * shift
    mirror = MirrorContact("gap", "tip", 0.04).bind(half, MATERIAL)
    facing = SelfContact("gap", 0.04).bind(whole, MATERIAL)
    with_image = mirror.energy(moved_half, 1.0) / mirror.pairs.area.sum()
    assert with_image > 0.0
    assert facing.energy(moved_whole, 1.0) / facing.pairs.area.sum() == pytest.approx(with_image, rel=1e-9)
