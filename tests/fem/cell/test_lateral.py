"""Rigidities out of the plane against those of prismatic bars, and against equilibria out of the plane."""

import numpy as np
import pytest

from fem import Effect, Model, NewtonOptions, PathOptions, SharedPlane, StrainLimitingLayer, StVenantKirchhoff, follow
from fem.cell.lateral import LateralRigidities, clamped_compliance, lateral_rigidities
from fem.cell.piece import BendingPiece
from fem.cell.sideways import Bent, Place, SlidingWalls, Twisted
from fem.supports import Fixed
from geometry import Body, Mesh, PneuNet
from geometry.arrays import Array
from geometry.curved import CurvedEdges
from geometry.topology import EDGES
from tests.bodies import box, bricks, named, on_plane
from tests.pieces import half_cell
from tests.quotients import quotient

E, NU = 1.2, 0.3
G = E / 2 / (1 + NU)
LAW = StVenantKirchhoff(E=E, nu=NU)
CELL = half_cell(PneuNet(), 4.0)
SOFT = StVenantKirchhoff(E=E, nu=0.495)


def rigidities(mesh: Mesh, length: float, *effects: Effect) -> LateralRigidities:
    body = Body(mesh, "bar", length, 2 * length, 0.0, True, ())
    piece = BendingPiece(body, LAW, "mirror", "p2", pressures={}, effects=effects)
    return lateral_rigidities(piece, piece.rest())


def half(mesh: Mesh) -> dict[str, Array]:
    return {"clamp": mesh.faces["left"], "tip": mesh.faces["right"], "sym": mesh.faces["back"]}


def prism(height: float, width: float, counts: tuple[int, int]) -> Mesh:
    mesh = box((1, *counts), (2.0, height, width / 2))
    return Mesh(mesh.points, mesh.tets, half(mesh))


def cylinder(radius: float, count: int) -> Mesh:
    """Half of one: a box on whose sections half a square is mapped to half a circle."""
    mesh = box((1, 2 * count, count), (2.0, 2.0, 1.0))

    def mapped(points: Array) -> Array:
        x, y, z = points.T
        return np.column_stack(
            [x, radius * (y - 1) * np.sqrt(1 - z**2 / 2), radius * z * np.sqrt(1 - (y - 1) ** 2 / 2)]
        )

    edges = np.unique(np.sort(mesh.tets[:, EDGES].reshape(-1, 2), axis=1), axis=0)
    points, middles = mapped(mesh.points), mapped(mesh.points[edges].mean(axis=1))
    curved = np.abs(middles - points[edges].mean(axis=1)).max(axis=1) > 1e-12
    return Mesh(points, mesh.tets, half(mesh), CurvedEdges(edges[curved], middles[curved]))


def tube(side: float, wall: float) -> Mesh:
    """Half a square tube."""
    inner = side - 2 * wall
    y = np.concatenate([[0.0], np.linspace(wall, side - wall, 11), [side]])
    z = np.concatenate([np.linspace(0.0, inner / 2, 6), [side / 2]])
    middle_y, middle_z = (y[1:] + y[:-1]) / 2, (z[1:] + z[:-1]) / 2
    filled = ~((np.abs(middle_y - side / 2) < inner / 2)[:, None] & (middle_z < inner / 2)[None])
    mesh = bricks(filled[None], [np.array([0.0, 1.0]), y, z])
    return named(mesh, clamp=on_plane(mesh, 0, 0.0), tip=on_plane(mesh, 0, 1.0), sym=on_plane(mesh, 2, 0.0))


@pytest.mark.parametrize(
    ("height", "width", "counts", "torsion"), [(4, 4, (8, 4), 0.1406 * 4), (8, 4, (8, 3), 0.2287 * 8)]
)
def test_a_rectangle(height: float, width: float, counts: tuple[int, int], torsion: float) -> None:
    found = rigidities(prism(height, width, counts), 2.0)
    assert found.bending == pytest.approx(E * height * width**3 / 12, rel=1e-6)
    assert found.torsion == pytest.approx(G * torsion * width**3, rel=2e-3)
    assert found.twist_axis == pytest.approx(height / 2, abs=1e-3)
    assert found.unstable == 0


def test_a_layer_adds_the_bending_in_its_plane_and_its_own_torsion() -> None:
    """In the middle of a square, where the section does not warp: E t w^3 / 12, and G t^3 w / 3 of a thin strip."""
    mesh, stiff, thickness, width = prism(4.0, 4.0, (8, 4)), 100 * E, 0.2, 4.0
    found = rigidities(mesh, 2.0, StrainLimitingLayer(mesh.plane(1, 2.0), thickness, stiff, NU))
    # one stress point of each triangle of the layer, four across half the width
    assert found.bending == pytest.approx((E * 4.0 + stiff * thickness) * width**3 / 12, rel=1e-2)
    own = 100 * G * thickness**3 * width / 3
    assert found.torsion == pytest.approx(G * 0.1406 * 4 * width**3 + own, rel=4e-3)
    assert own > 0.02 * found.torsion


