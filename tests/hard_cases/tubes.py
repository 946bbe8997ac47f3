"""Tubes in plane strain that swell at a limit of their pressure: their air over that at rest, by name."""

from fem import Fixed, Ogden
from fem.cell.inflation import inflated
from fem.cell.piece import BendingPiece
from tests.fem.cell.test_inflation import tube

#: laws of Ogden with a maximum of the pressure, and with a minimum beyond it as well; MPa, beyond this maximum where
#: the form after the snap is wanted
TUBES = {
    "soft_tube": (Ogden((0.1,), (1.4,), 100.0), 0.0),
    "rising_tube": (Ogden((0.1, 5e-4), (1.4, 4.0), 100.0), 0.0),
    "swollen_tube": (Ogden((0.1, 5e-4), (1.4, 4.0), 100.0), 1.0),
}


def air_of(name: str, pressure: float) -> float:
    """At a pressure in MPa. Raises `PieceFailed`."""
    law, after_snap = TUBES[name]
    piece = BendingPiece(tube(), law, "free", "mixed", supports=[Fixed("clamp", "x")])
    piece.after_snap = after_snap
    return piece.volume(inflated(piece, pressure, 0.0).state) / piece.volume(piece.rest().state)
