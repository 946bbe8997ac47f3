"""Step control for the solvers that leave it to their users: larger after success, halved after failure."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.peers.problem import PathResult

Answer = tuple[float, float, float]
#: equilibrium at a pressure (kPa) from a first guess of the unknowns; returns them and the iterations taken
Equilibrium = Callable[[float, np.ndarray], tuple[np.ndarray, int]]


class NoEquilibrium(ArithmeticError):
    """Newton's method did not converge."""


@dataclass(frozen=True)
class Stepping:
    """How the load is walked."""

    first: float  #: first increment, kPa
    growth: float  #: of the increment after a quick one
    quick: int  #: iterations of a quick increment at the most
    iterations: int  #: Newton iterations after which an attempt has failed
    predict: bool  #: begin where the last two equilibria point, not in the last one
    smallest: float = 0.01  #: kPa, the increment at which the path ends

    def walk(
        self,
        pressures: Sequence[float],
        start: np.ndarray,
        equilibrium: Equilibrium,
        answer: Callable[[np.ndarray], Answer],
        factorizations: Callable[[], int],
    ) -> PathResult:
        """Equilibria at the target pressures (kPa, ascending) from the state of rest `start`."""
        states = [(0.0, start)]
        increment, increments, failed = self.first, 0, 0
        answers: dict[float, Answer] = {}
        for target in pressures:
            while states[-1][0] < target:
                aim = target if target - states[-1][0] < 1.3 * increment else states[-1][0] + increment
                try:
                    unknowns, taken = equilibrium(aim, self._guess(states, aim))
                except NoEquilibrium as reason:
                    failed += 1
                    increment = (aim - states[-1][0]) / 2
                    if increment < self.smallest:
                        return PathResult(answers, increments, failed, factorizations(), str(reason))
                    continue
                increments += 1
                states = [states[-1], (aim, unknowns)]
                if taken <= self.quick:
                    increment *= self.growth
            answers[target] = answer(states[-1][1])
        return PathResult(answers, increments, failed, factorizations())

    def _guess(self, states: list[tuple[float, np.ndarray]], aim: float) -> np.ndarray:
        last, state = states[-1]
        if not self.predict or len(states) < 2:
            return state
        before, old = states[-2]
        return state + (aim - last) / (last - before) * (state - old)


#: chosen so that the four pressures cost the fewest factorizations; other choices in studies/peers.md
STEPPING = Stepping(first=8.0, growth=1.5, quick=12, iterations=40, predict=True)


def newton(
    guess: np.ndarray,
    iterations: int,
    residual: Callable[[np.ndarray], tuple[np.ndarray, float]],
    increment: Callable[[np.ndarray, np.ndarray], np.ndarray],
    tolerance: float,
) -> tuple[np.ndarray, int]:
    """Newton's method from `guess`; returns the unknowns and the increments taken.

    residual: forces at the unknowns, and their norm over that of the forces that balance. increment: the solution of
    the tangent at the unknowns for these forces. Raises `NoEquilibrium`.
    """
    state = guess
    for taken in range(iterations + 1):
        forces, relative = residual(state)
        if relative < tolerance:
            return state, taken
        if not np.isfinite(relative):
            raise NoEquilibrium(f"the residual grew without bound after {taken} iterations")
        if taken < iterations:
            state = state + increment(state, forces)
    raise NoEquilibrium(f"no equilibrium after {iterations} iterations (relative residual {relative:.1e})")
