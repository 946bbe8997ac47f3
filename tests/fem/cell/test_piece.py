"""Pieces between planes of mirror symmetry: slopes against differences, and copies of a piece against the piece."""

import numpy as np
import pytest

from fem import Hencky, Material, StrainLimitingLayer, StVenantKirchhoff
from fem.cell.air import air_volumes
from fem.cell.axis import axis_of, circle
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece, PieceFailed
from fem.cell.response import shear_rigidity, slopes
from geometry import BisectedCircle, Body, Mesh, PneuNet, Reason, SemicircularSingle
from geometry.curved import CurvedEdges
from tests.pieces import end_piece, half_cell
from tests.quotients import quotient

SVK = StVenantKirchhoff(E=1.2, nu=0.495)
DESIGN = PneuNet()


def doubled(body: Body) -> Body:
    """The piece and its mirror image beyond its plane."""
    points, tets = body.mesh.points, body.mesh.tets
    on_plane = np.isclose(points[:, 0], body.length)
    numbers = np.where(on_plane, np.arange(len(points)), len(points) + np.cumsum(~on_plane) - 1)
    image = points[~on_plane] * [-1.0, 1.0, 1.0] + [2 * body.length, 0.0, 0.0]
    faces = {
        name: np.vstack([triangles, numbers[triangles]])
        for name, triangles in body.mesh.faces.items()
        if name not in ("clamp", "tip")
    }
    faces |= {"clamp": body.mesh.faces["clamp"], "tip": numbers[body.mesh.faces["clamp"]]}
    curved = body.mesh.curved
    middles = curved.middles * [-1.0, 1.0, 1.0] + [2 * body.length, 0.0, 0.0]
    curved = curved.joined(CurvedEdges(numbers[curved.ends], middles))
    mesh = Mesh(np.vstack([points, image]), np.vstack([tets, numbers[tets]]), faces, curved)
    return Body(mesh, body.name, 2 * body.length, body.pitch, body.curve_y, True, body.cavities)


@pytest.mark.parametrize(
    ("formulation", "law"),
    [("p2p0", SVK), ("mixed", SVK), ("p2p0", Hencky(E=1.2, nu=0.45)), ("p2", StVenantKirchhoff(E=1.2, nu=0.3))],
)
@pytest.mark.usefixtures("solved_tightly")
def test_slopes_are_those_of_neighbouring_states(formulation: str, law: Material) -> None:
    piece = BendingPiece(half_cell(DESIGN, 4.0), law, "mirror", formulation, dhat=0.04)
    p, phi, h = 0.02, -0.03, piece.body.length
    at = piece.solve(p, phi, piece.rest())
    assert at.touches
    assert at.gap > 0.0
    known = slopes(piece, at)
    axis = axis_of(piece, at, known)
    slopes_by = {
        "angle": (known.moment_by_angle, axis.stretch_by_angle),
        "pressure": (known.moment_by_pressure, axis.stretch_by_pressure),
    }
    for name, turned, pressed in (("angle", 1e-4, 0.0), ("pressure", 0.0, 1e-5)):
        more, less = (piece.solve(p + sign * pressed, phi + sign * turned, at) for sign in (1, -1))
        longer, shorter = (axis_of(piece, state, slopes(piece, state)) for state in (more, less))
        width = 2.0 * (turned + pressed)
        moment, stretch = slopes_by[name]
        assert moment == quotient(more.moment, less.moment, width).within(rel=1e-4)
        assert stretch == quotient(longer.stretch, shorter.stretch, width).within(rel=1e-4)
        if turned:  # of one potential
            airs = [air_volumes(piece.body, piece.space, state.state.displacement)[0] for state in (more, less)]
            assert -known.moment_by_pressure == quotient(airs[0], airs[1], width).within(rel=1e-4)
    assert h / known.distance_by_force > 0.0


@pytest.mark.parametrize(("pressure", "angle"), [(0.03, -0.08), (0.0, 0.05), (0.0, 0.0)])
def test_the_state_from_rest_under_the_whole_pressure_is_that_of_small_steps(pressure: float, angle: float) -> None:
    piece = BendingPiece(half_cell(DESIGN, 4.0), SVK, "mirror", dhat=0.04)
    slow, before = piece.rest(), piece.factorizations
    for part in (0.25, 0.5, 0.75, 1.0):
        slow = piece.solve(part * pressure, part * angle, slow)
    between = piece.factorizations
    at_once = inflated(piece, pressure, angle)
    assert at_once.moment == pytest.approx(slow.moment, rel=1e-5, abs=1e-9)
    assert at_once.distance == pytest.approx(slow.distance, rel=1e-7)
    if pressure:
        assert piece.factorizations - between < between - before
        assert slow.touches


