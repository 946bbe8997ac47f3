"""The extensible rod: how the material curve of a loaded arm stretches.

The neutral axis of an arm under pressure does not lie on its material curve. Where the arm is bent by Delta, a fibre at
the distance e from the neutral axis is lengthened by e Delta:

    lambda(s) = lambda_0(s) + e Delta(s),    Delta = kappa - kappa_0

lambda_0 is the stretch of the curve without end load (experiment II), a profile like kappa_0; the eccentricity e is one
number per pressure, the sixth parameter, read from experiment III. With it the position of the rod at every s is right,
not only its angle. The moment that bends such an arm is that about its neutral axis, M + e N with the axial force N
(`moment_about_neutral_axis`). Stretch by the normal force (F/EA, a tenth of a per cent) is neglected.
"""

import math
from dataclasses import dataclass

import numpy as np

from geometry import Centreline
from geometry.arrays import Array, freeze
from rod.curves.cell_average import cell_averaged
from rod.curves.curve import Moment, moment_between
from rod.errors import RodError
from rod.load import Load


@dataclass(frozen=True)
class Extension:
    """lambda_0 and e. Arrays are read-only.

    Raises `RodError` unless s rises, every rest stretch is positive and e is a finite number.
    """

    s: Array  #: (n,) mm
    rest_stretch: Array  #: (n,) lambda_0 at s, joined by straight lines
    eccentricity: float  #: mm, positive where the curve is lengthened by Delta
    eccentricity_std: float = 0.0  #: mm

    def __post_init__(self) -> None:
        freeze(self, ("s", "rest_stretch"))
        if (
            self.s.ndim != 1
            or len(self.s) < 2
            or self.s.shape != self.rest_stretch.shape
            or np.any(np.diff(self.s) <= 0)
        ):
            raise RodError("The rest stretch is given at two or more points s that rise.")
        if not np.all(self.rest_stretch > 0.0):
            raise RodError("A rest stretch is a length over another and must be positive.")
        if not math.isfinite(self.eccentricity):
            raise RodError(f"The eccentricity must be a finite number, not {self.eccentricity} mm.")

    def at(self, s: Array) -> Array:
        """lambda_0 at s, mm, any shape."""
        return np.interp(s, self.s, self.rest_stretch)


def stretches(curve: Centreline) -> Array:
    """(n - 1,) arc length over rest length between neighbouring nodes, corrected for chord and arc."""
    return curve.chords / (np.diff(curve.s) * np.sinc(np.gradient(curve.angle) / (2.0 * np.pi)))


def extension(free: Centreline, loaded: Centreline, pitch: float) -> Extension:
    """lambda_0 from experiment II (free) and e from experiment III (loaded), both curves with the same points s.

    e minimises the squares of (lambda_III - lambda_II) - e Delta, both averaged over a pitch (mm), because within a
    cell they are proportional only on average. Its standard deviation is that of a regression with as many observations
    as cells.
    Raises `RodError` as `cell_averaged` does, and where nothing bends.
    """
    from scipy.interpolate import CubicSpline  # inside, because it would delay `pneurod rod` by its import

    s = free.s - free.s[0]
    lengths = [np.concatenate([[0.0], np.cumsum(stretches(c) * np.diff(s))]) for c in (free, loaded)]
    rest = CubicSpline(s, lengths[0])(s, 1)
    unloaded, bent = cell_averaged(free, pitch), cell_averaged(loaded, pitch)
    delta = bent.kappa - unloaded.kappa
    if not np.any(delta):
        raise RodError("Where nothing bends the neutral axis cannot be identified.")
    ahead, behind = bent.s + 0.5 * pitch, bent.s - 0.5 * pitch
    added = lengths[1] - lengths[0]
    stretch = (np.interp(ahead, s, added) - np.interp(behind, s, added)) / pitch
    eccentricity = float(delta @ stretch / (delta @ delta))
    cells = max(2.0, float(np.ptp(bent.s)) / pitch + 1.0)
    misfit = float(np.mean((stretch - eccentricity * delta) ** 2)) * cells / (cells - 1.0)
    std = math.sqrt(misfit / cells / float(np.mean(delta**2)))
    return Extension(s, rest, eccentricity, std)


def moment_about_neutral_axis(free: Centreline, loaded: Centreline, load: Load, eccentricity: float) -> Moment:
    """M + e N at the nodes of the loaded curve less that of the free one, which bears the weight alone.

    With the stretch lambda_0 + e Delta it does the work of all loads when the curvature of the rod changes. N is the
    force along the tangent; eccentricity: e, mm.
    """
    moment = moment_between(free, loaded, load)
    along = _axial_force(loaded, load) - _axial_force(free, load.own_weight)
    return Moment(moment.s, moment.value + eccentricity * along)


def _axial_force(curve: Centreline, load: Load) -> Array:
    """(n,) N, of the load on the curve beyond every node."""
    angle = np.interp(curve.s, 0.5 * (curve.s[1:] + curve.s[:-1]), curve.angle)
    x, y, _ = (force + weight * (curve.s[-1] - curve.s) for force, weight in zip(load.force, load.weight, strict=True))
    return x * np.cos(angle) + y * np.sin(angle)
