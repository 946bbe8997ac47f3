"""The intrinsic curvature of a rod, in any of its accepted forms, as samples joined by straight lines."""

import reprlib
from collections.abc import Callable

import numpy as np

from geometry.arrays import Array
from rod.checked import Amount, finite, numbers_in
from rod.errors import RodError

Profile = Amount | Array | Callable[[Array], Array]

#: intervals along the rod at which a kappa_0 that is a function is sampled
FUNCTION_SAMPLES = 640


def sampled(length: float, kappa_0: Profile) -> tuple[Array, Array]:
    """Positions (n,) in mm from 0 to the length, and kappa_0 (n,) in 1/mm there.

    kappa_0: a number, or a text such as "2 1/m"; an array (n,) of values at n equally spaced points from s = 0 to
    s = length; an array (n, 2) of columns s (mm) and kappa_0, s rising from 0 to length; or a function of s that takes
    and returns (m,) arrays.
    Raises `RodError` for anything else.
    """
    if callable(kappa_0):
        s = np.linspace(0.0, length, FUNCTION_SAMPLES + 1)
        return s, _called(kappa_0, s)
    kappa_0 = finite(kappa_0, "kappa_0", "1/mm") if isinstance(kappa_0, str) else kappa_0
    values = numbers_in(kappa_0)
    if values is None:
        raise RodError(
            f"kappa_0 is a number, an array of numbers or a function of s; {reprlib.repr(kappa_0)} is none of them."
        )
    if not np.all(np.isfinite(values)):
        raise RodError("kappa_0 holds a value that is not a finite number.")
    if values.ndim == 0:
        return np.array([0.0, length]), np.full(2, finite(kappa_0, "kappa_0"))
    return _samples(values, length)


def _called(function: Callable[[Array], Array], s: Array) -> Array:
    values = numbers_in(function(s.ravel()))
    if values is None or values.shape != (s.size,) or not np.all(np.isfinite(values)):
        raise RodError("kappa_0 as a function must return a finite number for every s of the array it is given.")
    return values.reshape(s.shape)


def _samples(values: Array, length: float) -> tuple[Array, Array]:
    """Positions and values, from an array of one of the two accepted shapes."""
    if values.ndim == 1 and len(values) >= 2:
        return np.linspace(0.0, length, len(values)), values
    if values.ndim != 2 or values.shape[1] != 2 or len(values) < 2:
        raise RodError(
            "kappa_0 as an array is (n,), values at equally spaced points, or (n, 2), columns s and kappa_0, "
            f"with n of at least 2; its shape is {values.shape}."
        )
    s = values[:, 0]
    if np.any(np.diff(s) <= 0.0):
        raise RodError("The column s of kappa_0 must rise from row to row.")
    if abs(s[0]) > 1e-6 * length or abs(s[-1] - length) > 1e-6 * length:
        raise RodError(
            f"kappa_0 is given from s = {values[0, 0]:g} to {values[-1, 0]:g} mm, the rod goes from 0 to {length:g} mm."
        )
    s = s.copy()
    s[0], s[-1] = 0.0, length
    return s, values[:, 1]
