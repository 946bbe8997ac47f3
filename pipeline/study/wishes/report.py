"""A design that was found, beside what was wanted: values, tables, a page with pictures, and what stands in its way."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.study.wishes.search import OF_LAW, Refusal, SearchResult, Trial
from pipeline.study.wishes.step import Model, propose
from pipeline.study.wishes.wish import Wish, Wishes, WishFile, exact_limits
from pipeline.values.errors import RunFailed
from pipeline.values.json_values import JsonObject
from pipeline.values.law import DRAFT
from pipeline.values.page import Section, page
from pipeline.values.plots import COLOURS, INK, Line, Panel, ordered_colour
from pipeline.values.table import Table

#: changes of logarithms that are tried, and distance from a bound or a limit at which a design stands at it
STEPS, AT = [0.02 * k for k in range(1, 21)], 0.01
#: part of the largest miss that is left at most where something is in the way
LEFT = 0.9
#: limits, the unit in their names, and the direction in which they are lifted
LIMITS = (("mass", "_g", 1.0), ("largest_stretch", "", 1.0), ("smallest_wall", "_mm", -1.0))


def active_constraints(model: Model) -> tuple[str, ...]:
    """A sentence for each bound, limit and material without which nothing would be missed, or else less."""
    before, told, met = model.worth(np.log(model.point)).misses.max(), dict[int, str](), set[int]()
    for step in STEPS:
        for number, (wider, words) in enumerate(_wider(model, step)):
            worth = wider.worth(np.log(propose(wider, STEPS[-1])))
            if number not in met and worth.is_within(1.0):
                told[number] = f"{words} nothing would be missed"
                met.add(number)
            elif number not in met and (miss := worth.misses.max()) < LEFT * before and np.all(worth.limits <= 1.0):
                told[number] = f"{words} the largest miss would be {miss:.2g} instead of {before:.2g} tolerances"
    return tuple(told[number] for number in sorted(met or told))


def _wider(model: Model, step: float) -> Iterator[tuple[Model, str]]:
    """The model where one bound, one limit or the material gives way by a change of its logarithm, and words for it."""
    wishes, numbers, far = model.file.wishes, model.numbers, float(np.exp(step))
    for k, one in enumerate(wishes.free):
        for name, bound, beyond in (("low", one.low, one.low / far), ("high", one.high, one.high * far)):
            if abs(np.log(model.point[k] / bound)) < AT:
                moved: Any = {name: beyond}
                free = (*wishes.free[:k], replace(one, **moved), *wishes.free[k + 1 :])
                at = f"{one.key} is at its bound, {bound:.4g} {one.unit}; at {beyond:.3g} {one.unit}"
                yield _changed(model, free=free), at
    for name, unit, side in LIMITS if np.any(model.limits(np.log(model.point)) > 1.0 - AT) else ():
        if (limit := getattr(wishes.limits, name + unit)) is not None:
            limits: Any = replace(wishes.limits, **{name + unit: limit * far**side})
            at = f"at {limit * far**side:.3g} {unit[1:]}".rstrip()
            yield _changed(model, limits=limits), f"limits.{name}, {limit:.4g} {unit[1:]}, is in the way; {at}"
    for side, word in ((1.0, "soft"), (-1.0, "stiff")):
        change, is_power = side * step * numbers.by_stiffness, wishes.powers & (numbers.values != 0.0)
        ratios = np.where(is_power, np.exp(change / np.where(is_power, numbers.values, 1.0)), 1.0)
        stiff = replace(numbers, values=np.where(is_power, ratios * numbers.values, numbers.values + change))
        words = f"the material is too {word}; with {far**side:.2g} times its moduli"
        yield replace(model, numbers=stiff), words


def _changed(model: Model, **changes: Any) -> Model:
    return replace(model, file=replace(model.file, wishes=replace(model.file.wishes, **changes)))


#: the files of a design: configuration, numbers, search, picture
FILES = ("design.yaml", "design.json", "history.csv", "design.html")


@dataclass(frozen=True)
class WishResult:
    """A wish and what the design has; numbers in the unit of the quantity."""

    number: int  #: in the file, from 1 on
    wish: Wish
    pressure_kPa: float
    at_start: tuple[float, ...]  #: of coarse cells; empty where the start has none
    value: tuple[float, ...]  #: of the law of its run, or of the law that a run delivers
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

    source: Path
    directory: Path
    name: str
    start: dict[str, float]  #: mm and kPa, by key
    found: dict[str, float]
    wishes: tuple[WishResult, ...]
    limits: tuple[LimitResult, ...]
    objective: float | None  #: what was made small; None where nothing was
    history: tuple[Trial | Refusal, ...]
    run: Path | None  #: the results of its run; None where it was left out
    behind: tuple[str, ...]  #: what stands in the way where something is missed, and what lies beyond it
    bounds: tuple[str, ...] = ()  #: at which a dimension or pressure stands, a clause each
    draft: bool = False  #: whether its numbers are of laws whose error is not known

    @property
    def given_up(self) -> tuple[str, ...]:
        """The wishes that are not met and the limits that are not kept, one clause each."""
        wishes = [
            f"wishes[{one.number}], {one.wish.name}, is {one.wish.text(one.value)} instead of "
            f"{one.wish.text(one.wish.target)}, {one.miss:.2g} times the tolerance away"
            for one in self.wishes
            if not one.is_met
        ]
        limits = [
            f"limits.{one.name} is {one.value:.4g} instead of {one.limit:.4g}" for one in self.limits if not one.is_kept
        ]
        return (*wishes, *limits)

    def worth(self, file: WishFile) -> tuple[float, ...]:
        """What is missed, what is made small, and how far wishes are missed."""
        unit = file.start.mass_tonne if file.wishes.minimize == "mass" else None
        return len(self.given_up), (unit or 1.0) * (self.objective or 0.0), sum(one.miss**2 for one in self.wishes)

    @property
    def tables(self) -> tuple[Table, Table]:
        """What was free, and the wishes."""
        return dimensions_table(self), wishes_table(self)

    def raise_if_missed(self) -> None:
        """Raise RunFailed where a wish is missed, or a limit."""
        if self.given_up:
            count = len(self.wishes) + len(self.limits)
            missed = f"{self.source}: {len(self.given_up)} of {count} wishes and limits are missed"
            nearest = f"{self.directory / FILES[0]} is the nearest design"
            told = "; ".join((*self.given_up, *self.behind, nearest))
            raise RunFailed(f"{missed}: {told}", directory=self.directory)

    def record(self) -> JsonObject:
        """The content of design.json."""
        wishes: list[JsonObject] = []
        for one in self.wishes:
            wished: JsonObject = {"wanted": one.wish.target, "within": one.wish.within}
            more: JsonObject = {name: getattr(one, name) for name in ("at_start", "value", "miss", "is_met")}
            wishes.append({"quantity": one.wish.quantity, "pressure_kPa": one.pressure_kPa, **wished, **more})
        limits: list[JsonObject] = [dict(vars(one)) for one in self.limits]
        found: JsonObject = {"name": self.name, "start": self.start, "found": self.found, "objective": self.objective}
        return {
            **found,
            "draft": self.draft,
            "wishes": wishes,
            "limits": limits,
            "given_up": self.given_up,
            "behind": self.behind,
            "bounds": self.bounds,
        }


def report_of(
    file: WishFile, found: SearchResult, directory: Path, run: Path | None = None, in_run: Array | None = None
) -> DesignReport:
    """The design that a search has found; in_run: (m,) numbers of the law of its run, where it has one."""
    wishes, trial, first = file.wishes, found.trial, found.history[0]
    numbers, values = trial.numbers.values if in_run is None else in_run, wishes.values(trial.point)
    before = wishes.parts(first.numbers.values) if isinstance(first, Trial) else [np.zeros(0)] * len(wishes.wishes)
    rows = zip(wishes.wishes, before, wishes.parts(numbers), wishes.misses(numbers), strict=True)
    results = tuple(
        WishResult(number, wish, wish.pressure(values), tuple(start.tolist()), tuple(value.tolist()), float(miss))
        for number, (wish, start, value, miss) in enumerate(rows, start=1)
    )
    limits = tuple(_limits(file, trial.numbers.stretch, trial.point))
    objective = None if np.isnan(trial.worth.objective) else trial.worth.objective
    start = wishes.values(wishes.start)
    ends = ((one, bound) for one in wishes.free for bound in (one.low, one.high))
    way = () if trial.worth.is_within(1.0) else active_constraints(Model(file, trial.point, trial.numbers))
    return DesignReport(
        *(file.source, directory, file.name, start, values, results, limits, objective, found.history, run, way),
        bounds=tuple(f"{e.key}, {b:.4g} {e.unit}" for e, b in ends if abs(np.log(values[e.key] / b)) < AT),
        draft=file.draft and in_run is None,
    )


def _limits(file: WishFile, stretch: float, point: Array) -> list[LimitResult]:
    limits = file.wishes.limits
    rows = [
        LimitResult(name, ratio * value if name == "smallest_wall" else value / ratio, value, ratio <= 1.0)
        for name, (ratio, value) in exact_limits(file.wishes, file.config(point)).items()
    ]
    if limits.largest_stretch is not None:
        rows.append(LimitResult("largest_stretch", limits.largest_stretch, stretch, stretch <= limits.largest_stretch))
    if limits.bears is not None:
        highest = limits.bears * file.wishes.pressures_kPa(point)[-1]
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
    law = f"a {DRAFT}" if report.draft else "the law that a run delivers" if report.run is None else "its run"
    return Table(heads, tuple(rows), f"at the start: of coarse cells; found: of {law}")


def dimensions_table(report: DesignReport) -> Table:
    """One row for each dimension and pressure that was free."""
    rows = tuple(
        (key, f"{report.start[key]:.4g}", f"{value:.4g}", f"{100.0 * (value / report.start[key] - 1.0):+.1f}")
        for key, value in report.found.items()
    )
    caption = f"at its bound: {'; '.join(report.bounds)}" if report.bounds else ""
    return Table(("free", "start (mm, kPa)", "found (mm, kPa)", "change (%)"), rows, caption)


def history_rows(wishes: Wishes, history: tuple[Trial | Refusal, ...]) -> tuple[list[str], list[list[object]]]:
    """Columns and rows of history.csv."""
    keys = [f"{one.key}_{one.unit}" for one in wishes.free]
    names = [f"{wish.name}{axis}" for wish in wishes.wishes for axis in ((" x", " y") if wish.target[1:] else ("",))]
    misses = [f"miss of {wish.name}" for wish in wishes.wishes]
    columns = ["number", "start", "law", *keys, *names, *misses, "largest_miss", "objective", "taken", "reason"]
    rows: list[list[object]] = []
    for number, trial in enumerate(history, start=1):
        head = [number, trial.start, trial.law, *trial.point.tolist()]
        if isinstance(trial, Refusal):
            rows.append([*head, *[np.nan] * (len(names) + len(misses) + 2), "no", trial.reason])
            continue
        away = trial.worth.misses.tolist()
        taken = "yes" if trial.taken else "no"
        rows.append([*head, *trial.numbers.values.tolist(), *away, max(away), trial.worth.objective, taken, ""])
    return columns, rows


def design_page(wishes: Wishes, report: DesignReport, found: Trial) -> str:
    """The arm at the start and as it was found, and the search: misses and dimensions by design that was tried."""
    shown = [(number, trial) for number, trial in enumerate(report.history, start=1) if isinstance(trial, Trial)]
    count = [number for number, _ in shown]

    def lines(names: Sequence[str], marker: str, value: Callable[[Trial], Array]) -> list[Line]:
        rows = np.array([value(trial) for _, trial in shown]).T
        return [
            Line(count, row, name, COLOURS[k % len(COLOURS)], marker=marker)
            for k, (name, row) in enumerate(zip(names, rows, strict=True))
        ]

    misses = lines([one.name for one in wishes.wishes], "circle", lambda t: np.maximum(t.worth.misses, 1e-4))
    misses.append(Line([1, count[-1]], [1.0, 1.0], "tolerance", INK, "dash"))
    laws = [(number, float(trial.worth.misses.max())) for number, trial in shown if trial.law == OF_LAW]
    of_law, largest = np.array(laws).T
    misses.append(Line(of_law, largest, "largest, delivered law", INK, "", "circle-open", marker_size=13.0))
    free = lines([one.key for one in wishes.free], "square", lambda trial: trial.point / wishes.start)
    panels = (
        Panel("Distance from the wishes", "design tried", "over the tolerance", tuple(misses), log_y=True),
        Panel("What was free", "design tried", "over its start", tuple(free)),
    )
    arms = ("start", shown[0][1].numbers.curves, "dot"), ("found", found.numbers.curves, "solid")
    bent = [
        Line(x, y, f"{name}, {at}", ordered_colour(k, len(curves)), dash, entry=name, frame=at)
        for name, curves, dash in arms
        for k, (at, (x, y)) in enumerate((at, curve.T) for at, curve in curves.items())
    ]
    arm = Panel("The arm to scale", "x (mm)", "y (mm)", tuple(bent), lengths=True, flat=True)
    return page(f"{report.name}: a design for a wish", Section(panels=[arm]), Section(panels=panels))
