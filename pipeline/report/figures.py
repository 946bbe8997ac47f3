"""The figures of the report, each one or two charts made from the result files.

Figs 8, 10 and 16 of the paper (K. M. de Payrebrune, O. M. O'Reilly) have the same form.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.arrays import Array
from pipeline.report.chart import Chart, Marks
from pipeline.report.results import Curve, Results
from pipeline.report.validation import recommended_rod, rod_errors
from pipeline.store.formats import CURVE_PREFIXES
from pipeline.validation.rods import ARM_LAW, EXTENSIBLE, FIVE


@dataclass(frozen=True)
class DrawnRod:
    """A rod in the tables of curves, and how it is drawn."""

    rod: str  #: one of the names in `pipeline.validation.rods`
    name: str  #: of its curves
    entry: "Entry"

    def column(self, curve: Curve, quantity: str) -> Array | None:
        """Its x_mm, y_mm or kappa_per_mm (n,) beside a curve of the finite elements; None where it is not there."""
        name = f"{CURVE_PREFIXES[self.rod]}_{quantity}"
        return curve[name] if curve.has(name) else None


@dataclass(frozen=True)
class Entry:
    """What a line style or a colour means."""

    style: str  #: as in `Marks`, with the class of a colour
    text: str


@dataclass(frozen=True)
class Figure:
    """Charts beside each other, with one legend and, where they are of several pressures, one slider."""

    charts: tuple[Chart, ...]
    legend: tuple[Entry, ...]
    pressures: tuple[float, ...]  #: kPa, at which the slider stops; fewer than two: no slider


_FIVE = DrawnRod(FIVE, "rod", Entry("rod", "rod, five parameters"))
_EXTENSIBLE = DrawnRod(EXTENSIBLE, "rod that stretches", Entry("rod", "rod that stretches, five parameters"))
_ARM_LAW = DrawnRod(ARM_LAW, "rod of the arm's own law", Entry("own", "rod, the arm's own law"))


def of_experiment(results: Results, experiment: str) -> Figure | None:
    """Shape and curvature of the material curve, finite elements and rod; None where no pressure was reached."""
    curves = sorted((c for c in results.curves if c.experiment == experiment), key=lambda curve: curve.pressure_kPa)
    if not curves:
        return None
    rods = _drawn(results)
    shape = Chart("Shape", "x (mm)", "y (mm)", _shapes(results, curves, rods), lengths=True)
    curvature = Chart("Curvature", "s (mm)", "κ (1/mm)", _curvatures(results, curves, rods))
    return _figure(results, [curve.pressure_kPa for curve in curves], [shape, curvature], _entries(curves, rods))


def validation_shapes(results: Results) -> Figure | None:
    """The material curve under each load that the parameters were not fitted to: finite elements and rod."""
    curves = sorted(results.validation_curves, key=lambda curve: curve.pressure_kPa)
    groups = {
        "Other heights of the end, other pressures": [c for c in curves if c.experiment != "dead"],
        "Dead force on the end": [c for c in curves if c.experiment == "dead"],
    }
    rods = _drawn(results)
    charts = [
        Chart(title, "x (mm)", "y (mm)", _shapes(results, of_group, rods), lengths=True)
        for title, of_group in groups.items()
        if of_group
    ]
    if not charts:
        return None
    return _figure(results, [curve.pressure_kPa for curve in curves], charts, _entries(curves, rods))


def moments(results: Results) -> Figure | None:
    """Bending moment in III over the change of curvature against II, with the lines of the rod: two or a single one."""
    marks: list[Marks] = []
    pressures = []
    for pressure in results.pressures:
        if not (pair := results.loaded_and_free(pressure)):
            continue
        loaded, free = pair
        inside = _estimated(free)
        change = (loaded["kappa_per_mm"] - free["kappa_per_mm"])[inside]
        moment, s = loaded["moment_N_mm"][inside], loaded["s_mm"][inside]
        name = f"finite elements, {pressure:g} kPa"
        marks.append(Marks(change, moment, name, "dots", colour(results, pressure), pressure))
        marks += _fitted_lines(results, pressure, s[np.isfinite(change)], change[np.isfinite(change)])
        pressures.append(pressure)
    if not marks:
        return None
    entries = [Entry("dots", "finite elements"), Entry("line", "lines of the rod")]
    entries += [Entry("single", "a single line, for comparison")] * any(mark.style == "single" for mark in marks)
    chart = Chart("Moment over change of curvature", "κ − κ₀ (1/mm)", "M (N mm)", tuple(marks))
    return _figure(results, pressures, [chart], entries)


def rigidities(results: Results) -> Figure | None:
    """α₁ and α₂ over pressure, with their standard deviations and the lines of slope β₁ and β₂."""
    pressures = np.array(results.parameters.get("pressures_kPa", ()), dtype=float)
    marks: list[Marks] = []
    for number, style in ((1, "first"), (2, "second")):
        key = f"alpha{number}_N_mm2"
        values = _numbers(results.parameters.get(key))
        if len(values) != len(pressures) or not len(values):
            continue
        spread = _numbers(results.parameters.get(f"{key}_std"))
        symbol = f"α{'₁₂'[number - 1]}"
        slope = results.parameters.get(f"beta{number}_N_mm2_per_kPa")
        if slope is not None and len(pressures) > 1:
            ends = pressures[[0, -1]]
            line = np.nanmean(values) + slope * (ends - pressures.mean())
            marks.append(Marks(ends, line, f"slope of {symbol}", f"slope {style}"))
        for k, pressure in enumerate(pressures):
            point = slice(k, k + 1)
            half = spread[point] if len(spread) == len(values) else None
            name = f"{symbol}, {pressure:g} kPa"
            marks.append(Marks(pressures[point], values[point], name, "dot", number + 19, spread=half))
    if not marks:
        return None
    entries = (Entry("dot p20", "α₁"), Entry("dot p21", "α₂"), Entry("slope", "slopes β₁, β₂"))
    chart = Chart("Bending rigidities", "p (kPa)", "α (N mm²)", tuple(marks), from_zero=True)
    return Figure((chart,), entries, ())


def end_forces(results: Results) -> Figure | None:
    """The end force over the pressure, finite elements and rods, for every prescribed height of the end."""
    rods = [drawn for drawn in _drawn(results) if drawn.rod in results.rods]
    rows = [row for drawn in rods[:1] for row in results.rows_of(drawn.rod) if row.force_N is not None]
    loads = sorted({row.load for row in rows})
    marks: list[Marks] = []
    for number, load in enumerate(loads):
        title = load or "as identified"
        marks.append(
            _forces([r for r in rows if r.load == load], "force_N", f"finite elements, {title}", "dot", number)
        )
        for drawn, style in zip(rods, ("ring", "square"), strict=False):
            of_rod = [row for row in results.rows_of(drawn.rod) if row.load == load and row.rod_force_N is not None]
            marks.append(_forces(of_rod, "rod_force_N", f"{drawn.rod}, {title}", style, number))
    if not marks:
        return None
    styles = [Entry("dot", "finite elements")]
    styles += [Entry(style, drawn.entry.text) for drawn, style in zip(rods, ("ring", "square"), strict=False)]
    loads_shown = [Entry(f"line p{30 + k % 6}", load or "as identified") for k, load in enumerate(loads)]
    chart = Chart("Force that holds the end", "p (kPa)", "force (N)", tuple(marks), from_zero=True)
    return Figure((chart,), (*styles, *loads_shown), ())


def colour(results: Results, pressure: float) -> int:
    """The number of the colour of a pressure, 0 (lowest) to 9 (highest)."""
    pressures = results.pressures
    if len(pressures) < 2:
        return 5
    return round(float(np.interp(pressure, pressures, np.linspace(0.0, 9.0, len(pressures)))))


def _figure(results: Results, pressures: Sequence[float], charts: Sequence[Chart], entries: Sequence[Entry]) -> Figure:
    distinct = tuple(sorted(set(pressures)))
    swatches = [Entry(f"line p{colour(results, pressure)}", f"{pressure:g} kPa") for pressure in distinct]
    return Figure(tuple(charts), (*swatches, *entries), distinct)


def _drawn(results: Results) -> list[DrawnRod]:
    """The rods that are drawn: of those with five parameters the one that stretches only where it is to be taken and
    its curves are there, which earlier versions did not write; and the one with the arm's own law."""
    there = any(_EXTENSIBLE.column(curve, "x_mm") is not None for curve in results.curves)
    stretches = there and recommended_rod(rod_errors(results)) == EXTENSIBLE
    return [_EXTENSIBLE if stretches else _FIVE, _ARM_LAW]