def test_a_circle() -> None:
    found = rigidities(cylinder(2.0, 4), 2.0)
    assert found.bending == pytest.approx(E * np.pi * 16 / 4, rel=1e-3)
    assert found.torsion == pytest.approx(G * np.pi * 16 / 2, rel=2e-3)
    assert found.twist_axis == pytest.approx(0.0, abs=1e-3)


def test_a_thin_closed_tube_twists_as_bredt_says() -> None:
    found = rigidities(tube(10.0, 0.5), 1.0)
    assert found.bending == pytest.approx(E * (10.0**4 - 9.0**4) / 12, rel=1e-6)
    assert found.torsion == pytest.approx(G * 0.5 * 9.5**3, rel=0.05)


def bent(angle: float, pressure: float = 0.0) -> tuple[Bent, Array]:
    """A cell whose plane tilts, held against roll at two nodes, and these nodes (2, 3)."""
    piece = BendingPiece(CELL, SOFT, "mirror", dhat=0.04)
    column = piece.space.points[piece.space.surface("clamp").unique_nodes]
    column = column[np.abs(column[:, 2]) < 1e-9]
    ends = column[[np.argmin(column[:, 1]), np.argmax(column[:, 1])]]
    place = Place(piece, piece.solve(pressure, angle, piece.rest()))
    return Bent(place, [Fixed("clamp", "x"), Fixed(ends, "z")]), ends


def test_the_moment_of_a_tilt_is_that_of_neighbouring_equilibria() -> None:
    """The whole cell, bent in its plane, with its plane tilted out of it to either side."""
    angle, tilt, tight = -0.06, 2e-3, PathOptions(NewtonOptions(tolerance=1e-10))
    found, ends = bent(angle)
    body = CELL.full()

    def moment(sign: float) -> float:
        b = sign * tilt
        normal = (np.cos(angle) * np.cos(b), np.sin(angle) * np.cos(b), -np.sin(b))
        supports = [Fixed("clamp", "x"), Fixed(ends, "z"), Fixed(ends[:1], "y"), SharedPlane("tip", normal)]
        step = follow(Model(body.mesh, SOFT, supports, []), [1.0], tight).steps[-1]
        nodes = step.space.surface("tip").unique_nodes
        levers = np.cross([-np.sin(angle), np.cos(angle), 0.0], step.positions[nodes])
        return float(np.vdot(step.gradient[nodes], levers))

    assert 2.0 * found.moment == quotient(moment(1.0), moment(-1.0), 2 * tilt).within(rel=1e-3)


@pytest.mark.parametrize(("angle", "pressure"), [(-0.06, 0.02), (0.0, 0.02)])
def test_turning_a_cell_under_pressure_as_a_rigid_body_takes_no_forces(angle: float, pressure: float) -> None:
    found, _ = bent(angle, pressure)
    turned = found.place.turned(np.array([1.0, 0.0, 0.0]))
    forces = found.equations.forces(turned) - np.sin(angle) * (found.rim - found.carried)
    left = found.equations.system.constraints.reduce(forces)
    assert np.abs(left).max() < 1e-6 * np.abs(found.forces).max()
    assert np.sin(angle) == 0.0 or np.abs(np.sin(angle) * found.rim).max() > 1e-4


def test_turning_walls_that_touch_their_images_as_a_rigid_body_takes_no_forces() -> None:
    """About y, by which the planes of twisted cells tilt; what is left is the turn of half a gap, 0.02 mm."""
    piece = BendingPiece(CELL, SOFT, "mirror", dhat=0.04)
    place = Place(piece, piece.solve(0.03, 0.0, piece.rest()))
    assert place.at.touches
    points, nodes = piece.space.points, place.start
    side = points[nodes[np.argmax(points[nodes, 2])]]
    found = Twisted(place, [Fixed("clamp", "yz"), Fixed(side, "x")])
    turned = place.turned(np.array([0.0, 1.0, 0.0]))
    forces = found.equations.forces(turned) - place.at.distance * found.rims[1]
    left = np.abs(found.equations.system.constraints.reduce(forces)).max()
    (walls,) = (term for term in found.equations.terms if isinstance(term, SlidingWalls))
    pressed = np.zeros_like(turned)
    walls.gradient(place.x + turned, 1.0, pressed)
    assert left < 3e-3 * np.abs(pressed).max()


def test_the_difference_of_two_clamped_bars_is_a_bar() -> None:
    """What a square prism of 8 mm gives way more than one of 4 mm: 4 mm of it without a clamp."""
    known = []
    for length in (4.0, 8.0):
        mesh = box((int(length), 4, 2), (length, 2.0, 1.0))
        body = Body(Mesh(mesh.points, mesh.tets, half(mesh)), "bar", length, 8.0, 0.0, True, ())
        piece = BendingPiece(body, LAW, "clamp", "p2", {})
        known.append(clamped_compliance(piece, piece.rest(), 1.0))
    more = known[1] - known[0]
    assert more[0, 0] == pytest.approx(4.0 / (G * 0.1406 * 16), rel=5e-3)
    assert more[1, 1] == pytest.approx(4.0 / (E * 16 / 12), rel=1e-3)
    assert more[0, 1] == pytest.approx(0.0, abs=1e-4)
