"""Tables and sentences of the report about loads that the parameters were not fitted to."""

from collections.abc import Sequence

from pipeline.report.results import Results, ValidationRow
from pipeline.report.sentences import number

#: error of a good rod under other loads: distance over the length, and relative error of the force
SHAPE_LIMIT, FORCE_LIMIT = 0.03, 0.10


def validation_rows(results: Results) -> list[list[str]]:
    """Rows of the table: load, in or out of sample, p, shape with and without stretch and of the extensible rod, angle,
    force of the inextensible and the extensible rod, curvature."""
    return [
        [
            row.title,
            row.sample,
            number(row.pressure_kPa),
            _percent(row.distance_over_length),
            _percent(row.distance_over_length_without_stretch),
            _percent(row.distance_over_length_with_eccentricity),
            number(row.end_angle_error_rad),
            _percent(row.force_error),
            _percent(row.force_error_with_eccentricity),
            _percent(row.curvature_error),
            number(row.curvature_error_at_s_mm),
        ]
        for row in (*results.in_sample, *results.out_of_sample)
    ]


def out_of_sample(results: Results) -> list[str]:
    """How well the rod predicts other loads, and where it fails."""
    compared = [
        (row.distance_over_length, row) for row in results.out_of_sample if row.distance_over_length is not None
    ]
    sentences = []
    if compared:
        distance, worst = max(compared, key=lambda pair: pair[0])
        sentences.append(
            f"Under {len(compared)} loads that the parameters were not fitted to, the largest distance between the "
            f"curves is {_percent(distance)} of l ({worst.location}, at s = {number(worst.distance_at_s_mm)} mm)."
        )
        rows = [row for _, row in compared]
        forces = [(abs(row.force_error), row) for row in rows if row.force_error is not None]
        if forces:
            error, worst = max(forces, key=lambda pair: pair[0])
            sentences.append(f"The largest error of the end force is {_percent(error)} ({worst.location}).")
        sentences.append(_beyond_the_limits(rows))
    sentences += [f"No rod for {row.location}: {row.reason}" for row in results.out_of_sample if row.reason]
    return sentences


def beyond_identified(results: Results) -> list[str]:
    """The loads whose moments leave the range of the identification, one sentence each."""
    return [f"{row.location}: {row.warning}" for row in results.validation if row.warning]


def _beyond_the_limits(rows: Sequence[ValidationRow]) -> str:
    failed = [
        row
        for row in rows
        if (row.distance_over_length or 0.0) > SHAPE_LIMIT or abs(row.force_error or 0.0) > FORCE_LIMIT
    ]
    limits = f"{100 * SHAPE_LIMIT:g} % of l or {100 * FORCE_LIMIT:g} % of the force"
    if not failed:
        return f"No error exceeds {limits}."
    positions = [round(row.curvature_error_at_s_mm) for row in failed if row.curvature_error_at_s_mm is not None]
    span = " to ".join(f"{s}" for s in sorted({min(positions), max(positions)})) if positions else ""
    where = f"; the error of the curvature is largest at s = {span} mm" if positions else ""
    return f"Errors exceed {limits} at: {'; '.join(row.location for row in failed)}{where}."


def law_rows(results: Results) -> list[list[str]]:
    """Rows of the table of laws: p, law, numbers, errors in and out of sample."""
    return [
        [f"{row.pressure_kPa:g}", row.law, str(row.numbers), _percent(row.in_sample), _percent(row.out_of_sample)]
        for row in results.laws
    ]


def simplest_laws(results: Results) -> list[str]:
    """The simplest sufficient law, one sentence per pressure."""
    return [
        f"At {row.pressure_kPa:g} kPa the simplest law that predicts the other loads as well as any is "
        f"“{row.law}” with {row.numbers} numbers."
        for row in results.laws
        if row.simplest
    ]


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{number(float(f'{100 * value:.2g}'))} %"
