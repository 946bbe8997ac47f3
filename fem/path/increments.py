"""Which part of the way to a target is tried next."""

from dataclasses import dataclass, field
from typing import final

import numpy as np

#: where an increment to a load has failed, this fraction of it is small enough to try the same load once more
RETRY = 0.25
#: largest number of increments that fail on the way to one target, and that are tried; the hard cases need 20 and 60
MAX_CUTBACKS, MAX_INCREMENTS = 40, 200
#: how accurately a limit is named that the path announces: distance between the last equilibrium and the lowest load
#: without one, as a fraction of the load
LIMIT_ACCURACY = 0.01
#: largest increment that may lose the stability, as a fraction of the way and of the load
STABLE_INCREMENT, STABLE_INCREMENT_LOAD = 1 / 16, 0.02
#: distance within which an announced limit is near, as a fraction of the load
NEAR = 0.1
#: largest distance from which the load without an equilibrium was tried, over the accuracy
TRIED_FROM = 1 / 2
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

    The whole way is tried first. An increment that fails is halved, one that converges is doubled. Where the path
    announces a limit, the next increment ends shortly before or shortly behind it.
    """

    start: float  #: value of the driven quantity where the way begins
    target: float
    smallest: float  #: increment that is tried, as a fraction of the way and, beyond rest, of the load
    reached: float = 0.0
    cutbacks: int = 0
    limit: float | None = None  #: value at which the path announces its end
    tried: int = 0  #: number of increments so far
    _increment: float = 1.0
    _failed: float = field(default=np.inf)  #: the lowest fraction that was not reached
    _distance: float = 0.0  #: from how far
    _unstable: bool = False  #: whether there was no stable equilibrium

    @property
    def next(self) -> float:
        """The fraction to be tried."""
        fraction = min(1.0, self.reached + self._increment)
        limit = self._limit_fraction
        if limit is None or limit >= fraction:
            return fraction
        ahead = min(limit, self._failed) - self.reached
        if ahead <= FROM_HERE * self._accuracy:
            return min(1.0, self._failed, limit + BEHIND * self._accuracy)
        part = APPROACH_NEAR if ahead <= self._load_fraction(NEAR) else APPROACH
        return min(fraction, self.reached + part * ahead)

    @property
    def is_small(self) -> bool:
        """Whether the next increment is small enough to pass a point where the path loses its stability.

        Near a sharp bend of the path a smaller one stays on the stable part.
        """
        largest = min(STABLE_INCREMENT, self._load_fraction(STABLE_INCREMENT_LOAD))
        return self.next - self.reached <= max(self.smallest, largest)

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

    def accepted(self, fraction: float, limit: float | None) -> None:
        """An equilibrium was found there; `limit` is the value at which the path now ends."""
        self.tried += 1
        placed = fraction < min(1.0, self.reached + self._increment)
        self.reached, self.limit = fraction, limit
        if not placed:
            self._increment = 2.0 * self._increment
        is_close = self._failed - self.reached <= RETRY * self._distance
        if self.reached >= self._failed or (is_close and not self.limit_is_confirmed):
            self._failed = np.inf
        elif limit is None and self.reached + self._increment >= self._failed and not is_close:
            self._increment = (self._failed - self.reached) / 2

    def failed(self, fraction: float, unstable: bool) -> None:
        """None was found there, or no stable one."""
        self.cutbacks, self.tried = self.cutbacks + 1, self.tried + 1
        self._failed, self._distance, self._unstable = fraction, fraction - self.reached, unstable
        self._increment = self._distance / 2

    @property
    def ended(self) -> bool:
        """Whether no smaller increment is worth trying."""
        # where the target is many times the load that is reached, a part of the way alone would be too large
        smallest = self.smallest * min(1.0, self._load_fraction(1.0) or 1.0)
        if self._limit_fraction is not None:
            smallest = min(smallest, self._accuracy * SMALLEST_NEAR_LIMIT)
        return self.is_confirmed_or_exhausted or self._increment < smallest

    @property
    def is_confirmed_or_exhausted(self) -> bool:
        """Whether the path ended at the limit that it announced, or enough increments were tried."""
        return self.is_exhausted or self.limit_is_confirmed

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
        # a load that failed from far away may be reached from near
        is_near = self._failed - self.reached <= self._accuracy and self._distance <= TRIED_FROM * self._accuracy
        return self._limit_fraction is not None and self._unstable and is_near

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
