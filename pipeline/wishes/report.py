"""A design that was found, beside what was wanted: values, tables and a page with pictures."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.plots import COLOURS, INK, Line, Panel, figure, standalone_page
from pipeline.report.tables import Table
from pipeline.store.json_values import JsonObject
from pipeline.wishes.search import Found
from pipeline.wishes.trial import Trial
from pipeline.wishes.wish import Limits, Wish, Wishes, exact_limits
from pipeline.wishes.wish_file import WishFile


@dataclass(frozen=True)
class WishResult:
    """A wish and what the design has; numbers in the unit of the quantity."""

    wish: Wish
    pressure_kPa: float
    at_start: tuple[float, ...]  #: of the coarse law; empty where the start has none
    value: tuple[float, ...]  #: of the delivered law
    miss: float  #: distance from the wanted value over the tolerance

    @property
    def is_met(self) -> bool:
        """Whether it is within the tolerance."""
        return self.miss <= 1.0


@dataclass(frozen=True)
class LimitResult:
    """A limit and what the design has, in g, mm, kPa or 1."""

    name: str
    limit: float
    value: float
    is_kept: bool


@dataclass(frozen=True)
class DesignReport:
    """A design for a wish; the same stands in the files of `directory`."""

    directory: Path
    name: str
    start: dict[str, float]  #: mm and kPa, by key
    found: dict[str, float]
    wishes: tuple[WishResult, ...]
    limits: tuple[LimitResult, ...]
    objective: float | None  #: over that at the start; None where nothing is made small
    history: tuple[Trial, ...]
    run: Path | None  #: the results of its run; None where it was left out

    @property
    def given_up(self) -> tuple[str, ...]:
        """The wishes that are not met and the limits that are not kept, one sentence each."""
        sentences = [
            f"{one.wish.name}: {one.wish.text(one.value)} instead of {one.wish.text(one.wish.target)}, "
            f"{one.miss:.2g} times the tolerance away"
            for one in self.wishes
            if not one.is_met
        ]
        kept = [f"{one.name}: {one.value:.4g} instead of {one.limit:.4g}" for one in self.limits if not one.is_kept]
        return (*sentences, *kept)

    def record(self) -> JsonObject:
        """The content of design.json."""
        rows: list[JsonObject] = [
            {
                "quantity": one.wish.quantity,
                "pressure_kPa": one.pressure_kPa,
                "wanted": one.wish.target,
                "within": one.wish.within,
                "at_start": one.at_start,
                "value": one.value,
                "miss": one.miss,
                "is_met": one.is_met,
            }
            for one in self.wishes
        ]
        limits: list[JsonObject] = [dict(vars(one)) for one in self.limits]
        found: JsonObject = {"name": self.name, "start": self.start, "found": self.found, "objective": self.objective}
        return {**found, "wishes": rows, "limits": limits, "given_up": self.given_up}


def report_of(file: WishFile, found: Found, directory: Path, run: Path | None) -> DesignReport:
    """The design that a search has found."""
    wishes, trial = file.wishes, found.trial
    point, start = np.array(trial.point), wishes.start
    values = wishes.values(point)
    parts = wishes.parts(found.numbers.values)
    before = wishes.parts(found.first.values) if found.first else [np.zeros(0)] * len(parts)
    rows = tuple(
        WishResult(wish, wish.pressure(values), _numbers(first), _numbers(part), wish.miss(part))
        for wish, first, part in zip(wishes.wishes, before, parts, strict=True)
    )
    objective = None if np.isnan(trial.objective) else trial.objective
    history, limits = found.history, tuple(_limits(file, found, point))
    return DesignReport(directory, file.name, wishes.values(start), values, rows, limits, objective, history, run)


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _limits(file: WishFile, found: Found, point: Array) -> list[LimitResult]:
    limits: Limits = file.wishes.limits
    wanted = {"mass": limits.mass_g, "smallest_wall": limits.smallest_wall_mm}
    rows = [
        LimitResult(name, wanted[name] or 0.0, value, ratio <= 1.0)
        for name, (ratio, value) in exact_limits(file.wishes, file.config(point)).items()
    ]
    if limits.largest_stretch is not None:
        stretch = found.numbers.stretch
        rows.append(LimitResult("largest_stretch", limits.largest_stretch, stretch, stretch <= limits.largest_stretch))
    if limits.bears is not None:
        highest = file.wishes.highest_kPa(point)
        rows.append(LimitResult("bears_kPa", highest, highest, is_kept=True))
    return rows


def wishes_table(report: DesignReport) -> Table:
    """One row per wish and limit."""
    rows = []
    for one in report.wishes:
        text = one.wish.text
        start = text(one.at_start) if one.at_start else "-"
        met = "yes" if one.is_met else "no"
        rows.append((one.wish.name, text(one.wish.target), text(one.wish.within), start, text(one.value), met))
    for limit in report.limits:
        met = "yes" if limit.is_kept else "no"
        rows.append((limit.name, f"{limit.limit:.4g}", "limit", "", f"{limit.value:.4g}", met))
    heads = ("wish", "wanted", "within", "at the start", "found", "met")
    return Table(heads, tuple(rows), "at the start: of coarse cells; found: of the law that a run delivers")


def dimensions_table(report: DesignReport) -> Table:
    """One row for each dimension and pressure that was free."""
    rows = tuple(
        (key, f"{report.start[key]:.4g}", f"{value:.4g}", f"{100.0 * (value / report.start[key] - 1.0):+.1f}")
        for key, value in report.found.items()
    )
    return Table(("free", "start (mm, kPa)", "found (mm, kPa)", "change (%)"), rows)


def history_rows(wishes: Wishes, history: tuple[Trial, ...]) -> tuple[list[str], list[list[object]]]:
    """Columns and rows of history.csv."""
    keys = [f"{one.key}_{one.unit}" for one in wishes.free]
    names = [f"{wish.name}{f' {axis}' if axis else ''}" for wish in wishes.wishes for axis in _axes(wish)]
    misses = [f"miss of {wish.name}" for wish in wishes.wishes]
    columns = ["number", "start", "law", *keys, *names, *misses, "largest_miss", "objective", "taken", "reason"]
    rows: list[list[object]] = []
    for number, trial in enumerate(history, start=1):
        values = trial.values or (np.nan,) * len(names)
        away = trial.misses or (np.nan,) * len(misses)
        row = [number, trial.start, trial.law, *trial.point, *values, *away]
        rows.append([*row, max(away), trial.objective, "yes" if trial.taken else "no", trial.reason])
    return columns, rows


def _axes(wish: Wish) -> tuple[str, ...]:
    return ("x", "y") if len(wish.target) > 1 else ("",)


def design_page(wishes: Wishes, report: DesignReport, found: Found) -> str:
    """The search and the arm: misses and dimensions by trial, and tips over what was wanted."""
    history = [(number, trial) for number, trial in enumerate(found.history, start=1) if trial.misses]
    panels = [_misses(wishes, history), _dimensions(wishes, history), _tips(wishes, found)]
    return standalone_page(f"{report.name}: a design for a wish", figure(tuple(panels)))


def _misses(wishes: Wishes, history: list[tuple[int, Trial]]) -> Panel:
    lines = [
        Line([n for n, _ in history], [max(t.misses[k], 1e-4) for _, t in history], wish.name, colour, marker="circle")
        for k, (wish, colour) in enumerate(zip(wishes.wishes, COLOURS * len(wishes.wishes), strict=False))
    ]
    lines.append(Line([1, history[-1][0]], [1.0, 1.0], "tolerance", INK, "dash"))
    return Panel("Distance from the wishes", "design tried", "over the tolerance", tuple(lines), log_y=True)


def _dimensions(wishes: Wishes, history: list[tuple[int, Trial]]) -> Panel:
    lines = [
        Line([n for n, _ in history], [t.point[k] / one.start for _, t in history], one.key, colour, "dot", "square")
        for k, (one, colour) in enumerate(zip(wishes.free, COLOURS * len(wishes.free), strict=False))
    ]
    return Panel("What was free", "design tried", "over its start", tuple(lines))


def _tips(wishes: Wishes, found: Found) -> Panel:
    lines = []
    for numbers, name, colour in ((found.first, "start", COLOURS[1]), (found.numbers, "found", COLOURS[0])):
        if numbers is not None:
            names = [wish.name for wish in wishes.wishes]
            x, y = numbers.tips.T
            lines.append(Line(x, y, name, colour, "", "circle", texts=names))
    wanted = np.array([wish.target for wish in wishes.wishes if wish.quantity == "tip"]).reshape(-1, 2)
    if len(wanted):
        lines.append(Line(wanted[:, 0], wanted[:, 1], "wanted", INK, "", "x"))
    return Panel("Tip of the arm without load", "x (mm)", "y (mm)", tuple(lines), lengths=True)
