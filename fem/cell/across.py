"""Twist and shear of a straight half cell of any section under pressure: their common compliance.

A torque T, or a shear force Q_y or Q_z, on the plane between two cells leaves the middle of the cell antisymmetric. The
moment of a shear force grows from zero there to h Q at the plane. It splits there into pure bending, whose displacement
is known, and a part that is antisymmetric about the plane too: nodes of the plane move within it as a rigid body,
freely along its normal, and no normal force acts. In the middle of the cell the sum of both moves along the arm alone.
The energy of the half cell under each pair of loads, less that of its bending, is h times the compliance

    (twist, shear_y, shear_z) = C (T, Q_y, Q_z),      with the torque about the material curve.

Forces of the air on rims of the plane that warps are those of `fem.cell.rim`.
"""

from dataclasses import dataclass
from typing import final

import numpy as np

from fem.cell.any_plane import frame_of
from fem.cell.mirror_contact import is_with_images
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes, force_change
from fem.cell.rim import rim_forces
from fem.equations.constraints import Constraints
from fem.supports import Fixed
from geometry.arrays import Array
from geometry.topology import cross

#: rad, the direction in which a body is turned to bend about minus y
QUARTER = np.pi / 2.0


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Straight:
    """A half cell in a straight state, in its own body or in one that is turned by a quarter."""

    piece: BendingPiece
    at: PieceState
    slopes: Slopes


def twist_and_shear(straight: Straight, quarter: Straight) -> Array:
    """C (3, 3) of the whole body, symmetric: 1/(N mm2), 1/(N mm) and 1/N; one factorization.

    quarter: the same state in the body turned by `QUARTER`. Raises `fem.equations.linear.SingularMatrix`.
    """
    section = _Section(straight)
    h, (about_y, about_z) = straight.piece.body.length, _bends(straight, quarter)
    forces = [section.forces(bend) for bend in (about_y, about_z)]
    stiffness = np.array([[float(np.vdot(force, bend)) for bend in (about_y, about_z)] for force in forces])
    soft = np.linalg.inv(0.5 * (stiffness + stiffness.T))
    moments = np.array([[0.0, 0.0], [0.0, -h], [h, 0.0]])  # about y and z at the plane, by T, Q_y and Q_z
    answers = [section.under(k, moment @ soft, (about_y, about_z)) for k, moment in enumerate(moments)]
    energy = np.array([[section.energy(one, other) for other in answers] for one in answers])
    bent = moments @ soft @ moments.T / 3.0  # of a moment that grows in proportion to s
    compliance = (energy - bent) / (h * straight.piece.whole)
    return np.asarray(0.5 * (compliance + compliance.T))


def _bends(straight: Straight, quarter: Straight) -> tuple[Array, Array]:
    """Displacements (n, 3) of bending about y and about z by one radian."""
    turned = quarter.slopes.by_angle
    about_y = np.column_stack([turned[:, 0], turned[:, 1:] @ frame_of(QUARTER)])
    return -about_y, straight.slopes.by_angle


def _triangle(points: Array) -> Array:
    """(3, 3): the first of the points (n, 3), the one that is farthest from it, and that farthest from both."""
    away = points - points[0]
    far = int(np.argmax((away**2).sum(axis=1)))
    aside = int(np.argmax((cross(away, away[far]) ** 2).sum(axis=1)))
    return points[[0, far, aside]]


class _Section:
    """The equations of twist and shear of a straight half cell, factorized."""

    def __init__(self, straight: Straight) -> None:
        self.piece, self.at = straight.piece, straight.at
        piece, space = self.piece, self.piece.space
        self.terms = tuple(term for term in self.at.terms if not is_with_images(term, piece.plane))
        self.middle = space.surface("clamp").unique_nodes
        held = [Fixed("clamp", "yz"), Fixed("tip", "yz"), Fixed(_triangle(space.points[self.middle]), "x")]
        self.system = piece.other_system("across", self.terms, Constraints.of(held, space))
        assembly = self.system.assemble(self.at.state, self.terms)
        self.tangent = self.system.linearise(self.at.state, assembly, self.terms)
        axis, normal = np.array([0.0, piece.body.curve_y, 0.0]), np.array([1.0, 0.0, 0.0])
        x = space.points + self.at.state.displacement - axis
        moves = [
            -cross(x, normal),
            np.broadcast_to([0.0, 1.0, 0.0], x.shape),
            np.broadcast_to([0.0, 0.0, 1.0], x.shape),
        ]
        self.moves = [self._on_plane(move) for move in moves]

        def of_turn(x: Array, nu: Array) -> Array:
            return np.outer((x - axis)[:, 1] * nu[:, 2] + x[:, 2] * nu[:, 1], normal)

        def of_lift(_: Array, nu: Array) -> Array:
            return np.outer(nu[:, 2], normal)

        self.rims = [rim_forces(piece, self.at, of_turn), np.zeros_like(x), rim_forces(piece, self.at, of_lift)]
        self.loads = [self.forces(move) + rim for move, rim in zip(self.moves, self.rims, strict=True)]
        self.motions = [move + self._answer(load) for move, load in zip(self.moves, self.loads, strict=True)]
        self.reaction = np.array([self._held_by(motion) for motion in self.motions]).T

    def _on_plane(self, values: Array) -> Array:
        result = np.zeros_like(self.piece.space.points)
        result[self.piece.plane] = values[self.piece.plane]
        return result

    def forces(self, motion: Array) -> Array:
        """Change (n, 3) of the nodal gradient with a displacement (n, 3), to first order."""
        return force_change(self.system, self.piece, self.at, self.terms, motion)

    def _answer(self, load: Array) -> Array:
        (change,) = self.tangent.solve_each([(load, None)])
        return change.displacement

    def _held_by(self, motion: Array) -> Array:
        """(3,): torque and forces within the plane that a displacement (n, 3) makes."""
        return np.array([float(np.vdot(load, motion)) for load in self.loads])

    def energy(self, one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
        """Twice that of the half body, between two answers of `under`; N mm."""
        (first, moved), (second, also) = one, other
        of_air = (np.vdot(also[k] * first + moved[k] * second, rim) for k, rim in enumerate(self.rims))
        return float(np.vdot(self.forces(first), second) + sum(of_air))

    def under(self, kind: int, turns: Array, bends: tuple[Array, Array]) -> tuple[Array, Array]:
        """The displacement (n, 3) under a unit torque (0) or a unit force along y (1) or z (2), and the motions of the
        plane in it: its turn in rad, and along y and z in mm, (3,).

        turns: (2,) rad of the plane about y and z by its bending; bends: (n, 3) per radian.
        """
        bending = turns[0] * bends[0] + turns[1] * bends[1]
        beside = np.zeros_like(bending)
        if kind:
            beside[self.middle, 1:] = -bending[self.middle, 1:]
            load = self.forces(beside)
            load[self.middle, 0] += self.forces(bending)[self.middle, 0]
            beside = beside + self._answer(load)
        parts = np.linalg.solve(self.reaction, np.eye(3)[kind] - self._held_by(beside))
        return np.asarray(bending + beside + np.tensordot(parts, np.array(self.motions), 1)), parts
