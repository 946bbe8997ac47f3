"""Pieces driven by the volume of their air: states, slopes, work along a closed way, and the limit of the pressure.

Tube in plane strain, incompressible: p = int W'(s) / (s^2 - 1) ds over the hoop stretch from the outer to the inner
wall (A. E. Green, W. Zerna, "Theoretical elasticity", 2nd ed. 1968).
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from fem import Fixed, Ogden
from fem.cell.design_change import DesignChange
from fem.cell.inflation import AirPath, FreePoint, along_air, bent, extremum, inflated
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import slopes
from geometry import Body, Mesh, PneuNet, Rectangular
from tests.bodies import box
from tests.pieces import half_cell
from tests.quotients import quotient

#: its pressure has a maximum: neither tubes nor balls of it stiffen
SOFT = Ogden((0.1,), (1.4,), 100.0)
INNER, OUTER = 1.0, 2.0
THICK = Rectangular(
    chambers=5, width=22.0, height=15.5, chamber_length=2.0, partition=7.0, base=0.5, side_wall=7.0, roof=7.0
)


def tube() -> Body:
    """A slice of half a tube."""
    mesh = box((3, 16, 1), (OUTER - INNER, np.pi, 0.4))
    radius, angle = INNER + mesh.points[:, 0], mesh.points[:, 1]
    points = np.column_stack([mesh.points[:, 2], radius * np.cos(angle), radius * np.sin(angle)])
    faces = mesh.faces
    sym = np.vstack([faces["bottom"], faces["top"]])
    named = {
        "cavity": faces["left"],
        "outer": faces["right"],
        "clamp": faces["back"],
        "tip": faces["front"],
        "sym": sym,
    }
    return Body(Mesh(points, mesh.tets, named), "tube", 0.4, 0.8, -OUTER)


def top(points) -> tuple[FreePoint, FreePoint]:
    """Two neighbouring states on both sides of the largest pressure."""
    return next(pair for pair in pairwise(points) if pair[0].rise > 0.0 > pair[1].rise)


def test_the_limit_pressure_of_a_tube_in_plane_strain() -> None:
    """Measured: 0.04 %."""

    def pressure(s: float) -> float:
        far = np.sqrt(1 + (s**2 - 1) * (INNER / OUTER) ** 2)
        slope = lambda t: 0.1 * (t**0.4 - t**-2.4)  # noqa: E731
        return quad(lambda t: slope(t) / (t**2 - 1), far, s)[0]

    largest = minimize_scalar(lambda s: -pressure(s), bounds=(1.2, 6.0), method="bounded")
    piece = BendingPiece(tube(), SOFT, "free", "mixed", supports=[Fixed("clamp", "x")])
    found = extremum(piece, *top(AirPath.of(piece).points()))
    assert found.pressure == pytest.approx(-largest.fun, rel=3e-3)
    stretch = np.sqrt(np.exp(found.air) / piece.volume(piece.rest().state))
    assert stretch == pytest.approx(largest.x, rel=0.03)


@pytest.fixture(scope="module")
def soft_cell() -> BendingPiece:
    return BendingPiece(half_cell(THICK, 6.0), SOFT, "mirror", "mixed")


@pytest.fixture(scope="module")
def soft_path(soft_cell: BendingPiece) -> list[FreePoint]:
    """To beyond the largest pressure."""
    points = []
    for point in AirPath.of(soft_cell).points():
        points.append(point)
        if point.rise < 0.0:
            return points
    raise AssertionError("no maximum")


def state_at(cell: BendingPiece, volume: float, angle: float, near: PieceState) -> PieceState:
    return cell.solve_at_volume(volume, angle, near.state, near)


def test_pressure_and_moment_along_a_closed_way_do_no_work(soft_cell: BendingPiece, soft_path: list[FreePoint]) -> None:
    """Around the largest pressure, in volume and angle; and the work of each side is the change of the energy."""
    top = extremum(soft_cell, *soft_path[-2:])
    volumes, angles = np.exp(top.air + np.array([-0.12, 0.12])), (0.8 * top.state.angle, 1.2 * top.state.angle)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]
    state, works, energies = top.state, [], []
    for start, end in pairwise(corners):
        way = [np.array([volumes[i], angles[j]]) for i, j in (start, end)]
        work = 0.0
        for t, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
            state = state_at(soft_cell, *(way[0] + t * (way[1] - way[0])), state)
            work += weight * float(np.dot([state.pressure, state.moment], way[1] - way[0]))
        works.append(work)
        state = state_at(soft_cell, *way[1], state)
        at = state.state
        energies.append(soft_cell.whole * soft_cell.system.energy(at.displacement, at.factor, ()))
    assert sum(works) == pytest.approx(0.0, abs=1e-4 * max(map(abs, works)))
    np.testing.assert_allclose(works[1:], np.diff(energies), atol=1e-4 * max(map(abs, works)))


def test_states_by_volume_and_by_pressure_are_the_same(soft_cell: BendingPiece, soft_path: list[FreePoint]) -> None:
    for point in soft_path[1:-1]:
        assert point.is_stable
        by_pressure = soft_cell.solve(point.state.pressure, point.state.angle, point.state, point.state.state)
        again = soft_cell.solve(point.state.pressure, point.state.angle, soft_path[0].state)
        for other in (by_pressure, again):
            apart = np.abs(other.state.displacement - point.state.state.displacement).max()
            assert apart < 1e-4 * np.abs(point.state.state.displacement).max()
            assert other.moment == pytest.approx(point.state.moment, abs=1e-4)


def test_a_pressure_is_reached_from_half_of_it(soft_cell: BendingPiece, soft_path: list[FreePoint]) -> None:
    """And along the air where increments from there fail."""
    pressure = 0.98 * max(point.pressure for point in soft_path)
    half = inflated(soft_cell, 0.5 * pressure, 0.0)
    further, from_rest = inflated(soft_cell, pressure, 0.0, begin=half), inflated(soft_cell, pressure, 0.0)
    assert further.moment == pytest.approx(from_rest.moment, rel=1e-5)
    size = np.abs(from_rest.state.displacement).max()
    assert further.state.displacement == pytest.approx(from_rest.state.displacement, abs=1e-5 * size)


@pytest.mark.usefixtures("solved_tightly")
@pytest.mark.parametrize("touching", [True, False])
def test_slopes_by_volume_and_angle_are_those_of_neighbouring_states(touching: bool, soft_cell: BendingPiece) -> None:
    """Of pressure and moment, and of the state; beyond the largest pressure too."""
    piece = BendingPiece(half_cell(PneuNet(), 5.0), SOFT, "mirror", dhat=0.04) if touching else soft_cell
    at = next(point for point in AirPath.of(piece).points() if point.state.touches or point.rise < 0.0).state
    volume = piece.volume(at.state)
    assert at.touches == touching
    known = slopes(piece, at)
    for column, (swollen, turned) in enumerate(((1e-4 * volume, 0.0), (0.0, 1e-4))):
        more, less = (state_at(piece, volume + k * swollen, at.angle + k * turned, at) for k in (1, -1))
        width = 2.0 * (swollen + turned)
        for row, (first, second) in enumerate(((more.pressure, less.pressure), (more.moment, less.moment))):
            assert known.energy_hessian[row, column] == quotient(first, second, width).within(rel=1e-3)
        rate = known.rates_at_volume[column].displacement
        apart = rate - (more.state.displacement - less.state.displacement) / width
        assert np.abs(apart).max() < 1e-3 * np.abs(rate).max()


def test_a_pressure_that_is_reached_along_the_air_is_that_of_increments(soft_cell: BendingPiece) -> None:
    at = along_air(soft_cell, 0.022)
    assert (at.pressure, at.negative_pivots) == (0.022, 0)
    by_pressure = inflated(soft_cell, 0.022, at.angle)
    assert by_pressure.distance == pytest.approx(at.distance, rel=1e-6)
    turned = bent(soft_cell, 0.5 * at.angle, at, None, None)
    assert turned.moment == pytest.approx(inflated(soft_cell, 0.022, 0.5 * at.angle).moment, rel=1e-4)


def test_a_pressure_beyond_the_last_form_is_named_with_its_limit(soft_cell: BendingPiece) -> None:
    with pytest.raises(PieceFailed) as failure:
        inflated(soft_cell, 0.03, 0.0)
    (reason,) = failure.value.reasons
    assert reason.code == "beyond_limit_pressure"
    assert reason.values["limit_kPa"] == pytest.approx(24.1, abs=0.1)


def test_a_tube_that_stiffens_snaps_to_its_swollen_form_and_back() -> None:
    """Between the minimum and the maximum of its pressure it has two forms."""

    def made(after_snap: float) -> BendingPiece:
        law = Ogden((0.1, 5e-4), (1.4, 4.0), 100.0)
        piece = BendingPiece(tube(), law, "free", "mixed", supports=[Fixed("clamp", "x")])
        piece.after_snap = after_snap
        return piece

    rising = made(0.0)
    pairs = pairwise(AirPath.of(rising).points())
    limit = extremum(rising, *next(pair for pair in pairs if pair[0].rise > 0.0 > pair[1].rise))
    back = extremum(rising, *next(pair for pair in pairs if pair[0].rise < 0.0 < pair[1].rise))
    assert back.pressure < limit.pressure
    assert back.air > limit.air
    between, beyond = 0.5 * (back.pressure + limit.pressure), 1.02 * limit.pressure
    swollen, in_a_weaker_body = made(limit.pressure), made(0.9 * between)
    first, second = along_air(rising, between), along_air(swollen, between)
    assert rising.volume(first.state) < np.exp(limit.air)
    assert rising.volume(second.state) > np.exp(back.air)
    before = along_air(in_a_weaker_body, back.pressure)
    assert before.distance == pytest.approx(along_air(rising, back.pressure).distance)
    assert inflated(rising, beyond, 0.0).distance == pytest.approx(inflated(swollen, beyond, 0.0).distance)


def test_the_limit_pressure_grows_with_all_moduli(soft_cell: BendingPiece, soft_path: list[FreePoint]) -> None:
    """In proportion, and with a wall as differences of pieces say."""
    limit = extremum(soft_cell, *soft_path[-2:])

    def of_law(factor: float) -> Ogden:
        return Ogden((0.1 * factor,), (1.4,), 100.0 * factor)

    stiffer = DesignChange.of_material(soft_cell, of_law(1.0 - 1e-4), of_law(1.0 + 1e-4), 2e-4)
    points = soft_cell.space.points
    wider = DesignChange.of_dimension(soft_cell, points * [0.0, 0.0, 1.0], 0.0)
    by_moduli, by_width = (one.limit_rate(soft_cell, limit.state, limit.rate) for one in (stiffer, wider))
    assert by_moduli == pytest.approx(limit.pressure, rel=1e-3)

    def limit_of(factor: float) -> float:
        body = half_cell(THICK, 6.0)
        mesh = replace(body.mesh, points=body.mesh.points * [1.0, 1.0, factor])
        middles = body.mesh.curved.middles * [1.0, 1.0, factor]
        mesh = replace(mesh, curved=replace(mesh.curved, middles=middles))
        piece = BendingPiece(replace(body, mesh=mesh), SOFT, "mirror", "mixed")
        return extremum(piece, *top(AirPath.of(piece).points())).pressure

    assert by_width == pytest.approx((limit_of(1.01) - limit_of(0.99)) / 0.02, rel=0.01)
