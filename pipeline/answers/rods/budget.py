"""What the tolerances of a built arm do to it: by how much each moves the tip, the curvature, the rigidity, the force.

To first order, from the derivatives of the arm's own law. Tolerances are taken as independent, so that their total is
the root of the sum of their squares.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.answers.rods.choice import plane_of, refuse_draft, run_along
from pipeline.config import units
from pipeline.config.tolerances import STIFFNESS, Tolerance, Tolerances
from pipeline.results.options import option_value, write_new
from pipeline.values.errors import InputError, argument, ask
from pipeline.values.page import Section, figure_page
from pipeline.values.plots import Line, Panel, ordered_colour
from pipeline.values.run import Run
from pipeline.values.table import Table
from rod.arm_law.curves import ACROSS
from rod.arm_law.law import ArmLaw
from rod.arm_law.quantities import QUANTITIES, QuantityAt, Rods, jacobian

#: titles of the quantities of the table, by name; the tip comes first
LIMIT = "limit"
NUMBERS = {one.name: one.title for one in QUANTITIES.values() if one.title} | {LIMIT: "limit pressure"}
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
    """What one tolerance does, to both sides."""

    parameter: str  #: key of the configuration
    tolerance: str  #: with its unit
    is_default: bool
    changes: Mapping[str, float]  #: by the names of `NUMBERS`: the tip over the length, all others over their value

    def size(self, number: str) -> float:
        """Zero where there is no number."""
        value = self.changes[number]
        return value if math.isfinite(value) else 0.0


@dataclass(frozen=True)
class Budget:
    """What all tolerances do to an arm at one pressure."""

    pressure_kPa: float
    process: str  #: of which the tolerances are that were not given
    rows: tuple[Row, ...]  #: by falling displacement of the tip

    def total(self, number: str) -> float:
        """Root of the sum of squares of one of `NUMBERS`, such as tip; NaN where there is no number."""
        finite = [row.changes[number] for row in self.rows if math.isfinite(row.changes[number])]
        return math.hypot(*finite) if finite else math.nan

    @property
    def numbers(self) -> dict[str, str]:
        """Numbers of the table with their titles; out of the plane, and a limit pressure, where the law has them."""
        shown = [name for name in NUMBERS if name not in (*ACROSS, LIMIT) or math.isfinite(self.total(name))]
        return {name: NUMBERS[name] for name in shown}

    def largest(self, number: str = "tip") -> Row:
        """The tolerance that does the most."""
        return max(self.rows, key=lambda row: row.size(number))

    @property
    def table(self) -> Table:
        """One row per tolerance, and their total."""
        shown = self.numbers
        rows = [(row.parameter, row.tolerance, *(_cell(row.changes[name]) for name in shown)) for row in self.rows]
        rows.append(("all", "", *(_cell(self.total(name)) for name in shown)))
        some = "Tolerances" if all(row.is_default for row in self.rows) else "Tolerances that are not given"
        caption = (
            f"Changes in % at {self.pressure_kPa:g} kPa by each tolerance, to first order; all: root of the sum of "
            f"squares. {some} are those {DEFAULTS[self.process]}."
        )
        return Table(("tolerance of", "±", *(f"{title} (%)" for title in shown.values())), tuple(rows), caption)


def budget_of(run: Run, pressure_kPa: float | None = None, tolerances: Tolerances | None = None) -> Budget | None:
    """The budget of a run at a pressure, the highest one of its law unless it is given; None without derivatives.

    tolerances: those of the configuration unless they are given. Raises InputError for a pressure outside the law.
    """
    law = _law(run)
    if law is None:
        return None
    return _budgets(run, law, [law.pressures[-1] if pressure_kPa is None else pressure_kPa], tolerances)[0]


def budgets_of(run: Run, tolerances: Tolerances | None = None) -> tuple[Budget, ...]:
    """The budgets of a run at those pressures of its configuration that its law has; empty without derivatives."""
    law = _law(run)
    if law is None or run.law is None:
        return ()
    low, high = law.pressures[0], law.pressures[-1]
    pressures = [state.pressure_kPa for state in run.law.unloaded if low <= state.pressure_kPa <= high]
    with suppress(InputError):
        return _budgets(run, law, pressures, tolerances) if pressures else ()
    return ()


def _law(run: Run) -> ArmLaw | None:
    """The law of a run, where it has derivatives."""
    law = run.law and run.law.plane
    return law if law and law.rates else None


def _budgets(
    run: Run, law: ArmLaw, pressures_kPa: Sequence[float], tolerances: Tolerances | None
) -> tuple[Budget, ...]:
    chosen = tolerances or Tolerances.from_record(run.config.get("tolerances"))
    return ask(str(run.directory / "law.json"), make_budgets, law, chosen, pressures_kPa, run.held_mm)


def make_budgets(
    law: ArmLaw, tolerances: Tolerances, pressures_kPa: Sequence[float], held_mm: float | None
) -> tuple[Budget, ...]:
    """The budgets of a law at some pressures.

    held_mm: height of the end in experiment III; None where it is not held so. Raises `RodError`.
    """
    chosen = tolerances.all(law.dimensions)
    most = {name: by for key, one in chosen.items() for name, by in _moves(law, key, one).items() if name != PRESSURE}
    names = [name for name in QUANTITIES if name in NUMBERS and (name != "force" or held_mm is not None)]
    here, after, parts = cache(law.at), law.rods_after(list(most)), len(pressures_kPa)
    asked = [QuantityAt(name, p, here(p), held_mm or 0.0).or_nan for p in pressures_kPa for name in names]

    def at(changes: Array) -> Rods:
        rods = after(changes[1:])
        return lambda pressure: rods(pressure + float(changes[0]) * pressure)

    steps = (min(law.step(name), LARGEST_PART * move) for name, move in most.items())
    rates = np.split(jacobian(at, asked, [PART_OF_PRESSURE, *steps]), parts)
    values = np.split(np.concatenate([number(here) for number in asked]), parts)
    budgets = []
    for pressure, rate, value in zip(pressures_kPa, rates, values, strict=True):
        by, rows = dict(zip((PRESSURE, *most), rate.T, strict=True)), []
        for key, tolerance in chosen.items():
            if moves := _moves(law, key, tolerance, pressure):
                change = np.sum([by[name] * amount for name, amount in moves.items()], axis=0)
                text = tolerance.text("kPa" if key == PRESSURE else law.rate(next(iter(moves))).unit)
                changes = _changes(names, change, value, law.length) | {LIMIT: _of_limit(law, moves)}
                rows.append(Row(key, text, tolerance.is_default, changes))
        budgets.append(Budget(pressure, tolerances.process, tuple(sorted(rows, key=lambda row: -row.size("tip")))))
    return tuple(budgets)


def _moves(law: ArmLaw, key: str, tolerance: Tolerance, pressure: float = 0.0) -> dict[str, float]:
    """The parameters that a tolerance changes, and by how much; the pressure by its part."""
    if key == PRESSURE:
        return {PRESSURE: tolerance.of(pressure) / pressure if pressure else 0.0}
    if key == STIFFNESS:
        return {name: tolerance.amount * value for name, value in law.moduli.items() if value}
    return {key: tolerance.of(law.rates[key].value)} if key in law.rates else {}


def _of_limit(law: ArmLaw, moves: Mapping[str, float]) -> float:
    """Change of the limit pressure over it; NaN without a limit, and where its derivatives are not known."""
    if law.limit is None or not moves.keys() <= law.limit.rates.keys():
        return math.nan
    return abs(sum(law.limit.rates[name] * amount for name, amount in moves.items())) / law.limit.value


def _changes(names: Sequence[str], change: Array, value: Array, length: float) -> dict[str, float]:
    """Changes of numbers (m,) as a `Row` has them; the first two are those of the tip."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = [math.hypot(*change[:2]) / length, *np.abs(change[2:] / value[2:]).tolist()]
    return dict.fromkeys(NUMBERS, math.nan) | dict(zip(names, relative, strict=True))


