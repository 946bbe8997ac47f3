"""The comparison of contact by pairs of walls with exact distances between them, and of contact in creases with
that searched anew."""

from dataclasses import dataclass, replace
from math import isinf

import numpy as np

import fem

#: why a state is compared
BESIDE = "walls of a cavity have moved along each other, so that their contact is approximate"
#: what a state is whose contact in creases (`fem.Step.path_dependence`) may not be that of its load alone
PATH_DEPENDENT = (
    "folded walls of a cavity may touch in more than one way, and in which of them they do may depend on the load "
    "increments"
)
#: mm and N; smaller differences are not told
NOTHING = 1e-5


@dataclass(frozen=True)
class ContactCheck:
    """How far a state is from the equilibrium with exact distances between walls (`fem.Step.exact`)."""

    end_mm: float | None  #: distance of the two ends; None where there is no such equilibrium
    end_N: float | None  #: difference of the two forces on the end
    reason: str = ""  #: why there is none

    @classmethod
    def of(cls, experiment: fem.Experiment, step: fem.Step) -> "ContactCheck | None":
        """None for a step that needs no comparison."""
        if step.inexact:
            return cls(None, None, fem.sentence(step.inexact))
        if step.exact is None:
            return None
        exact = replace(step, displacement=step.exact.displacement, gradient=step.exact.gradient)
        end = np.linalg.norm(np.subtract(experiment.end(exact), experiment.end(step)))
        force = np.linalg.norm(np.subtract(experiment.end_force(exact), experiment.end_force(step)))
        return cls(float(end), float(force))

    @property
    def clause(self) -> str:
        """What it means for the state."""
        return f"{BESIDE}: {self.difference}"

    @property
    def difference(self) -> str:
        """By how much end and force differ, or that this is not known."""
        if self.end_mm is None or self.end_N is None:
            return f"how far is not known, because the comparison with exact distances failed ({self.reason})"
        errors = ((self.end_mm, "mm", "the end is displaced by"), (self.end_N, "N", "the force on the end differs by"))
        differences = [f"{what} {error:.2g} {unit}" for error, unit, what in errors if error > NOTHING]
        return f"with exact distances between them {' and '.join(differences) or 'the end and its force are the same'}"


def path_dependence(*differences: float) -> str:
    """By how much states differ at most, or that this is not known (infinity), as a clause."""
    largest = max(differences)
    if isinf(largest):
        return "contact searched anew led to no equilibrium to compare with"
    by = "by at most" if len(differences) > 1 else "by"
    return f"the equilibrium with contact searched anew differs {by} {100 * largest:.2g} % in displacement or strain"
