"""Sentences for a body from a file that does not lie where an arm lies: x along it, y up, its middle at z = 0."""

import numpy as np

from geometry.arrays import Array

#: two sides reach equally far from zero but for this part of the size
EQUAL = 1e-3
#: a middle that is not known exactly is given with two decimals where that moves it by at most this part of the width
ROUNDED = 1e-4
#: the value of `axes`, by the direction along which a body is longest and the one in which it is high
_TURNS = {
    ("x", "z"): "[x, z, -y]",
    ("y", "x"): "[y, x, -z]",
    ("y", "z"): "[y, z, x]",
    ("z", "x"): "[z, x, y]",
    ("z", "y"): "[z, y, -x]",
}


def reach(low: float, high: float, middle: float) -> str:
    """The beginning of a sentence: from where to where the body reaches across, mm; middle: the key as it is."""
    low, high = (round(position, 6) + 0.0 for position in (low, high))
    return f"the body reaches from z = {low:.4g} to {high:.4g} mm" + (" from middle" if middle else "")


def middle_advice(low: float, high: float, middle: float, is_exact: bool = True) -> str:
    """What brings a body that reaches from z = low to high (mm) to both sides of z = 0, the second half of a sentence.

    middle: the key as it is, mm; is_exact: not so for splines, whose bounds are those of triangles.
    """
    position = round(middle + (low + high) / 2, 9) + 0.0
    short = round(position, 2) + 0.0
    if not is_exact and abs(short - position) <= ROUNDED * (high - low):
        position = short
    return f"write middle: {position:.9g} mm, the z of its middle"


def sides(low: float, high: float, middle: float) -> str:
    """Both values of the key `middle` with which z = 0 is at a side of the body."""
    return " or ".join(f"{round(middle + side, 9) + 0.0:.9g} mm" for side in (low, high))


def turn_advice(low: Array, high: Array, turned: bool) -> str:
    """How a body with the bounds low and high (3,), mm, is turned if it lies along another axis, or its height does; a
    part of a sentence.

    turned: whether it was turned with `axes`, so that no example can be given.
    """
    longest = int(np.argmax(high - low))
    others = [axis for axis in (2, 1, 0) if axis != longest]  # most programs have z up
    aside = np.abs(high + low) > EQUAL * float((high - low).max())
    up = next((axis for axis in others if aside[axis]), others[0])  # the width is likely on both sides of zero
    if longest == 0:
        if turned or up != 2:
            return ""
        reason = "" if aside[1] else "the body reaches equally far to both sides of y = 0: "
        return f"{reason}if its height is along z, write axes: {_TURNS['x', 'z']}"
    along = f"the body is longest along {'xyz'[longest]}"
    if turned:
        return f"{along}: check axes if that is the arm's length"
    return (
        f"{along}: if that is the arm's length, and its height is along {'xyz'[up]}, write axes: "
        f"{_TURNS['xyz'[longest], 'xyz'[up]]}"
    )


def likely_first(turn: str, others: str) -> str:
    """Two parts of a sentence; that on the turn stands first where something tells that the body has to be turned."""
    if not turn:
        return others
    return f"{turn}; otherwise {others}" if turn.startswith("the body") else f"{others}; {turn}"
