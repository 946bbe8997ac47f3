"""States of a piece of a body without a plane of symmetry along it: bent about any direction across its sections.

Cells that are symmetric about their own middle stay so under pressure and a moment about any direction across the arm.
A piece that bends by the curvatures kappa = (kappa_y, kappa_z) is that of `fem.cell.piece` in a body that is turned
about its material curve until kappa lies along z. There M_1 = M_z. The moment M_2 about the direction e2 within the
plane is that of the nodal forces on it and of the air, p int z dA over the mouths of the cavities, because a tilt b of
the plane about e2 adds -b int z dA to the volume of air. The work of M_2 with a change of kappa across itself is
M_2 sin(phi) / phi. Sections do not turn about the normal of the plane on the average (`fem.cell.boundary.NotTurned`).
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.cell.inflation import bent, bent_point
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes
from fem.cell.rim import mouths
from geometry import Body
from geometry.arrays import Array

#: of a difference quotient: change of the angle (rad) or of the pressure (MPa)
STEP = 1e-5
#: rad, angles below which sin(phi) / phi has no slope
STRAIGHT = 1e-6


def turned(body: Body, angle: float) -> Body:
    """A body turned about its material curve by minus an angle (rad): what lay along (-sin, cos) of y and z is along z.

    The face names stay.
    """

    def moved(points: Array) -> Array:
        y, z = points[:, 1] - body.curve_y, points[:, 2]
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.column_stack([points[:, 0], body.curve_y + cosine * y + sine * z, cosine * z - sine * y])

    mesh = body.mesh
    points = moved(mesh.points)
    points[body.curve_vertices] = mesh.points[body.curve_vertices]
    curved = replace(mesh.curved, middles=moved(mesh.curved.middles))
    return replace(body, mesh=replace(mesh, points=points, curved=curved))


def frame_of(angle: float) -> Array:
    """(2, 2): in rows the directions of y and z of the turned body, in y and z of the body."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def bent_from_straight(piece: BendingPiece, turn: float, straight: PieceState, angle: float) -> PieceState:
    """A turned piece at an angle (rad) of its plane, from the straight state of the piece that is not turned.

    turn: rad, as in `turned`. What is straight may be turned as a whole. Raises `PieceFailed`.
    """
    displacement = straight.state.displacement.copy()
    displacement[:, 1:] @= frame_of(turn).T
    state = piece.system.state_at(displacement, straight.pressure)
    start = replace(piece.rest(), pressure=straight.pressure, state=replace(state, pressure=straight.state.pressure))
    if angle == 0.0:
        return piece.solve_near(straight.pressure, 0.0, start.state, start)
    return bent(piece, angle, start, None, bent_point(piece, start))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class BentState:
    """A half cell bent about z of its turned body; components of vectors are those about y and z there."""

    moment: Array  #: (2,) N mm
    by_curvature: Array  #: (2,) N mm2
    by_pressure: Array  #: (2,) N mm/MPa, by the pressure of the state
    stretch: float  #: of the axis, an arc through the material curve in the middle of each cell
    stretch_by_curvature: float  #: mm
    stretch_by_pressure: float  #: 1/MPa
    axial_rigidity: float  #: N


def bent_state(piece: BendingPiece, at: PieceState, known: Slopes) -> BentState:
    """A half cell with its moments and their slopes."""
    phi, h = at.angle, piece.body.length
    part = float(np.sinc(phi / np.pi))
    part_slope = (np.cos(phi) * phi - np.sin(phi)) / phi**2 if phi > STRAIGHT else 0.0
    beside = moment_beside(piece, at)
    by_angle = _difference(piece, at, known.by_angle, 1.0, 0.0)
    by_pressure = _difference(piece, at, known.by_pressure, 0.0, 1.0)
    stretch, by_distance, by_phi = _stretch(piece, at)
    node, normal = piece.plane[0], np.array([np.cos(phi), np.sin(phi), 0.0])
    along = np.array([-normal[1], normal[0], 0.0])
    x = piece.space.points[node] + at.state.displacement[node]
    farther = float(known.by_angle[node] @ normal + x @ along), float(known.by_pressure[node] @ normal)
    return BentState(
        moment=np.array([part * beside, at.moment]),
        by_curvature=h * np.array([part * by_angle + part_slope * beside, known.moment_by_angle]),
        by_pressure=np.array([part * by_pressure, known.moment_by_pressure]),
        stretch=stretch,
        stretch_by_curvature=h * (by_distance * farther[0] + by_phi),
        stretch_by_pressure=by_distance * farther[1],
        axial_rigidity=h / known.distance_by_force,
    )


def moment_beside(piece: BendingPiece, at: PieceState) -> float:
    """M_2 in N mm."""
    x = piece.space.points + at.state.displacement
    gradient = piece.system.gradient_at(at.state.displacement, at.state.factor, at.terms)[piece.plane]
    along = np.array([-np.sin(at.angle), np.cos(at.angle), 0.0])
    air = sum(0.5 * pressure * float(x[:, 2] ** 2 @ nu[:, 2]) for pressure, x, nu in mouths(piece, at))
    return piece.whole * (float(np.vdot(gradient, np.cross(along, x[piece.plane]))) + air)


def _difference(piece: BendingPiece, at: PieceState, moved: Array, angle: float, pressure: float) -> float:
    """Change of M_2 with a displacement (n, 3) that belongs to changes of the angle and of the pressure."""

    def there(sign: float) -> float:
        step = sign * STEP
        state = piece.system.state_at(at.state.displacement + step * moved, at.pressure + step * pressure)
        return moment_beside(piece, replace(at, state=state, angle=at.angle + step * angle))

    return (there(1.0) - there(-1.0)) / (2.0 * STEP)


def _stretch(piece: BendingPiece, at: PieceState) -> tuple[float, float, float]:
    """The stretch of the axis, and its derivatives by the distance of the plane and by its angle at that distance."""
    phi, h, y = at.angle, piece.body.length, piece.body.curve_y
    factor = 1.0 / float(np.sinc(phi / np.pi))
    slope = factor**2 * (np.sin(phi) - phi * np.cos(phi)) / phi**2 if phi > STRAIGHT else 0.0
    half = at.distance - y * np.sin(phi)  # half the distance between neighbouring middles
    return half * factor / h, factor / h, (half * slope - y * np.cos(phi) * factor) / h
