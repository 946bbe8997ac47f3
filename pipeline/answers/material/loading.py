"""First loading of a test: without unloading, later cycles, what follows a break, and the slack at the start."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.signal import find_peaks

from geometry.arrays import Array, Index, Mask
from pipeline.answers.material.table import MIN_POINTS, PULLED, Series, Specimen, read_table
from pipeline.values.errors import InputError, argument

#: part of the range of strains by which the strain has to go back or beyond earlier strains; less is scatter
LEAST_RETURN = 0.05
#: fewest points on the way from one turn to the next, in the mean: rows in any order turn at every second point
POINTS_PER_WAY = 4
#: the stress before a break and after it over the largest stress, and the part of the strains within which it falls
BEFORE_BREAK, AFTER_BREAK, BREAK_WITHIN = 0.8, 0.5, 0.05
#: the steepest part is sought among windows of this strain that begin below the second one, and below a part of the
#: largest strain
WINDOW, LAST_START, PART = 0.4, 0.15, 0.25
#: slope of a window over the largest one from which it is the steepest: the first of these is taken
STEEPEST = 0.95
#: smallest slack that is taken away, over its standard error too, and the largest one
LEAST_SLACK, CERTAIN, LARGEST_SLACK = 0.003, 2.0, 0.2
#: strains of the start over which a stress e + c e^2 is judged, the least of them, and the least c of compression in
#: positive numbers: rubbers have 1.4 to 10 there, in tension -1.3 to 0.4; Ogden's exponent 5.5 has 0.8 in tension
START, LEAST_START, LEAST_BEND = 0.3, 0.15, 1.0
#: strain of a preload from which it is told
LEAST_PRELOAD = 0.02
#: power of the stretch in the nominal stress mu (s - s^-power) of a neo-Hookean body, by state
POWERS = {"uniaxial": 2, "planar": 3, "equibiaxial": 5}
#: standard deviations of the slack, and of the two numbers by which rubber departs from neo-Hooke's law
SPREADS = (0.03, 0.25, 0.15)
#: smallest error of a stress over the largest one in the window; numbers of different stresses over that of points
#: below which a load cell has steps
LEAST_NOISE, STEPPED = 0.003, 0.5


@dataclass(frozen=True)
class TensileTest:
    """One specimen, pulled or pressed for the first time."""

    name: str
    stretch: Array  #: (n,) along the axis from the end of the slack on, ascending
    stress: Array  #: (n,) MPa, force over the area at rest
    slack: float = 0.0  #: strain that was taken away
    left_out: tuple[Array, Array] = (np.empty(0), np.empty(0))  #: stretches and stresses of points that are not used
    notes: tuple[str, ...] = ()  #: what was left out and changed, and what is most likely wrong
    state: str = "uniaxial"  #: of `laws.STATES`

    @property
    def strain(self) -> Array:
        """(n,) stretch - 1."""
        return self.stretch - 1


@dataclass(frozen=True)
class Selection:
    """Which points of a file are used, as strains of the file."""

    cycle: int = 0  #: number of a loading; 0 for the first one and what later ones add beyond it
    start: float | None = None  #: least strain; None for the steepest part


def read_tensile(
    paths: Sequence[Path], specimen: Specimen, selection: Selection, kinds: Sequence[str] = ()
) -> tuple[TensileTest, ...]:
    """All tests of all files. A file without a column of tests is one test with the name of the file.

    kinds: states of `laws.STATES`, one for each file; without any, as the files say. Raises InputError.
    """
    tests: dict[str, TensileTest] = {}
    for path, kind in zip(paths, kinds or [""] * len(paths), strict=True):
        for series in read_table(path, specimen, kind):
            name = series.name if len(paths) == 1 and series.name else f"{path.stem} {series.name}".strip()
            if name in tests:
                raise InputError(f"{path}: test '{name}' was read already; give every test once")
            tests[name] = first_loading(f"{path}: test '{name}'", name, series, selection)
    return tuple(tests.values())


def first_loading(where: str, name: str, series: Series, selection: Selection) -> TensileTest:
    """The points of a test that are used. Raises InputError where these are too few, or are no tensile test."""
    strain, stress, notes = series.strain, series.stress, list(series.notes)
    _check(where, strain, stress)
    loaded, turn = _loading(where, strain, selection.cycle)
    if turn is not None:
        which = f"loading {selection.cycle}" if selection.cycle else "the first loading"
        notes.append(f"{where}: the strain goes back after line {series.lines[turn]}: {which} is used (--cycle)")
    order = loaded[np.lexsort((stress[loaded], strain[loaded]))]
    if (count := _before_break(strain[order], stress[order])) < len(order):
        notes.append(f"{where}: the stress drops after a strain of {100 * strain[order[count - 1]]:.4g} %, a break: "
                     "later points are left out")  # fmt: skip
        order = order[:count]
    _enough(where, len(order))
    begin, slack, offset = _slack(strain[order], stress[order], selection.start, POWERS[series.state])
    if slack:
        at = f"the steepest part, from {100 * begin:.2g} % on," if np.isfinite(begin) else "the start"
        notes.append(f"{where}: {100 * slack:.2g} % of strain are taken away as slack: the tangent at {at} meets zero "
                     "stress there (--from)")  # fmt: skip
    if offset:
        stress = stress - offset
        notes.append(
            f"{where}: {offset:.2g} MPa are taken away from every stress, the offset of the load cell at zero strain; "
            "if it was a preload, count strains from before it"
        )
    used = order[strain[order] >= begin]
    _enough(where, len(used))
    if series.state == "uniaxial" and not PULLED.search(series.kind):
        _check_tension(where, strain[used], stress[used], slack)
    rest = np.setdiff1d(np.arange(len(strain)), used)
    stretch = 1 + strain - slack
    out = stretch[rest], stress[rest]
    return TensileTest(name, stretch[used], stress[used], slack, out, tuple(notes), series.state)


def _check(where: str, strain: Array, stress: Array) -> None:
    _enough(where, len(strain))
    if np.ptp(strain) == 0:
        raise InputError(f"{where}: has one strain only; stress must be given over strain")
    if not stress.any():
        raise InputError(f"{where}: every stress is zero; give the measured force over the area at rest")
    if np.sum(strain * stress) <= 0:
        raise InputError(f"{where}: stress falls as the strain grows; tension must be positive in both columns")


def _check_tension(where: str, strain: Array, stress: Array, slack: float) -> None:
    """Asks about a stress that rises faster than the strain from the start; strain (n,) ascending, with its slack."""
    begin = max(float(strain[0]), 0.0) if slack else 0.0
    first = int(np.argmax(strain >= begin))
    last = max(int(np.sum(strain <= begin + START)), first + MIN_POINTS)
    strain, stress, longest = strain[first:last] - begin, stress[first:last], float(strain[-1])
    if longest >= 1 or len(strain) < MIN_POINTS or np.ptp(strain) < LEAST_START:  # none is pressed to nothing
        return
    powers = strain[:, None] ** (np.arange(3) if slack else np.arange(1, 3))
    excess = np.array([0.0, -LEAST_BEND, 1.0])[-powers.shape[1] :]
    error = scatter(strain, stress) * float(np.sqrt(excess @ np.linalg.pinv(powers.T @ powers) @ excess))
    if excess @ np.linalg.lstsq(powers, stress)[0] > CERTAIN * error:
        raise InputError(
            f"{where}: the stress rises faster than the strain from the start, as in compression: give compression "
            "negative numbers, or call tension 'tensile stress' in the title"
        )


def _enough(where: str, count: int) -> None:
    if count < MIN_POINTS:
        raise InputError(f"{where}: {count} points are left; {MIN_POINTS} are needed")


def _loading(where: str, strain: Array, cycle: int) -> tuple[Index, int | None]:
    """The points of a loading, tension and compression each, and the point after which the strain goes back."""
    found, turn = [], None
    for side in (np.flatnonzero(strain >= 0), np.flatnonzero(strain < 0)):
        if not len(side):
            continue
        reach = np.abs(strain[side])
        ways = _rising(reach)
        if cycle > max(len(ways), 1):
            raise InputError(f"{where}: {argument('cycle', cycle)}: the test has {max(len(ways), 1)}")
        if not ways or (len(ways) == 1 and ways[0].sum() == len(side)):
            found.append(side)
            continue
        chosen = ways[max(cycle, 1) - 1]
        if turn is None:
            turn = int(side[np.flatnonzero(ways[0])[-1]])
        for later in ways[1:] if not cycle else ():  # a specimen that is pulled further is pulled for the first time
            largest = float(reach[chosen].max())
            if float(reach[later].max()) > (1 + LEAST_RETURN) * largest:
                chosen = chosen | (later & (reach > largest))
        found.append(side[chosen])
    return np.concatenate(found), turn


def _rising(reach: Array) -> list[Mask]:
    """The ways on which the strain (n,) grows; none where it falls throughout or comes in any order."""
    turns = _turns(reach)
    if len(reach) < POINTS_PER_WAY * (len(turns) + 1):
        return []
    ends = [0, *turns, max(len(reach) - 1, 0)]
    ways = []
    for begin, end in pairwise(ends):
        if reach[end] > reach[begin]:
            way = np.zeros(len(reach), dtype=bool)
            way[begin : end + 1] = True
            ways.append(way)
    return ways


def _turns(strain: Array) -> Index:
    """The points at which the strain begins to go back by more than scatter."""
    least = LEAST_RETURN * float(np.ptp(strain))
    return np.sort(np.concatenate([find_peaks(side, prominence=least)[0] for side in (strain, -strain)]))


def _before_break(strain: Array, stress: Array) -> int:
    """How many points come before the break; strain (n,) ascending, stress (n,) MPa.

    The stress falls there to less than half within a small strain, further than before, and stays so.
    """
    peak = float(stress.max())
    if peak <= 0:
        return len(stress)
    last = int(np.flatnonzero(stress >= BEFORE_BREAK * peak)[-1])
    fallen = int(np.flatnonzero(stress >= AFTER_BREAK * peak)[-1]) + 1
    if fallen == len(stress) or strain[last] <= 0:
        return len(stress)
    sharp = fallen == last + 1 or strain[fallen] - strain[last] <= BREAK_WITHIN * strain[-1]
    falls = -np.diff(stress[: last + 1])
    return last + 1 if sharp and stress[last] - stress[fallen] > 2 * falls.max(initial=0.0) else len(stress)


def _slack(strain: Array, stress: Array, start: float | None, power: int) -> tuple[float, float, float]:
    """The strain at which the steepest part begins, the slack before it, and a stress at rest above zero; strain (n,)
    ascending, stress (n,) MPa.

    The tangent at the steepest part of the start, where a straight bar takes over from slack, is continued to zero
    stress (toe compensation: ASTM D638, annex A1). Here it has the curvature of rubber. `start` replaces the steepest
    part; 0.0 without slack. power: of `POWERS`.
    """
    pulled = strain >= (0 if start is None else start)
    if strain[0] < -LAST_START:  # it is pressed too
        return -np.inf if start is None else start, 0.0, 0.0
    strain, stress = strain[pulled], stress[pulled]
    begin = -np.inf if start is None else start
    if len(strain) < MIN_POINTS:
        return begin, 0.0, 0.0
    last = min(LAST_START, PART * float(strain[-1])) if start is None else float(strain[0])
    noise = max(scatter(strain, stress), LEAST_NOISE * float(np.abs(stress[strain <= strain[0] + WINDOW]).max()))
    windows = [_tangent(strain[k:], stress[k:], noise, power) for k in np.flatnonzero(strain[:-MIN_POINTS] <= last)]
    if not windows:
        return begin, 0.0, 0.0
    slopes, errors = (np.array([getattr(window, name) for window in windows]) for name in ("slope", "slope_error"))
    first = int(np.argmax(slopes + CERTAIN * errors >= STEEPEST * slopes.max()))
    found = windows[first]
    if abs(found.slack) <= max(LEAST_SLACK, CERTAIN * found.slack_error):
        return begin, 0.0, 0.0
    if found.slack < 0:
        return begin, 0.0, found.at_rest if found.slack < -LEAST_PRELOAD else 0.0
    return (float(strain[first]) if first and start is None else begin), found.slack, 0.0


@dataclass(frozen=True)
class _Tangent:
    slope: float  #: MPa, at zero stress
    slope_error: float
    slack: float
    slack_error: float
    at_rest: float  #: stress at zero strain, MPa


def _tangent(strain: Array, stress: Array, noise: float, power: int) -> _Tangent:
    """From the window that begins with the first point: P = a (s - s^-power) (1 + b (s - 1) + c (s^2 + 2 / s - 3)), s
    counted from the slack on, linear in a, a b, a c and a times a small slack; b, c and the slack are small."""
    inside = strain <= strain[0] + WINDOW
    inside[:MIN_POINTS] = True
    strain, stress, slack = strain[inside], stress[inside], 0.0
    stiffness = float(stress[-1] / ((1 + power) * strain[-1])) or noise
    for _ in range(5):
        s = 1 + strain - slack
        pull = s - s**-power
        matrix = (
            np.column_stack([pull, -(1 + power * s ** -(power + 1)), pull * (s - 1), pull * (s**2 + 2 / s - 3)]) / noise
        )
        prior = np.diag([0, *(1 / np.array(SPREADS))]) / abs(stiffness)
        target = np.concatenate([stress / noise, [0, slack * -prior[1, 1] * stiffness, 0, 0]])
        rows = np.vstack([matrix, prior])
        found = np.linalg.lstsq(rows, target)[0]
        stiffness = float(max(found[0], 0.1 * abs(stiffness)))
        slack = float(np.clip(slack + found[1] / stiffness, -LARGEST_SLACK, LARGEST_SLACK))
    errors = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    slope, rest = 1 + power, 1 - slack
    at_rest = found @ [(rest - rest**-power) * of for of in (1, 0, rest - 1, rest**2 + 2 / rest - 3)]
    return _Tangent(slope * stiffness, slope * float(errors[0]), slack, float(errors[1]) / stiffness, float(at_rest))


def scatter(strain: Array, stress: Array) -> float:
    """Standard deviation of a stress, MPa, from third divided differences, in which a smooth curve cancels, and from
    the steps of the load cell; strain (n,) ascending, stress (n,)."""
    steps = np.diff(np.unique(stress))
    step = float(np.median(steps)) if len(steps) and len(steps) < STEPPED * len(stress) else 0.0
    step *= (len(stress) / (12 * (len(steps) + 1))) ** 0.5  # points on one step have the same error
    x, first = np.unique(strain, return_index=True)
    if len(x) < 4:
        return step
    x, y = (np.lib.stride_tricks.sliding_window_view(values, 4) for values in (x, stress[first]))
    weights = 1 / (x[:, :, None] - x[:, None, :] + np.eye(4)).prod(axis=2)
    scaled = np.sum(weights * y, axis=1) / np.linalg.norm(weights, axis=1)
    return float(np.hypot(1.4826 * np.median(np.abs(scaled)), step))  # the median of a normal distribution
