"""The law at one pressure, tabulated over the moment as the integrator reads it.

Along a curve of one pressure kappa(M) and stretch(M) are joined by cubics with the exact slopes of the cell (Hermite).
Between two pressures both are joined likewise at equal moments, with the exact slopes by the pressure,

    dkappa/dp at fixed M = -(dM/dp) / (dM/dkappa),

and rigidities by straight lines. Nothing is extrapolated: the table ends where one of the two curves ends.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from geometry.arrays import Array
from rod.arm_law.curves import CellCurve, ClampCurve, TipCurve
from rod.law import RodError

#: moments of the table
POINTS = 257


@dataclass(frozen=True, eq=False)  # arrays inside
class SectionLaw:
    """kappa and stretch over equally spaced moments at one pressure; all arrays (POINTS,) unless said."""

    pressure: float  #: kPa
    moment: Array  #: N mm, equally spaced
    kappa: Array  #: 1/mm
    kappa_slope: Array  #: dkappa/dM, 1/(N mm2)
    stretch: Array
    stretch_slope: Array  #: dstretch/dM, 1/(N mm)
    axial_rigidity: Array  #: EA, N
    shear_rigidity: Array  #: GA, N
    s: Array  #: (m,) along half a cell, mm
    ripple: Array  #: (POINTS, m, 2) mm

    @property
    def kappa_0(self) -> float:
        """Curvature without moment, 1/mm; raises `RodError` where the law does not reach it."""
        if not self.moment[0] <= 0.0 <= self.moment[-1]:
            raise RodError(f"The law at {self.pressure:g} kPa has no point without moment.")
        return float(CubicHermiteSpline(self.moment, self.kappa, self.kappa_slope)(0.0))


def section_at(curves: Sequence[CellCurve], pressure: float) -> SectionLaw:
    """The law at a pressure in kPa; raises `RodError` outside the pressures of the curves."""
    lower, upper, t = bracket([curve.pressure for curve in curves], pressure)
    first, second = curves[lower], curves[upper]
    low, high = max(first.moment[0], second.moment[0]), min(first.moment[-1], second.moment[-1])
    if not low < high:
        raise RodError(f"The curves of {first.pressure:g} and {second.pressure:g} kPa have no moment in common.")
    moment = np.linspace(low, high, POINTS)
    step = second.pressure - first.pressure
    ends = [_resampled(curve, moment) for curve in (first, second)]
    values = {}
    for name in ("kappa", "stretch"):
        (a, da), (b, db) = ((end[name], end[f"{name}_by_pressure"]) for end in ends)
        values[name] = hermite(t, a, b, step * da, step * db)
    linear = {name: (1 - t) * ends[0][name] + t * ends[1][name] for name in ("axial", "shear", "ripple")}
    slopes = {name: (1 - t) * ends[0][f"{name}_slope"] + t * ends[1][f"{name}_slope"] for name in ("kappa", "stretch")}
    if lower != upper:  # the slopes of the joined values themselves
        slopes = {name: np.gradient(values[name], moment, edge_order=2) for name in values}
    return SectionLaw(
        pressure,
        moment,
        values["kappa"],
        slopes["kappa"],
        values["stretch"],
        slopes["stretch"],
        linear["axial"],
        linear["shear"],
        first.s,
        linear["ripple"],
    )


def bracket(pressures: Sequence[float], pressure: float) -> tuple[int, int, float]:
    """The neighbouring entries of rising pressures and the position between them, 0 to 1; twice the same entry where
    the pressure is that of one. Raises `RodError` outside."""
    p = np.asarray(pressures, float)
    exact = np.flatnonzero(np.abs(p - pressure) <= 1e-9 * max(1.0, abs(pressure)))
    if exact.size:
        return int(exact[0]), int(exact[0]), 0.0
    if not p[0] < pressure < p[-1]:
        raise RodError(f"The law goes from {p[0]:g} to {p[-1]:g} kPa; {pressure:g} kPa is outside.")
    upper = int(np.searchsorted(p, pressure))
    return upper - 1, upper, float((pressure - p[upper - 1]) / (p[upper] - p[upper - 1]))


def hermite(t: float, a: Array, b: Array, da: Array, db: Array) -> Array:
    """The cubic at t between a (t = 0) and b (t = 1) with the slopes da and db per unit of t."""
    h00, h10 = (1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2
    h01, h11 = t**2 * (3 - 2 * t), t**2 * (t - 1)
    return np.asarray(h00 * a + h10 * da + h01 * b + h11 * db)


def _resampled(curve: CellCurve, moment: Array) -> dict[str, Array]:
    """Values of one curve at moments (n,) within it, and their slopes by moment and by pressure at fixed moment."""
    kappa = CubicHermiteSpline(curve.moment, curve.kappa, 1.0 / curve.rigidity)
    stretch = CubicHermiteSpline(curve.moment, curve.stretch, curve.stretch_by_kappa / curve.rigidity)
    kappa_by_pressure = -curve.moment_by_pressure / curve.rigidity
    stretch_by_pressure = curve.stretch_by_pressure + curve.stretch_by_kappa * kappa_by_pressure
    nodes = curve.moment
    flat = curve.ripple.reshape(len(nodes), -1)
    ripple = np.stack([np.interp(moment, nodes, column) for column in flat.T], axis=1)
    return {
        "kappa": kappa(moment),
        "kappa_slope": kappa(moment, 1),
        "kappa_by_pressure": np.interp(moment, nodes, kappa_by_pressure),
        "stretch": stretch(moment),
        "stretch_slope": stretch(moment, 1),
        "stretch_by_pressure": np.interp(moment, nodes, stretch_by_pressure),
        "axial": np.interp(moment, nodes, curve.axial_rigidity),
        "shear": np.interp(moment, nodes, curve.shear_rigidity),
        "ripple": ripple.reshape(len(moment), *curve.ripple.shape[1:]),
    }


def clamp_at(curves: Sequence[ClampCurve], pressure: float) -> ClampCurve:
    """The clamped end at a pressure in kPa: straight lines in p at equal moments."""
    lower, upper, t = bracket([curve.pressure for curve in curves], pressure)
    first, second = curves[lower], curves[upper]
    if lower == upper:
        return first
    low, high = max(first.moment[0], second.moment[0]), min(first.moment[-1], second.moment[-1])
    if not low < high:
        raise RodError(f"The ends at {first.pressure:g} and {second.pressure:g} kPa have no moment in common.")
    moment = np.linspace(low, high, 41)

    def joined(name: str) -> Array:
        parts = []
        for curve in (first, second):
            values = getattr(curve, name)
            flat = values.reshape(len(curve.moment), -1)
            columns = [np.interp(moment, curve.moment, column) for column in flat.T]
            parts.append(np.stack(columns, axis=1).reshape(len(moment), *values.shape[1:]))
        return np.asarray((1 - t) * parts[0] + t * parts[1])

    return ClampCurve(
        pressure=pressure,
        moment=moment,
        rotation=joined("rotation"),
        rotation_by_moment=joined("rotation_by_moment"),
        offset=joined("offset"),
        offset_by_moment=joined("offset_by_moment"),
        s=first.s,
        beside=joined("beside"),
    )


def tip_at(curves: Sequence[TipCurve], pressure: float) -> TipCurve:
    """The tip at a pressure in kPa: straight lines in p."""
    lower, upper, t = bracket([curve.pressure for curve in curves], pressure)
    a, b = curves[lower], curves[upper]
    return TipCurve(
        pressure,
        (1 - t) * a.rotation + t * b.rotation,
        (1 - t) * a.couple + t * b.couple,
        a.s,
        (1 - t) * a.beside + t * b.beside,
    )
