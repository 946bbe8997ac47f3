"""The law at one pressure, tabulated over the moment as the integrator reads it.

Along a curve of one pressure kappa(M) and stretch(M) are joined by cubics with the exact slopes of the cell (Hermite).
Between two pressures the states that belong together are joined (`rod.arm_law.between`), rigidities by straight lines,
and what a section bulges by cubics in the pressure (`_beyond_straight`). Nothing is extrapolated.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from geometry.arrays import Array
from rod.arm_law.between import Joined, interpolate_columns, join_states
from rod.arm_law.curves import IN_SPACE, CellCurve, ClampCurve, CurveAt, TipCurve, has_unloaded
from rod.cubics import cubic, cubic_slope, hermite, monotone_cubic, monotone_slopes, parabola_slopes
from rod.errors import RodError
from rod.same_pressure import known_at

Curve = TypeVar("Curve", CellCurve, ClampCurve, TipCurve)
Bent = TypeVar("Bent", CellCurve, ClampCurve)

#: moments of the table
POINTS = 257
#: how far rigidity and dstretch/dkappa between two pressures may lie beyond those of the states that are joined, over
#: the larger one: where walls meet the joined lines may cross, and their derivatives by the moment tell nothing there
BEYOND = 0.25
#: moments of the clamped end between two pressures
CLAMP_POINTS = 65
#: of a tip, interpolated between pressures
TIP_VALUES = ("beside", "edge", "couple", "acts_at", "beside_held", "beside_pinned", "pinned_by_pull", "volume")


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
    in_space: Mapping[str, Array]  #: rigidities out of the plane as in `CellCurve`, by name; empty where not known
    volume: Array  #: (POINTS, c) air per rest length in each cavity, mm2; empty where not known

    @property
    def kappa_0(self) -> float:
        """Curvature without moment, 1/mm; raises `RodError` where the law does not reach it."""
        if not has_unloaded(self.moment):
            raise RodError(f"The law at {self.pressure:g} kPa has no point without moment.")
        return float(cubic(self.moment, self.kappa, self.kappa_slope, 0.0))


def section_at(path: Sequence[CurveAt[CellCurve]], place: float, pressure: float) -> SectionLaw:
    """The law at a place between those of the curves, where the pressure is so high (kPa).

    Raises `RodError` outside the places of the curves, and for curves that have no curvature in common.
    """
    lower, upper, _ = bracket([at.place for at in path], place)
    first, second = path[lower].curve, path[upper].curve
    if lower == upper:
        return _along(first)
    pairs = join_states(path[lower], path[upper], place)
    moment = np.linspace(pairs.moment[0], pairs.moment[-1], POINTS)
    kappa, stretch = (
        (pairs.moment, column, monotone_slopes(pairs.moment, column)) for column in (pairs.kappa, pairs.stretch)
    )

    sides, around = ((pairs.first, first), (pairs.second, second)), _around(path, lower, upper)

    def straight(name: str) -> Array:
        column = pairs.straight((getattr(first, name), getattr(second, name)), (first.moment, second.moment))
        return interpolate_columns(moment, pairs.moment, column)

    def in_space(name: str) -> Array:
        low, high = _smooth(pairs.first, first, name), _smooth(pairs.second, second, name)
        return interpolate_columns(moment, pairs.moment, (1.0 - pairs.t) * low + pairs.t * high)

    def near(name: str, values: Array) -> Array:
        """Values (n,) no farther from those of both curves than `BEYOND` of the larger one."""
        ends = [
            interpolate_columns(moment, pairs.moment, interpolate_columns(at, curve.moment, getattr(curve, name)))
            for at, curve in sides
        ]
        margin = BEYOND * np.max(np.abs(ends), axis=0)
        return np.clip(values, np.min(ends, axis=0) - margin, np.max(ends, axis=0) + margin)

    with np.errstate(divide="ignore"):
        kappa_slope = 1.0 / near("rigidity", 1.0 / cubic_slope(*kappa, moment))
    return SectionLaw(
        pressure,
        moment,
        cubic(*kappa, moment),
        kappa_slope,
        cubic(*stretch, moment),
        kappa_slope * near("stretch_by_kappa", cubic_slope(*stretch, moment) / kappa_slope),
        straight("axial_rigidity"),
        straight("shear_rigidity"),
        first.s,
        straight("ripple") + _beyond_straight_at(around, lambda curve, at: _over(at, curve, "ripple"), place, moment),
        {name: in_space(name) for name in IN_SPACE if first.is_in_space and second.is_in_space},
        _volumes(around, in_space, place, cubic(*kappa, moment)),
    )


def _volumes(
    around: Sequence[CurveAt[CellCurve]], straight: Callable[[str], Array], place: float, kappa: Array
) -> Array:
    """(n, c) mm2 at curvatures (n,), which decide more than moments do; empty where a curve has none.

    around: the curves of `_around`; straight: gives a column of two curves, joined by straight lines.
    """
    if not all(at.curve.volume.size for at in around):
        return np.empty(0)

    def at(curve: CellCurve, kappa: Array) -> Array:
        return monotone_cubic(curve.kappa, curve.volume, kappa)

    return straight("volume") + _beyond_straight_at(around, at, place, kappa, "kappa")


def _along(curve: CellCurve) -> SectionLaw:
    """The law at the pressure of a curve."""
    moment = np.linspace(curve.moment[0], curve.moment[-1], POINTS)
    kappa = (curve.moment, curve.kappa, 1.0 / curve.rigidity)
    stretch = (curve.moment, curve.stretch, curve.stretch_by_kappa / curve.rigidity)
    return SectionLaw(
        curve.pressure,
        moment,
        cubic(*kappa, moment),
        cubic_slope(*kappa, moment),
        cubic(*stretch, moment),
        cubic_slope(*stretch, moment),
        _over(moment, curve, "axial_rigidity"),
        _over(moment, curve, "shear_rigidity"),
        curve.s,
        interpolate_columns(moment, curve.moment, curve.ripple),
        {name: _smooth(moment, curve, name) for name in IN_SPACE if curve.is_in_space},
        _smooth(moment, curve, "volume") if curve.volume.size else curve.volume,
    )


def _over(moment: Array, curve: CellCurve, name: str) -> Array:
    return interpolate_columns(moment, curve.moment, getattr(curve, name))


def _smooth(moment: Array, curve: CellCurve, name: str) -> Array:
    """By cubics: the derivatives of rigidities out of the plane bend the rod in it."""
    return monotone_cubic(curve.moment, getattr(curve, name), moment)


def bracket(pressures: Sequence[float], pressure: float) -> tuple[int, int, float]:
    """The neighbouring entries of rising pressures and the position between them, 0 to 1; twice the same entry where
    the pressure is that of one. Raises `RodError` outside."""
    p = np.asarray(pressures, float)
    if (known := known_at(p, pressure)) is not None:
        return known, known, 0.0
    if not p[0] < pressure < p[-1]:
        raise RodError(
            f"The law goes from {p[0]:g} to {p[-1]:g} kPa; {pressure:g} kPa is outside, and it is not extrapolated."
        )
    upper = int(np.searchsorted(p, pressure))
    return upper - 1, upper, float((pressure - p[upper - 1]) / (p[upper] - p[upper - 1]))


def clamp_at(
    path: Sequence[CurveAt[ClampCurve]], cells: Sequence[CurveAt[CellCurve]], place: float, pressure: float
) -> ClampCurve:
    """The clamped end at a place, as `section_at`, from the states that belong together in the cells.

    Its rotation is a cubic in p with the slopes of both curves, offset and material curve are those of
    `_beyond_straight`, all else follows straight lines. Raises `RodError` as `section_at` does.
    """
    lower, upper, _ = bracket([at.place for at in path], place)
    first, second = path[lower].curve, path[upper].curve
    if lower == upper:
        return first
    pairs = join_states(cells[lower], cells[upper], place)
    moment = _moments_in_common(pairs, first, second)
    around = _around(path, lower, upper)

    def between(low: Array, high: Array) -> Array:
        return interpolate_columns(moment, pairs.moment, (1 - pairs.t) * low + pairs.t * high)

    def straight(values: Callable[[ClampCurve, Array], Array]) -> Array:
        return between(values(first, pairs.first), values(second, pairs.second))

    step = path[upper].place - path[lower].place
    low, low_slope = _rotations(path[lower], pairs.first, pairs.first_slope, step)
    high, high_slope = _rotations(path[upper], pairs.second, pairs.second_slope, step)
    rotation = interpolate_columns(moment, pairs.moment, hermite(pairs.t, low, high, low_slope, high_slope))
    offset = straight(ClampCurve.offset_at) + _beyond_straight_at(around, ClampCurve.offset_at, place, moment)
    volume, a, b = np.empty(0), first.lateral_compliance, second.lateral_compliance
    if all(at.curve.volume.size for at in around):
        volume = straight(ClampCurve.volume_at) + _beyond_straight_at(around, ClampCurve.volume_at, place, moment)
    return ClampCurve(
        pressure=pressure,
        moment=moment,
        rotation=rotation,
        rotation_by_moment=parabola_slopes(moment, rotation),
        rotation_by_pressure=between(
            first.slopes_at(first.rotation_by_pressure, pairs.first),
            second.slopes_at(second.rotation_by_pressure, pairs.second),
        ),
        offset=offset,
        offset_by_moment=parabola_slopes(moment, offset),
        s=first.s,
        beside=straight(ClampCurve.beside_at) + _beyond_straight_at(around, ClampCurve.beside_at, place, moment),
        lateral_compliance=(1 - pairs.t) * a + pairs.t * b if a.size and b.size else np.empty(0),
        volume=volume,
    )


def _moments_in_common(pairs: Joined, first: ClampCurve, second: ClampCurve) -> Array:
    """Moments (n,) of the states that both curves have. Raises `RodError` where they have none in common."""
    known = (pairs.first >= first.moment[0]) & (pairs.first <= first.moment[-1])
    known &= (pairs.second >= second.moment[0]) & (pairs.second <= second.moment[-1])
    if known.sum() < 2:
        raise RodError(f"The ends at {first.pressure:g} and {second.pressure:g} kPa have no state in common.")
    in_common = pairs.moment[known]
    return np.linspace(in_common[0], in_common[-1], CLAMP_POINTS)


def _rotations(at: CurveAt[ClampCurve], moment: Array, slope: Array, step: float) -> tuple[Array, Array]:
    """Of a curve at moments (n,), and their changes along the lines for a whole step of the place."""
    curve = at.curve
    inside = np.clip(moment, curve.moment[0], curve.moment[-1])
    by_moment = cubic_slope(curve.moment, curve.rotation, curve.rotation_by_moment, inside)
    by_place = curve.slopes_at(at.slopes["rotation"], moment)
    return curve.rotation_at(moment), by_place * step + by_moment * slope


def tip_at(path: Sequence[CurveAt[TipCurve]], place: float, pressure: float) -> TipCurve:
    """The tip at a place, as `section_at`, by cubics over the place."""
    lower, upper, t = bracket([at.place for at in path], place)
    a, b = path[lower].curve, path[upper].curve
    if lower == upper:
        return a
    around = _around(path, lower, upper)
    places = [at.place for at in around]

    def value(name: str) -> Array:
        straight = (1 - t) * getattr(a, name) + t * getattr(b, name)
        rows = np.array([getattr(at.curve, name) for at in around])
        return np.asarray(straight + _beyond_straight(places, rows, place))

    names = TIP_VALUES if all(at.curve.volume.size for at in around) else TIP_VALUES[:-1]
    return TipCurve(pressure, a.s, *(value(name) for name in names))


def _around(path: Sequence[CurveAt[Curve]], lower: int, upper: int) -> Sequence[CurveAt[Curve]]:
    """The two curves of an interval, and one on each side where there is one."""
    return path[max(lower - 1, 0) : upper + 2]


def _beyond_straight_at(
    around: Sequence[CurveAt[Bent]],
    values: Callable[[Bent, Array], Array],
    place: float,
    at: Array,
    over: str = "moment",
) -> Array:
    """`_beyond_straight` at moments (n,) in N mm; beyond those that all curves have, as at the last such moment.

    values: gives those of a curve at such moments, (n, ...). over: the field of the curves that takes their place.
    """
    curves = [one.curve for one in around]
    nodes = [getattr(curve, over) for curve in curves]
    low, high = max(own[0] for own in nodes), min(own[-1] for own in nodes)
    if low > high:
        return np.zeros(())
    inside = np.clip(at, low, high)
    rows = np.array([values(curve, inside) for curve in curves])
    return _beyond_straight([one.place for one in around], rows, place)


def _beyond_straight(places: Sequence[float], rows: Array, place: float) -> Array:
    """By how much a cubic in p departs from the straight line between two neighbouring rows (k, ...).

    Walls that bulge do so less and less as the pressure rises. The slopes are those of monotone cubics through all
    rows, at the first and at the last pressure those of a parabola through both rows of the interval. Zero for two rows
    in all. places: (k,), those of `_around`.
    """
    if len(places) < 3:
        return np.zeros(())
    lower, upper, t = bracket(places, place)
    step = places[upper] - places[lower]
    change = (rows[upper] - rows[lower]) / step
    slopes = monotone_slopes(np.asarray(places), rows)[lower : upper + 1]
    if lower == 0:
        slopes[0] = 2.0 * change - slopes[1]
    if upper == len(places) - 1:
        slopes[1] = 2.0 * change - slopes[0]
    # the cubic that is zero at both ends of the interval and has there the differences of the slopes
    steps = (slopes - change) * step
    return hermite(t, np.zeros(()), np.zeros(()), steps[0], steps[1])