def test_a_piece_with_a_stiff_layer_is_at_rest_without_pressure_and_bending() -> None:
    """Rounding in the layer makes forces there, with nothing to compare them with."""
    body = half_cell(SemicircularSingle(length=110.0, radius=7.3), 6.0)
    layer = StrainLimitingLayer(body.mesh.plane(1, body.curve_y), 0.05, 2000.0, 0.2)
    piece = BendingPiece(body, StVenantKirchhoff(E=1.2, nu=0.45), "mirror", "mixed", effects=[layer])
    at_rest = inflated(piece, 0.0, 0.0)
    assert (at_rest.moment, at_rest.distance) == (0.0, body.length)
    bent = inflated(piece, 0.0, 1e-3)
    assert bent.moment == pytest.approx(1e-3 * slopes(piece, at_rest).moment_by_angle, rel=1e-2)


def test_a_pressure_that_is_not_reached_at_once_is_reached_in_increments_that_grow_again(monkeypatch) -> None:
    piece = BendingPiece(half_cell(DESIGN, 4.0), SVK, "mirror", dhat=0.04)
    at_once = inflated(piece, 0.03, -0.08)
    solved, tried = BendingPiece.solve_near, []

    def reaching(piece, pressure, angle, predicted, start, *options):  # increments of a quarter at first
        tried.append(pressure / 0.03)
        if pressure - start.pressure > (0.25 if start.pressure == 0.0 else 0.5) * 0.03 * 1.01:
            raise PieceFailed(Reason("tangent_indefinite"))
        return solved(piece, pressure, angle, predicted, start, *options)

    monkeypatch.setattr(BendingPiece, "solve_near", reaching)
    reached = inflated(piece, 0.03, -0.08)
    np.testing.assert_allclose(tried, [1.0, 0.5, 0.25, 0.75, 1.0])
    assert reached.moment == pytest.approx(at_once.moment, rel=1e-5)
    assert reached.distance == pytest.approx(at_once.distance, rel=1e-7)


def test_no_increment_is_tried_twice_and_the_cubic_follows_a_failure(monkeypatch) -> None:
    piece = BendingPiece(half_cell(DESIGN, 4.0), SVK, "mirror")
    at_once = inflated(piece, 0.02, -0.08)
    solved, tried, starts = BendingPiece.solve_near, [], []

    def reaching(piece, pressure, angle, predicted, start, *options):  # an eighth of the way behind three quarters
        tried.append(pressure / 0.02)
        longest = 0.125 if start.pressure > 0.74 * 0.02 else 0.25
        if pressure - start.pressure > longest * 0.02 * 1.01:
            raise PieceFailed(Reason("tangent_indefinite"))
        reached = solved(piece, pressure, angle, predicted, start, *options)
        starts.append(np.abs(predicted.displacement - reached.state.displacement).max())
        return reached

    monkeypatch.setattr(BendingPiece, "solve_near", reaching)
    reached = inflated(piece, 0.02, -0.08)
    np.testing.assert_allclose(tried, [1.0, 0.5, 0.25, 0.75, 0.5, 1.0, 0.75, 1.0, 0.875, 1.0])
    assert max(starts[1:]) < 0.15 * starts[0]  # from rest there is no cubic
    assert reached.moment == pytest.approx(at_once.moment, rel=1e-5)


def test_a_pressure_that_is_not_reached_is_named_with_that_of_the_last_attempt() -> None:
    piece = BendingPiece(half_cell(DESIGN, 5.0), SVK, "mirror", dhat=0.04)
    with pytest.raises(PieceFailed, match=r"half cell at .* kPa and .* on the way to 5000 kPa; ") as failure:
        inflated(piece, 5.0, 0.0)
    assert "at 5000 kPa" not in str(failure.value)


def test_attempts_without_equilibrium_count_as_factorizations() -> None:
    piece = BendingPiece(half_cell(DESIGN, 5.0), SVK, "mirror", dhat=0.04)
    rest = piece.rest()
    with pytest.raises(PieceFailed, match="half cell at 5000 kPa"):
        piece.solve_near(5.0, 0.0, rest.state, rest)
    assert piece.factorizations > 0


