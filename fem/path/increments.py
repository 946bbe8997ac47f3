"""Which part of the way to a target is tried next."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np

#: iterations of a quick increment, after which the next one is twice as large
QUICK_ITERATIONS = 8
#: largest number of quick increments in succession that a longer one waits for: as many as there were failures behind
#: one that succeeded, so that a length that fails again and again is tried ever more seldom
MAX_WAIT = 4
#: where an increment to a load has failed, this fraction of it is small enough to try the same load once more
RETRY = 0.25
#: largest number of increments that fail on the way to one target, and that are tried; the hard cases need 20 and 60
MAX_CUTBACKS, MAX_INCREMENTS = 40, 200
#: largest number of increments that fail from within the accuracy of a limit before the path gets farther than that
MAX_NEAR_FAILURES = 6
#: how accurately a limit is named that the path announces: distance between the last equilibrium and the lowest load
#: without one, as a fraction of the load
LIMIT_ACCURACY = 0.01
#: largest increment that may lose the stability, as a fraction of the way and of the load
STABLE_INCREMENT, STABLE_INCREMENT_LOAD = 1 / 16, 0.02
#: distance within which an announced limit is near, as a fraction of the load
NEAR = 0.1
#: how far an increment may pass an announced limit, over the distance to the limit; and as a fraction of the load
PASSED, PASSED_LOAD = 4.0, 0.02
#: largest distance from which the load without an equilibrium was tried, over the accuracy; and the largest difference
#: of two limits announced one after the other that allows twice that distance, over the accuracy
TRIED_FROM, SETTLED = 1 / 2, 1 / 2
#: distance from an announced limit, over the accuracy, from which on the next increment ends behind it; how far behind
FROM_HERE, BEHIND = 0.7, 0.25
#: how much of the way to an announced limit, or to a failed load before it, the next increment goes: where that is far
#: and where it is near (`NEAR`)
APPROACH, APPROACH_NEAR = 0.6, 0.8
#: smallest increment on the way to an announced limit, over the accuracy
SMALLEST_NEAR_LIMIT = 1 / 4


@final
@dataclass
class Increments:
    """Increments on the way from one value of the driven quantity to the next target, as fractions of this way.

    The whole way is tried first. An increment that fails is halved, one that converges quickly is doubled. Where
    increments fail again after one that converged, a longer one is tried only after 2, 3, at most 4 quick ones in a
    row. Where the path announces a limit, the next increment ends shortly before or shortly behind it. Where a
    neighbouring path has reached the target, its increments are tried first, until one of them fails.
    """

    start: float  #: value of the driven quantity where the way begins
    target: float
    smallest: float  #: increment that is tried, as a fraction of the way and, beyond rest, of the load
    reached: float = 0.0
    cutbacks: int = 0
    limit: float | None = None  #: value at which the path announces its end
    _limit_before: float | None = None  #: the same, one equilibrium earlier
    tried: int = 0  #: number of increments so far
    _increment: float = 1.0
    _quick: int = 0  #: number of quick increments in succession since the last change of their length
    _setbacks: int = 0  #: number of failures that followed an equilibrium on this way
    _has_succeeded: bool = False  #: whether the last increment did
    _failed: float = field(default=np.inf)  #: the lowest fraction that was not reached
    _distance: float = 0.0  #: from how far
    _near_failures: int = 0  #: number of increments that failed from near
    _near: float = 0.0  #: the fraction from which on they are counted
    _unstable: bool = False  #: whether there was no stable equilibrium
    _inverted: bool = False  #: whether there was one in which an element is turned inside out
    _neighbour: tuple[float, ...] = ()  #: fractions at which a neighbouring path has equilibria

    @property
    def next(self) -> float:
        """The fraction to be tried."""
        fraction = min(1.0, self.reached + self._increment)
        limit = self._limit_fraction
        if limit is None or limit >= fraction or (self.tried == 0 and self._may_pass(fraction)):
            return fraction
        ahead = min(limit, self._failed) - self.reached
        if ahead <= FROM_HERE * self._accuracy:
            return min(1.0, self._failed, limit + BEHIND * self._accuracy)
        if self._failed - self.reached == self._distance:  # the last attempt from here
            return min(fraction, self.reached + ahead / 2)
        part = APPROACH_NEAR if ahead <= self._load_fraction(NEAR) else APPROACH
        if self.limit is not None and self._limit_before is not None and limit < self._failed:
            doubt = self._load_fraction(abs(self.limit / self._limit_before - 1.0))
            part = max(part, 1.0 - max(doubt, FROM_HERE / 2 * self._accuracy) / ahead)
        return min(fraction, self.reached + part * ahead)

    @property
    def is_small(self) -> bool:
        """Whether the next increment is small enough to pass a point where the path loses its stability.

        Near a sharp bend of the path a smaller one stays on the stable part.
        """
        increment = self.next - self.reached
        largest = min(STABLE_INCREMENT, self._load_fraction(STABLE_INCREMENT_LOAD))
        return increment <= max(self.smallest, largest)

    @property
    def passes_limit(self) -> bool:
        """Whether the next increment ends at an announced limit or beyond it."""
        limit = self._limit_fraction
        return limit is not None and self.next >= limit

    @property
    def nears_limit(self) -> bool:
        """Whether the next increment goes a good part of the way to an announced limit that is near."""
        limit = self._limit_fraction
        if limit is None:
            return False
        distance = limit - self.reached
        return distance <= self._load_fraction(NEAR) and self.next >= self.reached + distance / 4

    @property
    def may_pass_limit(self) -> bool:
        """Whether an equilibrium found with the next increment is near enough to an announced limit to be trusted."""
        return self._may_pass(self.next)

    def _may_pass(self, fraction: float) -> bool:
        limit, increment = self._limit_fraction, fraction - self.reached
        if limit is None:
            return True
        return increment <= max(PASSED * (limit - self.reached), self._load_fraction(PASSED_LOAD))

    def accepted(self, fraction: float, iterations: int, limit: float | None) -> None:
        """An equilibrium was found there in so many iterations; `limit` is the value at which the path now ends."""
        self.tried += 1
        placed = fraction < min(1.0, self.reached + self._increment)
        self.reached, self.limit, self._limit_before = fraction, limit, self.limit
        if self.reached - self._near > self._accuracy:
            self._near, self._near_failures = self.reached, 0
        self._has_succeeded = True
        if placed:
            self._quick = 0
        else:
            self._lengthen(iterations <= QUICK_ITERATIONS)
        is_close = self._failed - self.reached <= RETRY * self._distance
        if self.reached >= self._failed or (is_close and not self.limit_is_confirmed):
            self._failed = np.inf
        elif limit is None and self.reached + self._increment >= self._failed and not is_close:
            self._increment, self._quick = (self._failed - self.reached) / 2, 0
        self._follow_neighbour()

    def follow(self, fractions: Sequence[float]) -> None:
        """Try the increments of a neighbouring path, which has equilibria at these fractions: at the beginning of the
        way, or after the whole of it has failed.

        Where the other path went it in one increment there is nothing to follow.
        """
        self._neighbour = tuple(fractions) if min(fractions, default=np.inf) < self._failed else ()
        self._follow_neighbour()

    def _follow_neighbour(self) -> None:
        ahead = [fraction for fraction in self._neighbour if fraction > self.reached]
        if ahead:
            self._increment, self._quick = min(ahead) - self.reached, 0

    def _lengthen(self, quick: bool) -> None:
        """Double the increment where so many have been quick in succession, the last one as `quick` says."""
        self._quick = self._quick + 1 if quick else 0
        if self._quick >= max(1, min(self._setbacks, MAX_WAIT)):
            self._increment, self._quick = 2.0 * self._increment, 0

    def failed(self, fraction: float, unstable: bool, inverted: bool = False) -> None:
        """None was found there, or no stable one, or one in which an element is turned inside out."""
        self.cutbacks, self.tried = self.cutbacks + 1, self.tried + 1
        self._failed, self._distance = fraction, fraction - self.reached
        self._unstable, self._inverted = unstable, inverted
        self._near_failures += self._distance <= self._accuracy
        self._setbacks, self._has_succeeded = self._setbacks + self._has_succeeded, False
        self._increment, self._quick, self._neighbour = self._distance / 2, 0, ()

    @property
    def ended(self) -> bool:
        """Whether no smaller increment is worth trying."""
        if self.is_confirmed_or_exhausted or self.is_stuck:
            return True
        if self._inverted and self.cutbacks > 1 and self._distance <= self._load_fraction(LIMIT_ACCURACY):
            return True
        # where the target is many times the load that is reached, a part of the way alone would be too large
        smallest = self.smallest * min(1.0, self._load_fraction(1.0) or 1.0)
        if self._limit_fraction is not None:
            smallest = min(smallest, self._accuracy * SMALLEST_NEAR_LIMIT)
        return self._increment < smallest

    @property
    def is_confirmed_or_exhausted(self) -> bool:
        """Whether the path ended at the limit that it announced, or enough increments were tried."""
        return self.is_exhausted or self.limit_is_confirmed

    @property
    def is_stuck(self) -> bool:
        """Whether so many increments have failed from near that smaller ones would lead no farther."""
        return self._near_failures >= MAX_NEAR_FAILURES and not self.limit_is_confirmed

    @property
    def is_exhausted(self) -> bool:
        """Whether enough increments were tried."""
        return self.cutbacks >= MAX_CUTBACKS or self.tried >= MAX_INCREMENTS

    @property
    def confirmed_limit(self) -> float | None:
        """The announced limit where it is confirmed, or the first value without an equilibrium where that comes before
        it on the way, up or down; None where no limit is confirmed."""
        limit = self._limit_fraction
        if limit is None or not self.limit_is_confirmed:
            return None
        return self.start + self._failed * (self.target - self.start) if limit > self._failed else self.limit

    @property
    def limit_is_confirmed(self) -> bool:
        """Whether there is no stable equilibrium closely behind the last one, where the path announces its limit."""
        limit = self._limit_fraction
        if limit is None or not (self._unstable or self._limit_is_settled):
            return False
        is_near = self._failed - self.reached <= self._accuracy
        # a load that failed from far away may be reached from near
        is_sure = self._unstable and self._limit_is_settled
        was_near = self._distance <= (1.0 if is_sure else TRIED_FROM) * self._accuracy
        return is_near and was_near and not self._is_doubtful

    @property
    def _is_doubtful(self) -> bool:
        """Whether a limit is announced beyond the load that failed, which may have failed because it was too far."""
        limit = self._limit_fraction
        return limit is not None and limit > self._failed + (
            self._accuracy if self._distance <= self._accuracy else 0.0
        )

    @property
    def _limit_is_settled(self) -> bool:
        """Whether the limit that is announced now is the one that was announced before."""
        if self.limit is None or self._limit_before is None:
            return False
        return abs(self.limit - self._limit_before) <= SETTLED * LIMIT_ACCURACY * abs(self.limit)

    @property
    def _limit_fraction(self) -> float | None:
        """Of the announced limit; None where there is none ahead."""
        if self.limit is None or self.target == self.start:
            return None
        fraction = (self.limit - self.start) / (self.target - self.start)
        return fraction if fraction > self.reached else None

    @property
    def _accuracy(self) -> float:
        """Of the limit, as a fraction of the way."""
        return self._load_fraction(LIMIT_ACCURACY)

    def _load_fraction(self, part: float) -> float:
        """A part of the present load, as a fraction of the way."""
        way = self.target - self.start
        return part * abs((self.start + self.reached * way) / way) if way else 0.0