def _cell(value: float) -> str:
    return f"{100.0 * value:.2g}" if math.isfinite(value) else "-"


def budget_panels(budgets: Sequence[Budget]) -> tuple[Panel, ...]:
    """Bars for each number, a colour and a frame for each pressure, by the largest contribution at any of them."""
    panels: list[Panel] = []
    for name, title in NUMBERS.items():
        shown = [(k, budget) for k, budget in enumerate(budgets) if math.isfinite(budget.total(name))]
        rows = sorted((row for _, budget in shown for row in budget.rows), key=lambda row: -row.size(name))
        order = list(dict.fromkeys(row.parameter for row in rows))
        lines = tuple(_bars(budget, name, order, ordered_colour(k, len(budgets))) for k, budget in shown)
        if lines:
            panels.append(Panel(title, "", "change (%)", lines, from_zero=True))
    return tuple(panels)


def _bars(budget: Budget, name: str, order: Sequence[str], colour: str) -> Line:
    rows = sorted(budget.rows, key=lambda row: order.index(row.parameter))
    words: list[Any] = [f"{row.parameter.split('.', 1)[-1]} ± {row.tolerance}" for row in rows]
    values, pressure = [100.0 * row.size(name) for row in rows], f"{budget.pressure_kPa:g} kPa"
    return Line(words, values, pressure, colour, entry="", frame=pressure, bars=True)


