"""The material curve of a body, as both the finite elements and the rod speak of it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from geometry.arrays import Array


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
