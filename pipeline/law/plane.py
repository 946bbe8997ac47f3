"""Whether the cells of an arm bend in its plane."""

import numpy as np

from fem.cell.any_plane import moment_beside
from fem.cell.piece import PieceFailed
from fem.cell.response import inflated
from pipeline.law.pieces import ArmPieces, NoArmLaw
from pipeline.values.pressure import in_MPa

#: moment out of the plane of a straight cell over that within, up to which it bends in the plane
IN_PLANE = 0.01
#: moment over the pressure times the volume of the cell that is rounding
NOTHING = 1e-6
#: why an arm has no law of bending in its plane
OUT_OF_PLANE = "its cells bend out of the plane z = 0; `pneurod cell` measures its law in space"


def check_plane(pieces: ArmPieces) -> None:
    """Raise `NoArmLaw` for cells that the lowest pressure of the configuration bends out of the plane."""
    if not pieces.design.halves_differ:
        return
    try:
        state = inflated(pieces.cell, in_MPa(pieces.config.pressures_kPa[0]), 0.0)
    except PieceFailed:
        return  # the law will say so
    moments = np.array([moment_beside(pieces.cell, state), state.moment])
    rounding = NOTHING * state.pressure * pieces.cell.body.volume
    if abs(moments[0]) > max(IN_PLANE * float(np.linalg.norm(moments)), rounding):
        raise NoArmLaw(OUT_OF_PLANE)
