"""Rigidities of a cell out of its plane, about a planar state: lateral bending, twist and lateral shear.

A rod whose sections have the frame t, n, z bends by kappa_2 about n, twists by tau about t, and shears by gamma along
z. Over half a cell of the length h with the curvature kappa, phi = kappa h, its sections turn by

    bent:     kappa_2 (sin(kappa s) e_y - (1 - cos(kappa s)) e_x) / kappa + a e_x,
    twisted:  tau (sin(kappa s) e_x + (1 - cos(kappa s)) e_y) / kappa + b e_y,

and equilibrium without forces across leaves its moment (T, M_2, M_1) as a vector. A bent cell is therefore twisted by a
couple (kappa M_2 - kappa_2 M_1) h, and a twisted one bent by (kappa T - tau M_1) h, which the neighbours exert. Both
halves of it act on the two planes of the half cell as the stresses of the other kind do there. By these stresses the
turn of a warped plane is measured as well: a moment does work on its own turn alone.

Twist and shear have a common compliance: (tau, gamma) = C (T, Q). The axis of twist is where Q does not twist.

Derivatives by the design, at a fixed curvature, are differences to one side: of a cell with a little more of the
parameter, in the planar state that it then has to first order, and of the cell itself. So a parameter takes no further
equilibrium, and two factorizations.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from fem.cell.axis import end_ripples, length_of
from fem.cell.design_change import DesignChange, DesignRate, Variant, moved_term
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes
from fem.cell.sideways import Bent, Place, Twisted
from fem.equations.state import State
from fem.supports import Fixed
from geometry.arrays import Array

#: angles up to this are evaluated by series
SMALL = 0.05


@final
@dataclass(frozen=True)
class LateralRigidities:
    """Rigidities of the whole body out of its plane at one state of a half cell."""

    bending: float  #: B_2, moment about the normal of the axis over the lateral curvature, N mm2
    torsion: float  #: GJ, torque over twist without shear force, N mm2
    shear: float  #: lateral shear force over shear angle without twist, N
    twist_axis: float  #: its height above the axis of the rod, along the normal, mm
    #: by how much the plane between two cells tilts more than that in the middle of the cell, rad/(N mm) of torque
    tilt_by_torque: float
    unstable: int  #: number of unstable directions with bending and twist prescribed


def lateral_rigidities(piece: BendingPiece, at: PieceState) -> LateralRigidities:
    """Rigidities of a half cell that is meshed on one side of z = 0; two factorizations.

    Raises `fem.equations.linear.SingularMatrix` where it is unstable.
    """
    place = Place(piece, at)
    arch = _Arch.of(place)
    nodes, points = place.start, piece.space.points
    column = points[nodes[np.abs(points[nodes, 2]) < 1e-9 * piece.body.length]]
    ends = column[[int(np.argmin(column[:, 1])), int(np.argmax(column[:, 1]))]]
    bent = Bent(place, [Fixed("clamp", "x"), Fixed(ends, "z")])
    side = points[nodes[int(np.argmax(points[nodes, 2]))]]
    twisted = Twisted(place, [Fixed("clamp", "yz"), Fixed(side, "x")])
    compliance, tilts, parts = _twist(arch, bent, twisted)
    stiffness = np.linalg.inv(compliance)
    return LateralRigidities(
        bending=_bending(arch, bent, twisted.tractions(parts)),
        torsion=1.0 / float(compliance[0, 0]),
        shear=float(stiffness[1, 1]),
        twist_axis=float(stiffness[0, 1] / stiffness[1, 1]),
        tilt_by_torque=tilts,
        unstable=bent.equations.negative_pivots + twisted.equations.negative_pivots,
    )


@dataclass(frozen=True, eq=False)  # arrays inside
class _Arch:
    """The axis of a half cell as an arc, and how a rod on it moves out of the plane."""

    place: Place
    angle: float
    length: float
    stretch: float
    height: float  #: of the axis in the plane at the end: its position along e2, mm
    moment: float  #: M_1 of the meshed half, N mm

    @staticmethod
    def of(place: Place) -> "_Arch":
        piece, at = place.piece, place.at
        length, first = float(piece.space.points[piece.plane[0], 0]), float(place.x[piece.curve[0], 1])
        eta = float(place.x[piece.curve[-1]] @ place.within)
        stretch = length_of(at.angle, at.distance, first + eta) / length
        height = eta - float(end_ripples(at.angle, length, at.distance, eta, first)[1, 1])
        return _Arch(place, at.angle, length, stretch, height, at.moment / piece.whole)

    @property
    def turned(self) -> float:
        """sin(phi) / kappa, mm."""
        return self.length * float(np.sinc(self.angle / np.pi))

    @property
    def risen(self) -> float:
        """(1 - cos(phi)) / kappa, mm."""
        return 0.5 * self.length * self.angle * float(np.sinc(self.angle / (2.0 * np.pi))) ** 2

    @property
    def shortened(self) -> float:
        """(h - sin(phi) / kappa) / kappa, mm2."""
        if abs(self.angle) < SMALL:
            return self.length**2 * self.angle / 6.0 * (1.0 - self.angle**2 / 20.0)
        return self.length**2 * (self.angle - float(np.sin(self.angle))) / self.angle**2

    def bent(self, roll: float) -> tuple[float, float]:
        """kappa_2 and the roll about t at the end for a tilt by one there; roll: mean of both ends."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        matrix = [[0.5 * self.risen, 0.5 * (1.0 + cosine)], [self.turned, -sine]]
        curvature, first = np.linalg.solve(matrix, [roll, 1.0])
        return float(curvature), float(curvature * self.risen + first * cosine)

    def twisted(self, turn: float, lift: float, tilt: float) -> tuple[float, float, float, float]:
        """tau, gamma, and the tilts at start and end, of an end that is turned about n and lifted along z by `lift` at
        the origin; tilt: mean of both ends."""
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        matrix = [[self.turned, sine], [-0.5 * self.risen, 0.5 * (1.0 + cosine)]]
        twist, first = np.linalg.solve(matrix, [turn, tilt])
        lifted = turn * self.height + lift
        by_turns = self.stretch * (twist * self.shortened - first * self.turned)
        return float(twist), float(lifted - by_turns) / self.length, float(first), first * cosine - twist * self.risen


