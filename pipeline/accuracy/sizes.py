"""The sizes that requested accuracies need, and what they cost, from the pilots."""

from dataclasses import dataclass
from math import ceil, floor

import fem
from pipeline.accuracy.error_model import MeshErrorModel, Pilot
from pipeline.config.kinds import MOST_ACCURACY

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
        return self.with_size(floor(100.0 * size) / 100.0, accuracy)

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
            accuracy = self.with_size(floor(100.0 * self.smallest_mm) / 100.0, accuracy).estimated_error
        return ceil(1000.0 * accuracy - 1e-6) / 1000.0

    def compared(self, accuracy: float) -> tuple[Choice, ...]:
        """The choices for some accuracies around the requested one, the largest first."""
        others = [factor * accuracy for factor in COMPARED if factor * accuracy <= MOST_ACCURACY]
        return tuple(self.choice(value) for value in sorted((accuracy, *others), reverse=True))
