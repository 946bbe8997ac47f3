"""Frequency and damping of a motion that rings and creeps."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import find_peaks

from geometry.arrays import Array

#: periods from the first turning point on that are looked at; s, how long a creep beside the ringing lasts
PERIODS, CREEP = 4.0, (0.3, 5.0)


class Ringing(NamedTuple):
    """c + b exp(-t/tau) + exp(-damping omega t) (a cos omega t + d sin omega t), by least squares."""

    frequency: float  #: Hz, with its damping
    damping: float  #: ratio; 2 pi times it is the logarithmic decrement

    @classmethod
    def of(cls, time: Array, value: Array) -> "Ringing":
        """Of values (n,) at times (n,) in s, which begin with a release."""
        side = np.sign(value[-1] - value[0])
        tops, _ = find_peaks(side * value, prominence=0.05 * np.ptp(value))
        guess = 1.0 / float(time[tops[1]] - time[tops[0]])
        t, u = time[tops[0] :] - time[tops[0]], value[tops[0] :]
        t, u = t[t <= PERIODS / guess], u[t <= PERIODS / guess]

        def missed(unknowns: Array) -> Array:
            frequency, damping, late = unknowns
            phase = 2.0 * np.pi * frequency * t
            left = np.exp(-damping * phase)
            basis = np.column_stack([np.ones_like(t), np.exp(-t / late), left * np.cos(phase), left * np.sin(phase)])
            return np.asarray(basis @ np.linalg.lstsq(basis, u, rcond=None)[0] - u)

        bounds = [0.7 * guess, 0.0, CREEP[0]], [1.4 * guess, 0.5, CREEP[1]]
        found = least_squares(missed, [guess, 0.05, 1.0], bounds=bounds, x_scale=[guess, 0.05, 1.0])
        return cls(float(found.x[0]), float(found.x[1]))
