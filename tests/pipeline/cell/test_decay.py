"""How many half cells an end piece has: pieces without an equilibrium say nothing of how far the end disturbs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fem.cell.piece import PieceFailed
from pipeline.cell.decay import DECAY, NOT_DECAYED, Decay, Decayed
from pipeline.cell.pieces import NoArmLaw
from rod.arm_law.curves import ClampCurve

LENGTH = 100.0
CELL = SimpleNamespace(at=lambda _: (-0.001, 1.0, None), moment=np.array([-1.0, 1.0]), rigidity=np.array([1e-3, 1e-3]))


def clamp(rotation: float) -> ClampCurve:
    """A clamped end without moment that turns by so much, rad."""
    one, two = np.zeros(1), np.zeros((1, 2))
    s = np.linspace(0.0, 1.0, 2)
    return ClampCurve(1.0, one, one + rotation, one, one, two, two, s, np.zeros((1, 2, 2)))


@dataclass
class Answer:
    """What a worker returns."""

    rotation: float | None

    def result(self) -> Any:
        if self.rotation is None:
            raise PieceFailed("the end piece is not stable.")
        return SimpleNamespace(curve=clamp(self.rotation))


def decided(rotations: Mapping[int, float | None], available: int) -> Decayed:
    """With these rotations (rad) by half cells of the end piece; None for a piece without an equilibrium."""

    class Tasks:
        def submit(self, _: Callable[..., Any], __: Any, half_cells: int) -> Answer:
            return Answer(rotations[half_cells])

    pieces = SimpleNamespace(repetition=SimpleNamespace(half_cells=available), design=SimpleNamespace(length=LENGTH))
    return Decay(pieces, Tasks(), CELL).decided()  # type: ignore[arg-type]


def test_the_first_pair_that_agrees_is_taken() -> None:
    assert decided({1: 0.1, 3: 0.1 + 0.5 * DECAY}, 20) == (1, pytest.approx(0.5 * DECAY), "")
    small = {1: 0.1, 3: 0.1 + 3 * DECAY, 5: 0.1 + 3.1 * DECAY}
    assert decided(small, 20) == (3, pytest.approx(0.1 * DECAY), "")


@pytest.mark.parametrize("short", [{1: None, 3: 0.1}, {1: 0.1, 3: None}])
def test_after_a_piece_without_an_equilibrium_longer_ones_are_compared(short: Mapping[int, float | None]) -> None:
    half_cells, error, limit = decided({**short, 5: 0.1, 7: 0.1}, 20)
    assert half_cells == (3 if short[3] is not None else 5)
    assert (error, limit) == (0.0, "")


def test_nothing_is_known_where_no_pair_has_an_equilibrium() -> None:
    half_cells, error, limit = decided(dict.fromkeys((1, 3, 5, 7), None), 10)
    assert half_cells == 5
    assert error is None
    assert limit == "how far the ends of the arm disturb its cells is not known: the end piece is not stable"
    half_cells, error, limit = decided({}, 2)
    assert (half_cells, error) == (1, None)
    assert "too short" in limit


def test_the_last_pair_counts_where_longer_pieces_have_no_equilibrium() -> None:
    half_cells, error, limit = decided({1: 0.1, 3: 0.1 + 4 * DECAY, 5: None, 7: None}, 10)
    assert (half_cells, error) == (1, pytest.approx(4 * DECAY))
    assert "longer ones were not solved (the end piece is not stable)" in limit
    with pytest.raises(NoArmLaw, match="end pieces of 1 and 3 half cells differ by 2 % of the length at its end"):
        decided({1: 0.1, 3: 0.1 + 2 * NOT_DECAYED, 5: None, 7: None}, 10)


def test_ends_that_disturb_all_cells_are_named() -> None:
    half_cells, error, limit = decided({1: 0.1, 3: 0.11, 5: 0.11 + 4 * DECAY, 7: 0.11 + 8 * DECAY}, 10)
    assert (half_cells, error) == (5, pytest.approx(4 * DECAY))
    assert limit.endswith("at the end of the arm, which has no room for longer ones")
