"""Frequency and damping of a motion that rings and creeps."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from geometry.arrays import Array

#: periods from the first turning point on that are looked at
PERIODS = 4.0
#: s, how long a creep beside the ringing lasts at least and at most
CREEP = (0.3, 5.0)


@dataclass(frozen=True)
class Ringing:
    """c + b exp(-t/tau) + exp(-damping omega t) (a cos(omega t) + ...), fitted by least squares."""

    frequency: float  #: Hz, with its damping
    damping: float  #: ratio

    @property
    def decrement(self) -> float:
        """Logarithm of an amplitude over that one period later."""
        return 2.0 * np.pi * self.damping

    @classmethod
    def of(cls, time: Array, value: Array) -> "Ringing":
        """Of values (n,) at times (n,) s after a release; the first turning point is the largest value or smallest."""
        first, guess = _begin(time, value)
        known = (time >= time[first]) & (time <= time[first] + PERIODS / guess)
        t, u = time[known] - time[first], value[known]
        start, low, high = [guess, 0.05, 1.0], [0.7 * guess, 0.0, CREEP[0]], [1.4 * guess, 0.5, CREEP[1]]

        def missed(unknowns: Array) -> Array:
            frequency, damping, late = unknowns
            phase, left = 2.0 * np.pi * frequency * t, np.exp(-damping * 2.0 * np.pi * frequency * t)
            parts = [np.ones_like(t), np.exp(-t / late), left * np.cos(phase), left * np.sin(phase)]
            basis = np.column_stack(parts)
            return np.asarray(basis @ np.linalg.lstsq(basis, u, rcond=None)[0] - u)

        frequency, damping, _ = least_squares(missed, start, bounds=(low, high), x_scale=[guess, 0.05, 1.0]).x
        return cls(float(frequency), float(damping))


def _begin(time: Array, value: Array) -> tuple[int, float]:
    """The first turning point, and a guess of the frequency (Hz): that of the points on the same side."""
    sign = np.sign(value[-1] - value[0]) or 1.0
    tops, _ = find_peaks(sign * value, prominence=0.05 * np.ptp(value))
    return int(tops[0]), 1.0 / float(time[tops[1]] - time[tops[0]])
