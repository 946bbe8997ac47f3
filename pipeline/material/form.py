"""A law as it is fitted to tensile tests: constants that determine its stress in the test, and what points must tell.

Laws of rubber are incompressible here, which makes all laws but Ogden's linear in their constants.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from fem.materials import Constant, LinearLaw, Material
from geometry.arrays import Array
from pipeline.material.regression import TooFewPoints, least_squares

#: points beyond rest that a law needs more than it has constants, and different stretches among them
MORE_POINTS, MORE_STRETCHES = 3, 1
#: largest standard error of what has to be determined, over its value; of an exponent below 1, over 1
LARGEST_ERROR = 0.5
#: a stretch at which a law has its stiffness at rest, and the largest difference between stretches that are the same
NEAR_REST, ROUNDING = 1.001, 1e-9


class Form(ABC):
    """A law as it is fitted; stretches are (n,), constants (k,)."""

    law: str  #: as in the YAML
    name: str  #: in tables
    constants: tuple[str, ...]  #: names
    ranges: int  #: most ranges of stretch that are tried to find the widest one

    def fitted(self, stretch: Array, stress: Array) -> Array:
        """The constants that fit best to the nominal stress (n,), MPa. Raises `TooFewPoints`."""
        count, beyond = len(self.constants), np.round((stretch - 1) / ROUNDING)
        different = len(np.unique(beyond[beyond != 0]))
        for available, needed, what in (
            (np.count_nonzero(beyond), count + MORE_POINTS, "points"),
            (different, count + MORE_STRETCHES, "different strains"),
        ):
            if available < needed:
                many = "one constant needs" if count == 1 else f"{count} constants need"
                raise TooFewPoints(f"{many} {needed} {what} beyond rest, and there are {available}")
        return self._best_fit(stretch, stress)

    @abstractmethod
    def _best_fit(self, stretch: Array, stress: Array) -> Array:
        """As `fitted`, for enough points."""

    @abstractmethod
    def nominal(self, constants: Array, stretch: Array) -> Array:
        """Nominal stress (n,), MPa."""

    @abstractmethod
    def slopes(self, constants: Array, stretch: Array) -> Array:
        """(n, k) derivatives of the nominal stress by the constants."""

    @abstractmethod
    def solved(self, constants: Array, nu: float) -> Material:
        """The law with the Poisson ratio nu. Raises `fem.MaterialError`."""

    def undetermined(self, constants: Array, covariance: Array, stretch: Array, stress: Array) -> str:
        """What points with these stretches and stresses (n,), MPa, do not determine; empty where they suffice.

        covariance: (k, k) of the constants, which were fitted to these points.
        """
        near = np.array([NEAR_REST])
        error = relative_error(self.nominal(constants, near), self.slopes(constants, near), covariance)
        if error > LARGEST_ERROR:
            return f"the standard error of the stiffness at rest is {100 * error:.3g} % of it"
        return ""

    def named(self, values: Array) -> dict[str, float]:
        """A value of each constant by its name."""
        return dict(zip(self.constants, values.tolist(), strict=True))

    def possible_stretches(self, nu: float) -> tuple[float, float]:
        """The stretches at which a bar of the law can be."""
        return 0.0, np.inf


@final
@dataclass(frozen=True)
class LinearForm(Form):
    """A law whose stress is linear in its constants."""

    law: str
    kind: type[LinearLaw]

    ranges = 1000

    @property
    def name(self) -> str:  # type: ignore[override]
        return self.law

    @property
    def constants(self) -> tuple[str, ...]:  # type: ignore[override]
        return tuple(self.kind.uniaxial_terms(np.ones(1)))

    def _best_fit(self, stretch: Array, stress: Array) -> Array:
        return least_squares(self.slopes(np.empty(0), stretch), stress)

    def nominal(self, constants: Array, stretch: Array) -> Array:
        return np.asarray(self.slopes(constants, stretch) @ constants)

    def slopes(self, constants: Array, stretch: Array) -> Array:
        return np.column_stack(list(self.kind.uniaxial_terms(stretch).values()))

    def solved(self, constants: Array, nu: float) -> Material:
        return self.kind.from_uniaxial(self.named(constants), nu)

    def possible_stretches(self, nu: float) -> tuple[float, float]:
        """They are limited for laws that have a Poisson ratio."""
        if Constant.POISSON_RATIO not in self.kind.constants().values():
            return 0.0, np.inf
        return self.solved(np.ones(len(self.constants)), nu).stretch_limits


def relative_error(nominal: Array, slopes: Array, covariance: Array) -> float:
    """Standard error of a nominal stress (1,) over its value; slopes (1, k), covariance (k, k) of the constants."""
    return float(np.sqrt(slopes @ covariance @ slopes.T)[0, 0] / abs(nominal[0]))
