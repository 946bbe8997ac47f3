"""What the claims share: ranges that are required, pressures and arms, and readings with their intervals."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from benchmarks.paper.data import ARMS
from benchmarks.paper.estimates import CELLS, DEFAULT, PROCESS
from benchmarks.paper.reading import Claim, Reading

#: two numbers are equal if they differ by at most this part
SAME = 0.05
#: points lie on a line if they are off it by at most this part of the largest value, about what a printed figure shows
STRAIGHT = 0.02
#: from this pressure on (kPa) the walls of the pneu-net touch
TOUCHING = 17.0
ESTIMATORS = (CELLS, PROCESS, DEFAULT)
ROUND = ARMS[1:]
NAN = math.nan
UP, DOWN = (0.0, math.inf), (-math.inf, 0.0)
AT_MOST, ON_LINE = (0.0, 100.0 * SAME), (0.0, 100.0 * STRAIGHT)
NEAR_ONE = (1.0 - SAME, 1.0 + SAME)
SYMBOL = {"alpha1": "α₁", "alpha2": "α₂"}
SHORT = {
    "pneunet": "pneu-net",
    "semicircular": "semicircular",
    "semicircular_single": "one cavity",
    "bisected_circle": "bisected circle",
}
#: beside a claim whose sweep is missing
NOT_RUN = {name: f"the sweep `{name}` has not been run" for name in ("pneunet", "arms", "lengths")}


def claim(number: str, says: str, readings: Iterable[Reading], why: str, missing: str) -> Claim:
    """A claim with the reason for what is found; without readings, with the reason why there are none."""
    all_readings = tuple(readings)
    return Claim(number, says, all_readings, why if all_readings else "", "" if all_readings else missing)


def single(what: str, value: float, spread: float = 0.0, **others: Any) -> Reading:
    """A reading with its interval on both sides; without a number if it is nan."""
    return Reading(what, value, value - spread, value + spread, **others)


def range_of(what: str, values: Sequence[float], **others: Any) -> Reading:
    """The mean of values and their range."""
    if not len(values):
        return Reading(what, NAN, NAN, NAN, **others)
    return Reading(what, float(np.mean(values)), float(min(values)), float(max(values)), **others)
