"""Numbers of claims: how straight a quantity is over another one, whether it rises, how far apart two curves are."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry import Centreline
from geometry.arrays import Array


@dataclass(frozen=True)
class Line:
    """A least-squares line and how far the points are off it."""

    slope: float
    slope_std: float
    off: float  #: largest distance over the largest |value|
    at_zero: float  #: where it meets zero


def line(x: Sequence[float], y: Sequence[float], deviations: Sequence[float] = (), *, origin: bool = False) -> Line:
    """The line through the points x, y (n,), or through the origin as well; n >= 3, or 2 through the origin.

    The deviation of its slope follows from the scatter of the points, or from their own deviations if these give more.
    """
    u, v = np.asarray(x, float), np.asarray(y, float)
    middle = np.zeros(2) if origin else np.array([u.mean(), v.mean()])
    p, q = u - middle[0], v - middle[1]
    slope = float(p @ q) / float(p @ p)
    rest = q - slope * p
    scatter = float(rest @ rest) / max(1, len(u) - (1 if origin else 2)) / float(p @ p)
    given = float(np.sum((p * np.asarray(deviations)) ** 2)) / float(p @ p) ** 2 if len(deviations) else 0.0
    crossing = float(middle[0] - middle[1] / slope) if slope else float("nan")
    return Line(slope, max(scatter, given) ** 0.5, float(np.abs(rest).max() / np.abs(v).max()), crossing)


def aligned(moving: Centreline, fixed: Centreline) -> Array:
    """(n, 2) mm: a curve after the rigid motion that brings it closest to another one with the same points."""
    a, b = (np.column_stack([curve.x, curve.y]) for curve in (moving, fixed))
    a, centre = a - a.mean(axis=0), b.mean(axis=0)
    left, _, right = np.linalg.svd(a.T @ (b - centre))
    turn = left @ np.diag([1.0, float(np.sign(np.linalg.det(left @ right)))]) @ right
    return np.asarray(a @ turn + centre)


def aligned_distance(moving: Centreline, fixed: Centreline) -> float:
    """Largest distance (mm) of two curves with the same points after that motion."""
    return float(np.hypot(*(aligned(moving, fixed) - np.column_stack([fixed.x, fixed.y])).T).max())


def sign_change(s: Array, kappa: Array) -> float:
    """The first s (mm) at which kappa (n,) changes its sign; nan where it does not."""
    changes = np.flatnonzero(np.sign(kappa[1:]) * np.sign(kappa[:-1]) < 0)
    if not len(changes):
        return float("nan")
    k = int(changes[0])
    return float(s[k] - kappa[k] * (s[k + 1] - s[k]) / (kappa[k + 1] - kappa[k]))
