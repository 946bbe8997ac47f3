"""Curvature and moment along a material curve, with what an estimate of curvature can resolve.

No estimate gives curvature at a point: differences of angles give its mean over a cell, a smoother gives a weighted
mean over its length scale. Both are linear in the true curvature, so each estimate carries the weights of its means,
the *resolution* R:

    kappa_estimated(s_i) = sum_j R_ij kappa(sigma_j) + error

With R a law is compared with data as the estimate resolves it, so that a step in the rigidity is located where it is,
not where smoothing has spread it.
"""

from dataclasses import dataclass

import numpy as np

from geometry import Centreline
from geometry.arrays import Array, freeze
from rod.curves.uncertainty import local_deviation
from rod.errors import RodError
from rod.load import Load

#: intervals per length of the grid on which resolutions are expressed
GRID_CELLS = 448


def fine_grid(length: float) -> Array:
    """(GRID_CELLS,) midpoints of equal intervals from 0 to length, mm."""
    return np.linspace(0.5, GRID_CELLS - 0.5, GRID_CELLS) * (length / GRID_CELLS)


@dataclass(frozen=True)
class Curvature:
    """An estimate of curvature along a material curve of rest length `length`. Arrays are read-only.

    Raises `RodError` for fewer than 6 points.
    """

    length: float  #: mm
    pitch: float  #: mm, the length over which neighbouring errors are related
    s: Array  #: (n,) mm, rest arc length
    kappa: Array  #: (n,) 1/mm
    theta: Array  #: (n,) rad, tangent angle
    covariance: Array  #: (n, n) 1/mm2, of the error of kappa
    resolution: Array  #: (n, GRID_CELLS), weights of the true curvature on `fine_grid(length)`
    #: (n, nodes) 1/mm2, derivative of kappa by sideways displacements of the nodes, for estimates whose error is white
    #: noise of the nodes; None for others
    response: Array | None = None

    def __post_init__(self) -> None:
        freeze(self, ("s", "kappa", "theta", "covariance", "resolution", "response"))
        if len(self.s) < 6:
            raise RodError(f"A curvature needs at least 6 points along the curve; there are {len(self.s)}.")

    @property
    def middle(self) -> float:
        """Curvature in the middle of the arm, 1/mm, interpolated linearly between the points nearest to it."""
        return float(np.interp(self.length / 2, self.s, self.kappa))

    @property
    def middle_std(self) -> float:
        """Its standard deviation, 1/mm."""
        return float(np.interp(self.length / 2, self.s, self.kappa_std))

    @property
    def kappa_std(self) -> Array:
        """(n,) 1/mm, standard deviation of kappa; of white noise that from the roughness within a pitch.

        The curvature changes quickly at both ends, so that the noise of the whole curve is too large elsewhere.
        """
        if self.response is None:
            return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return local_deviation(self.response, self.kappa, self.s, self.pitch)


@dataclass(frozen=True)
class Moment:
    """Bending moment along the material curve. Arrays are read-only."""

    s: Array  #: (n,) mm, rest arc length
    value: Array  #: (n,) N mm

    def __post_init__(self) -> None:
        freeze(self, ("s", "value"))


def moment_from_load(centreline: Centreline, load: Load) -> Moment:
    """Bending moment at the nodes of the loaded curve (paper, equation (7), with couple and weight).

        M(s) = (r(l) - r(s)) x F + couple + integral from s to l of (r(t) + h n(t) - r(s)) x q dt

    with the height h of the mass above the curve and the normal n. It is statics alone and holds whatever the law of
    the rod. The integral is by the trapezoidal rule.
    """
    s, x, y = centreline.s - centreline.s[0], centreline.x, centreline.y
    (fx, fy, _), (qx, qy, _) = load.force, load.weight
    moment = (x[-1] - x) * fy - (y[-1] - y) * fx
    moment += _lever_integral(s, x) * qy - _lever_integral(s, y) * qx
    angle = centreline.angle
    couples = -load.weight_height * np.diff(s) * (qy * np.sin(angle) + qx * np.cos(angle))
    moment += np.append(np.cumsum(couples[::-1])[::-1], 0.0)
    return Moment(s, moment + load.couple[2])


def moment_between(free: Centreline, loaded: Centreline, load: Load) -> Moment:
    """Bending moment at the nodes of the loaded curve less that of the free one, which bears the weight alone.

    This is the moment that changes the curvature of the free curve into that of the loaded one.
    """
    moment, weight = moment_from_load(loaded, load), Load(weight=load.weight, weight_height=load.weight_height)
    return Moment(moment.s, moment.value - moment_from_load(free, weight).value)


def _lever_integral(s: Array, x: Array) -> Array:
    """(n,) mm2: integral from s to l of x(t) - x(s) dt."""
    pieces = np.diff(s) * 0.5 * (x[1:] + x[:-1])
    return np.append(np.cumsum(pieces[::-1])[::-1], 0.0) - (s[-1] - s) * x


def without_stretch(curve: Centreline) -> Centreline:
    """The curve with the same tangent angles and its rest length: the best shape of an inextensible rod."""
    angle, h = curve.angle, np.diff(curve.s)
    # the chord of an arc that turns by t is shorter than the arc by sin(t/2)/(t/2)
    chord = h * np.sinc(np.gradient(angle) / (2.0 * np.pi))
    x, y = (np.concatenate([[0.0], np.cumsum(chord * f(angle))]) for f in (np.cos, np.sin))
    return Centreline(curve.s, curve.x[0] + x, curve.y[0] + y)


def mean_angle_weights(s: Array, length: float) -> Array:
    """(n - 1, GRID_CELLS): mean tangent angle between neighbouring nodes s (n,), less the angle at s = 0, from
    curvature.

    Row j holds the weights w with mean theta over [s_j, s_j+1] = theta(0) + sum w kappa: integrals over the grid of the
    fraction of the interval that lies beyond sigma.
    """
    edges = np.linspace(0.0, length, GRID_CELLS + 1)

    def beyond(sigma: Array) -> Array:  # integral from 0 to sigma of that fraction of [a, b], one row per interval
        a, b = s[:-1, None], s[1:, None]
        inside = np.clip(sigma, a, b) - a
        return np.minimum(sigma, a) + inside - inside**2 / (2.0 * (b - a))

    return np.diff(beyond(edges[None, :]), axis=1)
