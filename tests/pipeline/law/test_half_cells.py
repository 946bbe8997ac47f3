"""How many half cells an end piece has: pieces without an equilibrium say nothing of how far the end disturbs."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fem.cell.piece import PieceFailed
from geometry import Reason
from pipeline.law.ends import DECAY, NOT_DECAYED, choose_half_cells
from pipeline.law.piece.pieces import NoArmLaw
from rod.arm_law.curves import ClampCurve

LENGTH = 100.0
CELL: Any = SimpleNamespace(
    at=lambda _: (-0.001, 1.0, None), moment=np.array([-1.0, 1.0]), rigidity=np.array([1e-3, 1e-3])
)


def clamp(rotation: float) -> ClampCurve:
    """A clamped end without moment that turns by so much, rad."""
    one, two = np.zeros(1), np.zeros((1, 2))
    s = np.linspace(0.0, 1.0, 2)
    return ClampCurve(1.0, one, one + rotation, one, one, two, two, s, np.zeros((1, 2, 2)))


def chosen(rotations: Mapping[int, float | None], available: int) -> tuple[int, float | None, Reason | None]:
    """With these rotations (rad) by half cells of the end piece; None for a piece without an equilibrium."""

    def answer(half_cells: int) -> ClampCurve:
        if (rotation := rotations[half_cells]) is None:
            raise PieceFailed(Reason("tangent_indefinite"))
        return clamp(rotation)

    return choose_half_cells(answer, CELL, available, LENGTH)


def test_the_first_pair_that_agrees_is_taken() -> None:
    assert chosen({1: 0.1, 3: 0.1 + 0.5 * DECAY}, 20) == (1, pytest.approx(0.5 * DECAY), None)
    small = {1: 0.1, 3: 0.1 + 3 * DECAY, 5: 0.1 + 3.1 * DECAY}
    assert chosen(small, 20) == (3, pytest.approx(0.1 * DECAY), None)


@pytest.mark.parametrize("short", [{1: None, 3: 0.1}, {1: 0.1, 3: None}])
def test_after_a_piece_without_an_equilibrium_longer_ones_are_compared(short: Mapping[int, float | None]) -> None:
    assert chosen({**short, 5: 0.1, 7: 0.1}, 20) == (3 if short[3] is not None else 5, 0.0, None)


def test_the_shortest_end_may_be_longer() -> None:
    """Ends of swollen cells, of which the shortest ones are wrong."""
    ends = {half_cells: clamp(rotation) for half_cells, rotation in {3: 0.1, 5: 0.1 + 2 * NOT_DECAYED}.items()}
    half_cells, error, limit = choose_half_cells(ends.__getitem__, CELL, 6, LENGTH, 3 * NOT_DECAYED, "they cost", 3)
    assert (half_cells, error) == (3, pytest.approx(2 * NOT_DECAYED))
    assert limit is not None
    assert limit.values["why"] == "they cost"


def test_nothing_is_known_where_no_pair_has_an_equilibrium() -> None:
    unknown = Reason("ends_unknown", {"why": "the tangent is indefinite"})
    assert chosen({1: None, 3: None}, 10) == (1, None, unknown)  # longer ones are not tried
    assert chosen({1: None, 3: 0.1, 5: None}, 10) == (3, None, unknown)
    assert chosen({}, 2) == (1, None, Reason("ends_short"))


def test_the_last_pair_counts_where_longer_pieces_have_no_equilibrium() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.1 + 4 * DECAY, 5: None, 7: None}, 10)
    assert (half_cells, error) == (1, pytest.approx(4 * DECAY))
    assert limit is not None
    assert (limit.code, limit.values["why"]) == ("ends_differ", "the tangent is indefinite")
    with pytest.raises(NoArmLaw, match="two half cells more change its end by 2 %"):
        chosen({1: 0.1, 3: 0.1 + 2 * NOT_DECAYED, 5: None, 7: None}, 10)


def test_ends_that_disturb_all_cells_are_named() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.11, 5: 0.11 + 4 * DECAY, 7: 0.11 + 6 * DECAY}, 10)
    assert (half_cells, error) == (5, pytest.approx(2 * DECAY))
    assert limit is not None
    assert limit.values["why"] == "the arm has no room"


def test_longer_pieces_that_are_not_nearer_to_each_other_end_the_search() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.1 + 3 * DECAY, 5: 0.1 + 7 * DECAY}, 20)
    assert (half_cells, error) == (1, pytest.approx(4 * DECAY))
    assert limit is not None
    assert (limit.code, limit.values["why"]) == ("ends_differ", "longer ones are not nearer to each other")
