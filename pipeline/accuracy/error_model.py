"""Model of the discretisation errors of the headline numbers, from a few meshes and their error indicators.

An error of a number is a product of two errors in the energy norm, that of the state and that of its dual (R. Becker,
R. Rannacher, Acta Numerica 10 (2001), section 3). It therefore falls as the energy of the error does, which the
indicator of `fem.stress_error` follows: the numbers of several meshes lie on a straight line over the indicator.
Numbers of meshes that are not nested scatter around that line; with three meshes the scatter adds to the estimate.
studies/accuracy.md compares estimates with true errors.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.accuracy.measure import HEADLINE, RIGIDITY, RodNumbers

#: bounds of the order with which the energy of the error falls with the mesh size: at a re-entrant edge stresses grow
#: at most as r^(-1/2), and in a smooth body the strain of quadratic elements converges with order 2
SLOWEST, FASTEST = 1.0, 4.0
#: smallest ratio of error to indicator, as root mean square over kappa_0 and F: that of the finest meshes of
#: studies/accuracy.md, so that meshes that agree by chance are not taken as exact
MIN_RATIO = 0.25


@dataclass(frozen=True)
class Pilot:
    """A coarse mesh that is solved before the run."""

    size_mm: float
    degrees_of_freedom: int
    cpu_seconds: float
    numbers: RodNumbers


@dataclass(frozen=True)
class MeshErrorModel:
    """Relative errors of kappa_0(l/2), alpha2 and F over the indicator, and the indicator over the mesh size."""

    size_mm: float  #: of the finer pilot
    indicator: float  #: on it
    order: float  #: power of the size with which the indicator falls
    ratios: Mapping[str, float]  #: error over the indicator, by the names of `HEADLINE`

    @staticmethod
    def fit(coarse: Pilot, fine: Pilot, run: RodNumbers | None = None) -> "MeshErrorModel":
        """From two pilots, and from the run they were solved for, at the same pressure.

        The order is that of the pilots' indicators within `SLOWEST` and `FASTEST`.
        """
        refinement = coarse.size_mm / fine.size_mm
        order = math.log(coarse.numbers.stress_error / fine.numbers.stress_error) / math.log(refinement)
        order = min(max(order, SLOWEST), FASTEST)
        meshes, indicator = [coarse.numbers, fine.numbers], fine.numbers.stress_error
        indicators = [indicator * refinement**order, indicator]
        if run is not None:
            meshes.append(run)
            indicators.append(run.stress_error)
        return MeshErrorModel(fine.size_mm, indicator, order, _ratios(indicators, meshes))

    def at(self, size_mm: float) -> dict[str, float]:
        """The errors on a mesh of another size, before it is solved."""
        return self.with_indicator(self.indicator * (size_mm / self.size_mm) ** self.order)

    def with_indicator(self, indicator: float) -> dict[str, float]:
        """The errors in a solved state with this indicator."""
        return {name: ratio * indicator for name, ratio in self.ratios.items()}

    def size_for(self, error: float) -> float:
        """The size (mm) at which the largest error is `error`."""
        return float(self.size_mm * (error / max(self.at(self.size_mm).values())) ** (1.0 / self.order))


def _ratios(indicators: Sequence[float], meshes: Sequence[RodNumbers]) -> dict[str, float]:
    """Errors over the indicator, by the names of `HEADLINE`.

    Meshes may agree on a number by chance, so no ratio is below the root mean square over kappa_0 and F, and that not
    below MIN_RATIO. A rigidity whose change is within two standard deviations of its identification tells nothing about
    the mesh, nor does one of a single line beside one of two lines, which is another quantity; its ratio is that root
    mean square.
    """
    ratios = {name: _ratio(name, indicators, meshes) for name in HEADLINE if name != RIGIDITY}
    usual = max(MIN_RATIO, math.sqrt(sum(ratio**2 for ratio in ratios.values()) / len(ratios)))
    comparable = [index for index, mesh in enumerate(meshes) if mesh.has_two_lines == meshes[-1].has_two_lines]
    ratios[RIGIDITY] = _of_rigidity([indicators[i] for i in comparable], [meshes[i] for i in comparable])
    return {name: max(ratios[name], usual) for name in HEADLINE}


def _of_rigidity(indicators: Sequence[float], meshes: Sequence[RodNumbers]) -> float:
    """The ratio of alpha2 from meshes with equally many lines; zero where these tell nothing about it."""
    if len(meshes) < 2:
        return 0.0
    ratio = _ratio(RIGIDITY, indicators, meshes)
    of_difference = math.sqrt(2.0 * float(np.mean([mesh.alpha2_relative_std**2 for mesh in meshes])))
    return ratio if ratio * float(np.ptp(indicators)) > 2.0 * of_difference else 0.0


def _ratio(name: str, indicators: Sequence[float], meshes: Sequence[RodNumbers]) -> float:
    """Slope of the straight line through a number of two or three meshes over the indicator, relative to that of the
    last mesh, and the standard deviation of three from the line. Meshes have the inverse of their indicator as weight.
    """
    weights, freedom = 1.0 / np.array(indicators), max(len(meshes) - 2, 1)
    values = np.array([getattr(mesh, name) for mesh in meshes])
    relative = values / values[-1]
    line = np.polyfit(indicators, relative, 1, w=weights)
    residuals = weights * (relative - np.polyval(line, indicators))
    return math.hypot(float(line[0]), float(np.linalg.norm(residuals)) / math.sqrt(freedom))
