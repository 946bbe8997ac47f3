"""Curves through points that take long to solve: further points where a curve misses what lies between two of them."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Generic, TypeVar

Point = TypeVar("Point")


@dataclass(frozen=True, eq=False)
class Interval(Generic[Point]):
    """Two neighbouring points of a curve."""

    first: Point
    second: Point
    part_of: "Interval[Point] | None" = None  #: the interval that was divided
    error: float | None = inf  #: how far the curve may miss between both; None: not known

    @property
    def errors(self) -> tuple[float, ...]:
        """Its error after those of the intervals that it is a part of."""
        before = () if self.part_of is None else self.part_of.errors
        return before if self.error is None else (*before, self.error)


@dataclass(frozen=True)
class AdaptiveCurve(Generic[Point]):
    """Divides the intervals between points where their errors are too large, until the budget is spent."""

    errors: Callable[[Sequence[Interval[Point]]], Iterable[float | None]]  #: infinite: divided in any case
    solve: Callable[[Sequence[Interval[Point]]], Iterable[Point | None]]  #: a point in each; None: there is none
    tolerance: float
    most: float = inf  #: points that are added
    #: whether an interval is left as it is, whatever its error
    ends: Callable[[Interval[Point]], bool] = lambda _: False
    #: the error of an interval, with a point in it, whose halves need none; None: they are looked at
    settled: Callable[[Interval[Point], Point], float | None] = lambda *_: None
    #: the intervals in the order in which they are divided, and how many at once
    order: Callable[[list[Interval[Point]]], list[Interval[Point]]] = list
    at_once: float = inf

    def refine(self, points: list[Point]) -> list[Interval[Point]]:
        """Put points where they are needed; returns the intervals that are not divided further."""
        left: list[Interval[Point]] = []
        pending, most = self._judged([Interval(*pair) for pair in pairwise(points)], left), self.most + len(points)
        while chosen := self._chosen(pending, points, most):
            pending = [one for one in pending if one not in chosen]
            halves: list[Interval[Point]] = []
            for one, middle in zip(chosen, self.solve(chosen), strict=True):
                if middle is None:
                    left.append(one)
                    continue
                points.insert(points.index(one.second), middle)
                if (error := self.settled(one, middle)) is None:
                    halves += [Interval(one.first, middle, one), Interval(middle, one.second, one)]
                else:
                    left.append(replace(one, error=error))
            # a point that could not be solved may have taken others away
            pending = [one for one in pending if one.first in points and one.second in points]
            pending += self._judged(halves, left)
        return [*left, *pending]

    def _judged(self, new: Sequence[Interval[Point]], left: list[Interval[Point]]) -> list[Interval[Point]]:
        """The intervals with errors that are too large; the others are `left`."""
        found = [replace(one, error=error) for one, error in zip(new, self.errors(new), strict=True)]
        wide = [one for one in found if (one.error or 0.0) > self.tolerance and not self.ends(one)]
        left += [one for one in found if one not in wide]
        return wide

    def _chosen(self, pending: list[Interval[Point]], points: Sequence[Point], most: float) -> list[Interval[Point]]:
        """The intervals that are divided next, in the order of the points; those with an infinite error always."""
        first, room = self.order(pending), most - len(points)
        chosen = [one for k, one in enumerate(first) if k < self.at_once and (k < room or one.error == inf)]
        return sorted(chosen, key=lambda one: points.index(one.first))


def divided(
    bound: Callable[[Point, Point], float],
    between: Callable[[Point, Point], Point | None],
    missed: Callable[[Point, Point, Point], float],
    tolerance: float,
    divisions: int,
) -> AdaptiveCurve[Point]:
    """A curve of cubics, whose last interval is divided first, and each not more than so many times.

    bound: how far the cubic between two points may miss. between: a point between two, None where there is none.
    missed: how far the cubic between the first two misses the third.
    """

    def settled(one: Interval[Point], middle: Point) -> float | None:
        # the error of the whole interval: walls that meet in a half make a kink there
        error = missed(one.first, one.second, middle)
        return error if error <= tolerance or len(one.errors) > divisions else None

    return AdaptiveCurve(
        lambda new: [bound(one.first, one.second) for one in new],
        lambda chosen: [between(one.first, one.second) for one in chosen],
        tolerance,
        settled=settled,
        order=lambda pending: pending[::-1],
        at_once=1,
    )
