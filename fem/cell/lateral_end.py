"""The clamped end of an arm out of its plane: motions of its plane under a lateral moment, a torque and a force."""

import numpy as np

from fem.cell.piece import BendingPiece, PieceState
from fem.cell.sideways import Bent, Place, Twisted
from fem.supports import Fixed
from geometry.arrays import Array


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