def _entries(curves: Sequence[Curve], rods: Sequence[DrawnRod]) -> list[Entry]:
    """The finite elements, and the rods that at least one of the curves has."""
    shown = [drawn.entry for drawn in rods if any(drawn.column(curve, "x_mm") is not None for curve in curves)]
    return [Entry("line", "finite elements"), *shown]


def _shapes(results: Results, curves: Sequence[Curve], rods: Sequence[DrawnRod]) -> tuple[Marks, ...]:
    marks = []
    for curve in curves:
        label = ", ".join(filter(None, (curve.load, f"{curve.pressure_kPa:g} kPa")))
        at = (colour(results, curve.pressure_kPa), curve.pressure_kPa)
        marks.append(Marks(curve["x_mm"], curve["y_mm"], f"finite elements, {label}", "line", *at))
        for drawn in rods:
            x, y = drawn.column(curve, "x_mm"), drawn.column(curve, "y_mm")
            if x is not None and y is not None:
                marks.append(Marks(x, y, f"{drawn.name}, {label}", drawn.entry.style, None, curve.pressure_kPa))
    return tuple(marks)


def _curvatures(results: Results, curves: Sequence[Curve], rods: Sequence[DrawnRod]) -> tuple[Marks, ...]:
    marks = []
    for curve in curves:
        label, at = f"{curve.pressure_kPa:g} kPa", (colour(results, curve.pressure_kPa), curve.pressure_kPa)
        spread = curve["kappa_std_per_mm"] if curve.has("kappa_std_per_mm") else None
        marks.append(Marks(curve["s_mm"], curve["kappa_per_mm"], f"finite elements, {label}", "line", *at, spread))
        for drawn in rods:
            kappa, style = drawn.column(curve, "kappa_per_mm"), drawn.entry.style
            if curve.experiment == "III" and kappa is not None:
                marks.append(Marks(curve["s_mm"], kappa, f"{drawn.name}, {label}", style, None, curve.pressure_kPa))
    return tuple(marks)


