"""Where a load path leads: the start of Newton's method at the next asked value.

Displacement, strain, stress and pressures are extrapolated each on its own, as polynomials of the prescribed quantity
through the last two places and, where they are known, their rates: a cubic through two places with rates, a parabola
through two places of which the last has one, lines otherwise. A rate costs one solution with the factor at hand.
Extrapolated displacements alone would strain a body that turns.

Measured with exact rates on the reference arm, from 5 to 17, 31 and 45 kPa: a line is 5.5 to 7.3 mm off, a parabola 0.9
to 1.4, a cubic 0.3 to 0.5; Newton then takes 4, 3 and 3 iterations.

Where no such foresight holds - at rest, beyond a kink, too far ahead - Newton begins a little way along the rate of the
last place, but under the whole load and the stress that goes with it to first order. A load that follows the surface
and the stress that carries it turn with the body: together they make no stiffness against rotations. A load without its
stress makes one, of either sign, and thin walls become unstable or turn the wrong way. Factorizations from rest to 45,
55 and 65 kPa on the reference arm: 7, 7 and 8; with 0.85 of the stress 10, 12 and 12. From 10 to 60 kPa: 8, from
the equilibrium at 10 kPa as it is 12. A load that keeps its direction has no stiffness of its own, and its stress may
make the body unstable at once: where the tangent limits the strain, this start is given up for one with no more stress
than goes with the little way. That holds at rest: a body that snaps later on (a half disc that collapses under a
vacuum) does so only if the strain may be limited. A layer's stress is carried along.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from typing import final

import numpy as np

from fem.effects.effect import Terms, advanced, at_constant_fraction
from fem.equations.linear import SingularMatrix
from fem.equations.state import State
from fem.equations.system import System
from fem.path.course import Course
from fem.path.newton import Converged

#: factorizations that a predicted start may take, also with walls in contact; good ones take 3 to 7, and 9 to 12
PREDICTED, TOUCHING = 8, 13
#: largest strain to which the rate is followed there. Factorizations from rest to 17, 31, 45 and 65 kPa on the
#: reference arm: 5, 6, 7 and 8; with 0.02 they are 6, 7, 7 and 8, with 0.2 5, 6, 6 and 13
KICK = 0.1

#: largest strain of the first place beyond which no parabola from rest is trusted, but the rate alone. Factorizations
#: of II and III on the bisected circle (mixed, 2.4 mm, strain 0.26 at 20 kPa) to 20 and 37 kPa: 31 with it, 19 without
STIFFENED = 0.2

#: steps outside the last two places beyond which a cubic is not trusted: 4 steps ahead, on three chambers from 5 to
#: 25 kPa, Newton finds nothing from it in 13 iterations; from a parabola it takes 7
FAR = 2.0


@dataclass(frozen=True)
class Place:
    """A converged point of the path: how far the prescribed quantity is, and the state there."""

    value: float  #: of the load factor, or of the volume
    share: float  #: of the constant prescribed displacements, 0 at rest and 1 from the first asked value on
    state: State
    touching: bool = False  #: whether walls are in contact there
    rate: State | None = None  #: change of the state per unit of the value; None where it is not known
    terms: Terms = ()  #: what acts there, at that share


@dataclass(frozen=True)
class Start:
    """Where Newton's method begins, and how far it may go from there."""

    state: State
    terms: Terms  #: with the stress that goes with the state
    iterations: int | None = None  #: factorizations that one foretold from places is worth; None for the others
    trial: bool = False  #: whether it is given up as soon as the strain is limited, for another one follows


