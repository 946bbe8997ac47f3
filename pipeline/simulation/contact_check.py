"""The comparison of contact by pairs of walls with exact distances between them."""

from dataclasses import dataclass, replace

import numpy as np

import fem

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
        if self.end_mm is None or self.end_N is None:
            return f"sliding contact is approximate by an unknown amount ({self.reason})"
        return (
            f"sliding contact is approximate: exact distances move the end by {self.end_mm:.2g} mm and change the "
            f"force on it by {self.end_N:.2g} N"
        )
