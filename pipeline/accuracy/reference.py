"""The reference of every number of the convergence study, and the errors against it.

The reference of a number is its limit on the finest meshes, extrapolated over the degrees of freedom n as n^(-1/3)
(`pipeline.identification.richardson`), less the effect of the contact distance, which is extrapolated to zero on one
mesh.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pipeline.accuracy.result import HEADLINE, RodNumbers
from pipeline.identification.richardson import extrapolated
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
#: the position of the end, whose reference has two coordinates
END = "end_mm"
#: the numbers that are plain numbers
SCALARS = tuple(name for name in NUMBERS if name != END)

#: smallest relative standard deviation of a limit, so that series without scatter can be weighted
MIN_STD = 1e-9


@dataclass(frozen=True)
class Reference:
    """The limit of a number."""

    value: float
    std: float  #: standard deviation of value

    @property
    def relative(self) -> float:
        """Standard deviation over the value."""
        return abs(self.std / self.value)


@dataclass(frozen=True)
class References:
    """The references of all numbers at one pressure; None where too few rungs have a number."""

    pressure_kPa: float
    numbers: Mapping[str, Reference | None]  #: by the names of `SCALARS`
    end: tuple[Reference, Reference] | None  #: x and y of the end in II, mm

    @property
    def relative_std(self) -> float:
        """The largest relative standard deviation of the headline numbers."""
        present = [reference for name in HEADLINE if (reference := self.numbers[name])]
        return max((reference.relative for reference in present), default=0.0)

    def record(self) -> JsonObject:
        """As in accuracy.json."""
        scalars = {name: asdict(reference) if reference else None for name, reference in self.numbers.items()}
        end = [asdict(axis) for axis in self.end] if self.end else None
        return {"pressure_kPa": self.pressure_kPa, **scalars, END: end}

    @staticmethod
    def read(record: Mapping[str, Any]) -> "References":
        """From accuracy.json."""
        end = record[END] and tuple(Reference(**axis) for axis in record[END])
        scalars = {name: record[name] and Reference(**record[name]) for name in SCALARS}
        return References(record["pressure_kPa"], scalars, end)


@dataclass(frozen=True)
class Errors:
    """Relative errors at one pressure; None where a number or its reference is missing."""

    pressure_kPa: float
    by_name: Mapping[str, float | None]  #: by the names of `NUMBERS`

    @staticmethod
    def of(numbers: RodNumbers, references: References, length: float) -> "Errors":
        """Errors of the numbers; that of the end is its distance from the reference over `length` (mm) of the arm."""
        errors: dict[str, float | None] = {}
        for name in SCALARS:
            value, reference = getattr(numbers, name), references.numbers[name]
            errors[name] = None if value is None or reference is None else value / reference.value - 1.0
        end = references.end
        errors[END] = end and math.dist(numbers.end_mm, [axis.value for axis in end]) / length
        return Errors(numbers.pressure_kPa, errors)


def largest_error(errors: Sequence[Errors]) -> float | None:
    """The largest error of kappa_0(l/2), alpha2 and F over all pressures; None where one of them is missing."""
    sizes = [at_pressure.by_name[name] for at_pressure in errors for name in HEADLINE]
    present = [abs(size) for size in sizes if size is not None]
    return max(present) if present and len(present) == len(sizes) else None


def limit(series: Sequence[Sequence[tuple[float, float]]]) -> Reference | None:
    """The value for infinitely many degrees of freedom, from series of (degrees of freedom, value).

    Every series with two or more meshes gives a limit; they are averaged by the inverse of their variances, and their
    spread around the mean adds to its variance, for the error of a single series can be underestimated. None without
    one.
    """
    limits = []
    for meshes in series:
        by_size = dict(meshes)
        if len(by_size) >= 2:
            single = extrapolated([n ** (-1 / 3) for n in by_size], list(by_size.values()))
            limits.append((single.limit_std, single.limit))
    if not limits:
        return None
    weights = [1.0 / (std**2 + (MIN_STD * value) ** 2) for std, value in limits]
    mean = sum(weight * value for weight, (_, value) in zip(weights, limits, strict=True)) / sum(weights)
    spread = sum(w * (value - mean) ** 2 for w, (_, value) in zip(weights, limits, strict=True)) / sum(weights)
    return Reference(mean, math.sqrt(1.0 / sum(weights) + spread))


def without_contact_distance(
    reference: Reference, distances: Sequence[tuple[float, float]], configured: float
) -> Reference:
    """The reference less the effect of the configured contact distance (mm), from (distance, value) on one mesh.

    Raises RodError where the configured distance is the only one.
    """
    to_zero = extrapolated([mm for mm, _ in distances], [value for _, value in distances])
    at_configured = next(value for mm, value in distances if mm == configured)
    value = reference.value + to_zero.limit - at_configured
    return Reference(value, math.hypot(reference.std, to_zero.limit_std))


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices, by cost, of the points (cost, error) that no other point dominates in both."""
    front: list[int] = []
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if not front or points[index][1] < points[front[-1]][1]:
            front.append(index)
    return front
