"""The pressures at which an arm under a load has its tip, its bending or its force where they are wanted.

The arm is solved at some pressures once (`Response`). A quantity that is wanted is then found between two of them by a
cubic, and the rod is solved there until the quantity is met, usually once or twice.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from rod.cubics import cubic, cubic_slope, parabola_slopes
from rod.errors import LoadError, RodError

#: pressures at which an arm is solved, at least
SAMPLES = 33
#: points of the cubic between two of them, among which the first estimate is found
PARTS = 16
#: change of the pressure, over the range of pressures, that is made without solving the rod again; most steps
SETTLED, STEPS = 1e-3, 12

#: how often the interval is halved in which the pressures without an equilibrium begin
BISECTIONS = 6
#: kPa, of difference quotients
DIFFERENCE = 1e-3

#: a number for each tip (n, d) in mm and force on the end (n, d) in N; d: 2, or 3 of an arm that bends in space
Quantity = Callable[[Array, Array], Array]


class AtPressure(NamedTuple):
    """The end of the rod at a pressure, and how fast it changes with the pressure."""

    pressure: float  #: kPa
    state: Array  #: (2 d,) tip in mm and force on the end in N
    slope: Array  #: (2 d,) their changes per kPa

    def of(self, quantity: Quantity) -> tuple[float, float]:
        """A quantity, and its change per kPa."""
        states = self.state + np.array([[0.0], [-DIFFERENCE], [DIFFERENCE]]) * self.slope
        value, low, high = quantity(*_halves(states))
        return float(value), float(high - low) / (2.0 * DIFFERENCE)


@dataclass(frozen=True, eq=False)  # arrays inside
class Response:
    """Tip and force of an arm under one load over rising pressures, at least three without a gap."""

    solve: Callable[[float], Array]  #: (2 d,) tip in mm and force on the end in N at a pressure in kPa
    pressures: Array  #: (n,) kPa
    states: Array  #: (n, 2 d)

    @staticmethod
    def all_of(solve: Callable[[float], Array], pressures: Sequence[float]) -> tuple["Response", ...]:
        """The responses between pressures at which there is no equilibrium, usually one.

        pressures: those of the law or of the identification; more are added between. Raises `RodError`, with the
        reason, where there is none at all, and `LoadError` as solve does.
        """
        pieces: list[list[tuple[float, Array]]] = [[]]
        reason, unsolved = "", None
        for pressure in map(float, _refined(pressures)):
            try:
                state = solve(pressure)
            except LoadError:
                raise
            except RodError as failure:
                reason = str(failure)
                if pieces[-1]:
                    pieces[-1] += _up_to_edge(solve, pieces[-1][-1][0], pressure)
                    pieces.append([])
                unsolved = pressure
                continue
            if not pieces[-1] and unsolved is not None:
                pieces[-1] += reversed(_up_to_edge(solve, pressure, unsolved))
            pieces[-1].append((pressure, state))
        long = [piece for piece in pieces if len(piece) > 2]
        if not long:
            raise RodError(reason or "One pressure alone is no range in which another one could be found.")
        return tuple(Response(solve, np.array([p for p, _ in it]), np.array([state for _, state in it])) for it in long)

    def where(self, quantity: Quantity, target: float) -> Iterator[AtPressure]:
        """The states in which a quantity has a value, by rising pressure."""
        yield from self._zeros(lambda states, _: quantity(*_halves(states)) - target)

    def nearest(self, position: Sequence[float]) -> Iterator[AtPressure]:
        """The states in which the tip is nearer to a position (mm) than at neighbouring pressures, ends included."""

        def recedes(states: Array, slopes: Array) -> Array:
            """Half the change of the squared distance by the pressure."""
            return np.asarray(((_halves(states)[0] - position) * _halves(slopes)[0]).sum(axis=1))

        at_ends = recedes(self.states[[0, -1]], self._slopes[[0, -1]])
        if at_ends[0] >= 0.0:
            yield self._sample(0)
        yield from (at for at, rises in self._zeros_with_direction(recedes) if rises)
        if at_ends[1] <= 0.0:
            yield self._sample(-1)

    def extremes(self, quantity: Quantity) -> tuple[AtPressure, AtPressure]:
        """The sampled states with the smallest and the largest value of a quantity."""
        values = quantity(*_halves(self.states))
        return self._sample(int(values.argmin())), self._sample(int(values.argmax()))

    @cached_property
    def _slopes(self) -> Array:
        return parabola_slopes(self.pressures, self.states)

    def _sample(self, k: int) -> AtPressure:
        return AtPressure(float(self.pressures[k]), self.states[k], self._slopes[k])

    def _slope_at(self, pressure: float) -> Array:
        return np.array([np.interp(pressure, self.pressures, column) for column in self._slopes.T])

    def _zeros(self, function: "Function") -> Iterator[AtPressure]:
        yield from (at for at, _ in self._zeros_with_direction(function))

    def _zeros_with_direction(self, function: "Function") -> Iterator[tuple[AtPressure, bool]]:
        """Where a function of the states (n, 2 d) and their slopes changes its sign, and whether it rises there."""
        p = self.pressures
        parts = np.append((p[:-1, None] + np.arange(PARTS) / PARTS * np.diff(p)[:, None]).ravel(), p[-1])
        between = cubic(p, self.states, self._slopes, parts), cubic_slope(p, self.states, self._slopes, parts)
        for a, b in pairwise(zip(parts, function(*between), strict=True)):
            if a[1] * b[1] < 0.0 or (b[1] == 0.0 and a[1] != 0.0):
                slope = float((b[1] - a[1]) / (b[0] - a[0]))
                yield self._refined(function, float(a[0] - a[1] / slope), slope), slope > 0.0

    def _refined(self, function: "Function", pressure: float, slope: float) -> AtPressure:
        """The state at the zero of a function near a pressure: the secant method with the rod itself."""
        span = float(np.ptp(self.pressures))
        before: tuple[float, float] | None = None
        for _ in range(STEPS):
            state, rate = self.solve(pressure), self._slope_at(pressure)
            value = float(function(state[None], rate[None])[0])
            if before is not None and pressure != before[0]:
                slope = (value - before[1]) / (pressure - before[0]) or slope
            before, step = (pressure, value), float(np.clip(-value / slope, -0.1 * span, 0.1 * span))
            there = float(np.clip(pressure + step, self.pressures[0], self.pressures[-1]))
            if abs(step) < SETTLED * span:
                return AtPressure(there, state + (there - pressure) * rate, rate)
            pressure = there
        return AtPressure(pressure, state, rate)


#: of states (n, 2 d) and their slopes by the pressure (n, 2 d), (n,)
Function = Callable[[Array, Array], Array]


def _halves(states: Array) -> tuple[Array, Array]:
    """Tips and forces, (n, d) each."""
    half = states.shape[1] // 2
    return states[:, :half], states[:, half:]


def _up_to_edge(solve: Callable[[float], Array], solved: float, unsolved: float) -> list[tuple[float, Array]]:
    """States between a pressure at which there is one and one at which there is none, towards the latter."""
    states = []
    for _ in range(BISECTIONS):
        pressure = 0.5 * (solved + unsolved)
        try:
            states.append((pressure, solve(pressure)))
        except RodError:
            unsolved = pressure
        else:
            solved = pressure
    return states


def _refined(pressures: Sequence[float]) -> Array:
    """The pressures and as many more between them that there are `SAMPLES` at least, wide intervals divided first."""
    known = np.asarray(pressures, float)
    if len(known) < 2:
        return known
    longest = np.ptp(known) / (SAMPLES - 1)
    pieces = [np.linspace(a, b, max(1, int(np.ceil((b - a) / longest))), endpoint=False) for a, b in pairwise(known)]
    return np.append(np.concatenate(pieces), known[-1])
