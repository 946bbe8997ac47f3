"""Simpler and richer laws than the five parameters, held against loads that were not used for the fit.

Every law says Delta as a function of s and M, linear in its numbers but for one place. It is fitted to one loaded
curve and then asked for the Delta of others at the same pressure (another end position, a dead force), from their
measured moment:

    one line               Delta = a M - b
    two slopes             Delta = a_i M, i by s < d: lines through the origin
    five parameters        Delta = a_i M - b_i, i by s < d
    spring and one line    Delta = a M - b, and a turn c M(0) at the clamp
    contact                Delta = a M - b + c (|M| - M_c)+ sign M: a slope that changes with the load, not with s

Where a simpler law predicts as well as a richer one, it is the better.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from geometry.arrays import Array
from rod.curves.curve import Curvature, Moment, fine_grid
from rod.law import RodError

#: over the length, the zone at the clamp that stands for a spring
SPRING = 0.02
#: a law is as good as another when its error is at most this many times the other's
AS_GOOD = 1.1


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

    def seen(self, deviation: Array) -> Array:
        """(n, k): what the estimate sees of deviations (GRID_CELLS, k) on the fine grid."""
        resolution = 0.5 * (self.kappa.resolution + self.kappa_0.resolution)
        return resolution @ deviation


@dataclass(frozen=True)
class Candidate:
    """A law and how well it does."""

    name: str
    numbers: int
    in_sample: float  #: root-mean-square error of Delta over that of Delta, on the curve it was fitted to
    out_of_sample: float  #: the same on the other curves together


@dataclass(frozen=True)
class _Law:
    name: str
    numbers: int
    #: from positions s, moments M (m,) and a place: columns (m, k) of Delta
    columns: Callable[[Array, Array, float, float], Array]
    #: the places to try, from length and largest moment
    places: Callable[[float, float], Array]


def _one(s: Array, m: Array, place: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m))])


def _two_slopes(s: Array, m: Array, place: float, length: float) -> Array:
    return np.column_stack([m * (s < place), m * (s >= place)])


def _five(s: Array, m: Array, place: float, length: float) -> Array:
    first = s < place
    return np.column_stack([m * first, -1.0 * first, m * ~first, -1.0 * ~first])


def _spring(s: Array, m: Array, place: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m)), m * (s < SPRING * length)])


def _contact(s: Array, m: Array, place: float, length: float) -> Array:
    return np.column_stack([m, -np.ones(len(m)), np.maximum(np.abs(m) - place, 0.0) * np.sign(m)])


def _nowhere(length: float, largest: float) -> Array:
    return np.zeros(1)


def _along(length: float, largest: float) -> Array:
    return np.linspace(0.045, 0.35, 69) * length


def _moments(length: float, largest: float) -> Array:
    return np.linspace(0.1, 0.9, 41) * largest


LAWS = (
    _Law("one line", 2, _one, _nowhere),
    _Law("two slopes", 3, _two_slopes, _along),
    _Law("five parameters", 5, _five, _along),
    _Law("spring and one line", 3, _spring, _nowhere),
    _Law("contact", 4, _contact, _moments),
)


def compare_laws(fitted: Observation, others: Sequence[Observation]) -> tuple[Candidate, ...]:
    """Every law fitted to one loaded curve and asked for others at the same pressure.

    Raises `RodError` when there is no other curve, or when they are not of the same arm.
    """
    if not others:
        raise RodError("Laws are compared by loads that were not used for the fit; there is none.")
    if any(abs(o.kappa.length - fitted.kappa.length) > 1e-6 * fitted.kappa.length for o in others):
        raise RodError("Laws are compared on curves of one arm; these differ in length.")
    return tuple(_candidate(law, fitted, others) for law in LAWS)


def simplest(candidates: Sequence[Candidate]) -> Candidate:
    """The law with the fewest numbers whose error out of sample is at most AS_GOOD times the smallest."""
    limit = AS_GOOD * min(c.out_of_sample for c in candidates)
    return min((c for c in candidates if c.out_of_sample <= limit), key=lambda c: (c.numbers, c.out_of_sample))


def _columns(law: _Law, observation: Observation, place: float) -> Array:
    length = observation.kappa.length
    s = fine_grid(length)
    moment = CubicSpline(observation.moment.s, observation.moment.value)(s)
    return observation.seen(law.columns(s, moment, place, length))


def _candidate(law: _Law, fitted: Observation, others: Sequence[Observation]) -> Candidate:
    best, place, numbers = np.inf, 0.0, [0.0] * law.numbers
    for trial in law.places(fitted.kappa.length, float(np.abs(fitted.moment.value).max())):
        columns = _columns(law, fitted, trial)
        found = np.linalg.lstsq(columns, fitted.delta, rcond=None)[0]
        error = float(np.sum((fitted.delta - columns @ found) ** 2))
        if error < best:
            best, place, numbers = error, trial, found.tolist()
    off = np.concatenate([o.delta - _columns(law, o, place) @ numbers for o in others])
    size = np.concatenate([o.delta for o in others])
    return Candidate(
        law.name,
        law.numbers,
        float(np.sqrt(best / np.sum(fitted.delta**2))),
        float(np.sqrt(np.sum(off**2) / np.sum(size**2))),
    )
