"""The predictor: where Newton's method starts on the way to the next target.

Displacement, strain, stress and pressures are extrapolated each on its own, as polynomials of the driven quantity
through the last two points of the path and, where they are available, the tangents of the path there (called rates): a
cubic through two points with rates, a parabola through two points of which the last has one, lines otherwise. A rate
costs one solution with the tangent matrix that is factorized already. Extrapolated displacements alone would strain a
body that turns.

Where the path cannot be extrapolated - at rest, across a kink - Newton's method starts a small step
along the rate of the last point, but under the whole load and the stress that goes with it to first order. A load that
follows the surface and the stress that balances it turn with the body: together they make no stiffness against
rotations. A load without its stress makes one, of either sign, and thin walls become unstable or turn the wrong way. A
load that keeps its direction has no stiffness of its own, and its stress may make the body unstable at once: where the
tangent limits the strain, this start is given up for one with no more stress than goes with the small step. That holds
at rest: a body that snaps later on (a half disc that collapses under a vacuum) does so only if the strain may be
limited. The stress of a strain-limiting layer is carried along. Factorizations with and without all this are in
docs/theory.md, "Load path".
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from typing import final

import numpy as np

from fem.effects.effect import Terms, at_constant_fraction, stressed
from fem.equations.linear import SingularMatrix
from fem.equations.linearised import StaleFactorization
from fem.equations.state import State
from fem.path.control import Control
from fem.path.newton import Converged, Start

#: iterations after which an extrapolated start is given up, without and with walls in contact: good ones take 3 to 7,
#: and 9 to 12
TRIAL_ITERATIONS, TRIAL_ITERATIONS_CONTACT = 8, 13

#: largest strain of the small step along the rate of a point; a smaller one costs iterations, a larger one may diverge
MAX_PREDICTOR_STRAIN = 0.1

#: largest strain of the first point beyond which no parabola is put through it and rest, but its rate alone is followed
MAX_START_STRAIN = 0.2


@dataclass(frozen=True)
class PathPoint:
    """An equilibrium on the path: the value of the driven quantity, and the state there."""

    value: float  #: of the load factor, of the volume in mm3, or of the part of the way
    constant_fraction: float  #: of constant loads and displacements, 0 at rest and 1 at the first target
    state: State
    touching: bool = False  #: whether walls are in contact there
    rate: State | None = None  #: tangent of the path, d(state)/d(value); None where it is not available
    terms: Terms = ()  #: in the potential there, with that fraction


@final
class Predictor:
    """Starts of Newton's method from the last points of a path that begins at rest."""

    def __init__(self, rest: PathPoint, control: Control) -> None:
        self.rest = rest
        self._rate_at_rest: State | None = None
        self._has_rate_at_rest = False  #: whether it was computed, with or without success
        constraints, terms = control.system.constraints, control.system.terms
        self.has_constant_loads = at_constant_fraction(terms, 0.5) != terms
        #: True if any load is applied in full from the first target: the path is not smooth there and is not
        #: extrapolated across it
        self.nonsmooth_start = bool(constraints.constant.any() or self.has_constant_loads)

    def starts(
        self, points: Sequence[PathPoint], target: Control, terms: Terms, limit: float | None = None
    ) -> Iterator[Start]:
        """Starts for the target, the most promising one first; points are the last two, or the one at rest.

        limit: the value at which the path announces its end, None where it announces none. Extrapolated starts have an
        iteration limit of their own. Factorizes once, where the path starts at rest.
        """
        before, last = points[0], points[-1]
        at_rest = len(points) == 1
        if at_rest:
            last = replace(last, rate=self.rate_from_rest(target))
        else:
            first = before if self._is_smooth(before, last) else None
            extrapolated = extrapolate(first, last, target.value, limit)
            if extrapolated is not None:
                iterations = TRIAL_ITERATIONS_CONTACT if last.touching else TRIAL_ITERATIONS
                yield Start(extrapolated, terms, iterations, iterates=True, trial=True)
        small, full = _small_step(last, target.value), extrapolate(None, last, target.value)
        balanced = small_step_under_load(last, target.value)
        if small is None or full is None or balanced is None:
            yield Start.at(last.state, terms)
            return
        x = target.system.space.points + last.state.displacement
        with_stress = stressed(terms, x, full.displacement - last.state.displacement)
        yield Start(balanced, with_stress, iterates=not at_rest, trial=at_rest)
        if at_rest:
            yield Start(small, terms)

    def rate_from_rest(self, target: Control) -> State | None:
        """d(state)/d(value) at rest, on the way to the first target; computed once, for all increments on that way."""
        if not self._has_rate_at_rest and target.value != self.rest.value:
            self._has_rate_at_rest = True
            with suppress(SingularMatrix):  # Newton's method meets the same tangent, and says so
                fraction = target.constant_fraction / (target.value - self.rest.value)
                self._rate_at_rest = target.rate_at_rest(self.rest.terms, fraction)
        return self._rate_at_rest

    @property
    def rate_at_rest(self) -> State | None:
        """d(state)/d(value) at rest; None before the first start was asked for, and where there is none."""
        return self._rate_at_rest

    def rate(self, point: Control, converged: Converged, terms: Terms) -> State | None:
        """Tangent of the path, d(state)/d(value), at an equilibrium just computed, from the last tangent matrix."""
        if converged.linearised is None or (self.nonsmooth_start and point.constant_fraction < 1.0):
            return None
        # at a limit point there is no such tangent; another factorization since then makes it stale
        with suppress(SingularMatrix, StaleFactorization):
            return point.rate(converged.state, converged.assembly, converged.linearised, terms)
        return None

    def rate_with_constants(self, point: Control, converged: Converged, terms: Terms) -> State | None:
        """The rate on the way to the first target, while constant loads and displacements grow as well."""
        ahead = point.value - self.rest.value
        if converged.linearised is None or not ahead:
            return None
        with suppress(SingularMatrix, StaleFactorization):
            growth = point.constant_fraction / ahead
            return point.rate_with_constants(converged.state, converged.assembly, converged.linearised, terms, growth)
        return None

    def _is_smooth(self, before: PathPoint, last: PathPoint) -> bool:
        """Whether a polynomial through both points describes the path: there is no kink between them (the first contact
        of walls, the first target with constant loads), and the walls have not stiffened much since rest."""
        from_rest = before.constant_fraction == 0.0
        return not (
            before.value == last.value
            or before.touching != last.touching
            or (self.nonsmooth_start and before.constant_fraction < last.constant_fraction)
            or (from_rest and float(np.abs(last.state.strain).max()) > MAX_START_STRAIN)
        )


