"""Half cells bent about any direction, against turned bodies, difference quotients and the half body."""

import numpy as np
import pytest

from fem import StVenantKirchhoff
from fem.cell.across import QUARTER, Straight, twist_and_shear
from fem.cell.air import air_volumes
from fem.cell.any_plane import BentState, bent_state, frame_of, turned
from fem.cell.axis import axis_of
from fem.cell.inflation import inflated
from fem.cell.lateral import lateral_rigidities
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import shear_rigidity, slopes
from geometry import BisectedCircle
from geometry.arrays import Array
from tests.pieces import half_cell
from tests.quotients import quotient

SOFT = StVenantKirchhoff(E=0.3, nu=0.49)
HALF = half_cell(BisectedCircle(), 6.0)
WHOLE = HALF.full()
FIRST, OTHER = WHOLE.cavities
PRESSURES = {FIRST: 1.0, OTHER: 0.25}
PRESSURE = 0.004


def state(angle: float, pressure: float, curvature: float) -> tuple[BendingPiece, PieceState]:
    piece = BendingPiece(turned(WHOLE, angle), SOFT, "mirror", "p2p0", PRESSURES)
    return piece, inflated(piece, pressure, curvature * piece.body.length)


def bent(angle: float, pressure: float, curvature: float) -> BentState:
    piece, at = state(angle, pressure, curvature)
    return bent_state(piece, at, slopes(piece, at))


def in_body(values: Array, angle: float) -> Array:
    return np.asarray(values @ frame_of(angle))


def test_a_straight_cell_has_the_same_moments_however_it_is_turned() -> None:
    piece = BendingPiece(HALF, SOFT, "mirror", "p2p0", PRESSURES)
    planar = inflated(piece, PRESSURE, 0.0).moment
    for angle in (0.0, 0.7, QUARTER, 4.0):
        assert in_body(bent(angle, PRESSURE, 0.0).moment, angle) == pytest.approx([0.0, planar], abs=1e-6 * abs(planar))


def test_a_plane_of_symmetry_stays_one() -> None:
    piece = BendingPiece(HALF, SOFT, "mirror", "p2p0", PRESSURES)
    planar, whole = inflated(piece, PRESSURE, 0.05), bent(0.0, PRESSURE, 0.05 / HALF.length)
    assert whole.moment == pytest.approx([0.0, planar.moment], abs=1e-6 * abs(planar.moment))
    assert whole.axial_rigidity == pytest.approx(HALF.length / slopes(piece, planar).distance_by_force, rel=1e-6)
    assert whole.stretch == pytest.approx(axis_of(piece, planar, slopes(piece, planar)).stretch, rel=5e-3)


@pytest.mark.usefixtures("solved_tightly")
def test_slopes_are_those_of_neighbouring_states() -> None:
    angle, kappa, step = 0.7, 0.004, 0.02
    at = bent(angle, PRESSURE, kappa)
    less, more = (bent(angle, PRESSURE, (1 + sign * step) * kappa) for sign in (-1, 1))
    lower, higher = (bent(angle, (1 + sign * step) * PRESSURE, kappa) for sign in (-1, 1))
    scale = float(np.abs(at.by_curvature).max())
    width = 2 * step * kappa
    assert at.by_curvature == quotient(more.moment, less.moment, width).within(abs=1e-4 * scale)
    assert at.stretch_by_curvature == quotient(more.stretch, less.stretch, width).within(rel=1e-3)
    width = 2 * step * PRESSURE
    by_pressure = quotient(higher.moment, lower.moment, width)
    assert at.by_pressure == by_pressure.within(abs=1e-3 * float(np.abs(by_pressure.value).max()))
    assert at.stretch_by_pressure == quotient(higher.stretch, lower.stretch, width).within(rel=1e-3)


@pytest.mark.usefixtures("solved_tightly")
def test_the_moments_grow_with_the_pressure_as_the_air_does_with_the_curvature() -> None:
    """About two directions of a body: dM/dp = -dV/dkappa, V the air of the cavities by their parts of the pressure."""
    angle, kappa, step = 0.7, 0.004, 1e-4

    def air(curvature: tuple[float, float]) -> float:
        piece, at = state(float(np.arctan2(-curvature[0], curvature[1])), PRESSURE, float(np.hypot(*curvature)))
        volumes = air_volumes(piece.body, piece.space, at.state.displacement) / piece.body.length
        return float(volumes @ [PRESSURES[name] for name in piece.body.cavities])

    middle = np.array([0.0, kappa]) @ frame_of(angle)
    more, less = ([air(tuple(middle + sign * step * direction)) for direction in np.eye(2)] for sign in (1.0, -1.0))
    by_pressure = in_body(bent(angle, PRESSURE, kappa).by_pressure, angle)
    assert -by_pressure == quotient(more, less, 2.0 * step).within(abs=1e-3 * float(np.abs(by_pressure).max()))


def test_the_moments_have_a_potential() -> None:
    """The work on the way from (k, 0) to (0, k) along a quarter circle and along two sides is the same."""
    kappa, count = 0.004, 4
    points, weights = np.polynomial.legendre.leggauss(count)

    def moment(y: float, z: float) -> Array:
        angle = float(np.arctan2(-y, z))
        return in_body(bent(angle, PRESSURE, float(np.hypot(y, z))).moment, angle)

    t = (points + 1) / 2
    straight = sum(w / 2 * moment(kappa * s, 0.0)[0] for s, w in zip(t, weights, strict=True)) * -kappa
    straight += sum(w / 2 * moment(0.0, kappa * s)[1] for s, w in zip(t, weights, strict=True)) * kappa
    around = 0.0
    for s, w in zip(t * np.pi / 2, weights, strict=True):
        there = moment(kappa * np.cos(s), kappa * np.sin(s))
        around += w / 2 * np.pi / 2 * kappa * float(there @ [-np.sin(s), np.cos(s)])
    scale = kappa * float(np.abs(moment(0.0, kappa)).max())
    assert around == pytest.approx(straight, abs=1e-4 * scale)


@pytest.mark.parametrize("pressure", [0.0, PRESSURE])
def test_twist_and_shear_are_those_of_half_the_body(pressure: float) -> None:
    parts = []
    for angle in (0.0, QUARTER):
        piece, at = state(angle, pressure, 0.0)
        parts.append(Straight(piece, at, slopes(piece, at)))
    whole = twist_and_shear(*parts)
    piece = BendingPiece(HALF, SOFT, "mirror", "p2p0", PRESSURES)
    at = inflated(piece, pressure, 0.0)
    known = slopes(piece, at)
    half = lateral_rigidities(piece, at)
    stiff = np.linalg.inv(whole[np.ix_([0, 2], [0, 2])])
    assert 1 / whole[0, 0] == pytest.approx(half.torsion, rel=1e-3)
    assert stiff[1, 1] == pytest.approx(half.shear, rel=2e-2)
    assert 1 / whole[1, 1] == pytest.approx(shear_rigidity(piece, at, known), rel=5e-3)
    assert whole[1, [0, 2]] == pytest.approx([0.0, 0.0], abs=5e-3 * whole[1, 1])
