"""The held edge of the arm's free end, to first order, against equilibria in which the edge is held."""

import numpy as np
import pytest

from fem import StVenantKirchhoff
from fem.cell.edge import FreeEdge, free_edge
from fem.cell.piece import BendingPiece
from fem.supports import Line, SharedPlane, Support, nodes_at
from geometry import PneuNet
from geometry.arrays import Array
from tests.pieces import end_piece
from tests.supports import Symmetry

SVK = StVenantKirchhoff(E=1.2, nu=0.495)
BODY = end_piece(PneuNet(), 1, 4.0)
EDGE = Line(BODY.edge("clamp"))
PRESSURE = 0.02


@pytest.fixture(scope="module")
def edge() -> FreeEdge:
    piece = BendingPiece(BODY, SVK, "free", dhat=0.04)
    return free_edge(piece, piece.solve(PRESSURE, 0.0, piece.rest()))


def supported(*supports: Support) -> tuple[Array, Array, Array, float]:
    """Edge nodes and forces on them (k, 2), the curve (m, 2), and the moment of the plane, with further supports."""
    piece = BendingPiece(BODY, SVK, "free", dhat=0.04, supports=supports)
    at = piece.solve(PRESSURE, 0.0, piece.rest())
    x = (piece.space.points + at.state.displacement)[:, :2]
    nodes = nodes_at(EDGE, piece.space)
    forces = piece.whole * piece.system.assemble(at.state, at.terms).gradient[nodes, :2]
    return x[nodes], forces, x[piece.curve], at.moment


def held_in(point: Array) -> tuple[Array, Array, Array, float]:
    """What `supported` returns with the edge held in a point (2,) of the plane, mm."""
    shift = point - EDGE.vertices[0, :2]
    along, across = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    return supported(Symmetry(EDGE, along, shift[0], ramp=False), Symmetry(EDGE, across, shift[1], ramp=False))


def couple_of(points: Array, forces: Array) -> float:
    """N mm about the first point."""
    lever = points - points[0]
    return float(np.sum(lever[:, 0] * forces[:, 1] - lever[:, 1] * forces[:, 0]))


@pytest.mark.parametrize("degrees", [0.0, 40.0, -75.0])
def test_a_support_without_resultant_force(edge: FreeEdge, degrees: float) -> None:
    """The bow is a few tenths of a millimetre, so the first order is right to a few hundredths of the couple."""
    angle = np.radians(degrees)
    points, forces, curve, moment = supported(SharedPlane(EDGE, (-float(np.sin(angle)), float(np.cos(angle)), 0.0)))
    held = edge.held(angle)
    largest = max(abs(edge.held(turn).couple) for turn in np.linspace(0.0, np.pi, 13))
    assert couple_of(points, forces) == pytest.approx(-moment, rel=1e-5, abs=1e-6)
    assert held.couple == pytest.approx(-moment, abs=0.04 * largest)
    moved = np.linalg.norm(curve - edge.curve, axis=1).max()
    assert np.linalg.norm(held.curve - curve, axis=1).max() < 0.06 * moved


def test_a_resultant_force_acts_at_its_lever(edge: FreeEdge) -> None:
    """Two heights of the support differ by a force, and its couple by that force times the lever."""
    held = edge.held(0.0)
    rise = float(held.curve[0, 1]) - BODY.curve_y
    couples, resultants = [], []
    for height in (rise - 0.03, rise + 0.03):
        points, forces, _, _ = supported(Symmetry(EDGE, (0.0, 1.0, 0.0), height, ramp=False))
        couples.append(couple_of(points, forces))
        resultants.append(forces[:, 1].sum())
    assert np.ptp(resultants) > 0.01
    assert np.diff(couples)[0] / np.diff(resultants)[0] == pytest.approx(
        held.lever, rel=0.1
    )  # a twentieth is of second order
    at_no_force = couples[0] - np.diff(couples)[0] / np.diff(resultants)[0] * resultants[0]
    assert at_no_force == pytest.approx(held.couple, rel=0.04)


def test_an_edge_in_one_point(edge: FreeEdge) -> None:
    """Held where it would be without a resultant force, the edge carries next to none."""
    held, _ = edge.pinned()
    _, forces, curve, _ = held_in(held[0])
    assert np.linalg.norm(forces.sum(axis=0)) < 0.05 * np.linalg.norm(forces, axis=1).sum()
    moved = np.linalg.norm(curve - edge.curve, axis=1).max()
    assert np.linalg.norm(held - curve, axis=1).max() < 0.06 * moved


def test_an_edge_in_one_point_that_is_pushed(edge: FreeEdge) -> None:
    """Two positions along x differ by a force, which moves the curve as its first order says."""
    held, by_force = edge.pinned()
    (_, low, first, _), (_, high, second, _) = (held_in(held[0] + change * by_force[0]) for change in (-0.02, 0.02))
    change = (high - low).sum(axis=0)
    assert change[0] == pytest.approx(0.04, rel=0.1)
    assert abs(change[1]) < 0.1 * change[0]
    expected = change[0] * by_force
    assert np.linalg.norm(second - first - expected, axis=1).max() < 0.1 * np.linalg.norm(expected, axis=1).max()


def test_a_force_spread_evenly_acts_in_the_middle_of_the_edge(edge: FreeEdge) -> None:
    assert edge.weights.sum() == pytest.approx(1.0)
    assert edge.middle == pytest.approx(edge.weights @ edge.positions)
    assert edge.positions[0] == pytest.approx(edge.curve[0])
