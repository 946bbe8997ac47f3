"""Simpler and richer laws than the five parameters, compared by loads that were not used for the fit.

Every law gives Delta as a function of s and M, linear in its parameters but for one nonlinear parameter, a break or a
threshold. It is fitted to one loaded curve and predicts the Delta of others at the same pressure (another end position,
a dead force) from their measured moment:

    one line               Delta = a M - b
    two slopes             Delta = a_i M, i by s < d: lines through the origin
    five parameters        Delta = a_i M - b_i, i by s < d
    spring and one line    Delta = a M - b, and a rotation c M(0) at the clamp
    contact                Delta = a M - b + c (|M| - M_c)+ sign M: a slope that changes with the load, not with s

Where a simpler law predicts as well as a richer one, it is preferred.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from geometry.arrays import Array
from rod.curves.curve import Curvature, Moment, fine_grid
from rod.errors import RodError

#: length of the zone at the clamp that represents a spring, over the length of the arm
SPRING_LENGTH = 0.02
#: a law is as good as another when its error is at most this many times the other's
EQUAL_ERROR = 1.1


@dataclass(frozen=True)
class Observation:
    """One loaded curve at one pressure: both curvatures from the same estimator, and the moment."""

    kappa_0: Curvature
    kappa: Curvature
    moment: Moment

    @property
    def delta(self) -> Array:
        """(n,) 1/mm."""
        return self.kappa.kappa - self.kappa_0.kappa

    def resolved(self, deviation: Array) -> Array:
        """(n, k): deviations (GRID_CELLS, k) on the fine grid as the estimate of curvature resolves them."""
        resolution = 0.5 * (self.kappa.resolution + self.kappa_0.resolution)
        return resolution @ deviation


@dataclass(frozen=True)
class Candidate:
    """A law and its errors."""

    name: str
    parameters: int  #: how many
    in_sample: float  #: root-mean-square error of Delta over that of Delta, on the curve it was fitted to
    out_of_sample: float  #: the same on the other curves together


@dataclass(frozen=True)
class _Law:
    name: str
    parameters: int
    #: from s, M (m,), the nonlinear parameter and the length: (m, k), Delta by the linear parameters
    design: Callable[[Array, Array, float, float], Array]
    #: candidates of the nonlinear parameter, from the length and the largest moment
    candidates: Callable[[float, float], Array]


def _single_line(s: Array, m: Array, nonlinear: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m))])


def _two_slopes(s: Array, m: Array, nonlinear: float, length: float) -> Array:
    return np.column_stack([m * (s < nonlinear), m * (s >= nonlinear)])


def _five_parameters(s: Array, m: Array, nonlinear: float, length: float) -> Array:
    first = s < nonlinear
    return np.column_stack([m * first, -1.0 * first, m * ~first, -1.0 * ~first])


def _spring_at_clamp(s: Array, m: Array, nonlinear: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m)), m * (s < SPRING_LENGTH * length)])


def _contact_threshold(s: Array, m: Array, nonlinear: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m)), np.maximum(np.abs(m) - nonlinear, 0.0) * np.sign(m)])


def _none(length: float, largest_moment: float) -> Array:
    return np.zeros(1)


def _breaks(length: float, largest_moment: float) -> Array:
    return np.linspace(0.045, 0.35, 69) * length


def _thresholds(length: float, largest_moment: float) -> Array:
    return np.linspace(0.1, 0.9, 41) * largest_moment


ALTERNATIVES = (
    _Law("one line", 2, _single_line, _none),
    _Law("two slopes", 3, _two_slopes, _breaks),
    _Law("five parameters", 5, _five_parameters, _breaks),
    _Law("spring and one line", 3, _spring_at_clamp, _none),
    _Law("contact", 4, _contact_threshold, _thresholds),
)


def compare_laws(fitted: Observation, others: Sequence[Observation]) -> tuple[Candidate, ...]:
    """Every law fitted to one loaded curve, with its error on others at the same pressure.

    Raises `RodError` when there is no other curve, or when they are not of the same arm.
    """
    if not others:
        raise RodError("Laws are compared by loads that were not used for the fit; there is none.")
    if any(abs(o.kappa.length - fitted.kappa.length) > 1e-6 * fitted.kappa.length for o in others):
        raise RodError("Laws are compared on curves of one arm; these differ in length.")
    return tuple(_candidate(law, fitted, others) for law in ALTERNATIVES)


def simplest(candidates: Sequence[Candidate]) -> Candidate:
    """The law with the fewest parameters whose error out of sample is at most EQUAL_ERROR times the smallest."""
    limit = EQUAL_ERROR * min(c.out_of_sample for c in candidates)
    return min((c for c in candidates if c.out_of_sample <= limit), key=lambda c: (c.parameters, c.out_of_sample))


def _resolved_design(law: _Law, observation: Observation, nonlinear: float) -> Array:
    """(n, k): observed Delta by the linear parameters of a law."""
    length = observation.kappa.length
    s = fine_grid(length)
    moment = CubicSpline(observation.moment.s, observation.moment.value)(s)
    return observation.resolved(law.design(s, moment, nonlinear, length))


def _candidate(law: _Law, fitted: Observation, others: Sequence[Observation]) -> Candidate:
    least, nonlinear, linear = np.inf, 0.0, [0.0] * law.parameters
    for trial in law.candidates(fitted.kappa.length, float(np.abs(fitted.moment.value).max())):
        design = _resolved_design(law, fitted, trial)
        solution = np.linalg.lstsq(design, fitted.delta, rcond=None)[0]
        squares = float(np.sum((fitted.delta - design @ solution) ** 2))
        if squares < least:
            least, nonlinear, linear = squares, trial, solution.tolist()
    residual = np.concatenate([o.delta - _resolved_design(law, o, nonlinear) @ linear for o in others])
    delta = np.concatenate([o.delta for o in others])
    return Candidate(
        law.name,
        law.parameters,
        float(np.sqrt(least / np.sum(fitted.delta**2))),
        float(np.sqrt(np.sum(residual**2) / np.sum(delta**2))),
    )
