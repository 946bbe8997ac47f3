"""The range of moments behind an identification, and rods whose moments leave it.

The lines M = alpha Delta + m0 are secants of a curve that starts at M = 0, fitted to the moments of experiment III.
Where a load bends the arm with moments that III hardly contains - next to none, or of the other sign - the lines are
extrapolated: a secant with an offset bends there although nothing acts.
"""

from dataclasses import dataclass

import numpy as np

from rod.curves.curve import Moment
from rod.solution import RodSolution

#: fraction of the arm with the smallest moments that is left out of the range: near the end M falls to zero
TAIL_FRACTION = 0.05
#: fraction of a rod that may lie outside without a warning; III itself has TAIL_FRACTION
ALLOWED_FRACTION = 0.15


@dataclass(frozen=True)
class MomentRange:
    """The range of moments from which the parameters of one pressure were identified."""

    low: float  #: N mm
    high: float  #: N mm

    @staticmethod
    def of(moment: Moment) -> "MomentRange":
        """All moments of a loaded curve but the smallest on TAIL_FRACTION of its length."""
        s = np.linspace(moment.s[0], moment.s[-1], 401)
        values = np.interp(s, moment.s, moment.value)
        sign = 1.0 if values[np.argmax(np.abs(values))] > 0.0 else -1.0
        ends = sorted(sign * edge for edge in (np.quantile(sign * values, TAIL_FRACTION), np.max(sign * values)))
        return MomentRange(float(ends[0]), float(ends[1]))

    def between(self, other: "MomentRange", fraction: float) -> "MomentRange":
        """The range at a pressure between this one's (fraction 0) and another's (fraction 1)."""
        low, high = ((1.0 - fraction) * a + fraction * b for a, b in ((self.low, other.low), (self.high, other.high)))
        return MomentRange(low, high)

    def warning(self, shape: RodSolution) -> str:
        """One sentence on how far the moment of a rod leaves the range; empty where it does not.

        An unloaded rod has the shape of kappa_0 and needs no law. The moment is that which bends the rod: of one that
        stretches about its neutral axis, and of the weight of a rod that has one the change.
        """
        if shape.load_steps == 0 or not np.any(shape.moment):
            return ""
        s = np.linspace(0.0, shape.s[-1], 401)
        moment = np.interp(s, shape.s, shape.moment if shape.bending_moment is None else shape.bending_moment)
        fraction = float(((moment < self.low) | (moment > self.high)).mean())
        if fraction <= ALLOWED_FRACTION:
            return ""
        farthest = moment[np.argmax(np.maximum(self.low - moment, moment - self.high))]
        return (
            f"The moment leaves the {self.low:.3g} to {self.high:.3g} N mm of the identification on "
            f"{100 * fraction:.0f} % of the rod, up to {farthest:.3g} N mm: the law is extrapolated there."
        )
