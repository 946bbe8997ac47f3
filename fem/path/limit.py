"""Whether a state continues its path, and where a path announces its end.

Near a limit point of the load, at distance d of the driven quantity, a state is e = c - a d - 2 b sqrt(d): a regular
motion and one in the critical mode, whose rate a + b / sqrt(d) becomes infinite (a fold; R. Seydel, "Practical
bifurcation and stability analysis", 3rd ed. 2010, 2.3). Two points with their rates r1 and r2 and the mean rate m
between them determine it: (m - r1) / (r2 - r1) = sqrt(d2) / (sqrt(d1) + sqrt(d2)), whatever a, b and c are. Strains are
compared, weighted with the growth of their rates. Newton's method may also find an equilibrium beyond the
limit point, to which the path does not lead. Such a jump is longer than either rate explains.
"""

from dataclasses import dataclass

import numpy as np

from fem.equations.state import State
from fem.path.predictor import PathPoint
from geometry.arrays import Array

#: growth of the largest rate of strain between two points from which it announces a limit
GROWTH = 1.05
#: largest part of the growth of the rates that the mean rate has between two points where a limit is announced, six
#: increments ahead; it is a half on a parabola, and less towards a fold
LARGEST_SHARE = 0.48
#: length of the way between two points over the longer one of both rates times the increment, beyond which it is a
#: jump. It is at most 1.06 on the hard cases, 1.2 where contact acts from rest on; where a thin wall snaps 1.7 to 1.8
LONGEST_WAY = 1.4
#: largest difference between the way and the mean of both rates times the increment, relative to the way, of an
#: increment that passes an announced limit or loses the stability
SMOOTH = 0.5
#: the same of an increment that loses the stability, however large it is: as at a bifurcation, where the path goes on
BIFURCATION = 0.05


@dataclass(frozen=True)
class Way:
    """The way between two points of a path, compared with the rates there; the larger number of displacement and
    strain each."""

    length: float  #: over the longer one of both rates times the increment
    mismatch: float  #: difference from the mean of both rates times the increment, over the length

    @property
    def is_jump(self) -> bool:
        """Whether no continuous path of such rates is as long."""
        return self.length > LONGEST_WAY

    @property
    def is_smooth(self) -> bool:
        """Whether the rates at both points describe it."""
        return not self.is_jump and self.mismatch <= SMOOTH

    @property
    def is_straight(self) -> bool:
        """Whether the rates at both points describe it so well that there is no other branch in between."""
        return not self.is_jump and self.mismatch <= BIFURCATION


def way_between(before: PathPoint, last: PathPoint) -> Way | None:
    """The way between two points; None where one of the rates is not known or nothing moved."""
    if before.rate is None or last.rate is None or before.value == last.value:
        return None
    increment = last.value - before.value
    ways = [_compared(before, last, increment, name) for name in ("displacement", "strain")]
    known = [way for way in ways if way is not None]
    return Way(max(way.length for way in known), max(way.mismatch for way in known)) if known else None


def _compared(before: PathPoint, last: PathPoint, increment: float, name: str) -> Way | None:
    assert before.rate is not None
    assert last.rate is not None
    change = getattr(last.state, name) - getattr(before.state, name)
    first, second = (increment * getattr(rate, name) for rate in (before.rate, last.rate))
    length, longest = float(np.linalg.norm(change)), max(float(np.linalg.norm(rate)) for rate in (first, second))
    if not length or not longest:
        return None
    return Way(length / longest, float(np.linalg.norm(change - (first + second) / 2)) / length)


def difference(first: State, second: State) -> float:
    """Difference of two states over the first, in displacement or strain, whichever is larger (norms); 0 from rest."""
    parts = [
        float(np.linalg.norm(getattr(second, name) - value) / size)
        for name in ("displacement", "strain")
        if (size := np.linalg.norm(value := getattr(first, name)))
    ]
    return max(parts, default=0.0)


def announced_limit(before: PathPoint, last: PathPoint) -> float | None:
    """Value of the driven quantity at which the rates of two points become infinite; None where they announce none."""
    increment = last.value - before.value
    if before.rate is None or last.rate is None or not increment:
        return None
    first, second = before.rate.strain, last.rate.strain
    mean = (last.state.strain - before.state.strain) / increment
    if not _largest(first) or _largest(second) < GROWTH * _largest(first):
        return None
    growth = second - first
    share = float(np.vdot(mean - first, growth) / np.vdot(growth, growth))
    if not 0.0 < share <= LARGEST_SHARE:
        return None
    ratio = share / (1.0 - share)  # of the roots of the distances
    return last.value + increment * ratio**2 / (1.0 - ratio**2)


def _largest(strain: Array) -> float:
    return float(np.abs(strain).max(initial=0.0))
