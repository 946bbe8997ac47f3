"""Model of the discretisation errors of the headline numbers, from a few meshes and their error indicators, and the
sizes that requested accuracies need.

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

import fem
from pipeline.accuracy.measure import HEADLINE, RIGIDITY, RodNumbers
from pipeline.config.kinds import MOST_ACCURACY

#: bounds of the order with which the energy of the error falls with the mesh size: at a re-entrant edge stresses grow
#: at most as r^(-1/2), and in a smooth body the strain of quadratic elements converges with order 2
SLOWEST, FASTEST = 1.0, 4.0
#: smallest ratio of error to indicator, as root mean square over kappa_0 and F: that of the finest meshes of
#: studies/accuracy.md, so that meshes that agree by chance are not taken as exact
MIN_RATIO = 0.25
#: fraction of the requested error that contact may have, and fraction of the rest that the mesh is planned for
CONTACT_FRACTION, MESH_FRACTION = 0.4, 0.8
#: relative error per activation distance over the gap: the largest measured, that of F on the gapped pneu-net arm
ERROR_PER_DISTANCE = 0.7
#: smallest activation distance over the gap: half of it takes three times the factorizations, because walls enter and
#: leave so thin a barrier between Newton iterations
MIN_DISTANCE = 0.01
#: powers with which unknowns grow with the inverse of the size, and CPU seconds with the unknowns: 1.5 to 1.8 and 1.1
#: to 1.3 on the meshes graded to the walls of studies/accuracy.md, from the size of the finer pilot to the finest
UNKNOWNS_ORDER, SECONDS_ORDER = 1.6, 1.25
#: accuracies that are compared with the requested one, over that
COMPARED = (2.0, 0.5)


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


@dataclass(frozen=True)
class Choice:
    """The mesh for an accuracy, and what it costs."""

    accuracy: float  #: requested relative error
    size_mm: float
    contact_dhat_mm: float | None
    estimated_of_contact: float
    estimated_error: float  #: the largest, contact included
    degrees_of_freedom: int  #: expected
    cpu_seconds: float  #: expected, of experiments II and III at the lowest pressure

    @property
    def is_reached(self) -> bool:
        """Whether the estimated error is within the accuracy."""
        return self.estimated_error <= self.accuracy


@dataclass(frozen=True)
class Sizes:
    """The sizes between bounds (mm), their errors and their cost."""

    model: MeshErrorModel
    pilots: tuple[Pilot, Pilot]  #: the coarser first
    gap_mm: float | None  #: between facing walls; None where no faces can meet
    given_dhat_mm: float | None  #: activation distance of the configuration, which is kept
    smallest_mm: float
    largest_mm: float

    def choice(self, accuracy: float) -> Choice:
        """The size for an accuracy, within the bounds."""
        _, of_contact = self._contact(accuracy)
        # a given distance may exceed its part
        of_mesh = max(accuracy - of_contact, (1.0 - CONTACT_FRACTION) * accuracy)
        size = min(max(self.model.size_for(MESH_FRACTION * of_mesh), self.smallest_mm), self.largest_mm)
        return self.with_size(math.floor(100.0 * size) / 100.0, accuracy)

    def with_size(self, size_mm: float, accuracy: float) -> Choice:
        """What a size leads to; contact is chosen for the accuracy."""
        distance, of_contact = self._contact(accuracy)
        error = max(self.model.at(size_mm).values()) + of_contact
        fine = self.pilots[1]
        refinement = fine.size_mm / size_mm
        freedom = fine.degrees_of_freedom * refinement**UNKNOWNS_ORDER
        seconds = fine.cpu_seconds * (freedom / fine.degrees_of_freedom) ** SECONDS_ORDER
        return Choice(accuracy, size_mm, distance, of_contact, error, round(freedom), seconds)

    def _contact(self, accuracy: float) -> tuple[float | None, float]:
        """The largest activation distance (mm) whose relative error is the part of contact, unless one is given, and
        its error."""
        if self.gap_mm is None:
            return None, 0.0
        relative = min(fem.ACTIVATION, max(CONTACT_FRACTION * accuracy / ERROR_PER_DISTANCE, MIN_DISTANCE))
        distance = self.given_dhat_mm or relative * self.gap_mm
        return distance, ERROR_PER_DISTANCE * distance / self.gap_mm

    @property
    def best_accuracy(self) -> float:
        """The smallest accuracy in steps of 0.1 % whose estimated error is within it."""
        accuracy = MOST_ACCURACY
        for _ in range(50):  # the error of contact changes by 0.4 of what the accuracy does
            accuracy = self.with_size(math.floor(100.0 * self.smallest_mm) / 100.0, accuracy).estimated_error
        return math.ceil(1000.0 * accuracy - 1e-6) / 1000.0

    def compared(self, accuracy: float) -> tuple[Choice, ...]:
        """The choices for some accuracies around the requested one, the largest first."""
        others = [factor * accuracy for factor in COMPARED if factor * accuracy <= MOST_ACCURACY]
        return tuple(self.choice(value) for value in sorted((accuracy, *others), reverse=True))