def _twist(arch: _Arch, bent: Bent, twisted: Twisted) -> tuple[Array, float, Array]:
    """C (2, 2) of the whole body, the difference of the tilts per torque, and the parts (2,) of both displacements of
    `twisted` for a unit torque.

    The couple that bends the half cell goes with them such that nothing else holds it.
    """
    place, whole = arch.place, arch.place.piece.whole
    sine, cosine = np.sin(arch.angle), np.cos(arch.angle)
    ends = bent.start_tractions, bent.tractions
    couple = 0.5 * (ends[0] + ends[1])
    (under_couple,) = twisted.equations.solve(-couple)
    held = twisted.held_by(under_couple)
    about_y = np.array([sine, -place.at.distance * cosine])  # of a torque about n, and of a force along z
    work = float(np.vdot(couple, place.turned(np.array([0.0, 1.0, 0.0])))) + float(about_y @ held)
    strains, forces, differences = np.empty((2, 2)), np.empty((2, 2)), np.empty(2)
    for k in range(2):
        reaction, turn, lift = twisted.reaction[:, k], float(k == 0), float(k == 1)
        factor = -(float(about_y @ reaction) - turn * arch.moment * cosine) / work
        motion = twisted.motions[k] + factor * under_couple
        torque, force = reaction + factor * held
        tilts = [float(np.vdot(end, motion)) for end in ends]
        twist, shear, first, last = arch.twisted(turn, lift, 0.5 * (tilts[0] + tilts[1]))
        strains[:, k] = twist, shear
        forces[:, k] = whole * (torque - arch.moment * last - arch.height * force), whole * force
        differences[k] = tilts[1] - tilts[0] - (last - first)
    by_torque = np.linalg.solve(forces, [1.0, 0.0])
    compliance = strains @ np.linalg.inv(forces)
    return 0.5 * (compliance + compliance.T), float(differences @ by_torque), np.asarray(by_torque)


