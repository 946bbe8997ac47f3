"""The rod axis of a bent piece: stretch, and where the material curve runs beside it.

In pure bending the planes of mirror symmetry of all cells pass through one line, the centre of curvature. The material
curve crosses them at two radii, in the middle of the cells and at their ends, because the floor of a cavity bulges; the
axis of the rod is the circle between the two.
"""

from dataclasses import dataclass
from math import nan
from typing import final

import numpy as np

from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes
from geometry.arrays import Array

#: angles up to this are evaluated by series
SMALL = 1e-3


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Axis:
    """The axis over a half cell at one state."""

    stretch: float  #: of the axis
    stretch_by_angle: float  #: 1/rad
    stretch_by_pressure: float  #: 1/MPa
    s: Array  #: (m,) rest positions of the nodes of the material curve from the middle of the cell, mm
    ripple: Array  #: (m, 2) of the nodes beside the axis point at the same s, along the axis and normal to it, mm
    stretch_by_other: float = nan  #: 1/MPa, as in `Slopes`


def axis_of(piece: BendingPiece, at: PieceState, known: Slopes) -> Axis:
    """The axis of a half cell between two mirror planes."""
    phi, h, c = at.angle, piece.body.length, at.distance
    x = piece.space.points + at.state.displacement
    first, last = piece.curve[0], piece.curve[-1]
    normal, along = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    y, eta = float(x[first, 1]), float(x[last, :2] @ along)
    a, b, a_slope, b_slope = _functions(phi)
    length = length_of(phi, c, y + eta)

    def change(displacement: Array, angle: float) -> float:
        """Change of the length of the axis with a displacement (n, 3) that belongs to a change of the angle."""
        dc = float(displacement[last, :2] @ normal) + eta * angle
        deta = float(displacement[last, :2] @ along) - c * angle
        dy = float(displacement[first, 1])
        direct = (a_slope + b_slope) * c - (y + eta)
        return ((a + b) * dc - phi * (dy + deta) + direct * angle) / 2.0

    middle = _middle(phi, c, eta, y)
    s = piece.space.points[piece.curve, 0]
    return Axis(
        stretch=length / h,
        stretch_by_angle=change(known.by_angle, 1.0) / h,
        stretch_by_pressure=change(known.by_pressure, 0.0) / h,
        s=s,
        ripple=_beside(x[piece.curve, :2], s, length / h, phi / h, middle),
        stretch_by_other=change(known.by_other, 0.0) / h if len(known.by_other) else nan,
    )


def length_of(phi: float, distance: float, heights: float) -> float:
    """Length of the axis over a half cell whose plane has turned by phi, mm; linear in the others.

    distance: c, mm; heights: the sum of those of the material curve in both planes, mm.
    """
    a, b, _, _ = _functions(phi)
    return ((a + b) * distance - phi * heights) / 2.0


def end_ripples(phi: float, half_pitch: float, distance: float, eta: float, y: float) -> Array:
    """(2, 2) mm: the material curve beside the axis in the middle of the cell, at the height y, and at its end, at the
    distance c and the height eta within the plane, mm; along the axis and normal to it."""
    normal, along = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    points, s = np.array([[0.0, y], distance * normal + eta * along]), np.array([0.0, half_pitch])
    stretch = length_of(phi, distance, y + eta) / half_pitch
    return _beside(points, s, stretch, phi / half_pitch, _middle(phi, distance, eta, y))


def _middle(phi: float, distance: float, eta: float, y: float) -> float:
    """Height of the axis in the middle of the cell, mm."""
    return y + (distance * float(np.tan(phi / 2.0)) - (y - eta)) / 2.0


def circle(s: Array, stretch: float, curvature: float) -> Array:
    """Points (m, 2) of an axis that starts at the origin along x, at rest positions s (m,), mm; curvature per rest
    length, 1/mm."""
    angle = curvature * s
    small = np.abs(angle) < SMALL
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1.0 - angle**2 / 6.0, np.sin(safe) / safe)
    versine = np.where(small, angle / 2.0 * (1.0 - angle**2 / 12.0), (1.0 - np.cos(safe)) / safe)
    return np.asarray(stretch * s[:, None] * np.stack([sine, versine], axis=1))


def components(away: Array, angle: Array) -> Array:
    """Components (m, 2) of vectors (m, 2) along and normal to directions of the given angles (m,)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([away[:, 0] * cosine + away[:, 1] * sine, away[:, 1] * cosine - away[:, 0] * sine], axis=1)


def _beside(points: Array, s: Array, stretch: float, curvature: float, height: float) -> Array:
    """Components (m, 2) along and normal to the axis of the points (m, 2) beside it."""
    return components(points - circle(s, stretch, curvature) - np.array([0.0, height]), curvature * s)


def _functions(phi: float) -> tuple[float, float, float, float]:
    """phi / sin phi, phi cot phi, and their derivatives."""
    if abs(phi) < SMALL:
        return 1.0 + phi**2 / 6.0, 1.0 - phi**2 / 3.0, phi / 3.0, -2.0 * phi / 3.0
    sine, cosine = float(np.sin(phi)), float(np.cos(phi))
    return phi / sine, phi * cosine / sine, (sine - phi * cosine) / sine**2, cosine / sine - phi / sine**2
