"""The material curve of a body, as both the finite elements and the rod speak of it."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array

#: the angle of the end of a material curve is that of its chord over this last part of its rest length
END_PART = 0.02


@dataclass(frozen=True)
class Centreline:
    """Current positions of the nodes of the material curve, by their rest arc length.

    Raises `ValueError` unless there are at least four nodes, all finite, with increasing s.
    """

    s: Array  #: (n,), arc length at rest, increasing, mm, read-only
    x: Array  #: (n,), current position along the rest axis, mm, read-only
    y: Array  #: (n,), current height, mm, read-only

    def __post_init__(self) -> None:
        for name in ("s", "x", "y"):
            values = np.array(getattr(self, name), dtype=np.float64)
            if values.ndim != 1 or values.shape != np.shape(self.s):
                raise ValueError(f"s, x and y of a centreline must have one shape (n,); {name} has {values.shape}")
            if not np.isfinite(values).all():
                raise ValueError(f"the centreline has a value of {name} that is not finite")
            values.setflags(write=False)
            object.__setattr__(self, name, values)
        if len(self.s) < 4:
            raise ValueError(f"a centreline needs at least 4 nodes, not {len(self.s)}")
        if not (np.diff(self.s) > 0).all():
            raise ValueError("the arc length s of a centreline must increase from node to node")

    @property
    def length(self) -> float:
        """Rest length, mm."""
        return float(self.s[-1] - self.s[0])

    @cached_property
    def chords(self) -> Array:
        """Current distance of successive nodes, (n - 1,), mm."""
        chords = np.hypot(np.diff(self.x), np.diff(self.y))
        chords.setflags(write=False)
        return chords

    @property
    def stretch(self) -> float:
        """Current length over rest length."""
        return float(self.chords.sum() / self.length)

    @cached_property
    def angle(self) -> Array:
        """Angle of the chord between successive nodes from the x axis, continuous along the curve, (n - 1,), rad."""
        angle = np.unwrap(np.arctan2(np.diff(self.y), np.diff(self.x)))
        angle.setflags(write=False)
        return angle

    @property
    def end_angle(self) -> float:
        """Angle of the end from the x axis, rad: that of the chord over the last `END_PART` of the rest length.

        Nodes are joined by straight lines. Of the angles that differ by full turns it is the one nearest to the last
        of `angle`.
        """
        begin = float(self.s[-1]) - END_PART * self.length
        x, y = (float(values[-1] - np.interp(begin, self.s, values)) for values in (self.x, self.y))
        return chord_angle(x, y, float(self.angle[-1]))


def chord_angle(x: float, y: float, near: float) -> float:
    """Angle of a chord (x, y) from the x axis, rad; of those that differ by full turns the one nearest to near."""
    angle = math.atan2(y, x)
    return angle + 2.0 * math.pi * round((near - angle) / (2.0 * math.pi))
