"""What the tolerances of a built arm do to it: by how much each moves the tip, the curvature, the rigidity, the force.

To first order, from the derivatives of the arm's own law. Tolerances are taken as independent, so that their total is
the root of the sum of their squares.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.answers.rods.choice import plane_of
from pipeline.answers.rods.ratio import run_along
from pipeline.config.tolerances import STIFFNESS, Tolerance, Tolerances
from pipeline.config.units import LENGTH, STRESS, Dimension
from pipeline.config.units import PRESSURE as UNIT
from pipeline.results.options import option_value
from pipeline.store.atomic_file import write_atomic
from pipeline.store.result_folder import open_file
from pipeline.values.errors import InputError, argument
from pipeline.values.page import figure_page
from pipeline.values.plots import COLOURS, Line, Panel
from pipeline.values.run import Run
from pipeline.values.table import Table
from rod.arm_law.curves import ACROSS
from rod.arm_law.derivative import NUMBERS as NUMBERS_OF_LAW
from rod.arm_law.law import ArmLaw
from rod.arm_law.law_rod import LawRod
from rod.errors import RodError

#: numbers of an arm, by their names in a `Row`, as they stand in tables
NUMBERS = {"tip": "tip / length", "kappa_0": "κ₀", "rigidity": "rigidity", "force": "force in III"}
#: those of a law with rigidities out of the plane, without moment
IN_SPACE = dict(zip(ACROSS, ("B₂", "GJ"), strict=True))
PRESSURE = "pressure"
#: part of a tolerance in difference quotients at most, and of a pressure
LARGEST_PART, PART_OF_PRESSURE = 0.05, 1e-3
#: what a process stands for, in the caption of the table
DEFAULTS = {
    "cast": "of a cast arm (ISO 3302-1, class M2; 10 % of the stiffness, 2 % of the pressure)",
    "printed": "of a printed arm (0.1 mm; 10 % of the stiffness, 2 % of the pressure)",
}


@dataclass(frozen=True)
class Row:
    """What one tolerance does, to both sides: the tip over the length, all others over their value; NaN: no number."""

    parameter: str  #: key of the configuration
    tolerance: str  #: with its unit
    is_default: bool
    tip: float
    kappa_0: float
    rigidity: float
    force: float
    lateral_rigidity: float
    torsional_rigidity: float

    def size(self, number: str) -> float:
        """Zero where there is no number."""
        value = float(getattr(self, number))
        return value if math.isfinite(value) else 0.0


@dataclass(frozen=True)
class Budget:
    """What all tolerances do to an arm at one pressure."""

    pressure_kPa: float
    process: str  #: of which the tolerances are that were not given
    rows: tuple[Row, ...]  #: by falling displacement of the tip

    def total(self, number: str) -> float:
        """Of a number of a `Row`, such as tip: the root of the sum of squares; NaN where there is no number."""
        known = [float(getattr(row, number)) for row in self.rows]
        finite = [value for value in known if math.isfinite(value)]
        return math.hypot(*finite) if finite else math.nan

    @property
    def numbers(self) -> dict[str, str]:
        """Those of the table with their titles, by their names in a `Row`."""
        return NUMBERS | {name: title for name, title in IN_SPACE.items() if math.isfinite(self.total(name))}

    def largest(self, number: str = "tip") -> Row:
        """The tolerance that does the most."""
        return max(self.rows, key=lambda row: row.size(number))


def budget_of(run: Run, pressure_kPa: float | None = None, tolerances: Tolerances | None = None) -> Budget | None:
    """The budget of a run at a pressure, the highest one of its law unless it is given; None without derivatives.

    tolerances: those of the configuration unless they are given. Raises InputError for a pressure outside the law.
    """
    law = _law(run)
    if law is None:
        return None
    chosen = tolerances or Tolerances.from_record(run.config.get("tolerances"))
    pressure = law.pressures[-1] if pressure_kPa is None else pressure_kPa
    end = run.config.get("end") or {}
    held = end.get("y_mm") if end.get("x_mm") is None else None
    try:
        return make_budget(law, chosen, pressure, held)
    except RodError as failure:
        raise InputError(f"{run.directory / 'law.json'}: {failure}") from None


def budgets_of(run: Run, tolerances: Tolerances | None = None) -> tuple[Budget, ...]:
    """The budgets of a run at those pressures of its configuration that its law has; empty without derivatives."""
    pressures = [state.pressure_kPa for state in run.law.beside.unloaded] if run.law else []
    found = []
    for pressure in pressures:
        with suppress(InputError):
            found.append(budget_of(run, pressure, tolerances))
    return tuple(filter(None, found))


def _law(run: Run) -> ArmLaw | None:
    """The law of a run, where it has derivatives."""
    law = run.law and run.law.plane
    return law if law and law.rates else None


def make_budget(law: ArmLaw, tolerances: Tolerances, pressure_kPa: float, held_mm: float | None) -> Budget:
    """The budget of a law at a pressure.

    held_mm: height of the end in experiment III; None where it is not held so. Raises `RodError`.
    """
    dimensions = {name: rate.value for name, rate in law.rates.items() if rate.unit == "mm"}
    known = _numbers(law.at(pressure_kPa), held_mm, law.at(pressure_kPa))
    rows = []
    for key, tolerance in tolerances.all(dimensions).items():
        rates, unit = _rates(law, key, tolerance, pressure_kPa, held_mm)
        if rates is not None:
            tip = math.hypot(rates["x"], rates["y"]) / law.length
            others = {name: abs(rates[name] / known[name]) for name in ("kappa_0", "rigidity", "force", *ACROSS)}
            rows.append(Row(key, tolerance.text(unit), tolerance.is_default, tip, **others))
    return Budget(pressure_kPa, tolerances.process, tuple(sorted(rows, key=lambda row: -row.size("tip"))))


def _rates(
    law: ArmLaw, key: str, tolerance: Tolerance, pressure: float, held_mm: float | None
) -> tuple[dict[str, float] | None, str]:
    """Changes of the numbers by a tolerance, and the unit of what it belongs to; None for what the law has not."""
    if key == PRESSURE:
        step = PART_OF_PRESSURE * pressure
        above = min(pressure + step, law.pressures[-1])
        laws, pressures, part = (law, law), (pressure - step, above), (above - pressure + step) / tolerance.of(pressure)
        return _difference(laws, pressures, part, law.at(pressure), held_mm), "kPa"
    changes = _changes(law, key, tolerance)
    if not changes:
        return None, ""
    part = min(LARGEST_PART, *(law.step(name) / change for name, change in changes.items()))
    less, more = (law.with_changes({name: sign * part * c for name, c in changes.items()}) for sign in (-1.0, 1.0))
    unit = law.rate(next(iter(changes))).unit
    return _difference((less, more), (pressure,) * 2, 2.0 * part, law.at(pressure), held_mm), unit


def _changes(law: ArmLaw, key: str, tolerance: Tolerance) -> dict[str, float]:
    """The parameters of the law that a tolerance changes, and by how much."""
    if key == STIFFNESS:
        moduli = {name: rate.value for name, rate in law.rates.items() if rate.unit == "MPa"}
        return {name: tolerance.amount * value for name, value in moduli.items() if value}
    return {key: tolerance.of(law.rates[key].value)} if key in law.rates else {}


def _difference(
    laws: Sequence[ArmLaw], pressures: Sequence[float], part: float, known: LawRod, held_mm: float | None
) -> dict[str, float]:
    less, more = (_numbers(law.at(pressure), held_mm, known) for law, pressure in zip(laws, pressures, strict=True))
    return {name: (more[name] - less[name]) / part for name in less}


def _numbers(rod: LawRod, held_mm: float | None, known: LawRod) -> Mapping[str, float]:
    def tried(number: Callable[[], float]) -> float:
        try:
            return number()
        except RodError:
            return math.nan

    x, y = rod.solve().end
    return {
        "x": x,
        "y": y,
        **{name: NUMBERS_OF_LAW[name](rod, known) for name in ("kappa_0", "rigidity", *ACROSS)},
        "force": math.nan if held_mm is None else tried(lambda: float(rod.solve(end_y=held_mm).force[1])),
    }


def budget_table(budget: Budget) -> Table:
    """One row per tolerance, and their total."""
    shown = budget.numbers
    rows = [(row.parameter, row.tolerance, *(_cell(getattr(row, name)) for name in shown)) for row in budget.rows]
    rows.append(("all", "", *(_cell(budget.total(name)) for name in shown)))
    some = "Tolerances" if all(row.is_default for row in budget.rows) else "Tolerances that are not given"
    caption = (
        f"Changes in % at {budget.pressure_kPa:g} kPa by each tolerance, to first order; all: root of the sum of "
        f"squares. {some} are those {DEFAULTS[budget.process]}."
    )
    return Table(("tolerance of", "±", *(f"{title} (%)" for title in shown.values())), tuple(rows), caption)


def _cell(value: float) -> str:
    return f"{100.0 * value:.2g}" if math.isfinite(value) else "-"


def budget_panels(budgets: Sequence[Budget]) -> tuple[Panel, ...]:
    """Bars for each number, one frame per pressure."""
    panels: list[Panel] = []
    for (name, title), colour in zip((NUMBERS | IN_SPACE).items(), COLOURS, strict=False):
        lines = [_bars(budget, name, title, colour) for budget in budgets if math.isfinite(budget.total(name))]
        if lines:
            panels.append(Panel(title, "", "change (%)", tuple(lines), from_zero=True))
    return tuple(panels)


def _bars(budget: Budget, name: str, title: str, colour: str) -> Line:
    rows = sorted(budget.rows, key=lambda row: -row.size(name))
    words: list[Any] = [f"{row.parameter.split('.', 1)[-1]} ± {row.tolerance}" for row in rows]
    values = [100.0 * row.size(name) for row in rows]
    return Line(words, values, title, colour, entry="", frame=f"{budget.pressure_kPa:g} kPa", bars=True)


def budget_page(name: str, budgets: Sequence[Budget]) -> str:
    """The figure alone on a page that opens offline."""
    return figure_page(f"{name}: what its tolerances do", budget_panels(budgets))


def budget_for(
    folder: Path, pressure: str | None, settings: Sequence[str], out: Path | None = None, ratio: str | None = None
) -> tuple[Budget, Path]:
    """The budget of a result folder at a pressure written with its unit, and the page with its picture.

    settings: tolerances as KEY=VALUE, in place of those of the configuration. ratio: of the pressures of a law that has
    several. Raises InputError.
    """
    run = run_along(folder, ratio)
    tolerances = _with_settings(run, settings)
    found = budget_of(run, None if pressure is None else option_value("pressure", pressure, UNIT), tolerances)
    if found is None:
        if run.law is not None:
            plane_of(run, "a budget")  # refuses a law of another kind
        raise InputError(f"{folder}: its law has no derivatives; an arm with cells has them, see docs/cell.md")
    page = open_file(out or folder / "budget.html")
    write_atomic(page, budget_page(run.design, budgets_of(run, tolerances) or (found,)).encode())
    return found, page


def _with_settings(run: Run, settings: Sequence[str]) -> Tolerances:
    """The tolerances of the configuration with others in their place."""
    known = Tolerances.from_record(run.config.get("tolerances"))
    law = _law(run)
    for setting in settings:
        key, separator, written = setting.partition("=")
        if not separator:
            raise InputError(
                f"{argument('tolerances', setting)}: write it as KEY=VALUE, for example geometry.wall='0.1 mm'"
            )
        try:
            known = known.with_setting(key.strip(), written.strip(), {} if law is None else _units(law))
        except ValueError as refused:
            raise InputError(f"{argument('tolerances', setting)}: {refused}") from None
    return known


def _units(law: ArmLaw) -> dict[str, Dimension | None]:
    """What each tolerance measures."""
    measured = {"mm": LENGTH, "MPa": STRESS}
    return {PRESSURE: UNIT, STIFFNESS: None, **{name: measured.get(rate.unit) for name, rate in law.rates.items()}}