def extrapolate(before: PathPoint | None, last: PathPoint, value: float, limit: float | None = None) -> State | None:
    """The state at `value` from the last point and the one before it; None where they do not determine a line.

    Towards a limit that the path announces as a fold, by both rates (`fem.path.limit`), otherwise as a polynomial.
    """
    ahead = value - last.value
    if before is None:
        return None if last.rate is None else weighted_sum([(1.0, last.state), (ahead, last.rate)])
    if limit is not None and before.rate is not None and last.rate is not None:
        distances = [abs(limit - v) for v in (before.value, last.value, value)]
        if distances[0] > distances[1] > distances[2] and (limit - last.value) * (limit - value) > 0:
            first, second, third = (float(np.sqrt(distance)) for distance in distances)
            growth = first / (first - second) * (second - third) ** 2 * float(np.sign(ahead))
            return weighted_sum([(1.0, last.state), (ahead + growth, last.rate), (-growth, before.rate)])
    # t is 0 at the last point and -1 at the one before it
    step = last.value - before.value
    t = ahead / step
    if last.rate is None:
        return weighted_sum([(1.0 + t, last.state), (-t, before.state)])
    if before.rate is None:
        return weighted_sum([(1.0 - t**2, last.state), (t**2, before.state), ((t + t**2) * step, last.rate)])
    return weighted_sum(
        [
            (1.0 - 3.0 * t**2 - 2.0 * t**3, last.state),
            (3.0 * t**2 + 2.0 * t**3, before.state),
            ((t + 2.0 * t**2 + t**3) * step, last.rate),
            ((t**2 + t**3) * step, before.rate),
        ]
    )


def small_step_under_load(last: PathPoint, value: float) -> State | None:
    """A small step along the rate of the last point, under the whole load at `value` and the stress that goes with it.

    None where there is no rate or it strains nothing.
    """
    small, full = _small_step(last, value), extrapolate(None, last, value)
    return (
        None if small is None or full is None else replace(full, displacement=small.displacement, strain=small.strain)
    )


def _small_step(last: PathPoint, value: float) -> State | None:
    """The state a small step along the rate of the last point; None where there is no rate or it strains nothing."""
    if last.rate is None or not (strain := float(np.abs(last.rate.strain).max())) > 0.0:
        return None
    ahead = value - last.value
    step = float(np.sign(ahead)) * min(abs(ahead), MAX_PREDICTOR_STRAIN / strain)
    return extrapolate(None, last, last.value + step)


def weighted_sum(parts: Sequence[tuple[float, State]]) -> State:
    """Weighted sum of states, field by field."""
    return State(*(sum(weight * getattr(state, part.name) for weight, state in parts) for part in fields(State)))