@final
class Predictor:
    """What the last places of a path say of the next one."""

    def __init__(self, system: System, course: Course) -> None:
        self.system = system
        self.course = course
        self._rate: State | None = None  # at rest
        self._rate_known = False
        #: whether something is whole from the first asked value on, so that the path has a kink there
        self.kinked = bool(system.constraints.constant.any() or at_constant_fraction(system.terms, 0.5) != system.terms)

    def starts(self, places: Sequence[Place], aim: Place, terms: Terms) -> Iterator[Start]:
        """Where Newton's method may start on the way to the aim, the most promising start first; places are the last
        two, or the one at rest."""
        before, last = places[0], places[-1]
        if len(places) == 1:
            last = replace(last, rate=self._rate_at_rest(last, aim, terms))
        else:
            # a place on the other side of a kink tells nothing: of the first touch of walls, or of the first asked
            # value; nor does rest, where walls have become so much stiffer since then
            kink = before.touching != last.touching or (self.kinked and before.share < last.share)
            kink = kink or (before.share == 0.0 and float(np.abs(last.state.strain).max()) > STIFFENED)
            guess = predicted(None if kink or before.value == last.value else before, last, aim.value)
            if guess is not None:
                yield Start(guess, terms, TOUCHING if last.touching else PREDICTED, trial=True)
        little, whole = _little(last, aim.value), predicted(None, last, aim.value)
        if little is None or whole is None:
            yield Start(aim.state, terms)
            return
        change, x = whole.displacement - last.state.displacement, self.system.space.points + last.state.displacement
        balanced = replace(whole, displacement=little.displacement, strain=little.strain)
        at_rest = len(places) == 1
        yield Start(balanced, advanced(terms, x, change), trial=at_rest)
        if at_rest:
            yield Start(little, terms)

    def rate(self, place: Place, found: Converged, terms: Terms) -> State | None:
        """Change of the state per unit of the value at a place just found, with the tangent of the last iteration."""
        if found.linearised is None or (self.kinked and place.share < 1.0):
            return None
        system, control = self.system, self.course.control(self.system, place.value, place.share)
        with suppress(SingularMatrix):
            change = control.rate(system, found.state, found.linearised, terms)
            if change is not None:
                return system.rate(found.state, found.assembly, change)
        return None

    def _rate_at_rest(self, rest: Place, aim: Place, terms: Terms) -> State | None:
        """Change of the state per unit of the value on the way from rest to the aim; takes a factorization, once."""
        if not self._rate_known and aim.value != rest.value:
            self._rate_known = True
            with suppress(SingularMatrix):
                share = aim.share / (aim.value - rest.value)
                self._rate = self.course.rate_at_rest(self.system, rest.state, terms, share)
        return self._rate


def predicted(before: Place | None, last: Place, value: float) -> State | None:
    """The state at `value` as the last place and the one before it foretell it; None where they tell nothing."""
    ahead = value - last.value
    parts = [(1.0, last.state)]
    if before is None:
        return None if last.rate is None else _sum([*parts, (ahead, last.rate)])
    # t is 0 at the last place and -1 at the one before it
    step = last.value - before.value
    t = ahead / step
    if last.rate is None:
        return _sum([(1.0 + t, last.state), (-t, before.state)])
    if before.rate is None or not -1.0 - FAR <= t <= FAR:
        return _sum([(1.0 - t**2, last.state), (t**2, before.state), ((t + t**2) * step, last.rate)])
    return _sum(
        [
            (1.0 - 3.0 * t**2 - 2.0 * t**3, last.state),
            (3.0 * t**2 + 2.0 * t**3, before.state),
            ((t + 2.0 * t**2 + t**3) * step, last.rate),
            ((t**2 + t**3) * step, before.rate),
        ]
    )


def _little(last: Place, value: float) -> State | None:
    """The state a little way along the rate of the last place; None where that is not known or strains nothing."""
    if last.rate is None or not (strain := float(np.abs(last.rate.strain).max())) > 0.0:
        return None
    ahead = value - last.value
    return predicted(None, last, last.value + float(np.sign(ahead)) * min(abs(ahead), KICK / strain))


def _sum(parts: Sequence[tuple[float, State]]) -> State:
    """The weighted sum of states."""
    return State(*(sum(weight * getattr(state, one.name) for weight, state in parts) for one in fields(State)))
