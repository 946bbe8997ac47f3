"""Sentences for a body from a file that does not lie where an arm lies: x along it, y up, its middle at z = 0."""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array

#: the two sides of a symmetric body reach equally far but for this part of its size, because the bounds of splines are
#: those of triangles
UNEQUAL = 1e-3
#: a middle that is not known exactly is given with two decimals where that moves it by at most this part of the width
ROUNDED = 1e-4
#: the value of `axes`, by the direction along which a body is longest and the one in which it is high
TURNS = {
    ("x", "z"): "[x, z, -y]",
    ("y", "x"): "[y, x, -z]",
    ("y", "z"): "[y, z, x]",
    ("z", "x"): "[z, x, y]",
    ("z", "y"): "[z, y, -x]",
}


@dataclass(frozen=True, eq=False)  # arrays inside
class Lying:
    """Where a body lies in its file, and what a user writes if it should lie elsewhere: parts of sentences."""

    low: Array  #: (3,) in the directions of the arm, measured from `middle`, mm
    high: Array  #: (3,)
    middle: float  #: the key, mm
    has_axes: bool  #: whether it was turned with the key `axes`, so that no example can be given
    is_exact: bool = True  #: whether the bounds are those of the body, not of triangles on it

    def beside(self, halves: bool) -> str:
        """The sentence for a body that does not have z = 0 within; halves: whether a file of one half may be given."""
        advice = (
            f"write symmetric: true if the file holds one half of an arm; if it holds the whole arm, {self.whole}"
            if halves
            else f"{self.whole}; a file of one half alone cannot be used"
        )
        return f"{self.reach}, and the material curve runs at z = 0; {self.turned_or(advice)}"

    @property
    def reach(self) -> str:
        """From where to where it reaches across."""
        low, high = (round(float(position), 6) + 0.0 for position in (self.low[2], self.high[2]))
        return f"the body reaches from z = {low:.4g} to {high:.4g} mm" + (" from middle" if self.middle else "")

    @property
    def whole(self) -> str:
        """What brings its middle to z = 0."""
        low, high = float(self.low[2]), float(self.high[2])
        position = self.middle + (low + high) / 2
        short = round(position, 2)
        if not self.is_exact and abs(short - position) <= ROUNDED * (high - low):
            position = short
        return f"write middle: {position_of(position)}, the z of its middle"

    @property
    def sides(self) -> str:
        """Both values of the key `middle` with which z = 0 is at a side of it."""
        return " or ".join(position_of(self.middle + float(side)) for side in (self.low[2], self.high[2]))

    @property
    def turn(self) -> str:
        """What turns it if it lies along another axis, or its height does; empty where it likely lies along x."""
        if self._longest == "x":
            if self.has_axes or self._up != "z":
                return ""
            reason = "the body reaches equally far to both sides of y = 0: " if self._must_turn else ""
            return f"{reason}if its height is along z, write axes: {TURNS['x', 'z']}"
        along = f"the body is longest along {self._longest}"
        if self.has_axes:
            return f"{along}: check axes if that is the arm's length"
        return (
            f"{along}: if that is the arm's length, and its height is along {self._up}, write axes: "
            f"{TURNS[self._longest, self._up]}"
        )

    def turned_or(self, advice: str) -> str:
        """What turns it and other advice, the likelier of them first."""
        if not self.turn:
            return advice
        return f"{self.turn}; otherwise {advice}" if self._must_turn else f"{advice}; {self.turn}"

    @property
    def _must_turn(self) -> bool:
        """Whether something tells that it lies along other axes."""
        return self._longest != "x" or not self._is_aside("y")

    @property
    def _longest(self) -> str:
        return "xyz"[int(np.argmax(self.high - self.low))]

    @property
    def _up(self) -> str:
        """The direction of its height: its width is likely on both sides of zero, and most programs have z up."""
        others = [axis for axis in "zyx" if axis != self._longest]
        return next(filter(self._is_aside, others), others[0])

    def _is_aside(self, axis: str) -> bool:
        """Whether it reaches farther to one side of zero."""
        low, high = self.low["xyz".index(axis)], self.high["xyz".index(axis)]
        return bool(abs(high + low) > UNEQUAL * (self.high - self.low).max())


def position_of(position: float) -> str:
    """A position as the value of a key, mm."""
    return f"{round(position, 9) + 0.0:.9g} mm"
