"""The intrinsic curvature of a rod, in any of its accepted forms, cut into smooth steps for the integrator."""

import reprlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Mask
from rod.checked import finite, numbers_in
from rod.errors import RodError
from rod.law import TwoSlopes
from rod.mechanics.luther import ABSCISSAE

Profile = float | Array | Callable[[Array], Array]

#: smallest number of steps along the rod, for constant kappa_0 and for samples joined by straight lines
MIN_STEPS = 40
#: steps along the rod where kappa_0 is a function of unknown roughness
FUNCTION_STEPS = 160


@dataclass(frozen=True)
class Steps:
    """Step boundaries with kappa_0 at the stages of the integrator; lengths in units of the rod's length."""

    s: Array  #: (n + 1,) step boundaries from 0 to 1
    kappa_0: Array  #: (n, 6) kappa_0 times length at the stages of every step
    first: Mask  #: (n,), the steps before d

    @property
    def stages(self) -> Array:
        """(n, 6) where the integrator evaluates kappa_0."""
        return _stages(self.s)


def cut_into_steps(length: float, kappa_0: Profile, law: TwoSlopes, refinement: float = 1.0) -> Steps:
    """Steps whose boundaries are d and the samples of kappa_0; `refinement` divides the longest step allowed.

    kappa_0 (1/mm): a number; an array (n,) of values at n equally spaced points from s = 0 to s = length; an array
    (n, 2) of columns s (mm) and kappa_0, s rising from 0 to length; or a function of s that takes and returns (m,)
    arrays. Samples are joined by straight lines. Raises `RodError` for anything else.
    """
    if callable(kappa_0):
        boundaries = _boundaries(np.linspace(0.0, 1.0, round(FUNCTION_STEPS * refinement) + 1), law.d / length)
        return _steps(boundaries, law.d / length, lambda s: _called(kappa_0, s * length) * length)
    values = numbers_in(kappa_0)
    if values is None:
        raise RodError(
            f"kappa_0 is a number, an array of numbers or a function of s; {reprlib.repr(kappa_0)} is none of them."
        )
    if not np.all(np.isfinite(values)):
        raise RodError("kappa_0 holds a value that is not a finite number.")
    if values.ndim == 0:
        curvature = finite(kappa_0, "kappa_0") * length
        boundaries = _boundaries(np.linspace(0.0, 1.0, round(MIN_STEPS * refinement) + 1), law.d / length)
        return _steps(boundaries, law.d / length, lambda s: np.full(s.shape, curvature))
    samples, values = _samples(values, length)
    boundaries = _boundaries(_refined(samples, MIN_STEPS * refinement), law.d / length)
    return _steps(boundaries, law.d / length, lambda s: np.interp(s, samples, values) * length)


def _called(function: Callable[[Array], Array], s: Array) -> Array:
    values = numbers_in(function(s.ravel()))
    if values is None or values.shape != (s.size,) or not np.all(np.isfinite(values)):
        raise RodError("kappa_0 as a function must return a finite number for every s of the array it is given.")
    return values.reshape(s.shape)


def _samples(values: Array, length: float) -> tuple[Array, Array]:
    """Sample positions over the length, and values, from an array of one of the two accepted shapes."""
    if values.ndim == 1 and len(values) >= 2:
        return np.linspace(0.0, 1.0, len(values)), values
    if values.ndim != 2 or values.shape[1] != 2 or len(values) < 2:
        raise RodError(
            "kappa_0 as an array is (n,), values at equally spaced points, or (n, 2), columns s and kappa_0, "
            f"with n of at least 2; its shape is {values.shape}."
        )
    s = values[:, 0] / length
    if np.any(np.diff(s) <= 0.0):
        raise RodError("The column s of kappa_0 must rise from row to row.")
    if abs(s[0]) > 1e-6 or abs(s[-1] - 1.0) > 1e-6:
        raise RodError(
            f"kappa_0 is given from s = {values[0, 0]:g} to {values[-1, 0]:g} mm, the rod goes from 0 to {length:g} mm."
        )
    s = s.copy()
    s[0], s[-1] = 0.0, 1.0
    return s, values[:, 1]


def _refined(samples: Array, steps: float) -> Array:
    """The samples, with wide intervals divided evenly so that no step is longer than 1/steps."""
    widths = np.diff(samples)
    pieces = np.maximum(1, np.ceil(widths * steps - 1e-9)).astype(int)
    if np.all(pieces == 1):
        return samples
    within = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.append(within * np.repeat(widths / pieces, pieces) + np.repeat(samples[:-1], pieces), 1.0)


def _boundaries(s: Array, d: float) -> Array:
    """The step boundaries with d among them; a boundary closer to d than rounding is moved onto it."""
    nearest = int(np.argmin(np.abs(s - d)))
    if abs(s[nearest] - d) < 1e-9 and 0 < nearest < len(s) - 1:
        moved = s.copy()
        moved[nearest] = d
        return moved
    return np.insert(s, int(np.searchsorted(s, d)), d)


def _steps(s: Array, d: float, curvature: Callable[[Array], Array]) -> Steps:
    return Steps(s, np.ascontiguousarray(curvature(_stages(s))), s[:-1] < d - 1e-15)


def _stages(s: Array) -> Array:
    """(n, 6) the stages of the steps between the boundaries s (n + 1,)."""
    return np.asarray(s[:-1, None] + np.diff(s)[:, None] * ABSCISSAE)
