"""The two ends of an arm at rising pressures, each from the state at the pressure before; and few states where the
walls of its cells do not touch."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest

import fem
from fem.cell.piece import BendingPiece, PieceFailed, PieceState
from fem.cell.response import inflated
from geometry import Reason, SemicircularSingle
from pipeline.law.ends import displacement
from pipeline.law.piece import measure_clamp
from pipeline.law.piece.measure import sweep_cell
from pipeline.law.piece.measure_clamp import SMOOTH, TOLERANCE, clamp_curve, clamp_without_moment, first_state
from pipeline.law.piece.measure_tip import tip_curve, tip_state
from pipeline.law.piece.point import reached
from pipeline.law.piece.reach import Reach
from rod.arm_law.curves import CellCurve
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


def test_an_end_from_the_state_at_a_lower_pressure_is_that_from_rest_in_fewer_factorizations(
    pieces: Pieces, cells: list[CellCurve]
) -> None:
    lower, upper = cells
    start = first_state(pieces.clamp, lower, None)
    spent = pieces.clamp.factorizations
    from_lower, _ = clamp_curve(pieces.clamp, upper, start)
    between = pieces.clamp.factorizations
    from_rest, _ = clamp_curve(pieces.clamp, upper)
    assert between - spent < pieces.clamp.factorizations - between
    for name in ("moment", "rotation", "offset", "beside"):
        ours, theirs = getattr(from_lower.curve, name), getattr(from_rest.curve, name)
        assert ours == pytest.approx(theirs, rel=1e-5, abs=1e-7), name
    tips = [tip_curve(pieces.free, upper, start)[0] for start in (tip_state(pieces.free, lower, None), None)]
    assert tips[0].curve.beside == pytest.approx(tips[1].curve.beside, abs=1e-7)
    assert tips[0].curve.couple == pytest.approx(tips[1].curve.couple, rel=1e-5, abs=1e-7)


def test_where_the_way_from_the_lower_pressure_fails_the_end_is_solved_from_rest(
    pieces: Pieces, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = inflated(pieces.clamp, 0.01, 0.0)
    solved = BendingPiece.solve_near

    def failing(piece: BendingPiece, *arguments: object, **options: object) -> PieceState:
        if arguments[3].pressure >= 0.01:  # type: ignore[attr-defined]
            raise PieceFailed(Reason("tangent_indefinite"))
        return solved(piece, *arguments, **options)  # type: ignore[arg-type]

    expected = inflated(pieces.clamp, 0.02, 0.0)
    monkeypatch.setattr(BendingPiece, "solve_near", failing)
    with pytest.raises(PieceFailed, match="the tangent is indefinite"):
        inflated(pieces.clamp, 0.02, 0.0, start)
    assert reached(pieces.clamp, 0.02, 0.0, start, lambda state: state.moment) == pytest.approx(expected.moment)


def test_without_contact_few_states_describe_the_clamped_end(pieces: Pieces, cells: list[CellCurve]) -> None:
    """Between its states, against states that are solved there."""
    cell, piece = cells[1], pieces.clamp
    clamp = clamp_curve(piece, cell)[0].curve
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
    first = measure_clamp._ClampPoint.on(piece, cell, first_state(piece, cell, None))
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


def test_a_clamped_end_with_little_moment_is_one_without_to_first_order(
    pieces: Pieces, cells: list[CellCurve], monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = cells[1]
    nearly, spent = clamp_without_moment(pieces.clamp, cell), pieces.clamp.factorizations
    monkeypatch.setattr(measure_clamp, "NEARLY_STRAIGHT", 1e-9)
    exact = clamp_without_moment(pieces.clamp, cell)
    assert pieces.clamp.factorizations > spent
    assert abs(exact.moment[0]) < 1e-3 * abs(nearly.moment[0])
    assert displacement(nearly, exact, cell, DESIGN.length) < 2e-5
