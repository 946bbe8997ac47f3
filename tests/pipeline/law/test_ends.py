"""The two ends of an arm at rising pressures, each from the state at the pressure before; and few states where the
walls of its cells do not touch."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import fem
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import continued
from geometry import Reason, SemicircularSingle
from pipeline.law.ends import DECAY, NOT_DECAYED, choose_half_cells, displacement
from pipeline.law.piece import measure_clamp
from pipeline.law.piece.measure import cell_without_moment, sweep_cell
from pipeline.law.piece.measure_clamp import (
    SMOOTH,
    TOLERANCE,
    clamp_curve,
    clamp_without_moment,
    straight_point,
)
from pipeline.law.piece.measure_tip import tip_curve
from pipeline.law.piece.pieces import NoArmLaw
from pipeline.law.piece.point import reached
from pipeline.law.piece.reach import Reach
from rod.arm_law.curves import CellCurve, ClampCurve
from tests.pieces import end_piece, half_cell

DESIGN = SemicircularSingle(length=110.0, radius=7.3)
RUBBER = fem.Hencky(E=1.2, nu=0.45)
SIZE = 7.0


@dataclass(frozen=True)
class Pieces:
    """The pieces of an arm without gaps."""

    @cached_property
    def cell(self) -> BendingPiece:
        return BendingPiece(half_cell(DESIGN, SIZE), RUBBER, "mirror")

    @cached_property
    def clamp(self) -> BendingPiece:
        return BendingPiece(end_piece(DESIGN, 1, SIZE), RUBBER, "clamp")

    @cached_property
    def free(self) -> BendingPiece:
        return BendingPiece(end_piece(DESIGN, 1, SIZE), RUBBER, "free")

    def curve(self, pressure: float) -> CellCurve:
        """The cell at a pressure in kPa."""
        return sweep_cell(self.cell, pressure, Reach(DESIGN.length, 0.1, 0.0, -0.001)).curve(self.cell.body.length)


@pytest.fixture(scope="module")
def pieces() -> Pieces:
    return Pieces()


@pytest.fixture(scope="module")
def cells(pieces: Pieces) -> list[CellCurve]:
    return [pieces.curve(pressure) for pressure in (20.0, 40.0)]


def test_states_without_moment_are_kept(pieces: Pieces, cells: list[CellCurve]) -> None:
    """Curves that begin with them do not depend on what was measured before."""
    first, again = Pieces(), Pieces()
    point = straight_point(first.clamp, cells[1])
    assert straight_point(first.clamp, cells[1]) is point
    ours, theirs = (
        clamp_curve(one.clamp, cells[1], partial(inflated, one.clamp, 0.04)).curve for one in (first, again)
    )
    assert first.clamp.factorizations > again.clamp.factorizations  # those of kept states count each time
    for name in ("moment", "rotation", "offset", "beside"):
        assert np.array_equal(getattr(ours, name), getattr(theirs, name)), name
    tips = [tip_curve(first.free, cells[1]).curve for _ in range(2)]
    assert np.array_equal(tips[0].beside, tips[1].beside)


def test_where_the_way_from_the_state_without_moment_fails_the_end_is_solved_from_rest(
    cells: list[CellCurve], monkeypatch: pytest.MonkeyPatch
) -> None:
    piece, cell = Pieces().clamp, cells[0]
    begin = partial(inflated, piece, 0.02)
    expected = measure_clamp._first(piece, cell, begin).state
    monkeypatch.setattr(BendingPiece, "solve", lambda *_: raised())

    def raised() -> PieceState:
        raise PieceFailed(Reason("tangent_indefinite"))

    state = measure_clamp._first(piece, cell, begin).state
    assert (state.angle, state.moment) == (expected.angle, pytest.approx(expected.moment, rel=1e-5))


def test_an_end_that_is_not_stable_when_inflated_at_once_is_solved_from_half_the_pressure(pieces: Pieces) -> None:
    states: list[PieceState] = []

    def second(state: PieceState) -> PieceState:
        states.append(state)
        if len(states) == 1:
            raise PieceFailed(Reason("tangent_indefinite"))
        return state

    state = reached(pieces.clamp, 0.02, -0.01, second)
    assert (state.pressure, state.angle) == (0.02, -0.01)
    assert state.moment == pytest.approx(states[0].moment, rel=1e-5)


def test_without_contact_few_states_describe_the_clamped_end(pieces: Pieces, cells: list[CellCurve]) -> None:
    """Between its states, against states that are solved there."""
    cell, piece = cells[1], pieces.clamp
    clamp = clamp_curve(piece, cell).curve
    assert len(clamp.moment) == SMOOTH[1] + 1
    length = piece.body.length
    for moment in 0.5 * (clamp.moment[1:] + clamp.moment[:-1]):
        angle = clamp.at(moment)[0] + cell.at(moment)[0] * length
        state = inflated(piece, cell.pressure / 1000.0, angle)
        x = (piece.space.points + state.state.displacement)[piece.curve, :2]
        rotation, offset, beside = measure_clamp._placed(piece, cell, state.moment, angle, x)
        there = clamp.at(state.moment)
        assert rotation == pytest.approx(there[0], abs=0.1 * TOLERANCE)
        assert offset == pytest.approx(there[1], abs=1e-4 * DESIGN.length)
        assert beside == pytest.approx(clamp.beside_at(np.array([state.moment]))[0], abs=2.5e-4 * DESIGN.length)


def test_states_that_are_not_on_one_path_are_noticed(pieces: Pieces, cells: list[CellCurve]) -> None:
    """A kink makes no more of the change of the rotation than of its slope; a jump does."""
    cell, piece = cells[0], pieces.clamp
    first = measure_clamp._first(piece, cell, None)
    moments, slopes = (0.0, 1.0), (0.2, 0.3)

    def miss(rotation: float) -> float:
        points = [
            replace(first, state=replace(first.state, moment=m), rotation=r, rotation_by_moment=s)
            for m, r, s in zip(moments, (0.0, rotation), slopes, strict=True)
        ]
        return measure_clamp._largest_miss(*points)

    for part in (0.0, 0.5, 1.0):  # of the interval before a kink
        assert miss(part * 0.2 + (1.0 - part) * 0.3) == pytest.approx(0.1 / 8.0)
    assert miss(0.25 + 0.4) == pytest.approx(0.1)


def test_a_longer_end_begins_as_a_shorter_one_and_goes_on_as_cells_do(pieces: Pieces, cells: list[CellCurve]) -> None:
    shorter, longer = (BendingPiece(end_piece(DESIGN, count, SIZE), RUBBER, "clamp") for count in (3, 5))
    at, of = straight_point(shorter, cells[1]).state, cell_without_moment(pieces.cell, 0.04).state
    angle, start = at.angle + 2.0 * of.angle, continued(longer, shorter, at, pieces.cell, of)
    near = longer.solve_near(0.04, angle, start, longer.rest())
    rest = inflated(longer, 0.04, angle)
    assert near.factorizations <= 2 < rest.factorizations
    assert near.state.displacement == pytest.approx(rest.state.displacement, abs=1e-5)
    assert start.displacement == pytest.approx(rest.state.displacement, abs=0.02)


def test_a_clamped_end_with_little_moment_is_one_without_to_first_order(
    pieces: Pieces, cells: list[CellCurve], monkeypatch: pytest.MonkeyPatch
) -> None:
    cell, again = cells[1], Pieces().clamp
    nearly = clamp_without_moment(pieces.clamp, cell)
    monkeypatch.setattr(measure_clamp, "NEARLY_STRAIGHT", 1e-9)
    exact = clamp_without_moment(again, cell)
    assert abs(exact.moment[0]) < 1e-3 * abs(nearly.moment[0])
    assert displacement(nearly, exact, cell, DESIGN.length) < 2e-5


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
    assert limit.values["why"] == "they cost"


def test_nothing_is_known_where_no_pair_has_an_equilibrium() -> None:
    unknown = Reason("ends_unknown", {"why": "the tangent is indefinite"})
    assert chosen({1: None, 3: None}, 10) == (1, None, unknown)  # longer ones are not tried
    assert chosen({1: None, 3: 0.1, 5: None}, 10) == (3, None, unknown)
    assert chosen({}, 2) == (1, None, Reason("ends_short"))


def test_the_last_pair_counts_where_longer_pieces_have_no_equilibrium() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.1 + 4 * DECAY, 5: None, 7: None}, 10)
    assert (half_cells, error) == (1, pytest.approx(4 * DECAY))
    assert (limit.code, limit.values["why"]) == ("ends_differ", "the tangent is indefinite")
    with pytest.raises(NoArmLaw, match="two half cells more change its end by 2 %"):
        chosen({1: 0.1, 3: 0.1 + 2 * NOT_DECAYED, 5: None, 7: None}, 10)


def test_ends_that_disturb_all_cells_are_named() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.11, 5: 0.11 + 4 * DECAY, 7: 0.11 + 6 * DECAY}, 10)
    assert (half_cells, error) == (5, pytest.approx(2 * DECAY))
    assert limit.values["why"] == "the arm has no room"


def test_longer_pieces_that_are_not_nearer_to_each_other_end_the_search() -> None:
    half_cells, error, limit = chosen({1: 0.1, 3: 0.1 + 3 * DECAY, 5: 0.1 + 7 * DECAY}, 20)
    assert (half_cells, error) == (1, pytest.approx(4 * DECAY))
    assert (limit.code, limit.values["why"]) == ("ends_differ", "longer ones are not nearer to each other")
