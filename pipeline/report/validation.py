"""Tables and sentences of the report about rods under all loads, those that nothing was fitted to included."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.report.formatting import number, percent
from pipeline.report.results import Results, ValidationRow
from pipeline.store.json_values import JsonObject
from pipeline.validation.rods import ARM_LAW, EXTENSIBLE, FIVE

#: the rods in words
TITLES = {
    FIVE: "the rod with five parameters",
    EXTENSIBLE: "the rod with five parameters that stretches",
    ARM_LAW: "the rod with the arm's own law",
}

#: error of a good rod under other loads: distance over the length, and relative error of the force
SHAPE_LIMIT, FORCE_LIMIT = 0.03, 0.10
#: distance over the length beyond which no rod is recommended
POOR = 0.10


@dataclass(frozen=True)
class RodErrors:
    """The largest errors of one rod."""

    rod: str
    loads: tuple[int, int]  #: how many in sample and out of sample
    distance: tuple[float | None, float | None]  #: over the length, in sample and out of sample; None without loads
    force: tuple[float | None, float | None]  #: relative, of the end force
    force_of_largest: tuple[float | None, float | None]  #: the same over the largest force of all loads
    missing: int  #: loads without an equilibrium

    @staticmethod
    def of(results: Results, rod: str) -> "RodErrors":
        """The errors of a rod over all loads and pressures."""
        samples = [[row for row in results.rows_of(rod, sample) if not row.reason] for sample in ("in", "out")]
        first, second = samples
        return RodErrors(
            rod,
            (len(first), len(second)),
            (_worst(first, "distance_over_length"), _worst(second, "distance_over_length")),
            (_worst(first, "force_error"), _worst(second, "force_error")),
            (_worst_force(first, results), _worst_force(second, results)),
            sum(bool(row.reason) for row in results.rows_of(rod)),
        )

    @property
    def shape(self) -> float:
        """Largest distance over the length, of all loads; infinite where it has no solution under any."""
        return max((value for value in self.distance if value is not None), default=math.inf)

    @property
    def largest(self) -> float:
        """Largest distance over the length, or error of the force over the largest force, of all loads.

        Over a force that is small itself no rod has a small error.
        """
        errors = (*self.distance, *self.force_of_largest)
        return max((value for value in errors if value is not None), default=math.inf)

    @property
    def largest_of(self) -> str:
        """What the largest error is one of."""
        distances = [value for value in self.distance if value is not None]
        return "length" if self.largest in distances else "largest force at the end"

    def record(self) -> JsonObject:
        """The largest errors as `pneurod run --json` writes them."""
        (inside, outside), (force_inside, force_outside) = self.distance, self.force
        return {
            "rod": self.rod,
            "loads_in_sample": self.loads[0],
            "loads_out_of_sample": self.loads[1],
            "distance_over_length_in_sample": inside,
            "distance_over_length_out_of_sample": outside,
            "force_error_in_sample": force_inside,
            "force_error_out_of_sample": force_outside,
            "force_error_over_largest_in_sample": self.force_of_largest[0],
            "force_error_over_largest_out_of_sample": self.force_of_largest[1],
            "loads_without_solution": self.missing,
        }

    def sentence(self) -> str:
        """How wrong the rod is, in and out of sample."""
        parts = []
        for k, sample in enumerate(("in sample", "out of sample (loads that nothing was fitted to)")):
            distance = self.distance[k]
            if distance is not None:
                parts.append(f"{sample} the shape is wrong by at most {percent(distance)} of l{self._of_force(k)}")
        if self.missing:
            parts.append(f"under {_count(self.missing)} it has no solution")
        return f"{_sentence_case(TITLES[self.rod])}: {'; '.join(parts)}."

    def _of_force(self, sample: int) -> str:
        force, of_largest = self.force[sample], self.force_of_largest[sample]
        if force is None or of_largest is None:
            return ""
        own, over_largest = percent(force), percent(of_largest)
        beside = "" if own == over_largest else f" of itself and {over_largest} of the largest force of all loads"
        return f", the force by at most {own}{beside}"


def _worst_force(rows: Sequence[ValidationRow], results: Results) -> float | None:
    """Largest error of the force over the largest force; over the force itself where the sizes are not stored."""
    largest = max((abs(row.force_N) for row in results.validation if row.force_N is not None), default=None)
    errors = [
        abs(row.force_error) * (abs(row.force_N) / largest if largest and row.force_N is not None else 1.0)
        for row in rows
        if row.force_error is not None
    ]
    return max(errors, default=None)


def _worst(rows: Sequence[ValidationRow], name: str) -> float | None:
    values = [abs(value) for row in rows if (value := getattr(row, name)) is not None]
    return max(values, default=None)


def rod_errors(results: Results) -> list[RodErrors]:
    """The errors of every rod, that with the smallest first.

    A rod with loads it has no answer to comes behind, and one that is far from the finite elements behind those.
    """
    return sorted(
        (RodErrors.of(results, rod) for rod in results.rods),
        key=lambda errors: (errors.shape > POOR, errors.missing, errors.largest),
    )


def recommended_rod(ordered: Sequence[RodErrors]) -> str:
    """The name of the rod to take, of those of `rod_errors`; empty where all are far from the finite elements."""
    return ordered[0].rod if ordered and ordered[0].shape <= POOR else ""


def rod_to_take(results: Results) -> list[str]:
    """Which rod has the smallest error over all loads, and how wrong each is; empty where none was compared."""
    ordered = rod_errors(results)
    if not ordered:
        return []
    sentences = [errors.sentence() for errors in ordered]
    near = [errors for errors in ordered if errors.shape <= POOR]
    if not near:
        return [f"No rod describes this arm{_least_far(ordered)}.", *sentences]
    best, number_of_near = near[0], len(near)
    first = f"Take {TITLES[best.rod]} ({best.rod})"
    if best.largest > min(errors.largest for errors in near):
        loads = "more" if best.missing else "some"
        first += (
            f": every rod with a smaller error has no solution under {loads} of the loads; its own largest error is "
            f"{percent(best.largest)} of the {best.largest_of}"
        )
    elif number_of_near > 1:
        of_near = "" if number_of_near == len(ordered) else f" that are within {percent(POOR)} of l"
        first += (
            f": its largest error against finite elements on the same mesh, {percent(best.largest)} of the "
            f"{best.largest_of}, is the smallest of {number_of_near} rods{of_near} (errors of the shape relative to "
            "the length, errors of the force at the end relative to the largest one)"
        )
    elif len(ordered) > 1:
        first += f": every other one is more than {percent(POOR)} of l away from the finite elements"
    return [f"{first}.", *sentences]


def _least_far(ordered: Sequence[RodErrors]) -> str:
    least = min(ordered, key=lambda errors: errors.shape)
    if math.isinf(least.shape):
        return ": none has a solution under any of the loads"
    distance = f"up to {percent(least.shape)} of l away from the finite elements"
    return f": the nearest, {TITLES[least.rod]} ({least.rod}), is {distance}"


def rod_table(results: Results) -> list[list[str]]:
    """Rows of the table of rods: rod, loads, and largest errors of shape and force in and out of sample."""
    return [
        [
            TITLES[errors.rod],
            *(
                cell
                for k in (0, 1)
                for cell in (str(errors.loads[k]), percent(errors.distance[k]), percent(errors.force[k]))
            ),
            str(errors.missing),
        ]
        for errors in rod_errors(results)
    ]


def validation_rows(results: Results) -> list[list[str]]:
    """Rows of the table: load, rod, in or out of sample, p, shape, angle (°), force, curvature.

    The shape with and without the stretch of the curve; without it only of a rod that does not stretch itself.
    """
    return [
        [
            row.title,
            TITLES[row.rod],
            row.sample,
            number(row.pressure_kPa),
            percent(row.distance_over_length),
            percent(row.distance_over_length_without_stretch if row.rod == FIVE else None),
            number(None if row.end_angle_error_rad is None else math.degrees(row.end_angle_error_rad)),
            percent(row.force_error),
            percent(row.curvature_error),
            number(row.curvature_error_at_s_mm),
        ]
        for row in sorted(results.validation, key=lambda row: (row.title, row.pressure_kPa, row.sample))
    ]


def under_all_loads(results: Results) -> list[str]:
    """Where every rod is farthest from the finite elements, that with the smallest error first; loads without a rod."""
    sentences = []
    for errors in rod_errors(results):
        rows = [row for row in results.rows_of(errors.rod) if row.distance_over_length is not None]
        if rows:
            sentences.append(f"{_sentence_case(TITLES[errors.rod])}: {_farthest(rows)}. {_beyond_the_limits(rows)}")
    return sentences + [
        f"{_sentence_case(TITLES[row.rod])}, {row.location}: {row.reason}" for row in results.validation if row.reason
    ]


def _farthest(rows: Sequence[ValidationRow]) -> str:
    """The largest errors of shape, end angle and force, each with its load."""
    distance, row = max(_known(rows, "distance_over_length"), key=lambda pair: pair[0])
    at = "" if row.distance_at_s_mm is None else f", at s = {number(row.distance_at_s_mm)} mm"
    parts = [f"the largest distance between the curves is {percent(distance)} of l ({row.location}{at})"]
    beginning = "the largest error"
    for name, what in (("end_angle_error_rad", "end angle"), ("force_error", "end force")):
        if known := _known(rows, name):
            error, row = max(known, key=lambda pair: pair[0])
            size = percent(error) if what == "end force" else f"{number(float(f'{math.degrees(error):.2g}'))}°"
            parts.append(f"{beginning} of the {what} is {size} ({row.location})")
            beginning = "that"
    return ", ".join(parts)


def _known(rows: Sequence[ValidationRow], name: str) -> list[tuple[float, ValidationRow]]:
    """The sizes of one error, each with its row, where it is known."""
    return [(abs(value), row) for row in rows if (value := getattr(row, name)) is not None]


def beyond_identified(results: Results) -> list[str]:
    """The loads whose moments leave the range of the identification of a rod, one sentence each."""
    return [
        f"{_sentence_case(TITLES[errors.rod])}, {row.location}: {row.warning}"
        for errors in rod_errors(results)
        for row in results.rows_of(errors.rod)
        if row.warning
    ]


def _beyond_the_limits(rows: Sequence[ValidationRow]) -> str:
    """The loads with large errors; of a rod that does not stretch how much of them is due to that."""
    failed = [
        row
        for row in rows
        if (row.distance_over_length or 0.0) > SHAPE_LIMIT or abs(row.force_error or 0.0) > FORCE_LIMIT
    ]
    limits = f"{100 * SHAPE_LIMIT:g} % of l or {100 * FORCE_LIMIT:g} % of the force"
    if not failed:
        return f"No error exceeds {limits}."
    far = [row for row in failed if row.rod == FIVE and (row.distance_over_length or 0.0) > SHAPE_LIMIT]
    known = [distance for distance, _ in _known(far, "distance_over_length_without_stretch")]
    removed = f"; without the stretch of the curve the distances that exceed {100 * SHAPE_LIMIT:g} % would be at most"
    without = f"{removed} {percent(max(known))} of l" if known else ""
    return f"Errors exceed {limits} at: {'; '.join(row.location for row in failed)}{without}."


def _count(loads: int) -> str:
    return "one load" if loads == 1 else f"{loads} loads"


def _sentence_case(text: str) -> str:
    return text[:1].upper() + text[1:]
