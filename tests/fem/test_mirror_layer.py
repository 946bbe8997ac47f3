"""A layer that goes on beyond the planes of a piece: its derivatives, and a half cell against the whole."""

import numpy as np
import pytest

from fem import NeoHooke, StrainLimitingLayer
from fem.cell.piece import BendingPiece
from fem.cell.response import slopes
from fem.discretisation import Discretisation
from fem.effects.mirror_layer import MirroredLayer, MirroredLayerTerm
from geometry import Body, Mesh
from geometry.arrays import Array
from tests.fem.test_membrane import HEIGHT, LENGTH, check_derivatives, strip
from tests.quotients import quotient

LAW = NeoHooke(mu=0.02, kappa=1.0)


@pytest.fixture(scope="module", params=["p2p0", "p1"])
def bound(request: pytest.FixtureRequest) -> tuple[MirroredLayerTerm, Array]:
    """The term and positions in which plane and layer are bent and turned."""
    mesh = strip((4, 1, 2))
    space = Discretisation.of(mesh, request.param)
    layer = StrainLimitingLayer(mesh.plane(1, 0.0), 0.5, 50.0, 0.3)
    return MirroredLayer(layer, "tip").bind(space, LAW), space.points + np.random.default_rng(1).normal(
        scale=0.1, size=space.points.shape
    )


def test_the_derivatives_are_those_of_the_energy(bound: tuple[MirroredLayerTerm, Array]) -> None:
    check_derivatives(*bound)


def test_a_plane_that_turns_with_the_layer_costs_nothing(bound: tuple[MirroredLayerTerm, Array]) -> None:
    term, bent = bound
    space = Discretisation.of(strip((4, 1, 2)), "p2p0" if len(term.layer.arrays.nodes[0]) == 6 else "p1")
    cosine, sine = np.cos(0.7), np.sin(0.7)
    turned = space.points @ np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]]) + [3.0, 2.0, 0.0]
    assert abs(term.energy(turned, 1.0)) < 1e-9 < term.energy(bent, 1.0)


def notched(half: bool) -> Body:
    """A strip with a layer, half as high near the plane x = LENGTH; with its mirror image there unless `half`."""
    whole = strip((4, 2, 1))
    middles = whole.points[whole.tets].mean(axis=1)
    tets = whole.tets[(middles[:, 1] < HEIGHT / 2) | (middles[:, 0] < LENGTH / 2)]
    points = whole.points
    if not half:
        on = np.isclose(points[:, 0], LENGTH)
        image = np.arange(len(points)) + len(points)
        image[on] = np.flatnonzero(on)
        points = np.vstack([points, points * [-1.0, 1.0, 1.0] + [2 * LENGTH, 0.0, 0.0]])
        tets = np.vstack([tets, image[tets][:, [0, 2, 1, 3]]])
    used, renumbered = np.unique(tets, return_inverse=True)
    length = LENGTH if half else 2 * LENGTH
    mesh = Mesh(points[used], renumbered.reshape(-1, 4), {})
    faces = {"clamp": mesh.plane(0, 0.0), "tip": mesh.plane(0, length), "sym": mesh.plane(2, 0.0)}
    mesh = Mesh(mesh.points, mesh.tets, faces | {"cavity": mesh.plane(1, 0.0)})  # nothing acts on it
    return Body(mesh, "notched", length, 2 * LENGTH, 0.0)


@pytest.mark.parametrize("formulation", ["p2p0", "mixed"])
def test_a_half_cell_bends_as_two_of_them(formulation: str) -> None:
    """The edges of the layer in the middle of two half cells are inside; in the plane of one they have an image."""
    pieces = []
    for half in (True, False):
        body = notched(half)
        layer = StrainLimitingLayer(body.mesh.plane(1, 0.0), 0.5, 50.0, 0.3)
        pieces.append(BendingPiece(body, LAW, "mirror", formulation, pressures={}, effects=[layer]))
    for angle in (1e-3, 0.5):
        one, two = (piece.solve(0.0, k * angle, piece.rest()) for k, piece in zip((1, 2), pieces, strict=True))
        assert two.moment == pytest.approx(one.moment, rel=1e-5)
        assert two.distance > 0.0
        assert slopes(pieces[1], two).moment_by_angle == pytest.approx(
            slopes(pieces[0], one).moment_by_angle / 2, rel=1e-5
        )
    alone = BendingPiece(notched(True), LAW, "mirror", formulation, pressures={})
    kinked = [term for term in pieces[0].terms if not isinstance(term, MirroredLayerTerm)]
    assert len(pieces[0].terms) - len(kinked) == 2
    assert one.moment > 1.5 * alone.solve(0.0, 0.5, alone.rest()).moment


@pytest.mark.usefixtures("solved_tightly")
def test_the_slopes_of_a_piece_with_a_layer_are_those_of_its_states() -> None:
    body = notched(True)
    layer = StrainLimitingLayer(body.mesh.plane(1, 0.0), 0.5, 50.0, 0.3)
    piece = BendingPiece(body, LAW, "mirror", pressures={}, effects=[layer])
    at = piece.solve(0.0, 0.3, piece.rest())
    less, more = (piece.solve(0.0, 0.3 + side, at).moment for side in (-1e-3, 1e-3))
    assert slopes(piece, at).moment_by_angle == quotient(more, less, 2e-3).within(rel=1e-4)
