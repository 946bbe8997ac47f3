"""Curves that are given further points: in which order, how many, and what is left."""

from collections.abc import Sequence
from math import inf

import pytest

from pipeline.law.piece.adaptive import AdaptiveCurve, Interval, divided


def widths(intervals: Sequence[Interval[float]]) -> list[float | None]:
    """Intervals near zero are worse than their widths."""
    return [(one.second - one.first) / (0.1 + one.first) for one in intervals]


def middles(intervals: Sequence[Interval[float]]) -> list[float | None]:
    return [0.5 * (one.first + one.second) for one in intervals]


def test_intervals_are_divided_until_all_are_right() -> None:
    points = [0.0, 1.0]
    left = AdaptiveCurve(widths, middles, 1.0).refine(points)
    assert points == sorted(points)
    assert all(one.error is not None and one.error <= 1.0 for one in left)
    assert sorted(one.first for one in left) == points[:-1]


def test_the_budget_goes_to_the_worst_intervals() -> None:
    points = [0.0, 0.5, 1.0, 2.0]
    worst = AdaptiveCurve(widths, middles, 0.1, 2, order=lambda all_: sorted(all_, key=lambda one: -(one.error or 0.0)))
    left = worst.refine(points)
    assert points == [0.0, 0.25, 0.5, 1.0, 1.5, 2.0]
    assert len(left) == 5
    assert max(one.error or 0.0 for one in left) > 0.1


def test_what_has_no_bound_is_divided_beyond_the_budget_and_what_is_not_known_is_left() -> None:
    points = [0.0, 1.0, 2.0]

    def errors(intervals: Sequence[Interval[float]]) -> list[float | None]:
        return [inf if one.part_of is None else None if one.first < 1.0 else 1.0 for one in intervals]

    left = AdaptiveCurve(errors, middles, 0.5, 1).refine(points)
    assert points == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert [one.error for one in left] == [None, None, 1.0, 1.0]


def test_a_point_that_cannot_be_solved_leaves_its_interval() -> None:
    points = [0.0, 1.0, 2.0]

    def some(intervals: Sequence[Interval[float]]) -> list[float | None]:
        return [None if one.first else 0.5 * one.second for one in intervals]

    left = AdaptiveCurve(widths, some, 0.6).refine(points)
    assert (1.0, 2.0) in {(one.first, one.second) for one in left}
    assert 1.5 not in points


@pytest.mark.parametrize(
    ("divisions", "expected"),
    [(0, [0.5]), (1, [0.5, 0.75, 0.25]), (9, [0.5, 0.75, 0.875, 0.625, 0.25, 0.375, 0.125])],
)
def test_cubics_are_divided_from_the_last_one_on(divisions: int, expected: list[float]) -> None:
    solved: list[float] = []

    def between(first: float, second: float) -> float:
        solved.append(0.5 * (first + second))
        return solved[-1]

    def width(first: float, second: float, *_: float) -> float:
        return second - first

    left = divided(width, between, width, 0.2, divisions).refine([0.0, 1.0])
    assert solved == expected
    assert all((one.error or 0.0) <= 0.2 for one in left) == (divisions > 1)
