"""The time that is left of work in steps: what they were expected to take, corrected by what those that ended took."""

import time
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

from pipeline.values.formatting import duration

#: s, between two words to one who waits
WAIT = 5.0


class TimeLeft:
    """Steps by their kind, with the expected effort of each in any unit.

    Time counts from when it is made, or from what is announced before the first step has ended.
    """

    def __init__(self, steps: Mapping[str, Sequence[float]], part: float = 0.0) -> None:
        """part: of all efforts, which has to have ended before anything is told."""
        self._open = {kind: list(efforts) for kind, efforts in steps.items()}
        self._least = part * sum(map(sum, self._open.values()))
        self._begin = self._told = time.monotonic()
        self._spent, self._expected = defaultdict[str, float](float), defaultdict[str, float](float)

    def announce(self, name: str, count: int) -> None:
        """So many steps of this name follow; those that were not expected take as long as the last one that was."""
        efforts = self._open.get(self._kind(name))
        if efforts is not None and len(efforts) < count:
            efforts += [efforts[-1] if efforts else 1.0] * (count - len(efforts))
        if not self._spent:
            self._begin = time.monotonic()

    def end(self, name: str, spent: float = 0.0) -> str:
        """The time left after a step, a clause for the end of a line; spent: what it took, 0 where it was kept."""
        kind = self._kind(name)
        if efforts := self._open.get(kind):
            effort = efforts.pop(0)
            if spent > 0.0:
                self._spent[kind] += spent
                self._expected[kind] += effort
        left = self.seconds
        return f"; about {duration(left)} left" if left else ""

    @property
    def seconds(self) -> float:
        """s; 0 where nothing is left, or nothing is known yet."""
        spent, expected = sum(self._spent.values()), sum(self._expected.values())
        if not spent or expected < self._least:
            return 0.0
        work = sum(
            sum(efforts) * (self._spent[kind] / self._expected[kind] if self._expected[kind] else spent / expected)
            for kind, efforts in self._open.items()
        )
        return (time.monotonic() - self._begin) * work / spent

    def tell(self, remark: Callable[[str], object], done: str, part: float) -> None:
        """Tell what is done, and the time left by its part of all, if `WAIT` has passed since the last words."""
        if (now := time.monotonic()) - self._told > WAIT:
            self._told = now
            remark(f"{done}; about {duration((now - self._begin) * (1.0 - part) / max(part, 1e-9))} left")

    def _kind(self, name: str) -> str:
        """The longest kind with which a name begins: `cell, mesh` of `cell, mesh 2.7 mm`."""
        return max((kind for kind in self._open if name.startswith(kind)), key=len, default="")
