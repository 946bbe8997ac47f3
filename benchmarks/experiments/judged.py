"""The lines of the table: what a case says before a calibration, and of the rows that one has not seen after it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.experiments.bar import Bar, BendingRod, Elements, Model
from benchmarks.experiments.cases import Case
from benchmarks.experiments.fitted_bar import BarNumbers, fit_bar
from benchmarks.foretold import foretell
from pipeline.answers.measured.gaussian import WITHIN
from pipeline.answers.measured.predicted import LawRods, Numbers
from pipeline.answers.measured.rows import Measurements
from pipeline.config.config import Config
from pipeline.law.study import measure_law
from pipeline.results.files import read_plane_law
from pipeline.store.progress import Silent

LAW = "the arm's own law"
#: elements of a bar through its height
THROUGH_HEIGHT = 5


@dataclass(frozen=True)
class Line:
    """One calibration of a case, or none."""

    case: str
    model: str
    rows: tuple[int, ...]  #: numbers of those that it was calibrated on, from 1; empty without a calibration
    count: int  #: of the other rows
    before: str  #: largest errors of these, in words
    after: str
    factor: float  #: of all moduli; 1 without a calibration
    inside: float  #: part of the other numbers in their intervals; NaN without a calibration


def lines_of(case: Case, folder: Path, jobs: int) -> Iterator[Line]:
    """The lines of a case; folder: of the law of an arm."""
    if isinstance(case.body, Bar):
        yield from _of_bar(case, case.body)
    else:
        yield from _of_arm(case, case.body, folder, jobs)


def _of_bar(case: Case, bar: Bar) -> Iterator[Line]:
    models: dict[str, Model] = {"finite elements": Elements(bar.height / THROUGH_HEIGHT), "rod": BendingRod()}
    for name, model in models.items():
        numbers = BarNumbers(case, bar, model)
        for rows in case.calibrate_on:
            fitted = fit_bar(numbers, rows)
            before, after = (f"{_percent(e.deflection)} of the deflection" for e in (fitted.before, fitted.after))
            others = len(numbers.rows) - len(rows)
            yield Line(case.name, name, rows, others, before, after, fitted.modulus, fitted.inside)


def _of_arm(case: Case, config: Config, folder: Path, jobs: int) -> Iterator[Line]:
    measure_law(config, folder, jobs, False, Silent()).raise_if_failed()
    law, rows = read_plane_law(folder / "law.json"), case.measured.rows
    if not case.calibrate_on:
        numbers = Numbers.of(case.measured)
        off = numbers.predicted(LawRods(law)) - numbers.values
        lines = np.array([row.line for row in numbers.rows])
        worst = max(float(np.linalg.norm(off[lines == row.line])) for row in rows) / law.length
        yield Line(case.name, LAW, (), len(rows), f"{_percent(worst)} of the length", "-", 1.0, np.nan)
    for chosen in case.calibrate_on:
        known, others = (_only(case.measured, chosen, inside) for inside in (True, False))
        foretold = foretell(law, config.record(), known, others)
        errors = np.array([foretold.errors(row.line) for row in others.rows]).max(axis=0)
        inside = float(np.mean(foretold.levels_of_readings <= WITHIN))
        before, after = (_percent(float(error)) for error in errors)
        yield Line(case.name, LAW, chosen, len(others.rows), before, after, foretold.modulus, inside)


def _only(measured: Measurements, numbers: tuple[int, ...], inside: bool) -> Measurements:
    rows = (row for k, row in enumerate(measured.rows, 1) if (k in numbers) == inside)
    return replace(measured, rows=tuple(rows))


def _percent(part: float) -> str:
    return f"{100.0 * part:.2g} %"
