"""The result of the convergence study: references, and per configuration its cost and its errors against them."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from pipeline.config.config import Config
from pipeline.store.provenance import provenance
from pipeline.study.accuracy.ladder import CONTACT, TOLERANCE, Rung, mesh_series
from pipeline.study.accuracy.measure import HEADLINE, RungResult
from pipeline.study.accuracy.reference import Errors, Order, References, orders_along, references_at
from pipeline.values.errors import RunFailed
from pipeline.values.formats import FORMAT
from pipeline.values.json_values import JsonObject


@dataclass(frozen=True)
class StudyRow:
    """One configuration: what varies, numbers and cost, and errors."""

    series: str
    value: float  #: what varies along the series
    result: RungResult
    errors: Mapping[float, Errors]  #: by pressure in kPa, as far as they were reached
    largest_error: float | None  #: None where a pressure was not reached
    on_front: bool = False  #: no other configuration is both cheaper and more accurate

    @property
    def point(self) -> tuple[float, float] | None:
        """CPU seconds and largest error; None where one is missing."""
        if self.result.cost is None or self.largest_error is None:
            return None
        return self.result.cost.cpu_seconds, self.largest_error

    def record(self) -> JsonObject:
        """The study as accuracy.json has it."""
        return {
            "series": self.series,
            "value": self.value,
            "failure": self.result.failure,
            **(asdict(self.result.cost) if self.result.cost else {}),
            "numbers": [asdict(numbers) for numbers in self.result.numbers],
            "headline": self.largest_error,
            "errors": [{"pressure_kPa": pressure, **errors} for pressure, errors in self.errors.items()],
            "on_front": self.on_front,
        }


@dataclass(frozen=True)
class ConvergenceStudy:
    """References, and per configuration its cost and its errors against them."""

    config: Config
    contact_mm: float | None  #: activation distance of the configuration
    references: tuple[References, ...]  #: by pressure
    rows: tuple[StudyRow, ...]
    left_out_kPa: tuple[float, ...]  #: pressures of the configuration that too few meshes reached for a reference

    @property
    def reference_error(self) -> float:
        """The largest relative standard deviation of the reference, of the headline numbers."""
        known = filter(None, (references.numbers[name] for references in self.references for name in HEADLINE))
        return max((abs(limit.std / limit.value) for limit in known), default=0.0)

    @property
    def orders(self) -> dict[tuple[str, float], dict[str, Order]]:
        """The orders of the headline numbers by series of meshes and pressure (kPa), where enough meshes have them."""
        orders = {}
        for series in dict.fromkeys(row.series for row in self.rows if row.series not in (TOLERANCE, CONTACT)):
            results = [row.result for row in self.rows if row.series == series]
            for pressure in (references.pressure_kPa for references in self.references):
                meshes = [
                    (result.cost.degrees_of_freedom, numbers)
                    for result in results
                    if result.cost and (numbers := result.at(pressure))
                ]
                orders[series, pressure] = orders_along(meshes)
        return {place: along for place, along in orders.items() if along}

    def record(self) -> JsonObject:
        """The content of accuracy.json."""
        size = self.config.mesh.size_mm
        return {
            "format": FORMAT,
            "config": self.config.record(),
            "config_hash": self.config.hash,
            **provenance(),
            "pressures_kPa": list(self.config.pressures_kPa),
            "as_configured": {"series": mesh_series(self.config), "size_mm": size, "contact_mm": self.contact_mm},
            "reference": [references.record() for references in self.references],
            "reference_error": self.reference_error,
            "left_out_kPa": self.left_out_kPa,
            "orders": [
                {"series": series, "pressure_kPa": pressure, **{name: asdict(order) for name, order in along.items()}}
                for (series, pressure), along in self.orders.items()
            ],
            "rungs": [row.record() for row in self.rows],
        }


def convergence_study(
    config: Config, rungs: Sequence[tuple[Rung, RungResult]], contact_mm: float | None
) -> ConvergenceStudy:
    """References and errors from the results of all rungs; contact_mm as in `ladder`.

    A pressure that too few rungs reached to extrapolate from is left out. Raises RunFailed where that is so at all.
    """
    every = {pressure: references_at(pressure, config, rungs, contact_mm) for pressure in config.pressures_kPa}
    references = {pressure: known for pressure, known in every.items() if known.numbers["force_N"] is not None}
    left_out = tuple(pressure for pressure in every if pressure not in references)
    if not references:
        lacking = ", ".join(f"{pressure:g} kPa" for pressure in left_out)
        raise RunFailed(f"too few meshes reached {lacking} to extrapolate from; choose lower pressures")
    rows = [_row(config.design.length, rung, result, references) for rung, result in rungs]
    points = {number: row.point for number, row in enumerate(rows) if row.point is not None}
    front = {list(points)[index] for index in pareto_front(list(points.values()))}
    marked = tuple(replace(row, on_front=number in front) for number, row in enumerate(rows))
    return ConvergenceStudy(config, contact_mm, tuple(references.values()), marked, left_out)


def _row(length: float, rung: Rung, result: RungResult, references: Mapping[float, References]) -> StudyRow:
    """A rung at the pressures with references; length: of the arm, mm."""
    numbers = tuple(row for row in result.numbers if row.pressure_kPa in references)
    errors = {row.pressure_kPa: references[row.pressure_kPa].errors(row, length) for row in numbers}
    largest = largest_error(list(errors.values())) if len(numbers) == len(references) else None
    return StudyRow(rung.series, rung.value, replace(result, numbers=numbers), errors, largest)


def largest_error(errors: Sequence[Errors]) -> float | None:
    """The largest error of kappa_0(l/2), alpha2 and F over all pressures; None where one of them is missing."""
    sizes = [at_pressure[name] for at_pressure in errors for name in HEADLINE]
    present = [abs(size) for size in sizes if size is not None]
    return max(present) if present and len(present) == len(sizes) else None


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices, by cost, of the points (cost, error) that no other point dominates in both."""
    front: list[int] = []
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if not front or points[index][1] < points[front[-1]][1]:
            front.append(index)
    return front
