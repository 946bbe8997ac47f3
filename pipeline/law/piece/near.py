"""A cell near its state without moment: all that an arm under no load, or a small one, needs of its law."""

from fem.cell.piece import BendingPiece
from pipeline.law.piece.measure import CellPoint, CellSweep, cell_without_moment, predicted_at, shear_at
from pipeline.values.pressure import in_MPa


def cell_near(piece: BendingPiece, pressure_kPa: float, bend: float) -> CellSweep:
    """The state without moment at a pressure, and those bent by `bend` (1/mm) more and less.

    Raises `PieceFailed`.
    """
    middle = cell_without_moment(piece, in_MPa(pressure_kPa))
    sides = []
    for sign in (-1.0, 1.0):
        angle = middle.state.angle + sign * bend * piece.body.length
        start = predicted_at(None, middle, angle)
        sides.append(CellPoint.of(piece, piece.solve(middle.state.pressure, angle, middle.state, start)))
    sweep = CellSweep(pressure_kPa, [sides[0], middle, sides[1]])
    sweep.shear.append((middle.moment, shear_at(piece, middle)))
    return sweep
