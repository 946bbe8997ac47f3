"""The sentences of the report."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pipeline.report.results import Results
from pipeline.store.formats import CONVERGED


def number(value: Any) -> str:
    """A number in four digits, without an exponent where it can be read without."""
    if value is None:
        return "-"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    if value == 0 or 1e-4 <= abs(value) < 1e5:
        return np.format_float_positional(value, precision=4, fractional=False, trim="-", unique=False)
    return f"{value:.3e}"


def opening(results: Results) -> str:
    """What the report is about, in one or two sentences."""
    pressures = ", ".join(f"{pressure:g}" for pressure in results.pressures)
    if not results.curves and not results.experiments:
        return "No pressure was reached, so there is nothing to show but what was asked."
    begun = f"A body {number(results.length)} mm long, solved at {pressures} kPa"
    if not results.parameters:
        return f"{begun}. The five parameters were not reached."
    return (
        f"{begun}, as a rod with five parameters: M = α (κ - κ₀) + m₀, with α₁ and m₀₁ up to s = d, α₂ and m₀₂ beyond."
    )


def agreement_of_rod(results: Results) -> list[str]:
    """The rod against the finite elements under the loads its numbers come from, one sentence per experiment."""
    sentences = []
    for experiment in ("II", "III"):
        rows = [row for row in results.in_sample if row["experiment"] == experiment]
        parts = [
            _largest(rows, "distance_over_length", 100.0, "the curves are at most {value} % of the length apart"),
            _largest(rows, "distance_over_length_with_eccentricity", 100.0, "those of the extensible rod {value} %"),
            _largest(rows, "end_angle_error_rad", 180.0 / np.pi, "the end angle is off by at most {value}°"),
            _largest(rows, "force_error", 100.0, "the end force by at most {value} %"),
        ]
        said = [part for part in parts if part]
        if said:
            sentences.append(f"In {experiment} {', '.join(said)}.")
    return sentences


def lines_needed(results: Results) -> str:
    """At which pressures one straight line is as good as two, which a criterion has judged."""
    verdicts = results.parameters.get("single_line_suffices") or []
    plain = [
        f"{pressure:g}"
        for pressure, verdict in zip(results.parameters.get("pressures_kPa", ()), verdicts, strict=True)
        if verdict
    ]
    if not verdicts:
        return ""
    if not plain:
        return "At every pressure two lines describe the data better than one."
    return f"At {', '.join(plain)} kPa one line is as good as two: α₁, α₂ and d mean nothing apart there."


def _largest(rows: Iterable[Any], key: str, scale: float, sentence: str) -> str:
    found = [(abs(row[key]) * scale, row["pressure_kPa"]) for row in rows if row.get(key) is not None]
    if not found:
        return ""
    value, pressure = max(found)
    return f"{sentence.format(value=f'{value:.2g}')} (at {pressure:g} kPa)"


def difference_of_rest_curvatures(results: Results) -> list[tuple[str, str, str]]:
    """Per pressure: p, kappa_0 at half the length in I and II, and how far the two profiles differ."""
    rows = []
    for pressure in results.pressures:
        free, clamped = results.curve("I", pressure), results.curve("II", pressure)
        if free is None or clamped is None:
            continue
        first = np.interp(clamped["s_mm"], free["s_mm"], free["kappa_per_mm"])
        second = clamped["kappa_per_mm"]
        middle = [np.interp(results.length / 2, clamped["s_mm"], kappa) for kappa in (first, second)]
        inner = np.abs(clamped["s_mm"] / results.length - 0.5) < 0.4
        apart = np.sqrt(np.mean((first - second)[inner] ** 2) / np.mean(second[inner] ** 2))
        rows.append((f"{pressure:g}", f"{middle[0]:.5f}, {middle[1]:.5f}", f"{100 * apart:.2g} %"))
    return rows


def share_of_factorization(results: Results) -> str:
    """How much of the solver's time the numeric factorization took."""
    parts = results.run.get("solver_seconds") or {}
    whole = sum(parts.values())
    if not whole or "factorization" not in parts:
        return ""
    count = sum(row.get("factorizations") or 0 for row in results.experiments)
    share = 100 * parts["factorization"] / whole
    return f"Numeric factorization took {share:.0f} % of {number(whole)} s; there were {count} factorizations."


def limits_met(results: Results) -> list[str]:
    """What was not reached and why, and which of the solved pressures carry a reason too."""
    sentences = []
    for row in results.experiments:
        if row.get("reason"):
            met = "" if row.get("status") == CONVERGED else f"{row.get('status')}: "
            sentences.append(f"{row['experiment']} at {row['pressure_kPa']:g} kPa: {met}{row['reason']}")
    return sentences
