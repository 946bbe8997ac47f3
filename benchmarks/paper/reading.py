"""Readings of claims, whether they hold, and the verdict that follows: one rule for all claims.

A claim is put as numbers that ought to lie in a range. A reading is one such number with its interval, found with one
material law, one estimator, one arm, at some pressures. It holds if its whole interval lies in the range, does not hold
if no part of the interval does, and is open otherwise. Readings that stand beside a claim explain it and do not count.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any, Literal

Status = Literal["holds", "does not hold", "open"]
HOLDS, FAILS, OPEN = "holds", "does not hold", "open"
#: what a reading may depend on, in the order in which a dependence is named
FACTORS = {
    "law": "the material law",
    "estimator": "the estimator",
    "arm": "the arm",
    "pressure": "the pressure",
    "part": "the part of the claim",
}
REPRODUCED, CONTRADICTED, UNDECIDED, MISSING = "reproduced", "contradicted", "cannot be told", "not yet measured"
#: behind a verdict where the interval of some reading leaves it open
IN_PART = " in part"


@dataclass(frozen=True)
class Reading:
    """A number that a claim speaks of."""

    what: str  #: in words
    value: float  #: nan where there is none; `without` says why then
    low: float  #: end of the interval
    high: float
    unit: str = ""
    required: tuple[float, float] | None = None  #: ends of the range; None: it stands beside the claim
    law: str = ""
    estimator: str = ""
    arm: str = ""
    pressure: str = ""  #: at which of several pressures
    part: str = ""  #: which of several things the claim says
    without: str = ""  #: why there is no number
    denies: bool = False  #: whether the claim does not hold because there is no number

    @property
    def status(self) -> Status | None:
        """Whether it holds; None beside the claim."""
        if self.required is None:
            return None
        if math.isnan(self.value):
            return "does not hold" if self.denies else "open"
        low, high = self.required
        if low <= self.low and self.high <= high:
            return "holds"
        return "does not hold" if self.high < low or self.low > high else "open"


@dataclass(frozen=True)
class Claim:
    """What the paper says, what is found, and why."""

    number: str
    says: str
    readings: tuple[Reading, ...]
    why: str
    missing: str = ""  #: why there are no readings

    @property
    def verdict(self) -> str:
        """By the statuses of the readings that count."""
        counting = [reading for reading in self.readings if reading.status is not None]
        if not counting:
            return MISSING
        decided = [reading for reading in counting if reading.status != OPEN]
        statuses = {reading.status for reading in decided}
        if not decided:
            return UNDECIDED
        if len(statuses) == 1:
            part = IN_PART if any(r.status == OPEN and not math.isnan(r.value) for r in counting) else ""
            return (REPRODUCED if statuses == {HOLDS} else CONTRADICTED) + part
        return f"depends on {dependence(decided)}"

    def record(self) -> dict[str, Any]:
        """For JSON; nan becomes null."""
        readings = [
            {**asdict(reading), **{name: _or_none(getattr(reading, name)) for name in ("value", "low", "high")}}
            for reading in self.readings
        ]
        return {
            "number": self.number,
            "says": self.says,
            "why": self.why,
            "missing": self.missing,
            "verdict": self.verdict,
            "readings": readings,
        }


def _or_none(value: float) -> float | None:
    return None if math.isnan(value) else value


def dependence(decided: Sequence[Reading]) -> str:
    """The fewest factors that determine whether a reading holds, in words."""
    for count in range(1, len(FACTORS) + 1):
        for names in combinations(FACTORS, count):
            groups: dict[tuple[str, ...], set[Status | None]] = {}
            for reading in decided:
                key = tuple(getattr(reading, name) for name in names)
                groups.setdefault(key, set()).add(reading.status)
            if all(len(statuses) == 1 for statuses in groups.values()):
                return " and ".join(FACTORS[name] for name in names)
    return "more than this"
