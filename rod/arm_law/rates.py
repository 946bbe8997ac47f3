"""Derivatives of an arm's own law by a parameter of its design, and the law after a small change of some of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Annotated, Any, final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import interpolate_columns
from rod.arm_law.curves import ACROSS, IN_SPACE, CellCurve, ClampCurve, nothing
from rod.cubics import monotone_slopes, parabola_slopes

#: change of the rigidity between two states, over it, from which there is a kink between them
KINK = 0.05


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class CellRate:
    """Derivatives of the curve of a cell at one pressure, at fixed curvature, per unit of the parameter."""

    moment: Annotated[Array, "moment_N_mm", "k"]  #: N mm
    stretch: Annotated[Array, "stretch", "k"]
    #: of the material curve in the middle and at the end of the cell, mm; straight between
    ripple: Annotated[Array, "ripple_mm", "k", 2, 2]
    largest_stretch: Annotated[Array, "largest_stretch"]  #: largest principal stretch of the cell without moment
    #: N mm2; it and the next empty where not known
    lateral_rigidity: Annotated[Array, "lateral_rigidity_N_mm2", "k"] = field(default_factory=nothing)
    torsional_rigidity: Annotated[Array, "torsional_rigidity_N_mm2", "k"] = field(default_factory=nothing)  #: N mm2

    def times(self, change: float) -> "CellRate":
        """For a change of the parameter."""
        return CellRate(*(change * getattr(self, one.name) for one in fields(self)))


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class ClampRate:
    """Derivatives of the curve of the clamped end at one pressure, at fixed moment, per unit of the parameter."""

    rotation: Annotated[Array, "rotation_rad", "k"]  #: rad
    offset: Annotated[Array, "offset_mm", "k", 2]  #: mm

    def times(self, change: float) -> "ClampRate":
        """For a change of the parameter."""
        return ClampRate(change * self.rotation, change * self.offset)


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class LawRate:
    """Derivatives of a law by one parameter, per unit of it. What is not here hardly changes, to first order."""

    value: Annotated[float, "value"]  #: of the parameter, to which the law belongs
    unit: Annotated[str, "unit"]  #: of the parameter: mm, MPa, or 1
    pitch: Annotated[float, "pitch_mm"]  #: change of the pitch, mm
    first_middle: Annotated[float, "first_middle_mm"]  #: mm
    length: Annotated[float, "length_mm"]  #: mm
    cells: Annotated[tuple[CellRate, ...], "curves"]  #: at the pressures of the law
    clamps: Annotated[tuple[ClampRate, ...], "clamp"]

    def with_moments(self, ratios: Sequence[float], across: Sequence[Array] = ()) -> "LawRate":
        """Derivatives of a law whose moments, and rigidities out of the plane, are multiplied at each pressure.

        across: (n, 2) the factors of the latter, where they are others.
        """
        cells = []
        for cell, ratio, own in zip(self.cells, ratios, across or [np.full(2, ratio) for ratio in ratios], strict=True):
            new = {name: factor * getattr(cell, name) for name, factor in zip(ACROSS, own, strict=True)}
            cells.append(replace(cell, moment=ratio * cell.moment, **new))
        return replace(self, cells=tuple(cells))

    def times(self, change: float) -> "LawRate":
        """For a change of the parameter, whose value stays as it is."""
        lengths = {name: change * getattr(self, name) for name in ("pitch", "first_middle", "length")}
        cells = tuple(cell.times(change) for cell in self.cells)
        return replace(self, **lengths, cells=cells, clamps=tuple(clamp.times(change) for clamp in self.clamps))

    def carried(self, before: Sequence[CellCurve], after: Sequence[CellCurve], change: float) -> "LawRate":
        """The derivatives of a law after small changes of parameters: at each curvature what it was there.

        before, after: the curves of the cells; change: of this parameter.
        """
        cells = tuple(
            CellRate(*(_at(new.kappa, old.kappa, getattr(cell, one.name)) for one in fields(CellRate)))
            for cell, old, new in zip(self.cells, before, after, strict=True)
        )
        return replace(self, cells=cells, value=self.value + change)


def _at(kappa: Array, nodes: Array, values: Array) -> Array:
    """Values (k, ...) over curvatures (k,) at others (n,), (n, ...); one number, or none, stays."""
    return interpolate_columns(kappa, nodes, values) if np.size(values) > 1 else values


def changed_cells(curves: Sequence[CellCurve], changes: Sequence[Sequence[CellRate]]) -> tuple[CellCurve, ...]:
    """The curves after changes of several parameters; raises `RodError` where hardly a state is left.

    changes: of each parameter by curve, times its change. Where walls begin to touch, the moment over the curvature has
    a kink, which the parameter moves: states move along the curve with the kinks beside them (`kink_shifts`), so that
    none comes to lie on the other side of one. States that would pass their neighbour are left out.

    Slopes by the curvature are those of `slopes_of`, slopes by the pressure those of parabolas through neighbouring
    curves at equal curvature. Axial and shear rigidities and volumes stay as they are at equal curvature.
    """
    total = [
        CellRate(*(_sum([getattr(one, column.name) for one in of_curve]) for column in fields(CellRate)))
        for of_curve in zip(*changes, strict=True)
    ]
    slopes = _by_pressure(curves, total)
    return tuple(_changed_cell(*parts) for parts in zip(curves, total, slopes, strict=True))


def _sum(values: Sequence[Array]) -> Array:
    """Of those that are known, of one shape."""
    return np.asarray(np.sum([one for one in values if one.size] or values[:1], axis=0))


def _changed_cell(curve: CellCurve, change: CellRate, by_pressure: tuple[Array, Array]) -> CellCurve:
    shift = kink_shifts(curve, change)
    moment = change.moment + shift * curve.rigidity
    kappa, moments = curve.kappa + shift, curve.moment + moment
    kept = np.array([True, *(np.diff(np.maximum.accumulate(kappa)) > 0.0)])
    kept &= np.array([True, *(np.diff(np.maximum.accumulate(moments)) > 0.0)])
    spread = slopes_of(curve, curve.kappa, shift)
    rigidity = curve.rigidity + slopes_of(curve, curve.kappa, moment) - curve.rigidity * spread
    stretch = change.stretch + shift * curve.stretch_by_kappa
    by_kappa = slopes_of(curve, curve.kappa, stretch) - curve.stretch_by_kappa * spread
    new = {
        "kappa": kappa,
        "moment": moments,
        "rigidity": rigidity,
        "moment_by_pressure": curve.moment_by_pressure + by_pressure[0],
        "stretch": curve.stretch + stretch,
        "stretch_by_kappa": curve.stretch_by_kappa + by_kappa,
        "stretch_by_pressure": curve.stretch_by_pressure + by_pressure[1],
    }
    part = (curve.s - curve.s[0]) / np.ptp(curve.s)
    bulge = (1.0 - part)[:, None] * change.ripple[:, None, 0] + part[:, None] * change.ripple[:, None, 1]
    new["ripple"] = curve.ripple + bulge + shift[:, None, None] * parabola_slopes(curve.kappa, curve.ripple)
    new |= {name: getattr(curve, name) for name in ("contact", "min_J")}
    for name in ("axial_rigidity", "shear_rigidity", *(IN_SPACE if curve.is_in_space else ())):
        new[name] = np.interp(kappa, curve.kappa, getattr(curve, name))
    if curve.volume.size:
        new["volume"] = interpolate_columns(kappa, curve.kappa, curve.volume)
    if curve.is_in_space and change.lateral_rigidity.size:
        new |= {name: new[name] + getattr(change, name) for name in ACROSS}
    return replace(curve, **{name: values[kept] for name, values in new.items()})


def kink_shifts(curve: CellCurve, change: CellRate) -> Array:
    """Shifts of the kinks of a curve near each of its states, (k,) 1/mm; zero where walls touch nowhere.

    Across a kink that moves, the change of the moment at fixed curvature has a step of minus the step of the rigidity
    times the shift of the kink: by least squares over the intervals with a kink, near ones counting more.
    """
    steps, stiffer = np.diff(change.moment), np.diff(curve.rigidity)
    kinks = np.flatnonzero((np.abs(stiffer) > KINK * np.abs(curve.rigidity[:-1])) & curve.contact[1:])
    if not kinks.size:
        return np.zeros_like(curve.moment)
    distance = np.abs(np.arange(len(curve.moment))[:, None] - (kinks + 0.5))
    weight = np.exp(-distance) * stiffer[kinks] ** 2
    return np.asarray(-(weight @ (steps[kinks] / stiffer[kinks])) / weight.sum(axis=1))


def onset_rate(curve: CellCurve, rate: CellRate) -> float:
    """Derivative of the curvature from which on walls touch, 1/mm per unit; NaN where there is none."""
    free = np.flatnonzero(~curve.contact)
    if curve.onset is None:
        return float("nan")
    return float(kink_shifts(curve, rate)[free[-1] : free[-1] + 2].mean())


def slopes_of(curve: CellCurve, x: Array, values: Array) -> Array:
    """Slopes of derivatives (k,) of a curve over its curvatures or moments x (k,).

    Those of parabolas through neighbouring states; where walls begin to touch the derivatives have a step, across which
    only monotone cubics do not overshoot.
    """
    smooth = curve.contact.all() or not curve.contact.any()
    return parabola_slopes(x, values) if smooth else monotone_slopes(x, values)


def _by_pressure(curves: Sequence[CellCurve], rates: Sequence[CellRate]) -> list[tuple[Array, Array]]:
    """Slopes of moment and stretch by the pressure at the curvatures of each curve, (k,) each, per kPa."""
    pressures, slopes = np.array([curve.pressure for curve in curves]), []
    for k, curve in enumerate(curves):
        around = range(max(k - 1, 0), min(k + 2, len(curves)))
        columns = []
        for name in ("moment", "stretch"):
            rows = [np.interp(curve.kappa, curves[i].kappa, getattr(rates[i], name)) for i in around]
            known = parabola_slopes(pressures[list(around)], np.array(rows)) if len(rows) > 1 else np.zeros((1, 1))
            columns.append(np.broadcast_to(known[k - around[0]], curve.kappa.shape))
        slopes.append((columns[0], columns[1]))
    return slopes


def changed_clamps(curves: Sequence[ClampCurve], changes: Sequence[Sequence[ClampRate]]) -> tuple[ClampCurve, ...]:
    """The clamped ends after changes of several parameters: of each parameter by curve, times its change."""
    changed = []
    for curve, of_curve in zip(curves, zip(*changes, strict=True), strict=True):
        new: dict[str, Any] = {}
        for name in ("rotation", "offset"):
            value = np.sum([getattr(change, name) for change in of_curve], axis=0)
            slope = parabola_slopes(curve.moment, value) if len(curve.moment) > 1 else np.zeros_like(value)
            by_moment = f"{name}_by_moment"
            new |= {name: getattr(curve, name) + value, by_moment: getattr(curve, by_moment) + slope}
        changed.append(replace(curve, **new))
    return tuple(changed)
