"""Measured motions, of an arm that is let go or whose pressure comes at 0 s, and what they tell.

A motion is told by the frequency and the damping ratio of its vibration, and by means of the tip over parts of the
time after that. The means are states of an arm whose rubber creeps.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from geometry.arrays import Array, Index
from pipeline.answers.measured.rows import OF_TIP, VIBRATION, Row, State
from pipeline.values.errors import InputError

#: periods of a vibration that are looked at, and after which its means begin; s, how long a creep beside it lasts
PERIODS, QUIET, CREEP = 4.0, 6.0, (0.3, 5.0)
#: height of a top over the largest motion, from which it is one; fewest tops of a vibration; fewest rows of a motion
TOP, TOPS, LEAST = 0.05, 3, 20
#: means of the tip, and half the part of its time over which each is taken
MEANS, HALF = 3, 0.2


class DampedOscillation(NamedTuple):
    """c + b exp(-t/tau) + exp(-x omega t) (a cos omega t + d sin omega t), by least squares.

    Frequency and damping ratio are those of a vibration exp(rate t), as `rod.Mode` has them.
    """

    frequency: float  #: Hz, of the size of the rate
    damping: float  #: part of the critical damping
    begun: float  #: s, of its first top

    @classmethod
    def of(cls, time: Array, value: Array) -> "DampedOscillation":
        """The oscillation of values (n,) at times (n,) in s from a release on, with two tops at least."""
        tops = tops_of(value)
        guess, begun = 1.0 / float(time[tops[1]] - time[tops[0]]), float(time[tops[0]])
        t, u = time[tops[0] :] - begun, value[tops[0] :]
        t, u = t[t <= PERIODS / guess], u[t <= PERIODS / guess]

        def missed(unknowns: Array) -> Array:
            frequency, damping, late = unknowns
            phase = 2.0 * np.pi * frequency * t
            left = np.exp(-damping * phase)
            basis = np.column_stack([np.ones_like(t), np.exp(-t / late), left * np.cos(phase), left * np.sin(phase)])
            return np.asarray(basis @ np.linalg.lstsq(basis, u, rcond=None)[0] - u)

        bounds = [0.7 * guess, 0.0, CREEP[0]], [1.4 * guess, 0.5, CREEP[1]]
        found = least_squares(missed, [guess, 0.05, 1.0], bounds=bounds, x_scale=[guess, 0.05, 1.0])
        size = float(np.hypot(1.0, found.x[1]))
        return cls(float(found.x[0]) * size, float(found.x[1]) / size, begun)


def tops_of(value: Array) -> Index:
    """Where values (n,) after a release turn back, on the side to which they go."""
    side = np.sign(value[-1] - value[0]) or 1.0
    return np.asarray(find_peaks(side * value, prominence=TOP * np.ptp(value))[0])


def told_of_motions(path: Path, rows: Sequence[Row]) -> tuple[Row, ...]:
    """The rows without a time, and what the motions of the others tell. Raises InputError, with the line."""
    motions: dict[tuple[State, str], list[Row]] = {}
    for row in rows:
        if row.state.t_s is not None:
            motions.setdefault((replace(row.state, t_s=None), row.repeat), []).append(row)
    still = [row for row in rows if row.state.t_s is None]
    return (*still, *(told for (state, _), motion in motions.items() for told in _told(path, state, motion)))


def _told(path: Path, state: State, motion: Sequence[Row]) -> list[Row]:
    where = f"{path}: line {motion[0].line}"
    time = np.array([row.state.t_s for row in motion])
    if (falls := np.diff(time) <= 0.0).any():
        at = motion[int(falls.argmax()) + 1].line
        raise InputError(f"{path}: line {at}: t_s does not rise; give every time of a motion once, in its order")
    if not (state.pressure_kPa or state.orientation or any(state.force_N)):
        raise InputError(
            f"{where}: nothing moves an arm at 0 kPa; give the orientation in which it was let go, or the force"
        )
    after = [row for row in motion if (row.state.t_s or 0.0) > 0.0]
    names = [name for name in OF_TIP if all(name in row.values for row in after)]
    if len(after) < LEAST or not names:
        raise InputError(f"{where}: a motion has {LEAST} rows or more after 0 s, all with the same of its tip")
    time, values = time[-len(after) :], np.array([[row.values[name] for name in names] for row in after])
    largest, free = values[:, np.ptp(values, axis=0).argmax()], replace(state, force_N=(0.0, 0.0))
    begun, period, found = max(float(time[0]), float(time[-1]) / LEAST), 0.0, []
    if len(tops_of(largest)) >= TOPS:
        ringing = DampedOscillation.of(time, largest)
        period = 1.0 / ringing.frequency
        begun = ringing.begun + QUIET * period
        found.append(Row(motion[0].line, free, dict(zip(VIBRATION, ringing[:2], strict=True))))
    if not any(state.force_N):  # of which the rubber remembers little
        for k, (place, *means) in _means(time, values, begun, period):
            mean = dict(zip(names, means, strict=True))
            found.append(Row(after[k].line, replace(free, t_s=place), mean))
    if not found:
        raise InputError(
            f"{where}: this motion tells nothing; follow it for a longer time, or until it has swung {TOPS} times"
        )
    return found


def _means(time: Array, values: Array, begun: float, period: float) -> Iterator[tuple[int, list[float]]]:
    """Where in time (n,) a mean is, its time in s, and means of values (n, q); of a vibration nothing is left."""
    first, last = begun / (1.0 - HALF), float(time[-1]) / (1.0 + HALF)
    for at in np.geomspace(first, last, MEANS).tolist() if first < last else ():
        wide = 2.0 * HALF * at
        wide = period * max(2, round(wide / period)) if period else wide
        weight = np.cos(np.clip((time - at) / wide, -0.5, 0.5) * np.pi) ** 2
        yield int(weight.argmax()), (weight @ np.column_stack([time, values]) / weight.sum()).tolist()