def budget_section(run: Run) -> Section | None:
    """Table and bars of the budgets of a run; None without derivatives."""
    budgets = budgets_of(run)
    return Section(panels=budget_panels(budgets), table=budgets[-1].table) if budgets else None


def budget_page(name: str, budgets: Sequence[Budget]) -> str:
    """The figure alone on a page that opens offline."""
    return figure_page(f"{name}: what its tolerances do", budget_panels(budgets))


def budget_for(
    folder: Path, pressure: Any, settings: Sequence[str], out: Path | None = None, ratio: str | None = None
) -> tuple[Budget, Path]:
    """The budget of a result folder at a pressure, a number or a text with its unit, and the page with its picture.

    settings: tolerances as KEY=VALUE, in place of those of the configuration. ratio: of the pressures of a law that has
    several. Raises InputError.
    """
    run = run_along(folder, ratio)
    tolerances = _with_settings(run, settings)
    found = budget_of(run, None if pressure is None else option_value("pressure", pressure, units.PRESSURE), tolerances)
    if found is None:
        if run.law is not None:
            refuse_draft(run, "a budget")
            plane_of(run, "a budget")  # refuses a law of another kind
        raise InputError(f"{folder}: its law has no derivatives; an arm with cells has them, see docs/cell.md")
    page = out or folder / "budget.html"
    write_new(page, budget_page(run.design, budgets_of(run, tolerances) or (found,)))
    return found, page


def _with_settings(run: Run, settings: Sequence[str]) -> Tolerances:
    """The tolerances of the configuration with others in their place."""
    known = Tolerances.from_record(run.config.get("tolerances"))
    known_units: dict[str, units.Dimension | None] = {}
    if law := _law(run):
        measured = {"mm": units.LENGTH, "MPa": units.STRESS, "N": units.FORCE}
        known_units = {PRESSURE: units.PRESSURE, STIFFNESS: None}
        known_units |= {name: measured.get(rate.unit) for name, rate in law.rates.items()}
    for setting in settings:
        key, separator, written = setting.partition("=")
        if not separator:
            raise InputError(
                f"{argument('tolerances', setting)}: write it as KEY=VALUE, for example geometry.wall='0.1 mm'"
            )
        known = ask(argument("tolerances", setting), known.with_setting, key.strip(), written.strip(), known_units)
    return known
