"""References of the numbers of the convergence study, errors against them, and orders of convergence.

The reference of a number is its limit on the finest meshes, extrapolated over the degrees of freedom n as n^(-1/3)
(`pipeline.identification.richardson`), less the effect of the contact distance, which is extrapolated to zero on one
mesh.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

from fem.elements import MOST_ACCURATE
from pipeline.accuracy.ladder import CONTACT, TOLERANCE, Rung
from pipeline.accuracy.measure import HEADLINE, RIGIDITY, Measured, RodNumbers
from pipeline.config.config import Config
from pipeline.identification.richardson import extrapolate
from pipeline.store.json_values import JsonObject

#: name of a number -> its symbol
NUMBERS = {
    "kappa_0_per_mm": "κ₀(l/2)",
    "alpha1_N_mm2": "α₁",
    "alpha2_N_mm2": "α₂",
    "d_mm": "d",
    "force_N": "F",
    "end_mm": "end",
}
#: the position of the end; its reference has one entry per coordinate
END, COORDINATES = "end_mm", ("end_x_mm", "end_y_mm")
#: the numbers that are plain numbers
SCALARS = tuple(name for name in NUMBERS if name != END)
#: the numbers whose meaning depends on whether the law has one slope or two
OF_THE_LAW = ("alpha1_N_mm2", RIGIDITY, "d_mm")
#: the element whose limit is the reference
REFERENCE_ELEMENT = MOST_ACCURATE
#: smallest relative standard deviation of a limit, so that series without scatter can be weighted
MIN_STD = 1e-9
#: fewest meshes that say something about an order
MIN_MESHES = 3

#: what varies, degrees of freedom or contact distance (mm), and the numbers there
Located = tuple[float, RodNumbers]
#: relative errors by the names of `NUMBERS`; None where a number or its reference is missing
Errors = Mapping[str, float | None]


@dataclass(frozen=True)
class Reference:
    """The limit of a number."""

    value: float
    std: float  #: standard deviation of value


@dataclass(frozen=True)
class References:
    """The references of all numbers at one pressure."""

    pressure_kPa: float
    #: by the names of `SCALARS` and `COORDINATES`; None where too few rungs have a number
    numbers: Mapping[str, Reference | None]

    @property
    def relative_std(self) -> float:
        """The largest relative standard deviation of the headline numbers."""
        present = [reference for name in HEADLINE if (reference := self.numbers[name])]
        return max((abs(reference.std / reference.value) for reference in present), default=0.0)

    @property
    def by_name(self) -> dict[str, tuple[Reference, ...]]:
        """The references that there are by the names of `NUMBERS`; two of the end."""
        parts = {name: [self.numbers[part] for part in (COORDINATES if name == END else (name,))] for name in NUMBERS}
        return {name: tuple(filter(None, parts_of)) for name, parts_of in parts.items() if all(parts_of)}

    def record(self) -> JsonObject:
        """As in accuracy.json."""
        records = {name: [asdict(reference) for reference in parts] for name, parts in self.by_name.items()}
        scalars = {name: records[name][0] if name in records else None for name in SCALARS}
        return {"pressure_kPa": self.pressure_kPa, **scalars, END: records.get(END)}

    def errors(self, numbers: RodNumbers, length: float) -> Errors:
        """Errors of the numbers; that of the end is its distance from the reference over `length` (mm) of the arm."""
        errors: dict[str, float | None] = dict.fromkeys(NUMBERS)
        for name, parts in self.by_name.items():
            if name == END:
                errors[name] = math.dist(numbers.end_mm, [reference.value for reference in parts]) / length
            elif (value := getattr(numbers, name)) is not None:
                errors[name] = value / parts[0].value - 1.0
        return errors


def references_at(
    pressure: float, config: Config, rungs: Sequence[tuple[Rung, Measured]], contact_mm: float | None
) -> References:
    """The references at one pressure, from the series of the reference element and those of the contact distance.

    contact_mm: the configured activation distance; None where no faces can meet.
    """
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
    names = (*SCALARS, *COORDINATES)
    return References(pressure, {name: _reference(name, meshes, distances, contact_mm) for name in names})


def _reference(
    name: str, meshes: Sequence[Sequence[Located]], distances: Sequence[Located], contact_mm: float | None
) -> Reference | None:
    """The limit over the meshes, less the effect of the contact distance where it was varied."""
    if name in OF_THE_LAW:
        two_lines = _most_have_two_lines(meshes)
        meshes = [[mesh for mesh in series if mesh[1].has_two_lines == two_lines] for series in meshes]
        distances = [mesh for mesh in distances if mesh[1].has_two_lines == two_lines]
    reference, by_distance = limit([_values(name, series) for series in meshes]), _values(name, distances)
    if reference is None or contact_mm is None or len(by_distance) < 2 or contact_mm not in by_distance:
        return reference
    return without_contact_distance(reference, by_distance, contact_mm)


def _values(name: str, meshes: Sequence[Located]) -> dict[float, float]:
    return {at: value for at, numbers in meshes if (value := _values_of(numbers)[name]) is not None}


def _values_of(numbers: RodNumbers) -> dict[str, float | None]:
    """The numbers by the names of `SCALARS` and `COORDINATES`."""
    return {
        **{name: getattr(numbers, name) for name in SCALARS},
        **dict(zip(COORDINATES, numbers.end_mm, strict=True)),
    }


def _most_have_two_lines(meshes: Sequence[Sequence[Located]]) -> bool:
    """Whether most meshes gave a law of two lines; the finest decides a tie.

    The rigidity of a single line and those of two are different numbers, so a number is extrapolated from meshes with
    the same law only.
    """
    by_size = sorted((mesh for series in meshes for mesh in series), key=lambda mesh: mesh[0])
    votes = sum(1 if numbers.has_two_lines else -1 for _, numbers in by_size)
    return votes > 0 or (votes == 0 and bool(by_size) and by_size[-1][1].has_two_lines)


def limit(series: Sequence[Mapping[float, float]]) -> Reference | None:
    """The value for infinitely many degrees of freedom, from series of values by degrees of freedom.

    Every series with two or more meshes gives a limit; they are averaged by the inverse of their variances, and their
    spread around the mean adds to its variance, for the error of a single series can be underestimated. None without
    one.
    """
    limits = []
    for by_size in series:
        if len(by_size) >= 2:
            single = extrapolate([n ** (-1 / 3) for n in by_size], list(by_size.values()))
            limits.append((single.limit_std, single.limit))
    if not limits:
        return None
    weights = [1.0 / (std**2 + (MIN_STD * value) ** 2) for std, value in limits]
    mean = sum(weight * value for weight, (_, value) in zip(weights, limits, strict=True)) / sum(weights)
    spread = sum(w * (value - mean) ** 2 for w, (_, value) in zip(weights, limits, strict=True)) / sum(weights)
    return Reference(mean, math.sqrt(1.0 / sum(weights) + spread))


def without_contact_distance(reference: Reference, by_distance: Mapping[float, float], configured: float) -> Reference:
    """The reference less the effect of the configured contact distance (mm), from values by distance on one mesh.

    Raises RodError where the configured distance is the only one.
    """
    to_zero = extrapolate(list(by_distance), list(by_distance.values()))
    value = reference.value + to_zero.limit - by_distance[configured]
    return Reference(value, math.hypot(reference.std, to_zero.limit_std))


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


@dataclass(frozen=True)
class Order:
    """The power of the mesh size n^(-1/3) with which the error of a number falls along a series of meshes."""

    value: float
    std: float  #: standard deviation; 1.0 where the meshes tell nothing about the order
    meshes: int  #: from how many meshes


def orders_along(meshes: Sequence[Located]) -> dict[str, Order]:
    """The orders of the headline numbers that enough meshes have, fitted together with the limit.

    The rigidity of a single line and the second one of two lines are different numbers; the order of the rigidity is
    that of the meshes with the law of the finest one.
    """
    by_size = dict(meshes)
    orders = {}
    for name in HEADLINE:
        values = {
            n ** (-1 / 3): getattr(numbers, name)
            for n, numbers in by_size.items()
            if name != RIGIDITY or numbers.has_two_lines == by_size[max(by_size)].has_two_lines
        }
        if len(values) >= MIN_MESHES:
            fit = extrapolate(list(values), list(values.values()))
            orders[name] = Order(fit.order, fit.order_std, len(values))
    return orders
