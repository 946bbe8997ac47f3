"""Two curves of a cell at neighbouring places of a path through pressures, joined at a place between them.

The path is that of one pressure, whose place is the pressure itself, or leads from one ratio of two pressures to
another (`rod.arm_law.pairs`). In what follows p is the place.

Where walls begin to touch, the moment over the curvature has a kink. Walls that meet because the arm bends do so at one
curvature, whatever the pressure; walls that meet because they bulge do so at a curvature that changes with the
pressure. Two kinks of the second kind, joined at equal curvatures or moments, would be spread over all curvatures
between them. States of equal curvature are therefore joined, or states equally far from the onset of contact: straight
lines lead from kappa_1 at p_1 to kappa_2 at p_2, and along each of them the moment is a cubic with the exact slopes of
the cell,

    dM/dp along the line = dM/dp + (dM/dkappa) (kappa_2 - kappa_1) / (p_2 - p_1),

and so is the stretch. Of both sets of lines that one is taken for which the moments in the middle that follow from the
slopes of the first and of the second curve differ less. Where one of the curves ends before the other is free of
moment, as those of chambers that swell, states are joined that lie equally far from the one without moment.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.curves import CellCurve, CurveAt, has_unloaded
from rod.cubics import cubic, cubic_slope, hermite
from rod.errors import RodError

#: pairs of states
PAIRS = 257
#: for the moment at a curvature: parts of an interval in the table of first guesses, iterations, and the smallest slope
#: dkappa/dM in them, over that where the cell is most rigid
PARTS, ITERATIONS, SMALLEST = 8, 4, 0.1


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class Joined:
    """Pairs of states of two curves, and the states between them at one place, by increasing curvature."""

    t: float  #: 0 at the place of the first curve, 1 at that of the second
    first: Array  #: (n,) moments on the first curve, N mm
    second: Array  #: (n,) moments on the second
    moment: Array  #: (n,) between, rising, N mm
    kappa: Array  #: (n,) 1/mm
    stretch: Array  #: (n,)
    first_slope: Array  #: (n,) change of the moment along the line at its first end, for the whole step, N mm
    second_slope: Array  #: (n,) the same at its second end

    def straight(self, values: tuple[Array, Array], nodes: tuple[Array, Array]) -> Array:
        """Values (k, ...) over moments (k,) of each curve, joined by straight lines, (n, ...)."""
        low, high = (
            interpolate_columns(self.first, nodes[0], values[0]),
            interpolate_columns(self.second, nodes[1], values[1]),
        )
        return np.asarray((1 - self.t) * low + self.t * high)


def measure_disagreement(first: CurveAt[CellCurve], second: CurveAt[CellCurve]) -> tuple[Array, Array]:
    """Curvatures (PAIRS,) at the place halfway between two curves, and by how much what the slopes of either curve
    predict there differs, (PAIRS,), both in 1/mm."""
    lines = _best(first, second)
    return (lines.low.kappa + lines.high.kappa) / 2.0, lines.differences


def join_states(first: CurveAt[CellCurve], second: CurveAt[CellCurve], place: float) -> Joined:
    """The states at a place between those of two curves.

    States whose moment does not exceed that of all states of smaller curvature are left out: where two kinks nearly
    meet, the cubics of neighbouring lines may cross. Raises `RodError` for curves without a curvature in common.
    """
    lines = _best(first, second)
    low, high = lines.low, lines.high
    t = (place - first.place) / (second.place - first.place)
    moment = hermite(t, low.moment, high.moment, low.moment_slope, high.moment_slope)
    stretch = hermite(t, low.stretch, high.stretch, low.stretch_slope, high.stretch_slope)
    rises = np.diff(np.maximum.accumulate(moment), prepend=-np.inf) > 0.0
    values = (low.moment, high.moment, moment, (1 - t) * low.kappa + t * high.kappa, stretch)
    slopes = low.moment_slope, high.moment_slope
    return Joined(t, *(column[rises] for column in (*values, *slopes)))


def interpolate_columns(at: Array, nodes: Array, values: Array) -> Array:
    """Values (k, ...) over nodes (k,) at positions (n,), by straight lines, (n, ...)."""
    flat = values.reshape(len(nodes), -1)
    rows = [np.interp(at, nodes, column) for column in flat.T]
    return np.stack(rows, axis=1).reshape(len(at), *values.shape[1:])


@dataclass(frozen=True, eq=False)  # arrays inside
class _States:
    """States of one curve at the ends of the lines, all (PAIRS,); slopes along the lines, for the whole step."""

    kappa: Array  #: 1/mm
    moment: Array  #: N mm
    moment_slope: Array
    stretch: Array
    stretch_slope: Array
    rigidity: Array  #: N mm2


@dataclass(frozen=True, eq=False)  # arrays inside
class _Lines:
    low: _States
    high: _States

    @cached_property
    def differences(self) -> Array:
        """Difference in the middle of what the slopes of both ends predict, over the rigidity, 1/mm."""
        low, high = self.low, self.high
        difference = low.moment + 0.5 * low.moment_slope - (high.moment - 0.5 * high.moment_slope)
        return np.asarray(2.0 * np.abs(difference) / (low.rigidity + high.rigidity))


@lru_cache(maxsize=64)  # places are compared by identity; a law has a dozen neighbours
def _best(first: CurveAt[CellCurve], second: CurveAt[CellCurve]) -> _Lines:
    """The lines whose ends agree best on what is between them."""
    return min(_lines(first, second), key=lambda lines: float(lines.differences.mean()))


def _lines(first_place: CurveAt[CellCurve], second_place: CurveAt[CellCurve]) -> list[_Lines]:
    """Lines of equal curvatures, and those of states equally far from the onset of contact where both curves have one.

    Raises `RodError` for curves without a curvature in common.
    """
    first, second = first_place.curve, second_place.curve
    lowest, last = (first.kappa[0], second.kappa[0]), min(first.kappa[-1], second.kappa[-1])
    ways = [[lowest, _halfway(max(lowest), last), (last, last)]]
    if first.onset is not None and second.onset is not None:
        onsets = first.onset, second.onset
        ways.append([lowest, onsets, _halfway(max(onsets), last), (last, last)])
    if all(has_unloaded(curve.moment) for curve in (first, second)):
        free, highest = (first.at(0.0)[0], second.at(0.0)[0]), (first.kappa[-1], second.kappa[-1])
        if max(free) >= last:
            before, after = np.all(np.diff([lowest, free, highest], axis=0) > 0.0, axis=1).tolist()
            ways = [[*[lowest] * before, free, *[highest] * after]]
    step = second_place.place - first_place.place
    lines = []
    for way in ways:
        ends = np.array(way)
        if np.any(np.diff(ends, axis=0) <= 0.0):
            continue
        means = ends.mean(axis=1)
        a, b = (np.interp(np.linspace(means[0], means[-1], PAIRS), means, ends[:, k]) for k in range(2))
        lines.append(_Lines(_states(first_place, a, b - a, step), _states(second_place, b, b - a, step)))
    if not lines:
        raise RodError(f"The curves of {first.pressure:g} and {second.pressure:g} kPa have no curvature in common.")
    return lines


def _halfway(low: float, high: float) -> tuple[float, float]:
    """Equal curvatures from which on the curves are joined at equal curvatures."""
    return (0.5 * (low + high),) * 2


def _states(at: CurveAt[CellCurve], kappa: Array, shift: Array, step: float) -> _States:
    """The states of a curve at curvatures (n,), 1/mm.

    shift: (n,) change of the curvature along the lines, 1/mm; step: that of the place.
    """
    curve = at.curve
    moment = _moments_at(curve, kappa)
    rigidity = 1.0 / np.interp(kappa, curve.kappa, 1.0 / curve.rigidity)
    by_place, stretch_by_kappa, stretch_by_place = (
        np.interp(kappa, curve.kappa, values)
        for values in (at.slopes["moment"], curve.stretch_by_kappa, at.slopes["stretch"])
    )
    return _States(
        kappa=kappa,
        moment=moment,
        moment_slope=by_place * step + rigidity * shift,
        stretch=curve.on(moment)[1],
        stretch_slope=stretch_by_place * step + stretch_by_kappa * shift,
        rigidity=rigidity,
    )


def _moments_at(curve: CellCurve, kappa: Array) -> Array:
    """Moments (n,) in N mm at curvatures (n,) in 1/mm within a curve, by Newton's method on its cubics."""
    parts = np.linspace(0.0, 1.0, PARTS, endpoint=False)
    table = np.append((curve.moment[:-1, None] + parts * np.diff(curve.moment)[:, None]).ravel(), curve.moment[-1])
    on_table = np.maximum.accumulate(curve.on(table)[0])
    row = np.clip(np.searchsorted(on_table, kappa, side="right") - 1, 0, len(table) - 2)
    moment = np.interp(kappa, on_table, table)
    cubics = curve.moment, curve.kappa, 1.0 / curve.rigidity
    for _ in range(ITERATIONS):
        slope = np.maximum(cubic_slope(*cubics, moment), SMALLEST / curve.rigidity.max())
        moment = np.clip(moment - (cubic(*cubics, moment) - kappa) / slope, table[row], table[row + 1])
    return np.asarray(moment)
