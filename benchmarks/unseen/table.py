"""What the designs of a campaign together say, as a table."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from scipy.stats import beta

from benchmarks.markdown import table
from benchmarks.unseen.checks import ALLOWED
from benchmarks.unseen.sorting import (
    MESH_ERROR,
    OUTCOMES,
    TOO_SLOW,
    TRACEBACK,
    WRONG,
    checks_in,
    has_numbers,
    outcome,
    rod_errors,
    states_of_all,
    within_mesh_error,
)

Record = Mapping[str, Any]


def largest_share(bad: int, count: int) -> float:
    """The largest part of bad designs that is compatible with `bad` of `count` (95 % one-sided, Clopper-Pearson)."""
    return float(beta.ppf(0.95, bad + 1, count - bad)) if bad < count else 1.0


def summary(records: Sequence[Record]) -> str:
    """Outcomes, states, numbers, limits, meshes, rods, and the largest difference of each check."""
    counts, states = Counter(map(outcome, records)), states_of_all(records)
    bad = counts[WRONG] + counts[TRACEBACK] + counts[TOO_SLOW]
    meshes = [good for record in records if (good := within_mesh_error(record)) is not None]
    limits = [limit["confirmed"] for record in records for limit in record["limits"]]
    rows = [[name, str(counts[name])] for name in OUTCOMES if counts[name]]
    rows += [
        ["largest part of bad designs, 95 %", f"{100 * largest_share(bad, len(records)):.2g} %"],
        ["states solved", f"{states.solved} of {states.all}"],
        ["states beyond a confirmed limit", str(states.beyond)],
        ["limits confirmed", f"{sum(limits)} of {len(limits)}"],
        ["designs with numbers or an early refusal", f"{sum(map(has_numbers, records))} of {len(records)}"],
        [f"meshes within {100 * MESH_ERROR:g} %", f"{sum(meshes)} of {len(meshes)}"],
    ]
    for name, errors in rod_errors(records).items():
        if errors:
            rows.append([f"{name} error of the rod: median, largest", _both(errors, 100.0, " %")])
    for name, allowed in ALLOWED.items():
        checks = [check for record in records for check in checks_in(record) if check.name == name]
        made = [check.value for check in checks if check.value is not None]
        if made:
            rows.append([f"{name}: median, largest (allowed {allowed:g})", _both(made)])
    return table(["", f"{len(records)} designs"], rows)


def _both(values: Sequence[float], factor: float = 1.0, unit: str = "") -> str:
    return ", ".join(f"{factor * value:.2g}{unit}" for value in (median(values), max(values)))
