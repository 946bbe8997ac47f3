"""The pressures at which an arm under a load has its tip, its bending or its force where they are wanted.

The equilibria of the arm are followed over the pressure (`Branch`): each is found beside the one before, with as many
unstable directions, so that they stay stable where the load has no path of its own. A quantity that is wanted is found
between two of them by a cubic, and then by Newton's method on the pressure with the derivative of the state.

A law at a new pressure takes several times as long as Newton's method in the state, which is therefore brought to its
end at each pressure: eliminating it first makes the same steps of the pressure as one system of both would.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from geometry.arrays import Array
from rod.arm.response import SolvedPath
from rod.cubics import cubic, cubic_slope, parabola_slopes
from rod.errors import LoadError, RodError
from rod.mechanics.equilibrium import Rod
from rod.solution import RodSolution, SpatialSolution

#: pressures at which an arm is solved, at least
SAMPLES = 17
#: points of the cubic between two of them, among which the first estimate is found
PARTS = 16
#: change of the pressure, over the range of pressures, that is made without solving the rod again; most steps
SETTLED, STEPS = 1e-5, 12

#: how often the interval is halved in which the pressures without an equilibrium begin
BISECTIONS = 6
#: kPa, of difference quotients
DIFFERENCE = 1e-3

#: numbers (n,) or (n, k) of the ends (n, 9) of an arm, as `SolvedPath.state` has them
Quantity = Callable[[Array], Array]
#: a pressure in kPa and the equilibrium there
Solved: TypeAlias = tuple[float, SolvedPath]


class AtPressure(NamedTuple):
    """The end of the rod at a pressure, and how fast it changes with the pressure."""

    pressure: float  #: kPa
    state: Array  #: (9,) as `SolvedPath.state`
    slope: Array  #: (9,) its change per kPa
    path: SolvedPath  #: an equilibrium there or near by
    after_snap: bool = False  #: as of its branch

    def of(self, quantity: Quantity) -> tuple[Array, Array]:
        """A quantity, and its change per kPa."""
        states = self.state + np.array([[0.0], [-DIFFERENCE], [DIFFERENCE]]) * self.slope
        value, low, high = quantity(states)
        return value, (high - low) / (2.0 * DIFFERENCE)


@dataclass(frozen=True, eq=False)  # arrays inside
class Branch:
    """The equilibria of an arm under one load over rising pressures, at least three without a gap."""

    at: Callable[[float], Rod]  #: the rod at a pressure in kPa
    paths: tuple[SolvedPath, ...]
    pressures: Array  #: (n,) kPa
    states: Array  #: (n, 9) of the paths
    after_snap: bool = False  #: whether they are those of the swollen form of an arm that has two

    @staticmethod
    def all_of(
        at: Callable[[float], Rod], solve: Callable[[Rod], RodSolution | SpatialSolution], pressures: Sequence[float]
    ) -> tuple["Branch", ...]:
        """The branches, usually one, with gaps where there is no equilibrium.

        at: the rod at a pressure in kPa; solve: its equilibrium on the path of the load; pressures: those of the law or
        of the identification; more are added between. Raises `RodError`, with the reason, where there is no equilibrium
        at all, and `LoadError` as solve does.
        """
        pieces: list[list[Solved]] = [[]]
        reason, unsolved = "", []
        for pressure in np.union1d(np.linspace(pressures[0], pressures[-1], SAMPLES), pressures).tolist():
            if pieces[-1]:
                pieces[-1] += _towards(at, pieces[-1][-1], pressure)
                if pieces[-1][-1][0] == pressure:
                    continue
                pieces.append([])
            try:
                path = solve(at(pressure)).path.refuse_fall()
            except LoadError:
                raise
            except RodError as failure:
                reason = str(failure)
                unsolved.append(pressure)
                continue
            pieces[-1].append((pressure, path))
            while unsolved:
                pieces[-1][:0] = reversed(_towards(at, pieces[-1][0], goal := unsolved.pop()))
                unsolved = unsolved if pieces[-1][0][0] == goal else []
        long = [piece for piece in pieces if len(piece) > 2]
        if not long:
            raise RodError(reason or "One pressure alone is no range in which another one could be found.")
        columns = (tuple(zip(*piece, strict=True)) for piece in long)
        return tuple(Branch(at, paths, np.array(p), np.array([path.state for path in paths])) for p, paths in columns)

    def where(self, quantity: Quantity, target: float) -> Iterator[AtPressure]:
        """The states in which a quantity has a value, by rising pressure."""
        for pressure, _ in self._zeros(lambda states, _: quantity(states) - target):
            yield self._met(pressure, lambda states: quantity(states) - target)

    def nearest(self, position: Sequence[float]) -> Iterator[AtPressure]:
        """The states in which the tip is nearer to a position (mm) than at neighbouring pressures, ends included."""

        def recedes(states: Array, slopes: Array) -> Array:
            """Half the change of the squared distance by the pressure."""
            return np.asarray((away(states) * slopes[:, : len(position)]).sum(axis=1))

        def away(states: Array) -> Array:
            return np.asarray(states[:, : len(position)] - position)

        at_ends = recedes(self.states[[0, -1]], self._slopes[[0, -1]])
        if at_ends[0] >= 0.0:
            yield self._sample(0)
        yield from (self._met(pressure, away) for pressure, rises in self._zeros(recedes) if rises)
        if at_ends[1] <= 0.0:
            yield self._sample(-1)

    def extremes(self, quantity: Quantity) -> tuple[AtPressure, AtPressure]:
        """The sampled states with the smallest and the largest value of a quantity."""
        values = quantity(self.states)
        return self._sample(int(values.argmin())), self._sample(int(values.argmax()))

    @cached_property
    def _slopes(self) -> Array:
        return parabola_slopes(self.pressures, self.states)

    def _sample(self, k: int) -> AtPressure:
        return AtPressure(float(self.pressures[k]), self.states[k], self._slopes[k], self.paths[k], self.after_snap)

    def _zeros(self, function: Callable[[Array, Array], Array]) -> Iterator[tuple[float, bool]]:
        """Pressures where a function of the states (n, 9) and their slopes changes its sign, and whether it rises."""
        p = self.pressures
        parts = np.append((p[:-1, None] + np.arange(PARTS) / PARTS * np.diff(p)[:, None]).ravel(), p[-1])
        between = cubic(p, self.states, self._slopes, parts), cubic_slope(p, self.states, self._slopes, parts)
        for a, b in pairwise(zip(parts, function(*between), strict=True)):
            if a[1] * b[1] < 0.0 or (b[1] == 0.0 and a[1] != 0.0):
                yield float(a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1])), bool(b[1] > a[1])

    def _met(self, pressure: float, missed: Quantity) -> AtPressure:
        """The state that misses a wish least, from a pressure near by: Newton's method, for several parts Gauss's."""
        span = float(np.ptp(self.pressures))
        apart = np.abs(self.pressures - pressure)
        k = int(np.argmin(np.where(apart > SETTLED * span, apart, np.inf)))
        there, path = float(self.pressures[k]), self.paths[k]
        for _ in range(STEPS):
            (before, other), path = (there, path), path.at(self.at(pressure).arm)
            response = path.derivative((other.rod, path.rod), passes=1)
            slope = path.change_of_state(response) / (pressure - before)
            at = AtPressure(pressure, path.state, slope, path, self.after_snap)
            left, change = at.of(missed)
            there, square = pressure, float(np.sum(change * change))
            step = -float(np.sum(left * change)) / square if square else 0.0
            pressure = float(np.clip(there + np.clip(step, -0.1 * span, 0.1 * span), *self.pressures[[0, -1]]))
            if abs(pressure - there) < SETTLED * span:
                break
        return at._replace(pressure=pressure, state=at.state + (pressure - there) * at.slope)


def _towards(at: Callable[[float], Rod], begin: Solved, pressure: float) -> list[Solved]:
    """States from one on towards a pressure, each beside the one before; the last is there unless they end before."""
    states, goal = [begin], pressure
    for _ in range(BISECTIONS):
        reached, path = states[-1]
        try:
            states.append((goal, path.at(at(goal).arm)))
        except RodError:
            goal = 0.5 * (reached + goal)
        else:
            if goal == pressure:
                break
            goal = 0.5 * (goal + pressure)
    return states[1:]
