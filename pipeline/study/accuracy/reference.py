"""References of the numbers of the convergence study, errors against them, and orders of convergence.

The reference of a number is its limit on the finest meshes, extrapolated over the degrees of freedom n as n^(-1/3)
(`pipeline.values.richardson`), less the effect of the contact distance, which is extrapolated to zero on one
mesh.

The rigidity of a single line and those of two are different numbers, so a number of the law is extrapolated from meshes
with equally many lines only.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem.elements import MOST_ACCURATE
from pipeline.config.config import Config
from pipeline.study.accuracy.ladder import CONTACT, TOLERANCE, Rung
from pipeline.study.accuracy.measure import HEADLINE, RIGIDITY, RodNumbers, RungResult
from pipeline.values.json_values import JsonObject
from pipeline.values.richardson import Limit, extrapolate

#: name of a number -> its symbol and unit
NUMBERS = {
    "kappa_0_per_mm": ("κ₀(l/2)", "1/mm"),
    "alpha1_N_mm2": ("α₁", "N mm²"),
    "alpha2_N_mm2": ("α₂", "N mm²"),
    "d_mm": ("d", "mm"),
    "force_N": ("F", "N"),
    "end_mm": ("end", "mm"),
}
#: the position of the end; its reference has one entry per coordinate
END, COORDINATES = "end_mm", ("end_x_mm", "end_y_mm")
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
class References:
    """The references of all numbers at one pressure."""

    pressure_kPa: float
    #: by the names of `RodNumbers.scalars`; None where too few rungs have a number
    numbers: Mapping[str, Limit | None]

    def of(self, name: str) -> tuple[Limit, ...]:
        """The reference of a number by its name in `NUMBERS`, two of the end; empty where there is none."""
        parts = [self.numbers[part] for part in (COORDINATES if name == END else (name,))]
        return tuple(filter(None, parts)) if all(parts) else ()

    def record(self) -> JsonObject:
        """The reference as accuracy.json has it."""
        records = {name: [part._asdict() for part in self.of(name)] or None for name in NUMBERS}
        scalars = {name: parts and parts[0] for name, parts in records.items() if name != END}
        return {"pressure_kPa": self.pressure_kPa, **scalars, END: records[END]}

    def errors(self, numbers: RodNumbers, length: float) -> Errors:
        """Errors of the numbers; that of the end is its distance from the reference over `length` (mm) of the arm."""
        errors: dict[str, float | None] = dict.fromkeys(NUMBERS)
        for name in NUMBERS:
            values = [reference.value for reference in self.of(name)]
            if name == END and values:
                errors[name] = math.dist(numbers.end_mm, values) / length
            elif values and (value := getattr(numbers, name)) is not None:
                errors[name] = value / values[0] - 1.0
        return errors


def references_at(
    pressure: float, config: Config, rungs: Sequence[tuple[Rung, RungResult]], contact_mm: float | None
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
    two_lines = _most_have_two_lines(series.values())

    def values_of(name: str, meshes: Sequence[Located]) -> dict[float, float]:
        return _values(name, meshes, two_lines if name in OF_THE_LAW else None)

    def reference(name: str) -> Limit | None:
        found, by_distance = limit([values_of(name, meshes) for meshes in series.values()]), values_of(name, distances)
        if found is None or contact_mm is None or len(by_distance) < 2 or contact_mm not in by_distance:
            return found
        return without_contact_distance(found, by_distance, contact_mm)

    names = [part for name in NUMBERS for part in (COORDINATES if name == END else (name,))]
    return References(pressure, {name: reference(name) for name in names})


def _values(name: str, meshes: Sequence[Located], two_lines: bool | None) -> dict[float, float]:
    """A number by what varies; two_lines: of meshes with laws of two lines, or of one; None for all."""
    chosen = [mesh for mesh in meshes if two_lines is None or mesh[1].has_two_lines == two_lines]
    return {at: value for at, numbers in chosen if (value := numbers.scalars[name]) is not None}


def _most_have_two_lines(meshes: Iterable[Sequence[Located]]) -> bool:
    """Whether most meshes gave a law of two lines; the finest decides a tie."""
    by_size = sorted((mesh for series in meshes for mesh in series), key=lambda mesh: mesh[0])
    votes = sum(1 if numbers.has_two_lines else -1 for _, numbers in by_size)
    return votes > 0 or (votes == 0 and bool(by_size) and by_size[-1][1].has_two_lines)


def limit(series: Sequence[Mapping[float, float]]) -> Limit | None:
    """The value for infinitely many degrees of freedom, from series of values by degrees of freedom.

    Every series with two or more meshes gives a limit; they are averaged by the inverse of their variances, and their
    spread around the mean adds to its variance, for the error of a single series can be underestimated. None without
    one.
    """
    fits = [
        extrapolate([n ** (-1 / 3) for n in by_size], list(by_size.values())) for by_size in series if len(by_size) >= 2
    ]
    if not fits:
        return None
    limits, stds = np.array([(fit.limit, fit.limit_std) for fit in fits]).T
    weights = 1.0 / (stds**2 + (MIN_STD * limits) ** 2)
    mean = float(np.average(limits, weights=weights))
    spread = float(np.average((limits - mean) ** 2, weights=weights))
    return Limit(mean, math.sqrt(1.0 / float(weights.sum()) + spread))


def without_contact_distance(reference: Limit, by_distance: Mapping[float, float], configured: float) -> Limit:
    """The reference less the effect of the configured contact distance (mm), from values by distance on one mesh."""
    to_zero = extrapolate(list(by_distance), list(by_distance.values()))
    value = reference.value + to_zero.limit - by_distance[configured]
    return Limit(value, math.hypot(reference.std, to_zero.limit_std))


@dataclass(frozen=True)
class Order:
    """The power of the mesh size n^(-1/3) with which the error of a number falls along a series of meshes."""

    value: float
    std: float  #: standard deviation; 1.0 where the meshes tell nothing about the order
    meshes: int  #: from how many meshes


def orders_along(meshes: Sequence[Located]) -> dict[str, Order]:
    """The orders of the headline numbers that enough meshes have, fitted together with the limit.

    The order of the rigidity is that of the meshes with the law of the finest one.
    """
    if not meshes:
        return {}
    of_finest = dict(meshes)[max(dict(meshes))].has_two_lines
    orders = {}
    for name in HEADLINE:
        values = _values(name, meshes, of_finest if name == RIGIDITY else None)
        if len(values) >= MIN_MESHES:
            fit = extrapolate([n ** (-1 / 3) for n in values], list(values.values()))
            orders[name] = Order(fit.order, fit.order_std, len(values))
    return orders
