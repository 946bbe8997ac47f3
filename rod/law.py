"""The five-parameter relation between moment and curvature (paper, equations (4) and (8)).

    M = alpha_i Delta + m0_i,    Delta = kappa - kappa_0,    i = 1 for s < d, i = 2 for s >= d

The intercepts are secants of a nonlinear curve: the two lines describe a *loaded* rod. Applied where there is no moment
they would bend an unloaded rod. A rod on which nothing acts therefore has Delta = 0 and takes the shape of kappa_0; any
other rod follows the lines. M is the moment that bends the rod: of one with a weight of its own the change of the
moment, of one that stretches the moment about the neutral axis.
"""

from dataclasses import dataclass, fields
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from geometry.arrays import Array
from rod.checked import finite
from rod.errors import RodError

#: in the order of the fields of `FiveParameters`
PARAMETER_NAMES = ("alpha1", "alpha2", "m01", "m02", "d")
#: their names with the unit, as in tables and in parameters.json
PARAMETER_COLUMNS = dict(
    zip(PARAMETER_NAMES, ("alpha1_N_mm2", "alpha2_N_mm2", "m01_N_mm", "m02_N_mm", "d_mm"), strict=True)
)


@dataclass(frozen=True)
class TwoSlopes:
    """Two lines between moment and curvature, one before and one beyond d; slopes may be negative.

    Some estimators of the paper's kind give negative slopes. Such a slope is no rigidity: the rod bends towards the
    side from which the moment pushes. Raises `RodError` where a number is not finite, a slope is zero or d is not
    positive.
    """

    alpha1: float  #: N mm2, slope between the clamp and d
    alpha2: float  #: N mm2, slope beyond d
    m01: float  #: N mm, intercept between the clamp and d
    m02: float  #: N mm, intercept beyond d
    d: float  #: mm, rest arc length at which the slope changes

    def __post_init__(self) -> None:
        for field in fields(self):
            object.__setattr__(self, field.name, finite(getattr(self, field.name), field.name))
        for name in ("alpha1", "alpha2"):
            if getattr(self, name) == 0.0:
                raise RodError(f"{name} is the slope of a line and must not be zero.")
        if self.d <= 0.0:
            raise RodError(f"d is measured from the clamp and must be positive, not {self.d:g} mm.")

    def rigidity(self, s: ArrayLike) -> Array:
        """alpha at s (mm), N mm2; s = d belongs to the second piece."""
        return np.where(np.asarray(s, float) < self.d, self.alpha1, self.alpha2)

    def intercept(self, s: ArrayLike) -> Array:
        """m0 at s (mm), N mm; s = d belongs to the second piece."""
        return np.where(np.asarray(s, float) < self.d, self.m01, self.m02)

    def moment(self, s: ArrayLike, deviation: ArrayLike) -> Array:
        """M (N mm) at s (mm) for the curvature deviation Delta = kappa - kappa_0 (1/mm) of a loaded rod."""
        return self.rigidity(s) * np.asarray(deviation, float) + self.intercept(s)

    def deviation(self, s: ArrayLike, moment: ArrayLike) -> Array:
        """Delta = kappa - kappa_0 (1/mm) at s (mm) under the moment M (N mm) of a loaded rod."""
        return (np.asarray(moment, float) - self.intercept(s)) / self.rigidity(s)

    def kappa_rest(self, s: ArrayLike, kappa_0: ArrayLike) -> Array:
        """kappa_0 - m0/alpha (1/mm): the rest curvature with which a rod code without intercepts represents the law.

        M = alpha (kappa - kappa_0) + m0 is alpha (kappa - kappa_rest); loaded rods only (see the module's docstring).
        """
        return np.asarray(kappa_0, float) - self.intercept(s) / self.rigidity(s)


@final
@dataclass(frozen=True)
class FiveParameters(TwoSlopes):
    """The five parameters of one pressure (paper, equations (4) and (8)); both slopes are rigidities.

    Raises `RodError` for what is no finite number, a rigidity that is not positive and a d that is not positive.
    """

    def __post_init__(self) -> None:
        for name in ("alpha1", "alpha2"):
            slope = finite(getattr(self, name), name)
            if slope <= 0.0:
                raise RodError(f"{name} is a rigidity and must be positive, not {slope:g} N mm2.")
        super().__post_init__()
