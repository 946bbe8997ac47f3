"""The sentences of the report."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pipeline.report.results import Results, ValidationRow
from pipeline.validation.rods import EXTENSIBLE, FIVE


def number(value: Any) -> str:
    """A number in four digits, without an exponent between 1e-4 and 1e5."""
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
        return "No pressure was reached; the report shows the configuration only."
    body = f"A body {number(results.length)} mm long, solved at {pressures} kPa"
    if not results.parameters:
        return f"{body}. The five parameters were not identified."
    return (
        f"{body}, as a rod with five parameters: M = α (κ - κ₀) + m₀, with α₁ and m₀₁ up to s = d, α₂ and m₀₂ beyond."
    )


def agreement_of_rod(results: Results) -> list[str]:
    """The rods against the finite elements in the experiments of the identification, one sentence per experiment."""
    sentences = []
    for experiment in ("II", "III"):
        rows, extensible = (
            [row for row in results.rows_of(rod, "in") if row.experiment == experiment] for rod in (FIVE, EXTENSIBLE)
        )
        parts = [
            _largest(rows, "distance_over_length", 100.0, "the largest distance between the curves is {value} % of l"),
            _largest(extensible, "distance_over_length", 100.0, "with the extensible rod {value} %"),
            _largest(rows, "end_angle_error_rad", 180.0 / np.pi, "the largest error of the end angle is {value}°"),
            _largest(rows, "force_error", 100.0, "that of the end force {value} %"),
        ]
        sentence = ", ".join(part for part in parts if part)
        if sentence:
            sentences.append(f"In {experiment} {sentence}.")
    return sentences


def lines_needed(results: Results) -> str:
    """At which pressures a single line describes the data as well as two, by the criterion of the identification."""
    verdicts = results.parameters.get("single_line_suffices")
    if not verdicts:
        return ""
    single = [
        f"{pressure:g}" for pressure, is_single in zip(results.identified_pressures, verdicts, strict=True) if is_single
    ]
    if not single:
        return "At every pressure two lines describe the data better than a single one."
    return (
        f"At {', '.join(single)} kPa a single line describes the data as well as two: there α₁ = α₂, and d has no "
        "meaning."
    )


def _largest(rows: Iterable[ValidationRow], name: str, scale: float, sentence: str) -> str:
    values = [(abs(value) * scale, row.pressure_kPa) for row in rows if (value := getattr(row, name)) is not None]
    if not values:
        return ""
    value, pressure = max(values)
    return f"{sentence.format(value=f'{value:.2g}')} (at {pressure:g} kPa)"


def difference_of_rest_curvatures(results: Results) -> list[tuple[str, str, str]]:
    """Per pressure: p, kappa_0 at half the length in I and II, and the relative difference of the two profiles."""
    rows = []
    for pressure in results.pressures:
        free, clamped = results.curve("I", pressure), results.curve("II", pressure)
        if free is None or clamped is None:
            continue
        first = np.interp(clamped["s_mm"], free["s_mm"], free["kappa_per_mm"])
        second = clamped["kappa_per_mm"]
        middle = [np.interp(results.length / 2, clamped["s_mm"], kappa) for kappa in (first, second)]
        inner = np.abs(clamped["s_mm"] / results.length - 0.5) < 0.4
        difference = np.sqrt(np.mean((first - second)[inner] ** 2) / np.mean(second[inner] ** 2))
        rows.append((f"{pressure:g}", f"{middle[0]:.5f}, {middle[1]:.5f}", f"{100 * difference:.2g} %"))
    return rows


def time_of_factorization(results: Results) -> str:
    """Which part of the solver's time the numeric factorizations took."""
    parts = results.run.get("solver_seconds") or {}
    total = sum(parts.values())
    if not total or "factorization" not in parts:
        return ""
    count = sum(row.factorizations or 0 for row in results.experiments)
    per_cent = 100 * parts["factorization"] / total
    return f"Numeric factorization took {per_cent:.0f} % of {number(total)} s; there were {count} factorizations."


def remarks(results: Results) -> list[str]:
    """Pressures that were not reached, and states to be used with care, each with the reason."""
    return [
        f"{row.experiment} at {row.pressure_kPa:g} kPa: {'' if row.reached else f'{row.status}: '}{row.reason}"
        for row in results.experiments
        if row.reason
    ]
