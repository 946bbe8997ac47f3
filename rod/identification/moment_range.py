"""The moments that an identification has seen, and rods that leave them.

The lines M = alpha Delta + m0 are secants of a curve that starts at M = 0, drawn through the moments of Test III. Where
a load bends the arm with moments that III hardly holds - next to nothing, or the other way - they are extrapolated: a
secant with an offset bends there although nothing acts.
"""

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Mask
from rod.curves.curve import Moment
from rod.mechanics.equilibrium import RodSolution

#: share of the arm that holds the smallest moments and does not count as sampled: near the end M falls to zero
TAIL = 0.05
#: share of a rod that may lie outside before it is worth a word; III itself has TAIL
ALLOWED = 0.15


@dataclass(frozen=True)
class MomentRange:
    """The range of moments behind the numbers of one pressure."""

    low: float  #: N mm
    high: float  #: N mm

    @staticmethod
    def of(moment: Moment) -> "MomentRange":
        """All moments of a loaded curve but the smallest on TAIL of its length."""
        s = np.linspace(moment.s[0], moment.s[-1], 401)
        values = np.interp(s, moment.s, moment.value)
        sign = 1.0 if values[np.argmax(np.abs(values))] > 0.0 else -1.0
        ends = sorted(sign * edge for edge in (np.quantile(sign * values, TAIL), np.max(sign * values)))
        return MomentRange(float(ends[0]), float(ends[1]))

    def between(self, other: "MomentRange", share: float) -> "MomentRange":
        """The range at a pressure between this one's (share 0) and another's (share 1)."""
        low, high = ((1.0 - share) * a + share * b for a, b in ((self.low, other.low), (self.high, other.high)))
        return MomentRange(low, high)

    def warning(self, shape: RodSolution) -> str:
        """Where the rod's moment leaves the range and how far, one sentence; empty where it does not.

        A rod without load has the shape of kappa_0 and needs no law.
        """
        if shape.load_steps == 0 or not np.any(shape.moment):
            return ""
        s = np.linspace(0.0, shape.s[-1], 401)
        moment = np.interp(s, shape.s, shape.moment)
        outside = (moment < self.low) | (moment > self.high)
        share = float(outside.mean())
        if share <= ALLOWED:
            return ""
        beyond = np.maximum(self.low - moment, moment - self.high)
        farthest = int(np.argmax(beyond))
        return (
            f"The moment leaves the {self.low:.3g} to {self.high:.3g} N mm that the numbers were identified from on "
            f"{100 * share:.0f} % of the rod, {_places(s, outside)}; it is farthest off at s = {s[farthest]:.3g} mm "
            f"with {moment[farthest]:.3g} N mm, and the law is extrapolated there."
        )


def _places(s: Array, outside: Mask) -> str:
    """Where along the rod, in words."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], outside.astype(int), [0]])))
    runs = zip(s[edges[::2]], s[edges[1::2] - 1], strict=True)
    return " and ".join(f"from s = {first:.3g} to {last:.3g} mm" for first, last in runs)
