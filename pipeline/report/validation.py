"""What the report says about loads that the numbers were not fitted to, in tables and sentences."""

from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.report.results import Results
from pipeline.report.sentences import number

#: over the length and relative: what the rod may be off by under a load it has not seen
SHAPE_LIMIT, FORCE_LIMIT = 0.03, 0.10


def validation_rows(results: Results) -> list[list[str]]:
    """Rows of the table: in or out of sample, load, p, shape with and without stretch and of the extensible rod, angle,
    force of the inextensible and the extensible rod, curvature."""
    rows = []
    for row in (*results.in_sample, *results.out_of_sample):
        rows.append(
            [
                row.get("load") or row["experiment"],
                "in" if row.get("sample", "in") == "in" else "out",
                number(row["pressure_kPa"]),
                _percent(row.get("distance_over_length")),
                _percent(row.get("distance_over_length_without_stretch")),
                _percent(row.get("distance_over_length_with_eccentricity")),
                number(row.get("end_angle_error_rad")),
                _percent(row.get("force_error")),
                _percent(row.get("force_error_with_eccentricity")),
                _percent(row.get("curvature_error")),
                number(row.get("curvature_error_at_s_mm")),
            ]
        )
    return rows


def out_of_sample(results: Results) -> list[str]:
    """How well the rod does under loads it has not seen, and where it fails."""
    rows = [row for row in results.out_of_sample if row.get("distance_over_length") is not None]
    said = []
    if rows:
        worst = max(rows, key=lambda row: row["distance_over_length"])
        said.append(
            f"Under {len(rows)} loads that the numbers were not fitted to, the curves are at most "
            f"{_percent(worst['distance_over_length'])} of the length apart ({_where(worst)}, "
            f"at s = {number(worst.get('distance_at_s_mm'))} mm)."
        )
        forces = [row for row in rows if row.get("force_error") is not None]
        if forces:
            worst = max(forces, key=lambda row: abs(row["force_error"]))
            said.append(f"The end force is off by at most {_percent(abs(worst['force_error']))} ({_where(worst)}).")
        said.extend(_failures(rows))
    for row in results.out_of_sample:
        if row.get("reason"):
            said.append(f"No rod for {_where(row)}: {row['reason']}")
    return said


def beyond_identified(results: Results) -> list[str]:
    """The loads whose moments leave what the numbers were identified from, one sentence each."""
    return [f"{_where(row)}: {row['warning']}" for row in results.validation if row.get("warning")]


def _failures(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    failed = [
        row
        for row in rows
        if row["distance_over_length"] > SHAPE_LIMIT or abs(row.get("force_error") or 0.0) > FORCE_LIMIT
    ]
    limits = f"{100 * SHAPE_LIMIT:g} % of the length or {100 * FORCE_LIMIT:g} % of the force"
    if not failed:
        return [f"Nowhere is it off by more than {limits}."]
    places = [round(row["curvature_error_at_s_mm"]) for row in failed if row.get("curvature_error_at_s_mm") is not None]
    span = " to ".join(f"{place}" for place in sorted({min(places), max(places)})) if places else ""
    where = f"; the curvature is off most at s = {span} mm" if places else ""
    return [f"It is off by more than {limits} at: {'; '.join(_where(row) for row in failed)}{where}."]


def laws_by_pressure(results: Results) -> tuple[list[list[str]], list[str]]:
    """Rows law, numbers, errors in and out of sample per pressure, and a sentence per pressure on the simplest."""
    rows = [
        [
            f"{row['pressure_kPa']:g}",
            row["law"],
            str(row["numbers"]),
            _percent(row["in_sample"]),
            _percent(row["out_of_sample"]),
        ]
        for row in results.laws
    ]
    said = []
    for row in results.laws:
        if row["simplest"]:
            said.append(
                f"At {row['pressure_kPa']:g} kPa the simplest law that predicts the other loads as well as any is "
                f"“{row['law']}” with {row['numbers']} numbers."
            )
    return rows, said


def _where(row: Mapping[str, Any]) -> str:
    return f"{row.get('load') or row['experiment']}, {row['pressure_kPa']:g} kPa"


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{number(float(f'{100 * value:.2g}'))} %"
