"""The five parameters over pressure: slopes and range of linearity (paper, section 4.1)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from rod.errors import RodError

#: negligible distance of a value from a straight line, over the largest value
STRAIGHTNESS_TOLERANCE = 0.02


class Quantity(NamedTuple):
    """Values of a quantity over pressure with their standard deviations, one of each per pressure."""

    values: Sequence[float]
    stds: Sequence[float]


@final
@dataclass(frozen=True)
class Straightness:
    """A straight line through values over pressure, and whether the values lie on it."""

    slope: float  #: per kPa
    slope_std: float
    intercept: float  #: at 0 kPa
    straight: bool  #: every value lies within two standard deviations or STRAIGHTNESS_TOLERANCE of the line
    tested: bool  #: from more than two pressures; two always lie on a line


def straightness(pressures: Sequence[float], values: Sequence[float], stds: Sequence[float]) -> Straightness:
    """Weighted straight line through values at the pressures (kPa).

    A standard deviation of zero counts as a thousandth of the largest value. Raises `RodError` for fewer than two
    different pressures or lengths that differ.
    """
    p, v, e = (np.asarray(a, float) for a in (pressures, values, stds))
    if not p.shape == v.shape == e.shape or len(np.unique(p)) < 2:
        raise RodError("A slope over pressure needs values and errors at two different pressures at least.")
    scale = float(np.abs(v).max()) or 1.0
    e = np.maximum(np.where(np.isfinite(e), e, scale), 1e-3 * scale)
    rows = np.column_stack([p, np.ones(len(p))]) / e[:, None]
    slope, intercept = np.linalg.lstsq(rows, v / e, rcond=None)[0]
    covariance = np.linalg.inv(rows.T @ rows)
    off = np.abs(v - slope * p - intercept)
    return Straightness(
        float(slope),
        float(np.sqrt(covariance[0, 0])),
        float(intercept),
        bool(np.all(off <= np.maximum(2.0 * e, STRAIGHTNESS_TOLERANCE * scale))),
        len(p) > 2,
    )


@final
@dataclass(frozen=True)
class LinearRange:
    """A range of pressures in which several quantities are linear, with their lines over that range."""

    low: float  #: kPa
    high: float  #: kPa
    lines: Mapping[str, Straightness]

    @property
    def tested(self) -> bool:
        """Whether there are more than two pressures in it."""
        return all(line.tested for line in self.lines.values())

    @staticmethod
    def over(pressures: Sequence[float], quantities: Mapping[str, Quantity]) -> "LinearRange":
        """The lines over all given pressures (kPa), straight or not. Raises `RodError` below two pressures."""
        lines = {name: straightness(pressures, *quantity) for name, quantity in quantities.items()}
        return LinearRange(pressures[0], pressures[-1], lines)


def linear_range(pressures: Sequence[float], quantities: Mapping[str, Quantity]) -> LinearRange | None:
    """The widest range of neighbouring pressures (kPa, ascending) in which every quantity is linear.

    Two pressures are a range only where there are no more, for two points always lie on a line. None where no three
    neighbours lie on lines, and below two pressures.
    """
    count = len(pressures)
    spans = [(i, j) for i in range(count) for j in range(i + min(3, count), count + 1) if j - i > 1]
    for i, j in sorted(spans, key=lambda span: pressures[span[0]] - pressures[span[1] - 1]):
        part = {name: Quantity(q.values[i:j], q.stds[i:j]) for name, q in quantities.items()}
        candidate = LinearRange.over(pressures[i:j], part)
        if all(line.straight for line in candidate.lines.values()):
            return candidate
    return None