def _forces(rows: Sequence[Any], key: str, name: str, style: str, number: int) -> Marks:
    ordered = sorted(rows, key=lambda row: row.pressure_kPa)
    pressures, forces = (np.array([getattr(row, k) for row in ordered], dtype=float) for k in ("pressure_kPa", key))
    return Marks(pressures, forces, name, style, 30 + number % 6)


def _estimated(curve: Curve) -> Array:
    """Points at which the curvature is an estimate (n,): the ends of a curve repeat the value of the nearest cell."""
    kappa = curve["kappa_per_mm"]
    changes = np.flatnonzero(np.diff(kappa))
    inside = np.ones(len(kappa), dtype=bool)
    if len(changes):
        inside[: changes[0]] = False
        inside[changes[-1] + 2 :] = False
    return inside


def _fitted_lines(results: Results, pressure: float, s: Array, change: Array) -> list[Marks]:
    """The lines of the rod over the changes of curvature (n,) of their part of s (n,): two and, for comparison, a
    single one over all of them, or the single one alone where the rod has that."""
    d, number = results.break_mm(pressure), colour(results, pressure)
    pieces = [("line" if d is None else "single", "single_line_alpha_N_mm2", "single_line_m0_N_mm", change)]
    if d is not None:
        pieces.append(("line", "alpha1_N_mm2", "m01_N_mm", change[s <= d]))
        pieces.append(("line", "alpha2_N_mm2", "m02_N_mm", change[s >= d]))
    marks = []
    for style, slope, height, part in pieces:
        alpha, m0 = results.at(slope, pressure), results.at(height, pressure)
        if alpha is not None and m0 is not None and len(part):
            ends = np.array([part.min(), part.max()])
            name = f"{'single' if d is None or style == 'single' else 'fitted'} line, {pressure:g} kPa"
            marks.append(Marks(ends, alpha * ends + m0, name, style, None if style == "single" else number, pressure))
    return marks


def _numbers(values: Any) -> Array:
    return np.array([np.nan if value is None else value for value in values or ()], dtype=float)
