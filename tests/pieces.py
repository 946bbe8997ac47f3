"""The pieces of an arm of a size: half a cell, and both ends."""

from geometry import Body, Design
from geometry.grading import OFF, Grading


def half_cell(design: Design, size: float, grading: Grading = OFF) -> Body:
    """Half a cell, with elements of `size` mm."""
    return design.half_cell(design.repetition(size, grading))


def end_piece(design: Design, half_cells: int, size: float) -> Body:
    """The clamped end with so many half cells."""
    return design.end_piece(half_cells, design.repetition(size, OFF))


def tip_piece(design: Design, half_cells: int, size: float) -> Body:
    """The other end, as its mirror image."""
    return design.tip_piece(half_cells, design.repetition(size, OFF))
