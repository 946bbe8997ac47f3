"""Cell-averaged curvature: an estimate without any smoothing parameter.

The chambers of an arm repeat with the pitch p. Within a cell the angle of the material curve has a ripple; between
equivalent points of neighbouring cells the ripple cancels, so that

    kappa(t) = (theta(t + p/2) - theta(t - p/2)) / p

is the mean curvature over one pitch around t, whatever its distribution within. theta is the chord angle between
neighbouring nodes.
"""

import numpy as np
from scipy.interpolate import CubicSpline

from geometry import Centreline
from geometry.arrays import Array
from rod.curves.curve import Curvature, mean_angle_weights
from rod.curves.uncertainty import white_noise
from rod.errors import RodError

#: by which a pitch may be shorter than twice the distance of nodes, relative to it
ROUNDING = 1e-9


def shortest_pitch(spacing: float) -> float:
    """The shortest pitch (mm) over which curvature is averaged where nodes are up to `spacing` (mm) apart."""
    return 2.0 * spacing / (1.0 + ROUNDING)


def cell_averaged(centreline: Centreline, pitch: float) -> Curvature:
    """Mean curvature over one pitch (mm) around points that are as dense as the nodes of the curve.

    theta and kappa belong to rest arc length. The end points lie about half a pitch inside the curve, for an end cell
    has one neighbour only. The covariance follows from white noise of the node positions, which is estimated from
    the roughness of kappa. Raises `RodError` for a pitch that is not positive or leaves less than three
    cells, and for nodes farther apart than half a pitch.
    """
    s = centreline.s - centreline.s[0]
    length = float(s[-1])
    if not (np.isfinite(pitch) and pitch > 0.0):
        raise RodError(f"The pitch of the cells must be positive, not {pitch} mm.")
    if length < 3.0 * pitch:
        raise RodError(
            f"Cell-averaged curvature needs three cells; a curve of {length:g} mm has no three of {pitch:g} mm."
        )
    if pitch < shortest_pitch(float(np.diff(s).max())):
        raise RodError(f"Nodes {np.diff(s).max():g} mm apart cannot resolve cells of {pitch:g} mm; refine the mesh.")
    middle = 0.5 * (s[:-1] + s[1:])
    # the last half cell is bent by the support of the end
    starts = np.flatnonzero(middle + pitch <= length - 0.5 * pitch)
    ahead = _interpolation(middle, middle[starts] + pitch)
    behind = np.eye(len(middle))[starts]
    difference = (ahead - behind) / pitch
    angle = centreline.angle
    kappa = difference @ angle
    response = difference @ (np.diff(np.eye(len(s)), axis=0) / np.diff(s)[:, None])  # of angles by sideways motions
    centres = middle[starts] + 0.5 * pitch
    theta = np.interp(centres, middle, angle)
    resolution = difference @ mean_angle_weights(s, length)
    return Curvature(length, pitch, centres, kappa, theta, white_noise(response, kappa), resolution, response)


def _interpolation(x: Array, at: Array) -> Array:
    """(m, n) weights of linear interpolation at the points `at` (m,) between x (n,)."""
    left = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
    fraction = np.clip((at - x[left]) / (x[left + 1] - x[left]), 0.0, 1.0)
    weights = np.zeros((len(at), len(x)))
    weights[np.arange(len(at)), left] = 1.0 - fraction
    weights[np.arange(len(at)), left + 1] += fraction
    return weights


def rest_curvature(free: Centreline) -> tuple[float, Array]:
    """theta (rad) at the clamp, and (n, 2) columns s (mm) and kappa (1/mm) at the nodes of the unloaded shape.

    The integral of theta is a cubic spline through the chords, so that a rod with this curvature, straight between
    nodes, has the chords' directions. It has the ripple and the noise of the shape; only its integrals matter.
    """
    s = free.s - free.s[0]
    rise = np.cumsum(np.diff(s) * free.angle)
    integral = CubicSpline(s, np.concatenate([[0.0], rise]))
    return float(integral(0.0, 1)), np.column_stack([s, integral(s, 2)])
