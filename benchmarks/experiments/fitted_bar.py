"""The modulus of a solid bar fitted to some of its rows, and what it foretells of the others."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, hypot
from typing import NamedTuple

import numpy as np

from benchmarks.experiments.bar import GRAVITY, Bar, Model, Response
from benchmarks.experiments.cases import Case
from geometry.arrays import Array
from pipeline.answers.measured.fit import OF_ANGLES, OF_POSITIONS
from pipeline.answers.measured.gaussian import Effects, Gaussian
from pipeline.answers.measured.predicted import KINDS
from pipeline.answers.measured.rows import Row
from pipeline.answers.measured.unknowns import OF_DATA_SHEET
from pipeline.values.errors import InputError

#: part of a difference quotient by the logarithm of the factor of all moduli
STEP = 0.02
#: rounds of the fit
ROUNDS = 8


class Errors(NamedTuple):
    """Of some rows; the largest ones."""

    tip: float  #: distance of the tip over the length
    deflection: float  #: of the height of the tip, over the measured one


@dataclass(frozen=True)
class FittedBar:
    """A fit, and the rows that it did not see."""

    rows: tuple[int, ...]  #: numbers of the fitted ones, from 1
    modulus: float  #: factor of all moduli
    before: Errors  #: of the other rows, with the modulus of the case
    after: Errors
    inside: float  #: part of the numbers of the other rows in their intervals


class BarNumbers:
    """The numbers of a case by a model, over the factor of all moduli."""

    def __init__(self, case: Case, bar: Bar, model: Model) -> None:
        self._responses: dict[tuple[float, float], Response] = {}
        for row in case.measured.rows:
            _check(case, row)
            force = row.state.force_N
            if force not in self._responses:
                self._responses[force] = Response(model, bar, force)
        self.rows = case.measured.rows
        self._weight = bar.density * GRAVITY * bar.length * bar.height * bar.width
        self._bar = bar

    @property
    def length(self) -> float:
        """mm"""
        return self._bar.length

    def pairs(self, rows: Sequence[int]) -> list[tuple[Row, str]]:
        """Every number of some rows, by row and name."""
        return [(self.rows[number - 1], name) for number in rows for name in self.rows[number - 1].values]

    def predicted(self, rows: Sequence[int], change: float) -> Array:
        """(n,) with the modulus times e^change."""
        return np.array([self._of(row, name, change) for row, name in self.pairs(rows)])

    def effects(self, rows: Sequence[int], change: float) -> Effects:
        """Their changes. The error of the model is one in the stiffness, which differs from load to load."""
        slopes = np.subtract(*(self.predicted(rows, change + sign * STEP) for sign in (1.0, -1.0))) / (2.0 * STEP)
        loads = np.array([hypot(*row.state.force_N) + self._weight / 3.0 for row, _ in self.pairs(rows)])
        return Effects(slopes[:, None], slopes[:, None], loads)

    def errors(self, rows: Sequence[int], change: float) -> Errors:
        """The largest ones of the tips of some rows."""
        tips, falls = [], []
        for row in (self.rows[number - 1] for number in rows):
            x, y = (self._of(row, name, change) - row.values[name] for name in ("tip_x", "tip_y"))
            tips.append(hypot(x, y) / self._bar.length)
            falls.append(abs(y / row.values["tip_y"]))
        return Errors(max(tips), max(falls))

    def _of(self, row: Row, name: str, change: float) -> float:
        tip = self._responses[row.state.force_N].at(exp(change))
        return {"tip_x": tip.x_mm, "tip_y": tip.y_mm, "end_angle": tip.angle_deg}[name]


def _check(case: Case, row: Row) -> None:
    where = f"{case.measured.file}: line {row.line}"
    state = row.state
    if state.pressure_kPa or state.tip_mass_g or state.held_y_mm is not None or state.orientation != "lying":
        raise InputError(f"{where}: a bar lies, and bears nothing but a force; write orientation lying and pressure 0")
    if not {"tip_x", "tip_y"} <= row.values.keys() <= {"tip_x", "tip_y", "end_angle"}:
        raise InputError(f"{where}: of a bar give tip_x_mm and tip_y_mm, and end_angle_deg where it was measured")


def fit_bar(numbers: BarNumbers, rows: tuple[int, ...]) -> FittedBar:
    """The factor of all moduli by some rows. Raises ValueError where a bar so soft was not solved."""
    values = np.array([row.values[name] for row, name in numbers.pairs(rows)])
    units = tuple(KINDS[name] for _, name in numbers.pairs(rows))
    usual = {"mm": OF_POSITIONS * numbers.length, "deg": OF_ANGLES}
    change = 0.0
    for _ in range(ROUNDS):
        residual = values - numbers.predicted(rows, change)
        effects = numbers.effects(rows, change)
        posterior = Gaussian.of(effects, residual, units, np.array([change]), np.array([OF_DATA_SHEET]), usual)
        change = float(posterior.mean[0])
    others = [number for number in range(1, len(numbers.rows) + 1) if number not in rows]
    return FittedBar(
        rows,
        exp(change),
        numbers.errors(others, 0.0),
        numbers.errors(others, change),
        _inside(numbers, others, change, posterior),
    )


def _inside(numbers: BarNumbers, rows: Sequence[int], change: float, posterior: Gaussian) -> float:
    """The part of the numbers of some rows that lie in their intervals, with the scatter of a reading."""
    pairs = numbers.pairs(rows)
    off = np.array([row.values[name] for row, name in pairs]) - numbers.predicted(rows, change)
    deviations = posterior.deviations(numbers.effects(rows, change), [KINDS[name] for _, name in pairs])
    return float(np.mean(np.abs(off) <= posterior.quantile * deviations))
