"""The figures of the report, made from the results of a run. Figs 8, 10 and 16 of the paper have the same form."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from pipeline.results.rod_errors import rod_to_take
from pipeline.values import plots
from pipeline.values.formats import ARM_LAW, CURVE_PREFIXES, FIVE
from pipeline.values.plots import COLOURS, GREY, INK, Line, Panel, ordered_colour
from pipeline.values.run import Curve, RodError, Run, bending_error_deg
from rod.arm_law.kinds import Law
from rod.errors import RodError as NoRod
from rod.load import Load

FINITE_ELEMENTS = "finite elements"
EXPERIMENTS = {
    "I": "Experiment I: free under pressure",
    "II": "Experiment II: clamped, under pressure",
    "III": "Experiment III: clamped, with the end held",
}
#: forms of an arm with a limit of the pressure: name, colour and dash of their angles
FORMS = {
    "rising": ("inflated from rest", COLOURS[1], "solid"),
    "unstable": ("unstable, along the volume of its air", GREY, "dash"),
    "swollen": ("after the snap", COLOURS[2], "solid"),
}
#: lengths of a cell at each end of an arm within which averages over a cell are not those of inner cells
END_CELLS = 1.5
#: parts of the rows of pressures at which the tip is drawn, and points from one row to the next
PARTS, BETWEEN = (0.25, 0.5, 0.75, 0.9, 1.0), 6


@dataclass(frozen=True)
class _Drawn:
    """How the curves of a rod are drawn."""

    rod: str
    entry: str
    dash: str
    marker: str

    def column(self, curve: Curve, quantity: str) -> Array | None:
        """x_mm, y_mm or kappa_per_mm (n,) of the rod beside a curve of the finite elements; None without it.

        The rod is at the arc lengths s_mm of the curve.
        """
        name = quantity if quantity == "s_mm" else f"{CURVE_PREFIXES[self.rod]}_{quantity}"
        return curve[name] if curve.has(name) else None

    def tip_mm(self, curve: Curve) -> tuple[float, float] | None:
        """Position of the end of the rod from its clamped end, mm; None where the rod is not there."""
        x, y = self.column(curve, "x_mm"), self.column(curve, "y_mm")
        return None if x is None or y is None else (float(x[-1] - x[0]), float(y[-1] - y[0]))


_DRAWN = {
    FIVE: _Drawn(FIVE, "rod, five parameters", "dash", "circle-open"),
    ARM_LAW: _Drawn(ARM_LAW, "rod, the arm's own law", "dot", "square-open"),
}


#: pairs of axes beside each other; none where there is nothing to draw
Panels = tuple[Panel, ...]


def bending(run: Run) -> Panels:
    """Bending angle over pressure and path of the tip in experiment II: finite elements, and the rod to take.

    Error bars of the rod are the error that the verdict gives, of rod and mesh together.
    """
    curves, rod = run.curves_of("II"), rod_to_take(run)
    at = _rod_tips(run, rod[0], curves) if rod else []
    if not (curves or at):
        return ()
    start = [0.0] if run.parameters.straight_without_pressure else []
    pressures = np.array([*start, *(curve.pressure_kPa for curve in curves)])
    bent = np.array([*start, *(run.bending_deg(curve.pressure_kPa) for curve in curves)])
    tips = np.array([*[(run.length_mm, 0.0)] * len(start), *(curve.tip_mm for curve in curves)])
    texts = [f"{FINITE_ELEMENTS}, {p:g} kPa" for p in pressures]
    angle = [Line(pressures, bent, FINITE_ELEMENTS, COLOURS[0], marker="circle")] if curves else []
    path = [Line(tips[:, 0], tips[:, 1], FINITE_ELEMENTS, COLOURS[0], marker="circle", texts=texts)] if curves else []
    if rod and at:
        drawn, error = _DRAWN[rod[0]], run.length_mm * rod[1].shape
        reached, angles, rod_tips = (np.array(column) for column in zip(*at, strict=True))
        turned = np.array([bending_error_deg(error, tip) for tip in rod_tips])
        entry = drawn.entry + (" on a finer mesh" if rod[0] == ARM_LAW and run.is_accurate else "")
        turns = Line(reached, angles, entry, INK, "", drawn.marker, marker_size=12, spread=turned)
        angle += [*_forms(run), turns]
        path.append(replace(turns, x=rod_tips[:, 0], y=rod_tips[:, 1], spread=np.full(len(at), error)))
    return (
        Panel("Bending angle over pressure", "p (kPa)", "bending angle (°)", tuple(angle)),
        Panel("Path of the tip", "x (mm)", "y (mm)", tuple(path), lengths=True),
    )


def _forms(run: Run) -> tuple[Line, ...]:
    """The angle over the pressure of an arm whose chambers swell at a limit of it: both forms, and what is between."""
    law = run.law if run.law and run.law.plane and run.law.plane.limit else None
    angles = law.angles if law else {}
    return tuple(
        Line(angles[form][:, 0], angles[form][:, 1], *drawn) for form, drawn in FORMS.items() if form in angles
    )


def _rod_tips(run: Run, rod: str, curves: Sequence[Curve]) -> list[tuple[float, float, tuple[float, float]]]:
    """Pressures (kPa) with how far a rod bends (degrees) and its end (mm): by the law delivered, or beside curves."""
    if rod == ARM_LAW:
        return [(at.pressure_kPa, at.bending_deg, at.tip_mm) for at in run.law.unloaded] if run.law else []
    tips = [(curve.pressure_kPa, tip) for curve in curves if (tip := _DRAWN[rod].tip_mm(curve))]
    return [(p, run.parameters.rods().at(p).solve().bending_deg, tip) for p, tip in tips]


def of_experiment(run: Run, experiment: str) -> Panels:
    """Shape and curvature of the material curve; empty where no pressure was reached."""
    curves = run.curves_of(experiment)
    if not curves:
        return ()
    rods = list(_DRAWN.values())
    shape = _compared(run, curves, ("x_mm", "y_mm"), rods)
    curvature = _compared(run, curves, ("s_mm", "kappa_per_mm"), rods if experiment == "III" else ())
    return Panel("Shape", "x (mm)", "y (mm)", shape, lengths=True), Panel("Curvature", "s (mm)", "κ (1/mm)", curvature)


def validation_shapes(run: Run) -> Panels:
    """The material curve under each load that nothing was fitted to."""
    curves = sorted(run.validation_curves, key=lambda curve: curve.pressure_kPa)
    groups = {
        "Other heights of the end, other pressures": [c for c in curves if c.experiment != "dead"],
        "Dead force on the end": [c for c in curves if c.experiment == "dead"],
    }
    rods = list(_DRAWN.values())
    return tuple(
        Panel(title, "x (mm)", "y (mm)", _compared(run, shown, ("x_mm", "y_mm"), rods), lengths=True)
        for title, shown in groups.items()
        if shown
    )


def moments(run: Run) -> Panels:
    """Moment in III over the change of curvature against II, both averaged over a cell: finite elements and rod.

    The rod is averaged as the finite elements are, so that both can be compared.
    """
    lines: list[Line] = []
    drawn = _DRAWN[FIVE]
    for pressure in run.identified_kPa:
        if not (pair := _pair(run, pressure)):
            continue
        loaded, free = pair
        inside = _estimated(free)
        moment = loaded["moment_N_mm"][inside]
        change = (loaded["kappa_per_mm"] - free["kappa_per_mm"])[inside]
        at, name = _colour(run, pressure), f"{pressure:g} kPa"
        lines.append(_dots(change, moment, f"{FINITE_ELEMENTS}, {name}", at, name))
        rod, rest = drawn.column(loaded, "kappa_per_mm"), drawn.column(free, "kappa_per_mm")
        if rod is not None and rest is not None:
            lines.append(
                Line((rod - rest)[inside], moment, f"{drawn.entry}, {name}", at, entry=drawn.entry, frame=name)
            )
    return (Panel("Moment over change of curvature", "κ − κ₀ (1/mm)", "M (N mm)", tuple(lines)),) if lines else ()


def rigidities(run: Run) -> Panels:
    """α₁ and α₂ over the pressure, with their standard deviations and the lines of slope β₁ and β₂."""
    pressures = np.array(run.identified_kPa)
    lines: list[Line] = []
    for number, symbol in ((1, "α₁"), (2, "α₂")):
        key, colour = f"alpha{number}_N_mm2", COLOURS[number - 1]
        values, spread = (np.array(getattr(run.parameters, name), dtype=float) for name in (key, f"{key}_std"))
        lines.append(Line(pressures, values, symbol, colour, dash="", marker="circle", spread=spread))
        slope = getattr(run.parameters, f"beta{number}_N_mm2_per_kPa")
        if slope is not None and len(pressures) > 1:
            ends = pressures[[0, -1]]
            line = np.nanmean(values) + slope * (ends - pressures.mean())
            lines.append(Line(ends, line, f"slope of {symbol}", colour, "dash", width=1.4, entry=""))
    if not len(pressures):
        return ()
    return (Panel("Bending rigidities", "p (kPa)", "α (N mm²)", tuple(lines), from_zero=True),)


def end_forces(run: Run) -> Panels:
    """The end force over the pressure, finite elements and rods, for every prescribed height of the end."""
    rods = [drawn for drawn in _DRAWN.values() if drawn.rod in run.rods]
    rows = [row for row in run.errors_of(rods[0].rod) if row.force_N is not None] if rods else []
    lines = []
    for k, load in enumerate(sorted({row.load for row in rows})):
        title, colour = load or "as in experiment III", COLOURS[k % len(COLOURS)]
        lines.append(
            _forces([row for row in rows if row.load == load], "force_N", f"{FINITE_ELEMENTS}, {title}", colour)
        )
        for drawn in rods:
            of_rod = [row for row in run.errors_of(drawn.rod) if row.load == load and row.rod_force_N is not None]
            name = f"{drawn.entry}, {title}"
            lines.append(_forces(of_rod, "rod_force_N", name, colour, drawn.marker, drawn.entry))
    panel = Panel("Force that holds the end", "p (kPa)", "force (N)", tuple(lines), from_zero=True)
    return (panel,) if lines else ()


def arm_law(run: Run) -> Panels:
    """Moment over curvature of a cell, and finite elements in III away from the ends of the arm."""
    lines: list[Line] = []
    for pressure in run.pressures_kPa:
        curves = run.law.curves(pressure) if run.law else None
        if curves is None:
            continue
        cell, _ = curves
        colour, name = _colour(run, pressure), f"{pressure:g} kPa"
        lines.append(
            Line(cell.kappa, cell.moment, f"the arm's own law, {name}", colour, entry="the arm's own law", frame=name)
        )
        if cell.contact.any():
            there = cell.kappa[cell.contact], cell.moment[cell.contact]
            lines.append(Line(*there, f"walls touch, {name}", INK, "", "x", entry="walls touch", frame=name))
        if (pair := _pair(run, pressure)) is not None:
            lines.append(_inner_cells(run, pair, colour, name))
    return (Panel("Moment of a cell over its curvature", "κ (1/mm)", "M (N mm)", tuple(lines)),) if lines else ()


def reach(run: Run) -> Panels:
    """The tips that an arm with several pressures reaches without a load, on the way from each row to the next one."""
    law = run.law.law if run.law else None
    if run.law is None or law is None or not len(around := run.law.ring(BETWEEN)):
        return ()
    lines = []
    for k, part in enumerate(PARTS):
        name, colour, given = f"{part * around.max():g} kPa", ordered_colour(k, len(PARTS)), part * around
        x, y, z = np.array([_tip(law, pressures) for pressures in given]).T
        texts = [f"{', '.join(f'{value:.4g}' for value in pressures)} kPa" for pressures in given]
        lines.append(Line(x, y, name, colour, marker="circle", marker_size=2, texts=texts, entry="", z=z, frame=name))
    return (Panel("Where the tip can be, by the largest pressure", "x (mm)", "y (mm)", tuple(lines), z="z (mm)"),)


def _tip(law: Law, pressures: Array) -> tuple[float, float, float]:
    """Not finite where the arm has no equilibrium."""
    try:
        return law.at(tuple(pressures.tolist())).solve_in_space(Load()).end
    except NoRod:
        return np.nan, np.nan, np.nan


def _inner_cells(run: Run, pair: tuple[Curve, Curve], colour: str, name: str) -> Line:
    """Changes of curvature from II to III, added to κ₀ in the middle, without the ends of the arm."""
    loaded, free = pair
    s, length, ends = loaded["s_mm"], run.length_mm, END_CELLS * run.averaging_mm
    middle = np.interp(length / 2.0, s, free["kappa_per_mm"])
    kappa = loaded["kappa_per_mm"] - free["kappa_per_mm"] + middle
    inner = (s > ends) & (s < length - ends)
    return _dots(kappa[inner], loaded["moment_N_mm"][inner], f"{FINITE_ELEMENTS}, {name}", colour, name)


def _pair(run: Run, pressure: float) -> tuple[Curve, Curve] | None:
    """III and II at one pressure at the same points, with the moment of III; None where they are not there."""
    free, loaded = run.curve("II", pressure), run.curve("III", pressure)
    if free is None or loaded is None or not loaded.has("moment_N_mm") or len(free["s_mm"]) != len(loaded["s_mm"]):
        return None
    return loaded, free


def _dots(x: Array, y: Array, name: str, colour: str, frame: str) -> Line:
    return Line(x, y, name, colour, "", "circle", marker_size=4, opacity=0.7, entry=FINITE_ELEMENTS, frame=frame)


def _colour(run: Run, pressure: float) -> str:
    known = run.pressures_kPa
    return ordered_colour(int(np.argmin(np.abs(np.array(known) - pressure))), len(known))


def _compared(run: Run, curves: Sequence[Curve], axes: tuple[str, str], rods: Sequence[_Drawn]) -> tuple[Line, ...]:
    """Two columns of curves of the finite elements, and the same of the rods that are there."""
    lines = []
    for curve in curves:
        frame, (x, y) = f"{curve.pressure_kPa:g} kPa", axes
        label, colour = ", ".join(filter(None, (curve.load, frame))), _colour(run, curve.pressure_kPa)
        spread = curve["kappa_std_per_mm"] if y == "kappa_per_mm" and curve.has("kappa_std_per_mm") else None
        name = f"{FINITE_ELEMENTS}, {label}"
        lines.append(Line(curve[x], curve[y], name, colour, spread=spread, entry=FINITE_ELEMENTS, frame=frame))
        for drawn in rods:
            along, across = (drawn.column(curve, axis) for axis in axes)
            if along is not None and across is not None:
                name = f"{drawn.entry}, {label}"
                lines.append(Line(along, across, name, INK, drawn.dash, width=1.6, entry=drawn.entry, frame=frame))
    return tuple(lines)


def _forces(
    rows: Sequence[RodError], key: str, name: str, colour: str, marker: str = "circle", entry: str = FINITE_ELEMENTS
) -> Line:
    ordered = sorted(rows, key=lambda row: row.pressure_kPa)
    pressures, forces = (np.array([getattr(row, k) for row in ordered], dtype=float) for k in ("pressure_kPa", key))
    size = 7.0 if marker == "circle" else 11.0
    return Line(pressures, forces, name, colour, "", marker, marker_size=size, entry=entry)


def _estimated(curve: Curve) -> Array:
    """Points at which the curvature is an estimate (n,): the ends of a curve repeat the value of the nearest cell."""
    changes = np.flatnonzero(np.diff(curve["kappa_per_mm"]))
    inside = np.ones(len(curve["s_mm"]), dtype=bool)
    if len(changes):
        inside[: changes[0]] = False
        inside[changes[-1] + 2 :] = False
    return inside


#: the figures of the report by the names that its template gives them
FIGURES: dict[str, Callable[[Run], Panels]] = {
    "bending": bending,
    "moments": moments,
    "rigidities": rigidities,
    "validation": validation_shapes,
    "forces": end_forces,
    "arm_law": arm_law,
    "reach": reach,
}


def make_figures(run: Run) -> dict[str, str | dict[str, str]]:
    """All figures of the report by their names; empty texts for those without data."""
    experiments = {title: plots.figure(of_experiment(run, name)) for name, title in EXPERIMENTS.items()}
    return {
        "experiments": {title: drawn for title, drawn in experiments.items() if drawn},
        **{name: plots.figure(panels(run)) for name, panels in FIGURES.items()},
    }
