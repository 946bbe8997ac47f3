"""Rubber in time: a modulus that relaxes by exponentials, and the creep that belongs to it.

    G(t) = 1 + sum g_k exp(-t / tau_k),    J(t) = 1 - sum j_k exp(-t / lambda_k),    J * dG = 1

1 is the modulus of the configuration, at long times. J. D. Ferry, Viscoelastic Properties of Polymers, 3rd ed. (1980).
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from geometry.arrays import Array
from rod.checked import positive
from rod.errors import RodError

#: branches of a loss factor in each tenfold of the frequency
PER_DECADE = 1


class Creep(NamedTuple):
    """The strain under a constant load over that at long times, J(t)."""

    shares: tuple[float, ...]  #: j_k
    times_s: tuple[float, ...]  #: lambda_k, s

    def compliance(self, t: Array | float) -> Array:
        """J at times in s, of their shape."""
        return np.asarray(1.0 - np.exp(-np.asarray(t, float)[..., None] / np.array(self.times_s)) @ self.shares)

    @property
    def relaxation(self) -> "Relaxation":
        """To what it belongs. Raises `RodError` for parts that no solid has."""
        shares, times = _inverse(-np.array(self.shares), np.array(self.times_s))
        return Relaxation(tuple(-share for share in shares), times)


@final
@dataclass(frozen=True)
class Relaxation:
    """The modulus over that at long times, G(t). Raises `RodError` unless all shares and times are positive."""

    shares: tuple[float, ...]  #: g_k, of the modulus at long times
    times_s: tuple[float, ...]  #: tau_k, s

    def __post_init__(self) -> None:
        for name, told in (("shares", "A share of a branch"), ("times_s", "The time of a branch in s")):
            object.__setattr__(self, name, tuple(positive(value, told) for value in getattr(self, name)))
        if len(self.shares) != len(self.times_s) or len(set(self.times_s)) < len(self.times_s):
            raise RodError("A relaxation has a share for each of its times, and no time twice.")

    @staticmethod
    def from_loss_factor(value: float, from_hz: float, to_hz: float) -> "Relaxation":
        """Branches evenly spaced in the logarithm of their time, with one loss factor at all frequencies between two.

        Raises `RodError` unless the frequencies rise and the loss factor is between 0 and what branches can give.
        """
        names = "The loss factor", "The lower frequency in Hz", "The higher frequency in Hz"
        value, low, high = map(positive, (value, from_hz, to_hz), names)
        if low > high:
            raise RodError(f"A loss factor holds from a lower to a higher frequency, not from {low:g} to {high:g} Hz.")
        rates = 2.0 * math.pi * np.geomspace(high, low, 1 + math.ceil(PER_DECADE * math.log10(high / low)))
        turned = rates[:, None] / rates
        shares = np.linalg.solve((turned - value * turned**2) / (1.0 + turned**2), np.full(len(rates), value))
        if not np.all(shares > 0.0):
            raise RodError(
                f"No branches give a loss factor of {value:g} from {low:g} to {high:g} Hz; rubbers have 0.5."
            )
        return Relaxation(tuple(shares.tolist()), tuple((1.0 / rates).tolist()))

    def modulus(self, t: Array | float) -> Array:
        """G at times in s, of their shape."""
        return np.asarray(1.0 + np.exp(-np.asarray(t, float)[..., None] / np.array(self.times_s)) @ self.shares)

    def dynamic(self, rate: ArrayLike) -> Array:
        """The modulus of a motion exp(rate t), complex, of the shape of the rates in 1/s."""
        turned = np.asarray(rate, complex)[..., None] * np.array(self.times_s)
        return np.asarray(1.0 + (turned / (1.0 + turned)) @ self.shares)

    def loss_factor(self, frequency_hz: Array | float) -> Array:
        """Lost over stored energy of a vibration, over a radian, at frequencies in Hz."""
        modulus = self.dynamic(2j * np.pi * np.asarray(frequency_hz, float))
        return np.asarray(modulus.imag / modulus.real)

    @cached_property
    def creep(self) -> Creep:
        """What belongs to it."""
        return Creep(*_inverse(np.array(self.shares), np.array(self.times_s)))


def _inverse(shares: Array, times: Array) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Shares (k,) and times of K(t) = 1 - sum share exp(-t / time) with K * dF = 1, for F = 1 + sum of such terms."""
    at_once = 1.0 + shares.sum()
    values, vectors = np.linalg.eig(np.outer(shares, 1.0 / times) / at_once - np.diag(1.0 / times))
    found = vectors.sum(axis=0) * np.linalg.solve(vectors, shares / at_once)
    order = np.argsort(-1.0 / values.real)
    return tuple(found.real[order].tolist()), tuple((-1.0 / values.real[order]).tolist())


#: rubber that does not relax
ELASTIC = Relaxation((), ())
