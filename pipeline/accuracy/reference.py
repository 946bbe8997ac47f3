"""From the rungs of the ladder to errors: the reference they are held against, and which of them nothing beats.

The reference of a number is its limit on the finest meshes, extrapolated over the degrees of freedom n as n^(-1/3)
(`pipeline.richardson`), plus what the contact distance still adds to it, which is extrapolated to zero on one mesh.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.richardson import extrapolated

#: key of a number that users take home -> how it is called
NUMBERS = {
    "kappa_0_per_mm": "κ₀(l/2)",
    "alpha1_N_mm2": "α₁",
    "alpha2_N_mm2": "α₂",
    "d_mm": "d",
    "force_N": "F",
    "end_mm": "end",
}
#: the numbers of which the largest error counts
HEADLINE = ("kappa_0_per_mm", "alpha2_N_mm2", "force_N")

#: relative deviation that a limit has at least, so that lines without scatter can be weighed
LEAST = 1e-9

Numbers = Mapping[str, Any]


@dataclass(frozen=True)
class Reference:
    """What a number is held against."""

    value: float
    std: float  #: standard deviation of value

    @property
    def relative(self) -> float:
        """Standard deviation over the value."""
        return abs(self.std / self.value)


def limit(lines: Sequence[Sequence[tuple[float, float]]]) -> Reference | None:
    """The value for infinitely many degrees of freedom, from lines of (degrees of freedom, value).

    Every line with two or more rungs gives a limit; they are averaged by the inverse of their variances, and their
    spread around that mean adds to its deviation, for a line can be surer of itself than it may be. None without one.
    """
    found = []
    for line in lines:
        by_size = dict(line)
        if len(by_size) >= 2:
            one = extrapolated([n ** (-1 / 3) for n in by_size], list(by_size.values()))
            found.append((one.limit_std, one.limit))
    if not found:
        return None
    weights = [1.0 / (std**2 + (LEAST * value) ** 2) for std, value in found]
    mean = sum(weight * value for weight, (_, value) in zip(weights, found, strict=True)) / sum(weights)
    spread = sum(w * (value - mean) ** 2 for w, (_, value) in zip(weights, found, strict=True)) / sum(weights)
    return Reference(mean, math.sqrt(1.0 / sum(weights) + spread))


def shifted(reference: Reference, distances: Sequence[tuple[float, float]], configured: float) -> Reference:
    """The reference less what the contact distance adds at the configured one (mm), from (distance, value) of one mesh.

    Raises RodError where the configured distance is the only one.
    """
    to_zero = extrapolated([mm for mm, _ in distances], [value for _, value in distances])
    at_it = next(value for mm, value in distances if mm == configured)
    return Reference(reference.value + to_zero.limit - at_it, math.hypot(reference.std, to_zero.limit_std))


def errors(numbers: Numbers, reference: Mapping[str, Any], length: float) -> dict[str, float | None]:
    """Relative errors of the numbers at one pressure; that of the end is its distance over the length (mm) of the arm.

    None where there is no number or no reference.
    """
    found: dict[str, float | None] = {}
    for key in NUMBERS:
        value, exact = numbers.get(key), reference.get(key)
        if value is None or exact is None:
            found[key] = None
        elif key == "end_mm":
            found[key] = math.dist(value, [one.value for one in exact]) / length
        else:
            found[key] = value / exact.value - 1.0
    return found


def headline(found: Sequence[Mapping[str, float | None]]) -> float | None:
    """The largest error of kappa_0(l/2), alpha2 and F over all pressures; None where one of them is missing."""
    sizes = [one[key] for one in found for key in HEADLINE]
    known = [abs(size) for size in sizes if size is not None]
    return max(known) if known and len(known) == len(sizes) else None


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices, by cost, of the points (cost, error) that no other beats in one and equals or beats in the other."""
    front: list[int] = []
    for index in sorted(range(len(points)), key=lambda i: points[i]):
        if not front or points[index][1] < points[front[-1]][1]:
            front.append(index)
    return front
