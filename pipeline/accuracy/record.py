"""The result of the convergence study: references, and per configuration its cost and its errors against them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from fem.elements import MOST_ACCURATE
from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE, Rung, mesh_series
from pipeline.accuracy.orders import MeshNumbers, SeriesOrders
from pipeline.accuracy.reference import (
    SCALARS,
    Errors,
    Reference,
    References,
    largest_error,
    limit,
    pareto_front,
    without_contact_distance,
)
from pipeline.accuracy.result import RodNumbers, RungResult
from pipeline.config.config import Config
from pipeline.errors import RunFailed
from pipeline.store.formats import FORMAT
from pipeline.store.json_values import JsonObject
from pipeline.store.provenance import provenance

#: the numbers whose meaning depends on whether the law has one slope or two
OF_THE_LAW = ("alpha1_N_mm2", "alpha2_N_mm2", "d_mm")
#: the element whose limit is the reference
REFERENCE_ELEMENT = MOST_ACCURATE
#: keys of accuracy.json that follow from the results of the rungs
COMPUTED = ("reference", "reference_error", "left_out_kPa", "orders", "rungs")

#: numbers of a mesh with its degrees of freedom, or with its contact distance (mm)
Located = tuple[float, RodNumbers]


@dataclass(frozen=True)
class StudyRow:
    """One configuration: what varies, numbers and cost, and errors."""

    series: str
    value: float | None  #: what varies along the series; None for a thinned curve without numbers
    result: RungResult  #: with the numbers of one stride
    errors: tuple[Errors, ...]  #: at the pressures that were reached
    largest_error: float | None  #: None where a pressure was not reached
    on_front: bool = False  #: no other configuration is both cheaper and more accurate

    @property
    def point(self) -> tuple[float, float] | None:
        """CPU seconds and largest error; None where one is missing."""
        if self.result.cost is None or self.largest_error is None:
            return None
        return self.result.cost.cpu_seconds, self.largest_error

    def record(self) -> JsonObject:
        """As in accuracy.json."""
        return {
            "series": self.series,
            "value": self.value,
            **self.result.record(),
            "headline": self.largest_error,
            "errors": [{"pressure_kPa": errors.pressure_kPa, **errors.by_name} for errors in self.errors],
            "on_front": self.on_front,
        }

    @staticmethod
    def read(record: Mapping[str, Any]) -> "StudyRow":
        """From accuracy.json."""
        errors = [{**row} for row in record["errors"]]
        return StudyRow(
            record["series"],
            record["value"],
            RungResult.read(record),
            tuple(Errors(row.pop("pressure_kPa"), row) for row in errors),
            record["headline"],
            record["on_front"],
        )


@dataclass(frozen=True)
class ConvergenceStudy:
    """The content of accuracy.json."""

    name: str  #: of the configuration
    config_hash: str
    references: tuple[References, ...]  #: by pressure
    rows: tuple[StudyRow, ...]
    left_out_kPa: tuple[float, ...]  #: pressures of the configuration that too few meshes reached for a reference
    about: JsonObject = field(repr=False)  #: configuration, provenance and what is configured, as JSON

    @property
    def reference_error(self) -> float:
        """The largest relative standard deviation of the reference."""
        return max(references.relative_std for references in self.references)

    @property
    def orders(self) -> tuple[SeriesOrders, ...]:
        """The orders of convergence along every series of meshes, at every pressure with enough meshes."""
        series: dict[str, list[StudyRow]] = {}
        for row in self.rows:
            if row.series not in (TOLERANCE, CONTACT, POINTS):
                series.setdefault(row.series, []).append(row)
        orders = (
            SeriesOrders.of(name, references.pressure_kPa, _meshes(rows, references.pressure_kPa))
            for name, rows in series.items()
            for references in self.references
        )
        return tuple(at_pressure for at_pressure in orders if at_pressure.orders)

    def record(self) -> JsonObject:
        """The content of accuracy.json."""
        return {
            **self.about,
            "reference": [references.record() for references in self.references],
            "reference_error": self.reference_error,
            "left_out_kPa": self.left_out_kPa,
            "orders": [orders.record() for orders in self.orders],
            "rungs": [row.record() for row in self.rows],
        }

    @staticmethod
    def read(record: Mapping[str, Any]) -> "ConvergenceStudy":
        """From accuracy.json."""
        return ConvergenceStudy(
            record["config"]["name"],
            record["config_hash"],
            tuple(References.read(row) for row in record["reference"]),
            tuple(StudyRow.read(row) for row in record["rungs"]),
            tuple(record.get("left_out_kPa", ())),
            {name: value for name, value in record.items() if name not in COMPUTED},
        )


def _meshes(rows: Sequence[StudyRow], pressure_kPa: float) -> list[MeshNumbers]:
    """The meshes of a series that reached a pressure."""
    return [
        MeshNumbers(row.result.cost.degrees_of_freedom, numbers)
        for row in rows
        if row.result.cost is not None and (numbers := row.result.at(pressure_kPa)) is not None
    ]


def convergence_study(
    config: Config, rungs: Sequence[tuple[Rung, RungResult]], contact_mm: float | None
) -> ConvergenceStudy:
    """References and errors from the results of all rungs; contact_mm as in `ladder`.

    A pressure that too few rungs reached to extrapolate from is left out. Raises RunFailed where that is so at all.
    """
    every = {pressure: _references(config, rungs, pressure, contact_mm) for pressure in config.pressures_kPa}
    references = {pressure: known for pressure, known in every.items() if known.numbers["force_N"] is not None}
    left_out = tuple(pressure for pressure in every if pressure not in references)
    if not references:
        lacking = ", ".join(f"{pressure:g} kPa" for pressure in left_out)
        raise RunFailed(f"too few meshes reached {lacking} to extrapolate from; choose lower pressures")
    length = config.design.length
    rows = [row for rung, result in rungs for row in _rows(length, rung, result, references)]
    points = {number: row.point for number, row in enumerate(rows) if row.point is not None}
    front = {list(points)[index] for index in pareto_front(list(points.values()))}
    about = {
        "format": FORMAT,
        "config": config.record(),
        "config_hash": config.hash,
        **provenance(),
        "pressures_kPa": list(config.pressures_kPa),
        "as_configured": {
            "series": mesh_series(config),
            "size_mm": config.mesh.element_size_mm,
            "contact_mm": contact_mm,
        },
    }
    marked = tuple(replace(row, on_front=number in front) for number, row in enumerate(rows))
    return ConvergenceStudy(config.name, config.hash, tuple(references.values()), marked, left_out, about)


def _references(
    config: Config, rungs: Sequence[tuple[Rung, RungResult]], pressure: float, contact_mm: float | None
) -> References:
    """The references at one pressure, from the series of the reference element and those of the contact distance."""
    series: dict[str, list[Located]] = {}
    distances: list[Located] = []
    for rung, result in rungs:
        numbers = result.at(pressure)
        if numbers is None:
            continue
        if rung.is_mesh and rung.config.mesh.formulation == REFERENCE_ELEMENT and result.cost is not None:
            series.setdefault(rung.series, []).append((result.cost.degrees_of_freedom, numbers))
        if contact_mm is not None and rung.config.mesh == config.mesh and rung.series != TOLERANCE:
            distances.append((rung.value if rung.series == CONTACT else contact_mm, numbers))
    meshes = list(series.values())
    scalars = {name: _scalar_reference(name, meshes, distances, contact_mm) for name in SCALARS}
    x, y = (_reference(_axis(meshes, i), _axis([distances], i)[0], contact_mm) for i in (0, 1))
    return References(pressure, scalars, None if x is None or y is None else (x, y))


def _scalar_reference(
    name: str, meshes: Sequence[Sequence[Located]], distances: Sequence[Located], contact_mm: float | None
) -> Reference | None:
    if name in OF_THE_LAW:
        two_lines = _most_have_two_lines(meshes)
        meshes = [[mesh for mesh in series if mesh[1].has_two_lines == two_lines] for series in meshes]
        distances = [mesh for mesh in distances if mesh[1].has_two_lines == two_lines]
    return _reference([_values(name, series) for series in meshes], _values(name, distances), contact_mm)


def _reference(
    meshes: Sequence[Sequence[tuple[float, float]]],
    distances: Sequence[tuple[float, float]],
    contact_mm: float | None,
) -> Reference | None:
    """The limit over the meshes, less the effect of the contact distance where it was varied."""
    reference = limit(meshes)
    if reference is None or contact_mm is None or len(distances) < 2 or contact_mm not in dict(distances):
        return reference
    return without_contact_distance(reference, distances, contact_mm)


def _values(name: str, meshes: Sequence[Located]) -> list[tuple[float, float]]:
    return [(at, value) for at, numbers in meshes if (value := getattr(numbers, name)) is not None]


def _axis(series: Sequence[Sequence[Located]], axis: int) -> list[list[tuple[float, float]]]:
    """The series with one coordinate of the end as their number."""
    return [[(at, numbers.end_mm[axis]) for at, numbers in meshes] for meshes in series]


def _most_have_two_lines(meshes: Sequence[Sequence[Located]]) -> bool:
    """Whether most meshes gave a law of two lines; the finest decides a tie.

    The rigidity of a single line and those of two are different numbers, so a number is extrapolated from meshes with
    the same law only.
    """
    by_size = sorted((mesh for series in meshes for mesh in series), key=lambda mesh: mesh[0])
    votes = sum(1 if numbers.has_two_lines else -1 for _, numbers in by_size)
    return votes > 0 or (votes == 0 and bool(by_size) and by_size[-1][1].has_two_lines)


def _rows(length: float, rung: Rung, result: RungResult, references: Mapping[float, References]) -> list[StudyRow]:
    """One row per rung, and one for every stride of its material curve, at the pressures with references.

    length: of the arm, mm.
    """
    rows = []
    for stride in rung.strides:
        numbers = tuple(row for row in result.of_stride(stride) if row.pressure_kPa in references)
        errors = tuple(Errors.of(row, references[row.pressure_kPa], length) for row in numbers)
        points = min((at_pressure.points for at_pressure in numbers), default=None)
        series, value = (rung.series, rung.value) if stride == 1 else (POINTS, points)
        complete = len(numbers) == len(references)
        rows.append(
            StudyRow(
                series, value, replace(result, numbers=numbers), errors, largest_error(errors) if complete else None
            )
        )
    return rows