def _bending(arch: _Arch, bent: Bent, torsion: Array) -> float:
    """B_2 of the whole body, N mm2; torsion: (n, 3) forces on both planes under a torque."""
    place = arch.place
    x_axis, normal = np.array([1.0, 0.0, 0.0]), place.normal
    last = place.on_plane(torsion - np.outer(torsion @ normal, normal))
    first = np.zeros_like(torsion)
    first[place.start, 1:] = -torsion[place.start, 1:]
    first /= np.vdot(first, place.turned(x_axis))
    last /= np.vdot(last, place.turned(normal))
    couple = 0.5 * (first + last)
    under_couple, held = bent.under(couple)
    sine, cosine = np.sin(arch.angle), np.cos(arch.angle)
    work = float(np.vdot(couple, place.turned(x_axis))) - held * sine
    factor = (bent.moment * sine - arch.moment * cosine) / work
    motion = bent.motion + factor * under_couple
    curvature, roll = arch.bent(float(np.vdot(couple, motion)))
    return float(place.piece.whole * (bent.moment + factor * held + arch.moment * roll) / curvature)


def clamped_compliance(piece: BendingPiece, at: PieceState, height: float) -> Array:
    """(3, 3), symmetric: turn about the normal n of the plane (rad), tilt about e2 (rad) and lift along z (mm) per
    torque, moment about e2 (N mm) and force along z (N), at a height within the plane in mm.

    Of the whole body without planar moment; two factorizations. The tilt of a warped plane is that on which the
    stresses of the moment do work. Raises `fem.equations.linear.SingularMatrix`.
    """
    place = Place(piece, at)
    bent, twisted = Bent(place, [Fixed("clamp")]), Twisted(place, [Fixed("clamp")])
    tilts = [float(np.vdot(bent.tractions, motion)) for motion in twisted.motions]
    by_forces = np.linalg.inv(piece.whole * twisted.reaction)
    compliance = np.zeros((3, 3))
    compliance[np.ix_((0, 2), (0, 2))] = by_forces
    compliance[1, 1] = 1.0 / (piece.whole * bent.moment)
    compliance[1, (0, 2)] = compliance[(0, 2), 1] = tilts @ by_forces
    shift = np.eye(3)  # from forces at that height to those at the origin
    shift[0, 2] = height
    result = shift.T @ compliance @ shift
    return np.asarray(0.5 * (result + result.T))


def lateral_rates(
    piece: BendingPiece,
    at: PieceState,
    known: Slopes,
    changes: Mapping[str, DesignChange],
    rates: Mapping[str, DesignRate],
) -> dict[str, tuple[float, float]]:
    """Derivatives of B_2 and GJ by parameter over B_2 and GJ, per unit of it.

    rates: of this state, with those of the displacement. Raises `fem.equations.linear.SingularMatrix`.
    """
    if not changes:
        return {}
    u = at.state.displacement
    own = _rigidities(piece, at, Variant(piece.space, piece.system.formulation, 1.0), u)
    result = {}
    for name, change in changes.items():
        step, rate = 0.5 * change.step, rates[name]
        turn = at.angle / piece.body.length * change.length
        moved = rate.moved + turn * known.by_angle
        moved[piece.plane] -= change.velocity[piece.plane]
        moment = at.moment + step * (rate.moment + turn * known.moment_by_angle)
        state = replace(at, angle=at.angle + step * turn, moment=moment)
        more = _rigidities(piece, state, change.more, u + step * moved)
        bending, torsion = more.bending / own.bending - 1.0, more.torsion / own.torsion - 1.0
        result[name] = bending / step, torsion / step
    return result


def _rigidities(piece: BendingPiece, at: PieceState, variant: Variant, displacement: Array) -> LateralRigidities:
    """Of a variant with this displacement (n, 3); at: its angle, moment and pressure, with the terms of the piece."""
    space, formulation = variant.space, variant.formulation
    strain, _ = space.strain_of(displacement)
    pressure = formulation.pressure_of(strain)
    stress = formulation.evaluate(strain, pressure).stress
    end = (space.points + displacement)[piece.plane[0]]
    moved = replace(
        at,
        distance=float(end @ (np.cos(at.angle), np.sin(at.angle), 0.0)),
        state=State(at.state.factor, displacement, pressure, strain, stress),
        terms=tuple(moved_term(term, piece.space.points, variant) for term in at.terms),
    )
    return lateral_rigidities(piece.varied(space, formulation), moved)