@pytest.mark.parametrize("design", [PneuNet(), BisectedCircle()], ids=lambda design: design.family)
def test_two_and_four_half_cells_bend_as_one(design) -> None:
    """Without contact, whose pairs differ between a wall and its image."""
    body = half_cell(design, 4.0)
    moments = []
    for piece_body in (body, doubled(body), doubled(doubled(body))):
        piece = BendingPiece(piece_body, SVK, "mirror")
        count = piece_body.length / body.length
        at = piece.solve(0.01, -0.02 * count, piece.rest())
        moments.append(at.moment)
    np.testing.assert_allclose(moments, moments[0], rtol=1e-8)


def test_a_whole_cell_gives_the_law_of_half_of_it() -> None:
    half = half_cell(DESIGN, 4.0)
    values = []
    for body in (half, half.full()):
        piece = BendingPiece(body, SVK, "mirror", dhat=0.04)
        at = piece.solve(0.02, -0.03, piece.rest())
        known = slopes(piece, at)
        values.append([at.moment, known.moment_by_angle, known.distance_by_force, shear_rigidity(piece, at, known)])
    np.testing.assert_allclose(values[1][:3], values[0][:3], rtol=1e-5)
    assert values[1][3] == pytest.approx(values[0][3], rel=2e-3)


def test_the_axis_runs_halfway_between_the_two_crossings_of_the_material_curve() -> None:
    piece = BendingPiece(half_cell(DESIGN, 4.0), SVK, "mirror", dhat=0.04)
    at = piece.solve(0.02, -0.03, piece.rest())
    axis = axis_of(piece, at, slopes(piece, at))
    np.testing.assert_allclose(axis.ripple[[0, -1], 0], 0.0, atol=1e-12)
    assert axis.ripple[0, 1] == pytest.approx(-axis.ripple[-1, 1], abs=1e-12)
    x = (piece.space.points + at.state.displacement)[piece.curve, :2]
    centre = np.array([0.0, at.distance / np.sin(at.angle)])
    radius = np.linalg.norm(x[[0, -1]] - centre, axis=1)
    assert axis.stretch * piece.body.length == pytest.approx(abs(at.angle) * radius.mean(), rel=1e-12)
    on_axis = circle(axis.s, axis.stretch, at.angle / piece.body.length)
    np.testing.assert_allclose(on_axis[0], 0.0)
    assert np.linalg.norm(np.diff(on_axis, axis=0), axis=1).sum() == pytest.approx(axis.stretch * 5.0, rel=1e-4)


def test_free_and_clamped_ends() -> None:
    """A free end bears no moment; the clamp turns the plane less than a free end by the same pressure."""
    body = end_piece(DESIGN, 1, 4.0)
    free = BendingPiece(body, SVK, "free", dhat=0.04)
    at = free.solve(0.01, 0.0, free.rest())
    assert abs(at.moment) < 1e-6
    clamped = BendingPiece(body, SVK, "clamp", dhat=0.04)
    bent = clamped.solve(0.01, -0.05, clamped.rest())
    np.testing.assert_array_equal(bent.state.displacement[clamped.space.surface("clamp").unique_nodes], 0.0)


def test_a_pressure_no_cell_can_bear_ends_with_a_sentence() -> None:
    piece = BendingPiece(half_cell(DESIGN, 5.0), SVK, "mirror", dhat=0.04)
    at = r"^no equilibrium of the half cell at [\d.]+ kPa and a mean curvature of 0 1/mm"
    with pytest.raises(PieceFailed, match=rf"{at}, on the way to 5000 kPa; "):
        piece.solve(5.0, 0.0, piece.rest())
    with pytest.raises(PieceFailed, match=rf"{at}; "):
        piece.solve_near(5.0, 0.0, piece.rest().state, piece.rest())


def test_a_state_does_not_depend_on_those_that_the_same_piece_had_before() -> None:
    """Bit for bit, so that results are the same whichever process computes what."""
    body, at = half_cell(DESIGN, 4.0), (0.005, -0.005)
    first, second = (BendingPiece(body, SVK, "mirror", dhat=0.04) for _ in range(2))
    assert second.solve(0.02, -0.04, second.rest()).touches
    alone, later = first.solve(*at, first.rest()), second.solve(*at, second.rest())
    assert not alone.touches
    np.testing.assert_array_equal(alone.state.displacement, later.state.displacement)
