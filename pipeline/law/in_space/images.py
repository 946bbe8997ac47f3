"""States of an arm that a turn about its material curve brings to itself, each cavity to the place of another.

A turn takes the pressure of each cavity along, and turns curvatures, moments and places. Of states that are images of
each other one is solved.
"""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from math import pi
from typing import Any, TypeVar

import numpy as np

from fem.cell.any_plane import frame_of
from geometry.arrays import Array
from pipeline.law.in_space.states import CellState, Curvatures, EndState
from pipeline.law.piece.tasks import ArmTasks
from pipeline.store.parallel import Pending
from rod.same_pressure import Pressures

State = TypeVar("State")

#: vectors of a state of the cell and of an end; the moments of a cell are those across and along its curvature
IN_CELL, IN_END = ("curvature", "across", "along", "beside"), ("moment", "turn", "place")
#: digits of numbers that are the same
DIGITS = 9


@dataclass(frozen=True)
class Turns:
    """The turns of an arm: how many bring it to itself, and what a turn does."""

    count: int  #: 1: none but the whole one
    places: tuple[int, ...]  #: the cavity whose place each one takes

    @staticmethod
    def of(cavities: Sequence[str], order: Sequence[str]) -> "Turns":
        """order: cavities, each of which a turn brings to the place of the next one; empty where none does."""
        if not order:
            return Turns(1, tuple(range(len(cavities))))
        following = dict(zip(order, (*order[1:], order[0]), strict=True))
        return Turns(len(order), tuple(cavities.index(following[name]) for name in cavities))

    def pressures(self, pressures: Sequence[float], times: int) -> tuple[float, ...]:
        """Values of the cavities after so many turns."""
        for _ in range(times % self.count):
            moved = dict(zip(self.places, pressures, strict=True))
            pressures = [moved[place] for place in range(len(moved))]
        return tuple(pressures)

    def across(self, vector: Sequence[float], times: int) -> Curvatures:
        """A vector (2,) along y and z after so many turns."""
        y, z = np.asarray(vector) @ frame_of(2.0 * pi * (times % self.count) / self.count)
        return float(y), float(z)

    def state(self, state: Any, times: int) -> Any:
        """A state of a piece, or a compliance against twist and shear, after so many turns."""
        if times % self.count == 0:
            return state
        if not isinstance(state, CellState | EndState):
            return self._compliance(state, times)
        turned: dict[str, Any] = {name: self.pressures(getattr(state, name), times) for name in ("pressures", "volume")}
        for name in IN_CELL if isinstance(state, CellState) else IN_END:
            turned[name] = self._turned(getattr(state, name), times)
        return replace(state, **turned)

    def back(self, pressures: Pressures, curvature: Curvatures = (0.0, 0.0)) -> int:
        """The turns after which the pressures are those of the image that is solved: the largest in their order, and of
        equal ones that with the largest curvature about y."""

        def order(times: int) -> tuple[float, ...]:
            turned = *self.pressures(pressures, times), *self.across(curvature, times)
            return *np.round(turned, DIGITS).tolist(), -times

        return max(range(self.count), key=order)

    def _turned(self, vector: Sequence[float], times: int) -> tuple[float, ...]:
        """A vector along y and z, or along x, y and z."""
        return (*vector[:-2], *self.across(vector[-2:], times))

    def _compliance(self, upper: Sequence[float], times: int) -> list[float]:
        rows, columns = np.triu_indices(3)
        matrix, turn = np.zeros((3, 3)), np.eye(3)
        matrix[rows, columns] = matrix[columns, rows] = upper
        turn[1:, 1:] = frame_of(2.0 * pi * times / self.count)
        image: Array = turn.T @ matrix @ turn
        return [float(value) for value in image[rows, columns]]


@dataclass(frozen=True, eq=False)  # a cache inside
class Images:
    """Submits states of one arm; of those that are images of each other the first one."""

    tasks: ArmTasks
    turns: Turns
    _begun: dict[Any, Pending[Any]] = field(default_factory=dict, init=False, repr=False)

    @staticmethod
    def of(tasks: ArmTasks) -> "Images":
        """The images of the arm of tasks; a layer on one side leaves none but the arm itself."""
        pieces, effects = tasks.pieces, tasks.pieces.config.effects
        order = () if effects.strain_limiting_layer.on or effects.hoops.on else pieces.repetition.turned
        return Images(tasks, Turns.of(list(pieces.design.cavities), order))

    def submit(self, task: Callable[..., State], pressures: Pressures, *curvature: Curvatures) -> Pending[State]:
        """A task of `pipeline.law.in_space.states`, or the image of one that was begun."""
        times = self.turns.back(pressures, *curvature)
        solved = self.turns.pressures(pressures, times), *(self.turns.across(one, times) for one in curvature)
        key = task, *(tuple(np.round(numbers, DIGITS).tolist()) for numbers in solved)
        if key not in self._begun:
            self._begun[key] = self.tasks.submit(task, *solved)
        begun = self._begun[key]
        return Pending(Future(), lambda: self.turns.state(begun.result(), -times))

    def distinct(self, rows: Iterable[Pressures]) -> list[Pressures]:
        """Pressures without images of earlier ones."""
        first: dict[tuple[float, ...], Pressures] = {}
        for row in rows:
            first.setdefault(tuple(np.round(self.turns.pressures(row, self.turns.back(row)), DIGITS).tolist()), row)
        return list(first.values())

    def around(self, pressures: Pressures, curvatures: Sequence[Curvatures]) -> list[tuple[Pressures, Curvatures]]:
        """Bent states under pressures, and their images."""
        count = 1 if self.turns.pressures(pressures, 1) == tuple(pressures) else self.turns.count
        turns = self.turns
        return [(turns.pressures(pressures, n), turns.across(one, n)) for n in range(count) for one in curvatures]
